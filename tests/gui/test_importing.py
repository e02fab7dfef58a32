"""User stories: landmark files come in, and a user sees before what they will do."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt, QTimer
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication, QDialogButtonBox, QLabel
from tests.gui.test_files import drop

from pinwarp.core.findings import FindingKind
from pinwarp.core.landmarks import Landmark, Side, scaled
from pinwarp.core.mesh import Mesh
from pinwarp.gui.app import PrintedMessages
from pinwarp.gui.files.documents import Opening
from pinwarp.gui.scene.drawables import Caption, ScaleBar
from pinwarp.gui.window.window_dialogs import WindowDialogs
from pinwarp.io.landmark_files import LandmarkReading, write_landmarks
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.io.samples import assets_folder, sample_session
from pinwarp.io.session_file import read_session
from pinwarp.session.importing.fit import Fit, fitted
from pinwarp.session.importing.landmarks import Arriving, Pairing
from pinwarp.session.mesh_units import scale_side
from pinwarp.session.rulers import Rulers
from pinwarp.session.session import Session

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
BY_NAME, BY_ORDER, AS_NEW, AS_PASSENGERS, ONLY_KNOWN = Pairing
OK, CANCEL = QDialogButtonBox.StandardButton.Ok, QDialogButtonBox.StandardButton.Cancel
LPS = Fit(flips=True)
IN_METRES, IN_MILLIMETRES = Fit(factor=0.001), Fit(factor=1000.0)


def press(dialog, button=OK):
    QTest.mouseClick(dialog.buttons.button(button), Qt.MouseButton.LeftButton)


def choose(button):
    """Click a radio button on its sign, as its words may end before its middle."""
    QTest.mouseClick(
        button,
        Qt.MouseButton.LeftButton,
        Qt.KeyboardModifier.NoModifier,
        QPoint(10, button.height() // 2),
    )
    assert button.isChecked()


def happenings(dialog):
    """What the last column says."""
    model = dialog.model
    column = model.columnCount() - 1
    return [model.index(i, column).data().strip() for i in range(model.rowCount())]


def numbers(dialog, row=0):
    """The coordinates of a row as they are shown."""
    return [float(dialog.model.index(row, axis).data()) for axis in (1, 2, 3)]


def titles(dialog):
    model = dialog.model
    horizontal = Qt.Orientation.Horizontal
    return [
        model.headerData(i, horizontal, Qt.ItemDataRole.DisplayRole).strip()
        for i in range(model.columnCount())
    ]


@pytest.fixture
def half_done(user):
    """The sample bones with the source landmarks only."""
    user.open_sample()
    pairs = [x for x in user.session.landmarks if x.is_pair]
    user.pairs = pairs
    halves = tuple(x.placed(DESTINATION, None) for x in pairs)
    user.editor.replace_all(replace(user.session, landmarks=halves), None)
    user.settle()
    return user


@pytest.fixture
def bring(user, tmp_path):
    """Import landmarks of one side from a file, in the window's own way."""

    def bring(landmarks, side, *at_import, name="bone.landmarks.csv", lines=()):
        path = tmp_path / name
        write_landmarks(path, landmarks, side, unit="mm")
        if lines:
            path.write_text(path.read_text() + "\n".join(lines) + "\n")
        user.dialogs.opens = [path]
        user.dialogs.at_import = list(at_import)
        user.trigger("import_pairs" if side is None else f"import_{side.value}")
        assert user.dialogs.at_import == []
        assert user.dialogs.errors == []

    return bring


def renamed(landmarks, name="F-{}"):
    return [replace(x, name=name.format(i)) for i, x in enumerate(landmarks)]


def destinations(user):
    return [x.destination for x in user.session.landmarks]


# The preview


def test_a_clean_file_that_matches_comes_in_without_a_question(half_done, bring):
    # In another order than in the session.
    bring(half_done.pairs[::-1], DESTINATION)
    assert len(half_done.session.pairs) == 16
    assert "16 landmarks from bone.landmarks.csv" in half_done.window.statusBar().currentMessage()


def test_skipped_lines_are_shown_before_anything_changes(half_done, bring):
    def look(dialog):
        assert half_done.session.pairs == ()
        assert dialog.windowTitle() == "Import destination landmarks"
        rows = [dialog.skipped.topLevelItem(i) for i in range(dialog.skipped.topLevelItemCount())]
        assert [[row.text(i) for i in range(3)] for row in rows] == [
            ["18", "'two' is not a number", "broken,1,two,3"]
        ]
        press(dialog)

    bring(half_done.pairs, DESTINATION, look, lines=["broken,1,two,3"])
    assert len(half_done.session.pairs) == 16
    # The user has seen them: they are not told again.
    assert half_done.dialogs.told == []


@pytest.mark.parametrize(
    "way_out",
    [lambda d: press(d, CANCEL), lambda d: QTest.keyClick(d, Qt.Key.Key_Escape)],
    ids=["Cancel", "Escape"],
)
def test_cancel_changes_nothing(half_done, bring, way_out):
    before = half_done.session

    def cancel(dialog):
        choose(dialog.pairings[AS_NEW])
        way_out(dialog)

    bring(renamed(half_done.pairs), DESTINATION, cancel)
    assert half_done.session is before
    assert half_done.editor.undo_label is None
    assert "nothing was changed" in half_done.window.statusBar().currentMessage()


def test_other_names_are_matched_by_order_and_the_table_follows_the_choice(half_done, bring):
    names = [x.name for x in half_done.pairs]

    def look(dialog):
        assert dialog.choice.pairing is BY_ORDER
        assert happenings(dialog) == [f"pairs with {name}" for name in names]
        assert "none is known here" in dialog.pairings[BY_NAME].text()
        assert "16 wait for a destination position" in dialog.pairings[BY_ORDER].text()
        choose(dialog.pairings[BY_NAME])
        assert happenings(dialog) == ["new"] * 16
        assert dialog.outcome.text() == "16 are new."
        choose(dialog.pairings[BY_ORDER])
        assert happenings(dialog) == [f"pairs with {name}" for name in names]
        assert dialog.outcome.text() == "16 pair up."
        QTest.keyClick(dialog, Qt.Key.Key_Return)

    bring(renamed(half_done.pairs), DESTINATION, look)
    assert [x.name for x in half_done.session.landmarks] == names
    assert destinations(half_done) == [x.destination for x in half_done.pairs]
    assert half_done.editor.undo_label == "Import destination landmarks"
    assert "by order" in half_done.window.statusBar().currentMessage()
    half_done.trigger("undo")
    assert half_done.session.pairs == ()


def test_landmarks_can_come_as_new_whatever_their_names(half_done, bring):
    before = half_done.session.landmarks
    name = before[0].name

    def look(dialog):
        assert dialog.choice.pairing is BY_NAME
        choose(dialog.pairings[AS_NEW])
        assert happenings(dialog)[0] == f"new, called {name}_2"
        press(dialog)

    bring(half_done.pairs, DESTINATION, look, lines=["extra,1,2,3"])
    assert half_done.session.landmarks[:16] == before
    assert half_done.session.landmark(f"{name}_2").destination == half_done.pairs[0].destination


def test_a_name_that_matches_none_is_pointed_out(half_done, bring):
    arriving = [*half_done.pairs[1:], replace(half_done.pairs[0], name="misspelt")]

    def look(dialog):
        assert happenings(dialog)[-1] == "new"
        waits = half_done.pairs[0].name
        assert dialog.outcome.text() == (
            f"15 pair up, 1 is new (misspelt). 1 of the session still waits ({waits})."
        )
        press(dialog)

    bring(arriving, DESTINATION, look)
    assert len(half_done.session.pairs) == 15


def test_replacing_positions_is_asked_and_order_is_not_offered_where_nobody_waits(user, bring):
    user.open_sample()
    pairs = [x for x in user.session.landmarks if x.is_pair]
    corrected = [replace(pairs[0], destination=pairs[1].destination), *pairs[1:]]

    def look(dialog):
        assert happenings(dialog)[0] == f"replaces the position of {pairs[0].name}"
        assert set(happenings(dialog)[1:]) == {f"changes nothing of {x.name}" for x in pairs[1:]}
        assert not dialog.pairings[BY_ORDER].isEnabled()
        press(dialog)

    bring(corrected, DESTINATION, look)
    assert user.session.landmark(pairs[0].name).destination == pairs[1].destination


def test_the_dialog_says_what_the_file_says_about_frame_and_unit(half_done, tmp_path):
    path = tmp_path / "bone.fcsv"
    write_landmarks(path, renamed(half_done.pairs), DESTINATION, unit="mm")
    said = []

    def look(dialog):
        said.extend(label.text() for label in dialog.findChildren(type(dialog.outcome)))
        assert titles(dialog) == ["Name", "x (mm)", "y (mm)", "z (mm)", "What happens"]

    half_done.dialogs.at_import = [look]
    drop(half_done.window.viewports[DESTINATION], path)
    half_done.settle()
    assert "16 landmarks in bone.fcsv" in said
    assert "3D Slicer .fcsv – frame LPS, unit mm" in said


def test_a_file_dropped_with_another_waits_until_that_one_is_decided(half_done, tmp_path):
    seen = []
    paths = []
    for name in ("first", "second"):
        paths.append(tmp_path / f"{name}.csv")
        write_landmarks(paths[-1], renamed(half_done.pairs, f"{name}-{{}}"), DESTINATION)

    def import_first(dialog):
        seen.append(happenings(dialog)[0])
        # Long enough for the second file to be read.
        half_done.qtbot.waitUntil(lambda: half_done.window.jobs.is_idle)
        half_done.qtbot.wait(50)
        press(dialog)

    def import_second(dialog):
        seen.append(happenings(dialog)[0])
        press(dialog)

    half_done.dialogs.at_import = [import_first, import_second]
    drop(half_done.window.viewports[DESTINATION], *paths)
    half_done.settle()
    # Nobody waits for the second any more: all its names are new.
    assert seen == [f"pairs with {half_done.pairs[0].name}", "new"]
    assert len(half_done.session.landmarks) == 32
    assert half_done.session.landmark("second-3").source is None


# Frame and unit


@pytest.mark.parametrize(
    ("spoilt", "offer"),
    [
        (LPS, "With x and y negated (LPS to RAS or back)"),
        (IN_METRES, "Multiplied by 1,000 (m to mm)"),
        (IN_MILLIMETRES, "Divided by 1,000 (mm to m)"),
    ],
)
def test_another_frame_or_unit_is_offered_with_figures_and_undone_in_one_step(
    half_done, bring, spoilt, offer
):
    before = half_done.session

    def look(dialog):
        stored, better = dialog.fits[DESTINATION]
        assert (stored.text(), better.text()) == ("As stored", offer)
        assert better.isChecked()
        words = [label.text() for label in dialog.findChildren(type(dialog.outcome))]
        (question,) = (text for text in words if "How are they meant?" in text)
        assert "from the destination mesh in the median" in question
        assert re.search(r"\d m?m from", question)
        assert "on the mesh" in words
        right = half_done.pairs[0].destination
        assert np.allclose(numbers(dialog), right, atol=0.001)
        choose(stored)
        (moved,) = spoilt.applied(half_done.pairs[:1], DESTINATION)
        assert np.allclose(numbers(dialog), moved.destination, rtol=1e-5)
        choose(better)
        assert np.allclose(numbers(dialog), right, atol=0.001)
        press(dialog)

    bring(spoilt.applied(half_done.pairs, DESTINATION), DESTINATION, look)
    assert np.allclose(destinations(half_done), [x.destination for x in half_done.pairs], atol=1e-9)
    assert offer in half_done.window.statusBar().currentMessage()
    half_done.trigger("undo")
    assert half_done.session == before


def test_positions_can_be_kept_as_stored(half_done, bring):
    def keep(dialog):
        choose(dialog.fits[DESTINATION][0])
        press(dialog)

    spoilt = LPS.applied(half_done.pairs, DESTINATION)
    bring(spoilt, DESTINATION, keep)
    assert destinations(half_done) == [x.destination for x in spoilt]


def test_what_was_kept_is_listed_to_check_until_a_click_puts_it_right(half_done, bring):
    def keep(dialog):
        choose(dialog.fits[DESTINATION][0])
        press(dialog)

    bring(LPS.applied(half_done.pairs, DESTINATION), DESTINATION, keep)
    half_done.settle()
    panel = half_done.window.parts.findings.panel
    row = panel.rows[0]
    assert "The destination landmarks lie" in row.found.sentence
    assert "they are in another frame." in row.found.sentence
    assert row.remedy.text() == "Negate x and y"
    assert row.disable.isHidden()
    QTest.mouseClick(row.remedy, Qt.MouseButton.LeftButton)
    half_done.settle()
    right = [x.destination for x in half_done.pairs]
    assert np.allclose(destinations(half_done), right, atol=1e-9)
    assert not any("another frame" in row.found.sentence for row in panel.rows)
    half_done.trigger("undo")
    half_done.settle()
    assert "another frame" in panel.rows[0].found.sentence


def test_what_was_kept_is_put_right_also_where_bones_in_metres_are_shown_in_millimetres(
    user, bring
):
    user.open_sample()
    metres = scale_side(scale_side(user.session, SOURCE, 0.001), DESTINATION, 0.001)
    right = [x.destination for x in metres.landmarks]
    off = fitted(metres, DESTINATION, LPS)
    user.editor.replace_all(off, None)
    user.settle()
    assert user.editor.rulers.session.unit == "mm"
    row = user.window.parts.findings.panel.rows[0]
    assert row.remedy.text() == "Negate x and y"
    assert " mm from their mesh" in row.found.sentence
    QTest.mouseClick(row.remedy, Qt.MouseButton.LeftButton)
    user.settle()
    there = [x.destination for x in user.session.landmarks if x.destination is not None]
    assert np.allclose(there, [x for x in right if x is not None], atol=1e-12)
    user.trigger("undo")
    assert user.session == off


def test_a_mesh_exchanged_under_its_landmarks_is_listed_until_the_right_one_is_opened(
    user, tmp_path
):
    user.open_sample()
    panel = user.window.parts.findings.panel
    mesh = user.session.mesh(DESTINATION)
    other = tmp_path / "other.ply"
    write_mesh(other, mesh.with_vertices(mesh.vertices[:, [1, 2, 0]] + 900.0))
    user.window.parts.documents.open_mesh(DESTINATION, other)
    user.settle()
    row = panel.rows[0]
    assert "is it the one that they were placed on?" in row.found.sentence
    assert row.remedy.text() == "Open Mesh…"
    # Whoever goes from finding to finding comes past it, and to the next one.
    user.press(Qt.Key.Key_N, Qt.KeyboardModifier.ShiftModifier)
    user.dialogs.opens = [assets_folder() / "femur_subject.ply"]
    QTest.mouseClick(row.remedy, Qt.MouseButton.LeftButton)
    user.settle()
    assert user.dialogs.opens == []
    assert not any("placed on" in row.found.sentence for row in panel.rows)
    assert user.editor.undo_label == "Open destination mesh"


def test_units_that_were_left_are_listed_with_the_ways_to_scale(user):
    user.open_sample()
    apart = scale_side(user.session, SOURCE, 0.001)
    user.editor.replace_all(apart, None)
    user.settle()
    panel = user.window.parts.findings.panel
    (row,) = [x for x in panel.rows if x.found.finding.kind is FindingKind.UNITS]
    assert "worth knowing" in panel.header.text()
    assert row.remedy.text() == "Scale"
    first, second = row.which.actions()
    assert first.text() == "Scale the Source by 1,000"
    assert second.text() == "Scale the Destination by 1/1,000"

    QTest.mouseClick(row.remedy, Qt.MouseButton.LeftButton)
    user.qtbot.waitUntil(row.which.isVisible)
    QTest.keyClick(row.which, Qt.Key.Key_Down)
    QTest.keyClick(row.which, Qt.Key.Key_Return)
    user.settle()
    assert user.editor.undo_label == "Scale source by 1,000"
    assert user.session.mesh(SOURCE).diagonal > 100
    assert not any(x.found.finding.kind is FindingKind.UNITS for x in panel.rows)
    user.trigger("undo")
    assert user.session == apart


def test_pairs_are_judged_on_either_side(user, bring):
    user.open_sample()
    pairs = [x for x in user.session.landmarks if x.is_pair]
    user.editor.replace_all(replace(user.session, landmarks=()), None)

    def look(dialog):
        assert list(dialog.fits) == [SOURCE]
        assert titles(dialog)[1:4] == ["S x (mm)", "S y (mm)", "S z (mm)"]
        press(dialog)

    bring(scaled(pairs, 0.001, SOURCE), None, look)
    assert len(user.session.pairs) == 16
    assert np.allclose([x.source for x in user.session.pairs], [x.source for x in pairs])
    assert destinations(user) == [x.destination for x in pairs]


def test_millimetres_on_a_real_bone_in_metres(user, shared_data, tmp_path):
    folder = shared_data / "opensim-creator-femur"
    lines = (folder / "subject_femur_r.landmarks.csv").read_text().splitlines()
    rows = [line.split(",") for line in lines[1:]]
    path = tmp_path / "subject_mm.csv"
    path.write_text(
        "name,x,y,z\n"
        + "".join(f"{name},{','.join(str(1000 * float(x)) for x in v)}\n" for name, *v in rows)
    )
    user.window.parts.documents.open_mesh(DESTINATION, folder / "subject_femur_r.obj")
    user.settle()

    def look(dialog):
        words = " ".join(label.text() for label in dialog.findChildren(type(dialog.outcome)))
        assert "As stored they lie 172 m from the destination mesh" in words
        assert titles(dialog)[1] == "x (m)"
        press(dialog)

    user.dialogs.at_import = [look]
    drop(user.window.viewports[DESTINATION], path)
    user.settle()
    assert np.allclose(destinations(user), [[float(x) for x in v] for _, *v in rows], rtol=1e-12)


# Landmarks before their mesh, and the command line


def test_a_mesh_opened_after_its_landmarks_offers_to_correct_them_once(user, bring):
    pairs = [x for x in read_session(sample_session()).landmarks if x.is_pair]
    # Without a mesh there is nothing to compare with, and nothing is asked.
    bring(LPS.applied(pairs, SOURCE), SOURCE)
    user.dialogs.choices = [0]
    user.window.parts.documents.open_mesh(SOURCE, assets_folder() / "femur_generic.ply")
    user.settle()
    ((_, text, more, labels),) = user.dialogs.choice_questions
    assert "source landmarks lie" in text
    assert "mm from the mesh in the median" in text
    assert "With x and y negated (LPS to RAS or back): on the mesh." in more
    assert labels == ["Negate x and y", "Leave As They Are"]
    assert [x.source for x in user.session.landmarks] == [x.source for x in pairs]
    user.trigger("undo")
    assert user.session.mesh(SOURCE) is not None
    assert user.session.landmarks[0].source != pairs[0].source
    user.trigger("redo")
    # All is well now: the other mesh raises no further question.
    user.window.parts.documents.open_mesh(DESTINATION, assets_folder() / "femur_subject.ply")
    user.settle()
    assert len(user.dialogs.choice_questions) == 1


def test_an_offer_that_is_declined_changes_nothing(user, bring):
    pairs = [x for x in read_session(sample_session()).landmarks if x.is_pair]
    spoilt = LPS.applied(pairs, SOURCE)
    bring(spoilt, SOURCE)
    user.window.parts.documents.open_mesh(SOURCE, assets_folder() / "femur_generic.ply")
    user.settle()
    assert len(user.dialogs.choice_questions) == 1
    assert [x.source for x in user.session.landmarks] == [x.source for x in spoilt]
    assert user.editor.undo_label == "Open source mesh"


def test_files_of_the_command_line_come_in_at_once_and_tell_afterwards(user, tmp_path):
    pairs = [x for x in read_session(sample_session()).landmarks if x.is_pair]
    paths = {side: tmp_path / f"{side.value}.csv" for side in Side}
    write_landmarks(paths[SOURCE], pairs, SOURCE)
    write_landmarks(paths[DESTINATION], LPS.applied(renamed(pairs), DESTINATION), DESTINATION)
    with paths[DESTINATION].open("a") as stream:
        stream.write("broken,1,two,3\n")
    user.window.parts.documents.open(
        Opening(
            source=assets_folder() / "femur_generic.ply",
            destination=assets_folder() / "femur_subject.ply",
            source_landmarks=paths[SOURCE],
            destination_landmarks=paths[DESTINATION],
        )
    )
    user.settle()
    assert [x.name for x in user.session.pairs] == [x.name for x in pairs]
    ((title, text, details),) = user.dialogs.told
    assert title == "Some lines were skipped"
    assert "1 line was skipped" in text
    assert "Line 18" in details
    ((_, text, _, _),) = user.dialogs.choice_questions
    assert "destination landmarks lie" in text
    # Nobody has agreed to a change.
    expected = LPS.applied(pairs, DESTINATION)
    assert destinations(user) == [x.destination for x in expected]


# Meshes in different units


@pytest.fixture
def small_bone(tmp_path):
    """The sample's source in metres."""
    mesh = read_mesh(assets_folder() / "femur_generic.ply").mesh
    path = tmp_path / "generic_m.ply"
    write_mesh(path, mesh.with_vertices(mesh.vertices / 1000))
    return path


def open_apart(user, small_bone):
    user.window.parts.documents.open_mesh(SOURCE, small_bone)
    user.settle()
    assert user.session.unit == "m"
    user.window.parts.documents.open_mesh(DESTINATION, assets_folder() / "femur_subject.ply")
    user.settle()


def test_a_mesh_in_another_unit_can_be_scaled_and_the_session_remembers(user, small_bone, tmp_path):
    user.dialogs.choices = [1]
    open_apart(user, small_bone)
    ((title, text, _, labels),) = user.dialogs.choice_questions
    assert title == "Different units?"
    assert "destination is 924 times as large as the source: 415.5 and 0.4496 across" in text
    assert "in their own numbers" in text
    assert labels == [
        "Scale the Destination by 1/1,000",
        "Scale the Source by 1,000",
        "Leave Both",
    ]
    assert np.isclose(user.session.mesh(SOURCE).diagonal, 449.588, rtol=1e-5)
    assert user.session.unit == "mm"
    assert user.window.viewports[SOURCE].drawn(Caption).file == "generic_m.ply (× 1000)"
    path = tmp_path / "scaled.pinwarp.csv"
    user.dialogs.saves = [path]
    user.trigger("save_as")
    scaled_mesh = user.session.mesh(SOURCE)
    user.dialogs.opens = [path]
    user.trigger("open_session")
    assert np.array_equal(user.session.mesh(SOURCE).vertices, scaled_mesh.vertices)
    assert user.dialogs.told == []
    assert read_mesh(small_bone).mesh.diagonal < 1


def test_scaling_takes_the_landmarks_along_and_is_one_step(user, small_bone, bring):
    bring([Landmark("a", None, (100, 200, 300))], DESTINATION)
    user.dialogs.choices = [0]
    open_apart(user, small_bone)
    assert np.allclose(user.session.landmark("a").destination, (0.1, 0.2, 0.3))
    assert user.session.unit == "m"
    assert user.editor.undo_label == "Scale destination by 1/1,000"
    user.trigger("undo")
    assert user.session.landmark("a").destination == (100, 200, 300)
    assert user.session.mesh(DESTINATION).diagonal > 400


def test_a_unit_that_is_wrong_on_one_side_is_not_shown_there(user, small_bone):
    open_apart(user, small_bone)
    assert user.window.viewports[SOURCE].drawn(ScaleBar).ruler.unit == "m"
    assert user.window.viewports[DESTINATION].drawn(ScaleBar).ruler.unit == ""
    model = user.window.parts.table.model
    columns = {model.title(number) for number in range(model.columnCount())}
    assert {"Source x\nm", "Dest. x", "Residual", "Left out"} <= columns


def test_sizes_that_no_unit_explains_are_only_told(user, tmp_path):
    path = tmp_path / "huge.ply"
    write_mesh(path, Mesh(1e9 * np.eye(3), [[0, 1, 2]]))
    user.window.parts.documents.open_mesh(SOURCE, assets_folder() / "femur_generic.ply")
    user.window.parts.documents.open_mesh(DESTINATION, path)
    user.settle()
    assert user.dialogs.choice_questions == []
    ((title, text, _),) = user.dialogs.told
    assert title == "Different units?"
    assert "times as large as the source" in text


def test_real_pelves_in_metres_and_millimetres(user, shared_data):
    folder = shared_data / "msk-morph-pelvis"
    user.dialogs.choices = [0]
    user.window.parts.documents.open_mesh(SOURCE, folder / "template_pelvis_r.stl")
    user.settle()
    assert user.dialogs.choice_questions == []
    user.window.parts.documents.open_mesh(DESTINATION, folder / "target_pelvis_r.stl")
    user.settle()
    assert len(user.dialogs.choice_questions) == 1
    assert 0.2 < user.session.mesh(DESTINATION).diagonal < 0.4
    assert user.session.unit == "m"


@pytest.mark.parametrize(("label", "answer"), [("First", 0), ("Second", 1), ("Leave", 2)])
def test_a_choice_is_what_its_button_says(user, label, answer):
    def click():
        box = QApplication.activeModalWidget()
        (button,) = (button for button in box.buttons() if button.text() == label)
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)

    QTimer.singleShot(100, user.window, click)
    dialogs = WindowDialogs(user.window)
    assert dialogs.ask_choice("Title", "Text", "More", ["First", "Second", "Leave"]) == answer


def test_escape_leaves_everything_at_a_choice(user):
    def escape():
        QTest.keyClick(QApplication.activeModalWidget(), Qt.Key.Key_Escape)

    QTimer.singleShot(100, user.window, escape)
    assert WindowDialogs(user.window).ask_choice("Title", "Text", "", ["Do", "Leave"]) == 1


# Units beside numbers


def test_lengths_in_the_table_say_their_unit_and_follow_it(user):
    user.open_sample()
    header, model = (
        user.window.parts.table.table.horizontalHeader(),
        user.window.parts.table.table.model(),
    )

    def title(key):
        for i in range(model.columnCount()):
            text = model.headerData(i, Qt.Orientation.Horizontal, Qt.ItemDataRole.DisplayRole)
            if text.startswith(key):
                return text
        raise AssertionError(key)

    assert title("Residual") == "Residual\nmm"
    assert title("Left out") == "Left out\nmm"
    assert header.height() >= 2 * header.fontMetrics().height()
    unit = user.window.parts.penalty.panel.unit
    unit.setFocus()
    QTest.keyClick(unit, Qt.Key.Key_Down)
    QTest.keyClick(unit, Qt.Key.Key_Return)
    user.settle()
    assert user.session.unit == "cm"
    assert title("Residual") == "Residual\ncm"
    index = model.index(0, 1)
    assert model.data(index, Qt.ItemDataRole.ToolTipRole).endswith(") cm")


# Several specimens in one file


@pytest.fixture
def two_femurs(half_done, tmp_path):
    """One TPS file: both bones of the sample as specimens."""
    texts = []
    for side in (SOURCE, DESTINATION):
        path = tmp_path / f"{side.value}.tps"
        write_landmarks(path, half_done.pairs, side, unit="mm")
        texts.append(path.read_text())
    path = tmp_path / "femurs.tps"
    path.write_text("".join(texts))
    return path


def mark(dialog, name):
    """Click a specimen in the list."""
    names = dialog.specimens
    (item,) = names.findItems(name, Qt.MatchFlag.MatchExactly)
    place = names.visualItemRect(item).center()
    QTest.mouseClick(names.viewport(), Qt.MouseButton.LeftButton, pos=place)


def test_a_click_says_which_specimen_of_a_file_is_meant(half_done, two_femurs):
    def choose_specimen(dialog):
        words = " ".join(label.text() for label in dialog.findChildren(QLabel))
        assert "femurs.tps holds 2 specimens. Which one are the destination landmarks of?" in words
        assert dialog.chosen == "source"
        mark(dialog, "destination")
        assert dialog.chosen == "destination"
        press(dialog)

    def look(dialog):
        words = " ".join(label.text() for label in dialog.findChildren(QLabel))
        assert "16 landmarks of destination in femurs.tps" in words
        assert dialog.fits == {}
        press(dialog)

    half_done.dialogs.opens = [two_femurs]
    half_done.dialogs.at_specimen = [choose_specimen]
    half_done.dialogs.at_import = [look]
    half_done.trigger("import_destination")
    half_done.settle()
    assert half_done.dialogs.at_import == []
    assert destinations(half_done) == [x.destination for x in half_done.pairs]


def test_both_sides_come_from_two_specimens_of_one_file(half_done, two_femurs):
    half_done.editor.replace_all(replace(half_done.session, landmarks=()), None)
    for side in (SOURCE, DESTINATION):

        def choose_specimen(dialog, name=side.value):
            mark(dialog, name)
            press(dialog)

        half_done.dialogs.opens = [two_femurs]
        half_done.dialogs.at_specimen = [choose_specimen]
        half_done.trigger(f"import_{side.value}")
        half_done.settle()
    assert [(x.source, x.destination) for x in half_done.session.landmarks] == [
        (x.source, x.destination) for x in half_done.pairs
    ]


def test_without_a_specimen_nothing_is_imported(half_done, two_femurs):
    before = half_done.session
    half_done.dialogs.opens = [two_femurs]
    half_done.dialogs.at_specimen = [lambda dialog: press(dialog, CANCEL)]
    half_done.trigger("import_destination")
    half_done.settle()
    assert half_done.session == before


def test_what_may_be_no_landmarks_is_asked_about_before_it_comes_in(half_done, tmp_path):
    log = tmp_path / "imu.csv"
    log.write_text("time,x,y,z\n" + "".join(f"{n},{n},2,3\n" for n in range(120)))

    def look(dialog):
        words = [label.text() for label in dialog.findChildren(QLabel)]
        assert "Are these landmarks?" in words
        assert "It has a column 'time', as recordings over time have." in words
        press(dialog, CANCEL)

    half_done.dialogs.opens = [log]
    half_done.dialogs.at_import = [look]
    half_done.trigger("import_destination")
    half_done.settle()
    assert half_done.dialogs.at_import == []


# Passengers


def stations():
    return [Landmark(f"station_{i}", (10.0 * i, 5.0, 200.0)) for i in range(3)]


def test_stations_come_in_as_passengers_where_everything_is_paired(user, bring):
    user.open_sample()
    before = user.session

    def look(dialog):
        assert dialog.pairings[AS_PASSENGERS].isChecked()
        assert set(happenings(dialog)) == {"a new passenger"}
        press(dialog)

    bring(stations(), SOURCE, look)
    assert [x.name for x in user.session.passengers[-3:]] == [f"station_{i}" for i in range(3)]
    assert user.session.pairs == before.pairs
    user.trigger("undo")
    assert user.session == before


def test_unknown_names_are_no_halves_unless_somebody_says_so(user, bring):
    user.open_sample()
    before = user.session
    bring(stations(), SOURCE, lambda dialog: dialog.reject())
    assert user.session == before

    def as_new(dialog):
        choose(dialog.pairings[AS_NEW])
        press(dialog)

    bring(stations(), SOURCE, as_new)
    assert [x.is_pair for x in user.session.landmarks[-3:]] == [False] * 3
    assert user.session.passengers == before.passengers

    def look(dialog):
        assert not dialog.pairings[AS_PASSENGERS].isEnabled()
        dialog.reject()

    user.editor.replace_all(before, None)
    bring([x.placed(DESTINATION, x.source) for x in stations()], DESTINATION, look)
    assert user.session == before


def test_the_command_line_opens_a_session_with_passengers(user, tmp_path):
    path = tmp_path / "stations.csv"
    write_landmarks(path, stations(), SOURCE, unit="mm")
    user.window.parts.documents.open(Opening(session=sample_session(), passengers=path))
    user.settle()
    assert len(user.session.pairs) == 16
    assert [x.name for x in user.session.passengers[-3:]] == [f"station_{i}" for i in range(3)]


def test_of_a_file_that_brings_more_only_the_known_names_can_be_taken(user, bring):
    user.open_sample()
    before = user.session
    first = before.pairs[0]
    moved = first.placed(SOURCE, tuple(np.add(first.source, 0.5).tolist()))

    def look(dialog):
        button = dialog.pairings[ONLY_KNOWN]
        assert button.text() == "Only those &known here: 1 of 4"
        choose(button)
        assert happenings(dialog)[1:] == ["left out: none here is called so"] * 3
        assert "3 are left out" in dialog.outcome.text()
        press(dialog)

    bring([moved, *stations()], SOURCE, look)
    assert len(user.session.landmarks) == len(before.landmarks)
    assert user.session.landmark(first.name).source == moved.source
    assert "3 left out" in user.window.statusBar().currentMessage()
    user.trigger("undo")
    assert user.session == before


def test_the_command_line_asks_too_where_names_are_strangers_to_a_paired_session(user, tmp_path):
    path = tmp_path / "others.csv"
    write_landmarks(path, [x.placed(DESTINATION, x.source) for x in stations()], DESTINATION)
    user.dialogs.at_import = [lambda dialog: dialog.reject()]
    user.window.parts.documents.open(Opening(session=sample_session(), destination_landmarks=path))
    user.settle()
    assert user.dialogs.at_import == []
    assert len(user.session.landmarks) == len(read_session(sample_session()).landmarks)


def test_strangers_dropped_one_after_the_other_are_each_asked_about(user, tmp_path):
    user.open_sample()
    before = user.session
    paths = [tmp_path / f"{name}.csv" for name in ("one", "two")]
    for path in paths:
        marks = [replace(x, name=f"{path.stem}_{x.name}") for x in stations()]
        write_landmarks(path, marks, SOURCE, unit="mm")
    user.dialogs.at_import = [press, press]
    drop(user.window.viewports[SOURCE], *paths)
    user.settle()
    assert user.dialogs.at_import == []
    assert user.session.pairs == before.pairs
    assert len(user.session.passengers) == len(before.passengers) + 6


@pytest.mark.parametrize(("side", "way_out"), [(SOURCE, "--passengers"), (DESTINATION, "window")])
def test_a_picture_that_nobody_is_asked_about_leaves_strangers_out(capsys, side, way_out):
    session = Session(landmarks=read_session(sample_session()).landmarks)
    marks = tuple(Landmark(x.name).placed(side, x.source) for x in stations())
    arriving = Arriving(Path("others.csv"), LandmarkReading(marks, False, ()), side)
    messages = PrintedMessages()
    assert messages.ask_import(session, arriving, Rulers()) is None
    told = capsys.readouterr().err
    assert "others.csv was left out" in told
    assert "station_0" in told
    assert way_out in told
    # The command fails, so that a script hears of it.
    assert len(messages.errors) == 1
