"""User stories: refining the warp to the whole surface, in the window."""

from __future__ import annotations

import itertools
import shutil
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication, QTabBar
from tests.cli.conftest import Command
from tests.core.bones import bone, landmarks, truth
from tests.core.femur import femur_landmarks, femur_meshes

from pinwarp.core.basis import Basis
from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import PenaltyConvention
from pinwarp.gui.refining import words
from pinwarp.gui.scene.drawables import Badge, Colouring, Legend
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.session import edits
from pinwarp.session.judging.check import check
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.outputs.exports import warped_mesh
from pinwarp.session.session import Session
from pinwarp.session.warp.refined import OUT_OF_DATE, refinement_in_use

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
LEFT, CONTROL = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def file(tmp_path):
    """A session of two small bones, which are drawn and refined in no time."""
    source = bone(24, 40)
    write_mesh(tmp_path / "source.ply", source)
    write_mesh(tmp_path / "destination.ply", source.with_vertices(truth(source.vertices)))
    u = landmarks(10)
    pairs = (
        Landmark(f"p{i}", as_position(a), as_position(b))
        for i, (a, b) in enumerate(zip(u, truth(u), strict=True))
    )
    meshes = (read_mesh(tmp_path / f"{side.value}.ply") for side in Side)
    write_session(tmp_path / "bones.pinwarp.csv", Session(*meshes, tuple(pairs)))
    return tmp_path / "bones.pinwarp.csv"


@pytest.fixture
def user(user, file):
    """Has opened the small bones, and looks at the panel of the refinement."""
    opened(user, file)
    return user


def opened(user, path):
    user.dialogs.opens.append(path)
    user.trigger("open_session")
    show_panel(user)


def panel(user):
    return user.window.parts.refining.panel


def run(user):
    return user.window.parts.refining.run


def drawn(user):
    return np.array(user.window.viewports[DESTINATION].overlay_points)


def shown(user, kind):
    return user.window.viewports[DESTINATION].drawn(kind)


def show_panel(user, title="Refine"):
    for bar in user.window.findChildren(QTabBar):
        for number in range(bar.count()):
            if bar.tabText(number) == title:
                QTest.mouseClick(bar, LEFT, pos=bar.tabRect(number).center())
    user.settle()


def click(user, button, *, settled=True):
    panel(user).ensureWidgetVisible(button)
    assert button.isVisible(), button.text()
    assert button.isEnabled(), button.text()
    QTest.mouseClick(button, LEFT)
    if settled:
        user.settle()


def type_in(user, line, text):
    panel(user).ensureWidgetVisible(line)
    QTest.mouseClick(line, LEFT)
    line.selectAll()
    user.qtbot.keyClicks(line, text)
    QTest.keyClick(line, Qt.Key.Key_Return)
    user.settle()


def refine(user, feature=80, *, settled=True):
    type_in(user, panel(user).feature.line, str(feature))
    click(user, panel(user).refine, settled=settled)


def begin(user, feature=15):
    """Refine until the first level is drawn; the next ones wait for the window."""
    start = drawn(user)
    refine(user, feature, settled=False)
    user.qtbot.waitUntil(lambda: run(user).level is not None, timeout=30_000)
    user.qtbot.waitUntil(lambda: np.abs(drawn(user) - start).max() > 1e-3, timeout=30_000)
    return start


@contextmanager
def levels_of(user):
    """What is drawn and said whenever a level has arrived and been surveyed."""
    seen = []

    def look(_survey):
        if run(user).level is not None:
            user.window.scenes.show_now()
            seen.append((panel(user).stage.text(), drawn(user), shown(user, Colouring)))

    user.window.parts.maps.map_changed.connect(look)
    yield seen
    user.window.parts.maps.map_changed.disconnect(look)


def status(user):
    return user.window.statusBar().currentMessage()


def test_one_refines_by_mouse_sees_every_level_and_undoes_it_in_one_step(user, sample_copy):
    opened(user, sample_copy)
    user.trigger("map_distance")
    before, start = user.session, drawn(user)
    assert panel(user).state.text() == words.NOT_REFINED
    assert panel(user).feature.line.text() == "7.066"
    with levels_of(user) as seen:
        refine(user, 60)
    assert [words for words, _, _ in seen] == [
        f"Level {number} of 5: features larger than {feature} mm"
        for number, feature in enumerate((225, 157, 110, 77.1, 60), 1)
    ]
    pictures = [start, *(points for _, points, _ in seen)]
    for one, other in itertools.pairwise(pictures):
        assert np.abs(one - other).max() > 0.01
    # The map follows, in the range it had.
    assert all(colouring is not None for _, _, colouring in seen)
    assert len({colouring.range for _, _, colouring in seen}) == 1

    assert user.editor.undo_label == "Refine to surface"
    assert replace(user.session, refinement=None) == before
    assert np.abs(drawn(user) - warped_mesh(user.session).vertices).max() < 0.01
    assert panel(user).state.text().startswith("Refined: ")
    assert "No folds." in panel(user).state.text()
    mean = check(user.session).distance.mean
    assert f"→ {mean:.3g} mm (fitted): it proves nothing." in panel(user).state.text()
    assert shown(user, Legend).title == "Distance to the destination (fitted)"
    assert "proves nothing" in user.window.parts.maps.panel.meaning.text()
    assert "Bars (fitted)" in user.window.parts.maps.panel.series.text()
    note = user.window.parts.refining.note
    assert note.label.text().endswith("fitted pairs")
    assert not note.again.isVisible()

    user.press(Qt.Key.Key_Z, CONTROL)
    assert user.session == before
    assert np.abs(drawn(user) - start).max() < 1e-3
    assert panel(user).state.text() == words.NOT_REFINED
    assert shown(user, Legend).title == "Distance to the destination"
    user.press(Qt.Key.Key_Y, CONTROL)
    assert refinement_in_use(user.session) is not None
    click(user, panel(user).remove)
    assert user.session == before
    assert user.editor.undo_label == "Remove refinement"


def test_saved_and_opened_again_it_is_what_the_command_makes_bit_for_bit(user, file, state_folder):
    other = Path(shutil.copy(file, file.with_name("other.pinwarp.csv")))
    refine(user)
    # Unsaved it is in the journal already.
    user.qtbot.waitUntil(
        lambda: any(
            "# refine" in path.read_text(errors="replace")
            for path in state_folder.rglob("*")
            if path.is_file()
        ),
        timeout=5000,
    )
    user.press(Qt.Key.Key_S, CONTROL)
    picture, refined = drawn(user), user.session
    kept = read_session(file)
    assert kept.refinement == refined.refinement
    Command()("refine", other, "--feature", 80)
    made = read_session(other)
    assert made.refinement == kept.refinement
    np.testing.assert_array_equal(warped_mesh(made).vertices, warped_mesh(kept).vertices)

    user.dialogs.opens.append(other)
    user.trigger("open_session")
    np.testing.assert_array_equal(drawn(user), picture)
    assert panel(user).options.smallest_feature == 80
    assert panel(user).refine.text() == "Refine Again"
    click(user, panel(user).refine)
    assert user.session.refinement == kept.refinement


def test_cancelling_keeps_the_start(user):
    before, undo = user.session, user.editor.undo_label
    start = begin(user)
    assert panel(user).stage.text().startswith("Level ")
    assert not panel(user).refine.isVisible()
    click(user, panel(user).cancel)
    assert (user.session, user.editor.undo_label) == (before, undo)
    assert np.abs(drawn(user) - start).max() < 1e-3
    assert status(user) == words.CANCELLED
    assert panel(user).refine.isVisible()
    assert not panel(user).cancel.isVisible()
    refine(user, 60)
    assert refinement_in_use(user.session) is not None


def test_holding_r_shows_the_landmarks_warp_with_its_map(user):
    QTest.keyPress(user.window, Qt.Key.Key_R)
    assert status(user) == words.NOTHING_TO_COMPARE
    QTest.keyRelease(user.window, Qt.Key.Key_R)
    user.trigger("map_distance")
    start = drawn(user)
    refine(user)
    refined, legend = drawn(user), shown(user, Legend)
    # The keyboard did not go to a field when the button went.
    QTest.keyPress(QApplication.focusWidget(), Qt.Key.Key_R)
    user.settle()
    assert np.abs(drawn(user) - start).max() < 1e-3
    assert shown(user, Badge).words == "R: without refinement (hold)"
    # By colour the two can be compared.
    assert shown(user, Legend).range == legend.range
    assert shown(user, Legend).title == "Distance to the destination"
    assert refinement_in_use(user.session) is not None
    assert not user.editor.is_previewing
    QTest.keyRelease(user.window, Qt.Key.Key_R)
    user.settle()
    assert np.abs(drawn(user) - refined).max() < 1e-3
    assert shown(user, Badge) is None
    assert shown(user, Legend) == legend

    click(user, panel(user).without)
    assert np.abs(drawn(user) - start).max() < 1e-3
    assert shown(user, Badge).words == "Without refinement"
    click(user, panel(user).without)
    assert np.abs(drawn(user) - refined).max() < 1e-3


def test_after_a_drag_it_is_out_of_date_and_a_button_refines_again(user):
    refine(user)
    old = user.session.refinement
    user.drag_a_landmark()
    note = user.window.parts.refining.note
    assert panel(user).state.text() == OUT_OF_DATE
    assert note.label.text() == "The refinement is out of date"
    assert note.again.isVisible()
    landmarks_only = warped_mesh(replace(user.session, refinement=None)).vertices
    assert np.abs(drawn(user) - landmarks_only).max() < 0.01
    QTest.mouseClick(note.again, LEFT)
    user.settle()
    assert user.session.refinement != old
    assert refinement_in_use(user.session) is not None
    assert not note.again.isVisible()

    # The penalty slider takes over live.
    figures = user.window.parts.penalty.panel.figures
    assert "not of the refined one" in figures.left_out.toolTip()
    assert "not refined" in user.window.parts.penalty.panel.plot.plotted.title
    slider = user.window.parts.penalty.panel.slider
    start = QPoint(round(slider.place_of(0)), slider.height() // 2)
    user.drag(slider, start, start + QPoint(60, 0), release=False)
    landmarks_only = warped_mesh(replace(user.session, refinement=None)).vertices
    assert np.abs(drawn(user) - landmarks_only).max() < 0.01
    assert user.window.parts.refining.note.label.text() == "The refinement is out of date"
    QTest.mouseRelease(slider, LEFT, pos=start + QPoint(60, 0))
    user.settle()
    assert panel(user).state.text() == OUT_OF_DATE
    assert "not of the refined one" not in figures.left_out.toolTip()
    user.press(Qt.Key.Key_Z, CONTROL)
    assert refinement_in_use(user.session) is not None


def test_an_edit_or_undo_meanwhile_cancels_it_and_counts(user):
    before = user.session
    begin(user)
    user.drag_a_landmark()
    assert user.session.pairs != before.pairs
    assert user.session.refinement is None
    assert status(user) == words.CHANGED
    assert np.abs(drawn(user) - warped_mesh(user.session).vertices).max() < 0.01
    assert panel(user).refine.isVisible()

    begin(user)
    user.press(Qt.Key.Key_Z, CONTROL)
    assert user.session == before
    assert status(user) == words.CHANGED


def test_what_it_does_not_depend_on_may_be_edited_meanwhile(user):
    name = user.session.pairs[0].name
    begin(user)
    user.editor.commit(edits.rename(user.session, name, "first"), "Rename")
    user.settle()
    assert user.editor.undo_label == "Refine to surface"
    assert user.session.landmark("first") is not None
    assert refinement_in_use(user.session) is not None

    # What is under the hand is waited for.
    user.press(Qt.Key.Key_Z, CONTROL)
    begin(user)
    user.editor.preview(edits.set_blend(user.editor.committed, 0.5))
    user.qtbot.waitUntil(lambda: user.window.long_jobs.is_idle, timeout=30_000)
    QApplication.processEvents()
    assert user.session.settings.blend == 0.5
    assert user.editor.committed.refinement is None
    user.editor.cancel_preview()
    user.settle()
    assert refinement_in_use(user.session) is not None


def test_another_session_may_be_opened_and_the_window_closed_meanwhile(user, file):
    begin(user)
    user.editor.replace_all(Session(), None)
    user.settle()
    assert user.session == Session()
    assert panel(user).refine.isVisible()
    assert "no source mesh" in panel(user).problem.text()

    opened(user, file)
    begin(user)
    user.window.close()
    assert not user.window.isVisible()
    assert user.editor.committed.refinement is None


def test_a_mesh_that_is_inside_out_is_turned_by_choice(user, tmp_path):
    other = tmp_path / "turned.ply"
    mesh = user.session.mesh(DESTINATION)
    write_mesh(other, Mesh(mesh.vertices, mesh.faces[:, ::-1]))
    user.editor.commit(user.session.with_mesh(DESTINATION, read_mesh(other)), "Replace mesh")
    user.settle()
    refine(user, 60)
    assert "inside out, most likely the destination" in panel(user).problem.text()
    assert user.session.refinement is None
    assert user.dialogs.errors == []
    click(user, panel(user).turn)
    assert user.session.refinement.turn_destination
    assert panel(user).problem.text() == ""
    assert panel(user).turned.isChecked()

    # And back again, where they fit as they are.
    write_mesh(other, mesh)
    user.editor.commit(user.session.with_mesh(DESTINATION, read_mesh(other)), "Replace mesh")
    user.settle()
    click(user, panel(user).refine)
    assert panel(user).problem.text() == words.ALREADY_TURNED
    click(user, panel(user).turn)
    assert not user.session.refinement.turn_destination


def flat(session):
    pairs = [replace(p, source=(*p.source[:2], 0.0)) for p in session.landmarks]
    return replace(session, landmarks=tuple(pairs))


def mirrored(session):
    x = np.array([-1.0, 1.0, 1.0])
    pairs = [replace(p, source=as_position(x * p.source)) for p in session.landmarks]
    return replace(session, landmarks=tuple(pairs))


def coincident(session):
    first, second, *others = session.landmarks
    return replace(session, landmarks=(first, replace(second, source=first.source), *others))


NOT_YET = {
    "There is no destination mesh: open the bone": lambda s: s.with_mesh(DESTINATION, None),
    "There is no source mesh: open the bone": lambda s: s.with_mesh(SOURCE, None),
    "There are 3 pairs of landmarks, and a surface can be fitted from 4 on: place more.": (
        lambda s: replace(s, landmarks=s.landmarks[:3])
    ),
    "There are no pairs of landmarks": lambda s: replace(s, landmarks=()),
    "A warp of the OPYNSIM convention can be refined at penalty 0 only": lambda s: (
        edits.set_convention(edits.set_penalty(s, 3.0), PenaltyConvention.OPYNSIM)
    ),
    "A warp can be refined with the basis r only": lambda s: edits.set_basis(s, Basis.R2_LOG_R),
    "At an infinite penalty the warp is the affine fit": lambda s: edits.set_penalty(s, np.inf),
}
REFUSED = {
    "All source landmarks lie in one plane": flat,
    "The landmarks mirror the source": mirrored,
    "lie at one place of the source: remove or disable one of them.": coincident,
}


def test_what_is_missing_is_said_in_the_panel_before_one_tries(user):
    whole = user.session
    for reason, change in NOT_YET.items():
        user.editor.commit(change(whole), "Change")
        user.settle()
        session = user.session
        assert reason in panel(user).problem.text()
        assert panel(user).problem.isVisible()
        assert not panel(user).refine.isEnabled()
        user.press(Qt.Key.Key_R, CONTROL)
        assert user.session is session
        assert user.window.is_settled
    assert panel(user).tolerance.line.text() == "affine"
    type_in(user, panel(user).tolerance.line, "0")
    assert panel(user).problem.text() == ""
    assert panel(user).refine.isEnabled()
    assert user.dialogs.errors == []


def test_what_cannot_be_fitted_is_said_in_the_panel_and_changes_nothing(user):
    whole = user.session
    for reason, change in REFUSED.items():
        user.editor.commit(change(whole), "Change")
        user.settle()
        session, picture = user.session, drawn(user)
        assert panel(user).problem.text() == ""
        user.press(Qt.Key.Key_R, CONTROL)
        assert reason in panel(user).problem.text()
        assert user.session is session
        assert np.abs(drawn(user) - picture).max() < 1e-3
        assert panel(user).refine.isEnabled()
    assert user.dialogs.errors == []


def test_lengths_that_are_none_are_refused_and_usual_ones_taken_back(user):
    feature, tolerance = panel(user).feature, panel(user).tolerance
    for line, text, least in (
        (feature.line, "0", "above 0"),
        (feature.line, "fine", "above 0"),
        (tolerance.line, "-1", "0 or more"),
    ):
        type_in(user, line, text)
        assert least in panel(user).problem.text()
    assert panel(user).options.smallest_feature is None
    type_in(user, feature.line, "12,5 mm")
    assert panel(user).options.smallest_feature == 12.5
    assert not feature.box.isChecked()
    slider = panel(user).slider
    middle = QPoint(slider.width() // 2, slider.height() // 2)
    user.drag(slider, slider_handle(slider), middle)
    assert 10 < panel(user).options.smallest_feature < 40
    click(user, feature.box)
    assert panel(user).options.smallest_feature is None
    type_in(user, tolerance.line, "2")
    assert panel(user).options.landmark_tolerance == 2


def slider_handle(slider) -> QPoint:
    share = slider.value() / slider.maximum()
    return QPoint(round(6 + share * (slider.width() - 12)), slider.height() // 2)


def test_the_check_leaves_each_landmark_out_and_tells_what_it_is_worth(user):
    assert not panel(user).check.isEnabled()
    refine(user, 60)
    click(user, panel(user).check)
    sentence = panel(user).sentence.text()
    assert sentence.startswith("Left out one by one, ")
    assert "of 10 landmarks are missed by less: RMS " in sentence
    for pair in user.session.pairs:
        assert f">{pair.name}<" in panel(user).table.text()
    user.editor.commit(edits.set_penalty(user.session, 5.0), "Change penalty")
    user.settle()
    assert not panel(user).sentence.isVisible()
    user.press(Qt.Key.Key_Z, CONTROL)
    assert panel(user).sentence.text() == sentence
    assert panel(user).sentence.isVisible()

    # Another one is cancelled.
    refine(user, 50)
    session = user.session
    click(user, panel(user).check, settled=False)
    user.qtbot.waitUntil(lambda: panel(user).bar.value() > 0, timeout=30_000)
    assert "without landmark" in panel(user).stage.text()
    click(user, panel(user).cancel)
    assert status(user) == words.CHECK_CANCELLED
    assert user.session is session
    assert not panel(user).sentence.isVisible()

    # A sweep of penalties is one of the landmarks.
    start = warped_mesh(replace(user.session, refinement=None)).vertices
    user.trigger("sweep")
    first = user.window.parts.snapshots.snapshots[0]
    assert first.inputs.refinement is None
    assert np.abs(drawn(user) - start).max() > 0.01, "the refinement is back"


def real_femur(user, shared_data, folder, keep=None):
    files = []
    for name, mesh in zip(("s.ply", "d.ply"), femur_meshes(shared_data), strict=True):
        faces = mesh.faces
        if name == "d.ply" and keep is not None:
            faces = faces[keep(mesh)]
        write_mesh(folder / name, Mesh(mesh.vertices, faces))
        files.append(read_mesh(folder / name))
    names, u, v = femur_landmarks(shared_data)
    pairs = (
        Landmark(name, as_position(a), as_position(b))
        for name, a, b in zip(names, u, v, strict=True)
    )
    user.editor.replace_all(Session(*files, tuple(pairs)), None)
    user.settle()


def upper_half(mesh):
    axis = int(np.argmax(np.ptp(mesh.vertices, axis=0)))
    along = mesh.vertices[mesh.faces].mean(axis=1)[:, axis]
    return along > np.median(along)


def test_the_real_femur_is_refined_by_mouse_at_three_levels_and_more(user, shared_data, tmp_path):
    real_femur(user, shared_data, tmp_path)
    seen = []
    user.window.parts.warps.result_changed.connect(
        lambda _result: seen.append((run(user).level is not None, drawn(user)))
    )
    refine(user, 12)
    levels = [points for is_level, points in seen if is_level]
    assert sum(np.abs(a - b).max() > 0.01 for a, b in itertools.pairwise(levels)) >= 3
    checked = check(user.session)
    assert checked.folded_vertices == 0
    assert checked.distance.mean < 0.5
    assert checked.rms_residual == 0


def test_half_a_real_femur_is_fitted_where_it_is(user, shared_data, tmp_path):
    real_femur(user, shared_data, tmp_path, upper_half)
    refine(user, 20)
    refined = user.session.refinement
    missing = refined.places - (len(refined.source) - 20)
    assert f"{missing} have no counterpart" in panel(user).state.text()
    assert check(user.session).folded_vertices == 0
    assert "No folds." in panel(user).state.text()
