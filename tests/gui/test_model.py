"""User stories: a generic model becomes a subject's, bone by bone."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt, QTimer
from qtpy.QtTest import QTest
from tests.gui.conftest import Driver, ScriptedDialogs, close_window, open_window
from tests.gui.test_files import drop
from tests.gui.test_themes import greatest_contrast, pixels
from tests.osim_models import POSE, copied_model, edited_model, paired, subject

from pinwarp.core.landmarks import Side
from pinwarp.core.model_rows import Outcome
from pinwarp.gui.exporting.picture import PictureOrder, _painted
from pinwarp.gui.files.file_dialogs import Answer
from pinwarp.gui.files.lost_work_dialog import LostAnswer
from pinwarp.gui.model import rule_tree
from pinwarp.gui.model.body_tree import NAME, STATE, WORST, WRAPS
from pinwarp.gui.model.model_dialogs import DryRunDialog
from pinwarp.gui.scene.model_drawables import ModelElements
from pinwarp.io.meshes import write_mesh
from pinwarp.io.osim.bone import bone_of
from pinwarp.io.osim.reading import read_model
from pinwarp.session.keeping.files import read_session
from pinwarp.session.keeping.journal import WORK
from pinwarp.session.model.elements import OutlineKind
from pinwarp.session.model.study import read_study
from pinwarp.session.model.warped import warped_model

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
THIGH, SHANK = "/bodyset/thigh", "/bodyset/shank"
KNEE = "/markerset/KNEE"


@pytest.fixture
def leg(tmp_path) -> Path:
    """The small leg with its meshes, in a folder of its own."""
    return copied_model("leg", tmp_path / "leg")


def panel(user):
    return user.window.parts.model.panel


def bench(user):
    return user.window.parts.model._opened.bench


def open_model(user, path: Path) -> None:
    user.dialogs.opens.append(path)
    user.trigger("open_model")


def click_item(user, tree, item, column: int = 0) -> None:
    tree.scrollToItem(item)
    at = tree.visualItemRect(item).center()
    x = tree.columnViewportPosition(column) + tree.columnWidth(column) // 2
    QTest.mouseClick(tree.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(x, at.y()))
    user.settle()


def choose_body(user, name: str) -> None:
    tree = panel(user).bodies
    (item,) = tree.findItems(name, Qt.MatchFlag.MatchExactly, NAME)
    click_item(user, tree, item)


def choose_element(user, text: str) -> None:
    tree = panel(user).rules
    flags = Qt.MatchFlag.MatchExactly | Qt.MatchFlag.MatchRecursive
    (item,) = tree.findItems(text, flags, rule_tree.ELEMENT)
    click_item(user, tree, item)


def in_list(user, text: str, column: int) -> str:
    flags = Qt.MatchFlag.MatchExactly | Qt.MatchFlag.MatchRecursive
    (item,) = panel(user).rules.findItems(text, flags, rule_tree.ELEMENT)
    return item.text(column)


def rule_in_list(user, text: str) -> str:
    return in_list(user, text, rule_tree.RULE)


def state_of(user, name: str) -> str:
    (item,) = panel(user).bodies.findItems(name, Qt.MatchFlag.MatchExactly, NAME)
    return item.text(STATE)


def choose_rule(user, words: str) -> None:
    """Choose from the box by its keys, as somebody would."""
    box = panel(user).rule
    box.setFocus()
    for _ in range(box.count()):
        if box.currentText() == words:
            break
        QTest.keyClick(box, Qt.Key.Key_Down)
    else:
        QTest.keyClick(box, Qt.Key.Key_Home)
        while box.currentText() != words:
            QTest.keyClick(box, Qt.Key.Key_Down)
    assert box.currentText() == words
    user.settle()


def pair_body(user, count: int = 24) -> None:
    """Pair the chosen body with a subject's bone."""
    session = user.editor.committed
    landmarks = paired(session.mesh(SOURCE).vertices, count=count)
    user.editor.commit(replace(session, landmarks=landmarks), "Pair the bone")
    user.settle()


def subject_mesh(model: Path, body: str) -> Path:
    """Write the bone of a subject beside a model."""
    mesh = bone_of(read_model(model), body).mesh
    path = model.parent / f"subject_{body.rsplit('/', 1)[-1]}.ply"
    write_mesh(path, mesh.with_vertices(subject(mesh.vertices) @ POSE.T + [0.3, -1.2, 0.8]))
    return path


def seen_on_both(user, landmarks):
    """The landmarks that can be clicked in both views as the cameras stand."""
    seen = np.ones(len(landmarks), bool)
    for side, view in user.window.viewports.items():
        places = np.array([landmark.position(side) for landmark in landmarks])
        middle = np.array(view.bone.center)
        # A little outside, so that the place does not hide itself.
        seen &= ~view.behind_surface(places + 1e-3 * (places - middle))
        seen &= (np.abs(view.sight.places(places)) < 0.9).all(axis=1)
    return [landmark for landmark, is_seen in zip(landmarks, seen, strict=True) if is_seen]


def elements(user, side: Side) -> ModelElements | None:
    return user.window.viewports[side].drawn(ModelElements)


def test_a_body_that_is_chosen_becomes_the_source_with_all_that_stands_on_it(user, leg):
    open_model(user, leg)
    tree = panel(user).bodies
    assert [tree.topLevelItem(i).text(NAME) for i in range(3)] == ["hip", "thigh", "shank"]
    assert user.session.source is None
    choose_body(user, "thigh")
    assert user.session.source.path.name == "thigh"
    assert (user.session.unit, user.session.landmarks) == ("m", ())
    assert user.editor.undo_label is None

    drawn = elements(user, SOURCE)
    bone = bone_of(read_model(leg), THIGH)
    assert len(drawn.points) == len(bone.parts.points)
    assert {line.kind for line in drawn.lines} == set(OutlineKind) - {OutlineKind.MUSCLE}
    assert elements(user, DESTINATION) is None
    # They are no landmarks.
    assert user.window.viewports[SOURCE].layer.markers == ()
    assert user.window.parts.table.model.rowCount() == 0
    assert "Pair the bone" in panel(user).details.text()


def test_in_a_small_window_the_names_of_bodies_are_read_whole(user, leg):
    open_model(user, leg)
    tree = panel(user).bodies
    user.window.resize(1280, 800)
    user.settle()
    assert not tree.isColumnHidden(WRAPS)
    user.window.resize(1024, 580)
    user.settle()
    assert user.window.width() <= 1024
    words = tree.fontMetrics().horizontalAdvance("calcaneus_r")
    assert tree.columnWidth(NAME) >= words + 30
    assert tree.horizontalScrollBar().maximum() == 0
    assert not tree.isColumnHidden(WORST)
    # Why there is no curve is read whole, too.
    plot = user.window.parts.penalty.panel.plot
    picture = pixels(plot)
    edges = np.concatenate([picture[:3].reshape(-1, 3), picture[-3:].reshape(-1, 3)])
    assert greatest_contrast(edges) < 2, "no words are cut at the upper or lower edge"
    assert greatest_contrast(picture) > 4


def test_a_model_is_opened_by_dropping_it(user, leg):
    drop(user.window.viewports[DESTINATION], leg)
    user.settle()
    assert bench(user).model.path == leg
    assert panel(user).isVisible()


def test_pairs_that_are_clicked_carry_the_elements_live(user, leg):
    open_model(user, leg)
    choose_body(user, "thigh")
    user.window.parts.documents.open_mesh(DESTINATION, subject_mesh(leg, THIGH))
    user.settle()
    for pair in seen_on_both(user, paired(user.session.mesh(SOURCE).vertices))[:4]:
        for side in Side:
            user.click_position(side, pair.position(side))
    assert len(user.session.pairs) >= 2
    assert state_of(user, "thigh") == "started*"

    before = elements(user, DESTINATION).points
    result = user.window.parts.warps.result
    np.testing.assert_allclose(
        before, result.spline.evaluate(elements(user, SOURCE).points), atol=1e-9
    )
    user.drag_a_landmark(release=False)
    moved = elements(user, DESTINATION).points
    assert np.abs(moved - before).max() > 1e-4
    np.testing.assert_allclose(
        moved,
        user.window.parts.warps.result.spline.evaluate(elements(user, SOURCE).points),
        atol=1e-9,
    )


def test_another_body_keeps_what_can_be_undone_on_the_one_before(user, leg):
    open_model(user, leg)
    choose_body(user, "thigh")
    pair_body(user)
    thigh = user.session
    choose_body(user, "shank")
    assert user.session.source.path.name == "shank"
    assert user.editor.undo_label is None
    assert (state_of(user, "thigh"), state_of(user, "shank")) == ("done*", "none")
    pair_body(user, 6)
    choose_body(user, "thigh")
    assert user.session is thigh
    user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert user.session.landmarks == ()
    choose_body(user, "shank")
    assert len(user.session.pairs) == 6
    user.trigger("undo")
    assert user.session.landmarks == ()
    assert user.dialogs.unsaved_questions == 0


def test_a_rule_is_changed_seen_and_undone(user, leg):
    open_model(user, leg)
    choose_body(user, "thigh")
    pair_body(user)
    choose_element(user, "KNEE")
    assert rule_in_list(user, "KNEE") == "carried"
    assert "carried" in panel(user).details.text()
    moved = float(in_list(user, "KNEE", rule_tree.MOVED))
    (thigh,) = panel(user).bodies.findItems("thigh", Qt.MatchFlag.MatchExactly, NAME)
    assert thigh.text(WORST).endswith(" mm")
    user.trigger("lengths_cm")
    assert float(in_list(user, "KNEE", rule_tree.MOVED)) == pytest.approx(moved / 10, abs=0.006)
    assert "in cm" in panel(user).rules.headerItem().toolTip(rule_tree.MOVED)
    assert thigh.text(WORST).endswith(" cm")
    choose_rule(user, "Left as it is")
    assert user.editor.rules.keep == {KNEE}
    assert rule_in_list(user, "KNEE") == "kept"
    assert user.editor.undo_label == "Keep KNEE"
    user.trigger("undo")
    assert rule_in_list(user, "KNEE") == "carried"

    choose_element(user, "hipj/hipj_child")
    assert panel(user).rule.currentText() == "Carried, orientation kept"
    choose_rule(user, "Carried and turned with the bone")
    assert rule_in_list(user, "hipj/hipj_child") == "turned"
    user.trigger("undo")
    assert user.editor.rules.turn == frozenset()


def test_a_click_on_an_element_looks_at_it_on_both_bones(user, leg):
    user.window.parts.documents.open_mesh(DESTINATION, subject_mesh(leg, THIGH))
    open_model(user, leg)
    choose_body(user, "thigh")
    pair_body(user)
    choose_element(user, "KNEE")
    for side in Side:
        drawn = elements(user, side)
        row = int(np.flatnonzero(drawn.is_chosen)[0])
        assert drawn.is_chosen.sum() == 1
        view = user.window.viewports[side]
        at = user.place_of(side, drawn.points[row])
        if view.bone is not None:
            assert abs(at.x() - view.width() / 2) < 3
            assert abs(at.y() - view.height() / 2) < 3


def test_the_model_is_exported_after_a_dry_run_and_its_points_are_where_they_were_seen(user, leg):
    open_model(user, leg)
    choose_body(user, "thigh")
    pair_body(user)
    new = leg.parent / "anna.osim"
    user.dialogs.export_model = False
    user.trigger("export_model")
    assert len(user.dialogs.dry_runs) == 1
    assert not new.exists()
    user.dialogs.export_model = True
    user.dialogs.saves.append(new)
    user.trigger("export_model")
    assert user.dialogs.errors == []
    carried = user.dialogs.dry_runs[1]
    assert carried.counts[Outcome.WARPED] > 5
    assert (leg.parent / "anna_report.csv").exists()
    assert (leg.parent / "anna_Geometry").is_dir()
    # The pose aside, the points of the new model are those that were drawn on the destination.
    parts = bone_of(read_model(new), THIGH).parts
    places = {point.path: point.location for point in parts.points if point.frame == THIGH}
    shown = user.window.parts.model.figures.after
    drawn = dict(zip(shown.paths, shown.points, strict=True))
    a, b = (np.array([of[path] for path in places]) for of in (places, drawn))
    np.testing.assert_allclose(
        np.linalg.norm(a[1:] - a[0], axis=1), np.linalg.norm(b[1:] - b[0], axis=1), atol=1e-9
    )


def test_the_dry_run_says_what_is_flagged_and_is_answered_by_the_mouse(user, leg):
    open_model(user, leg)
    choose_body(user, "thigh")
    pair_body(user)
    study = bench(user).study(to_export=True)
    dialog = DryRunDialog(warped_model(study), user.window)

    def look():
        assert "Nothing is written yet" in dialog.summary.text()
        assert "! /" in dialog.text.toPlainText()
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    QTimer.singleShot(50, dialog, look)
    assert dialog.exec()
    dialog.deleteLater()


def test_a_saved_study_is_that_of_the_command_line_and_goes_on_where_it_was(user, leg):
    open_model(user, leg)
    choose_body(user, "shank")
    pair_body(user, 12)
    choose_body(user, "thigh")
    pair_body(user)
    choose_element(user, "KNEE")
    choose_rule(user, "Left as it is")
    before = {one: bench(user).bodies[one].current for one in (THIGH, SHANK)}
    path = leg.parent / "anna.pinwarp-model.csv"
    user.dialogs.saves.append(path)
    user.trigger("save_study")
    assert user.dialogs.errors == []
    assert not user.editor.is_dirty
    assert (leg.parent / "anna_thigh.pinwarp.csv").exists()

    study = read_study(path)
    assert {one.body for one in study.bodies} == {THIGH, SHANK}
    assert study.keep == {KNEE}
    assert {row.path: row.outcome for row in warped_model(study).rows}[KNEE] is Outcome.KEPT

    user.trigger("close_model")
    user.trigger("close_session")
    assert user.dialogs.unsaved_questions == 0
    open_model(user, path)
    assert (state_of(user, "thigh"), state_of(user, "shank")) == ("done", "done")
    for name, body in (("shank", SHANK), ("thigh", THIGH)):
        choose_body(user, name)
        assert user.session.landmarks == before[body].landmarks
        assert user.session.mesh(SOURCE) is not None
    assert rule_in_list(user, "KNEE") == "kept"
    assert not bench(user).is_dirty


def test_closing_asks_about_bodies_that_are_set_aside_and_saving_saves_them(user, leg):
    open_model(user, leg)
    choose_body(user, "thigh")
    pair_body(user)
    choose_body(user, "shank")
    user.dialogs.unsaved = Answer.CANCEL
    user.window.close()
    assert user.window.isVisible()
    assert user.dialogs.unsaved_questions == 1
    user.dialogs.unsaved = Answer.SAVE
    user.dialogs.saves.append(leg.parent / "leg.pinwarp-model.csv")
    user.trigger("close_model")
    assert (leg.parent / "leg_thigh.pinwarp.csv").exists()
    assert bench(user) is None


def test_after_a_crash_the_bodies_that_were_set_aside_are_offered_too(
    user, leg, state_folder, tmp_path
):
    open_model(user, leg)
    choose_body(user, "thigh")
    pair_body(user)
    choose_body(user, "shank")
    pair_body(user, 6)

    def kept():
        return {len(read_session(x).pairs) for x in state_folder.glob(f"windows/*/{WORK}")}

    user.qtbot.waitUntil(lambda: kept() == {6, 24}, timeout=9000)
    shutil.copytree(state_folder, tmp_path / "after" / "state")

    dialogs = ScriptedDialogs()
    dialogs.lost = [LostAnswer.RESTORE, LostAnswer.RESTORE]
    window = open_window(dialogs, tmp_path / "after", tmp_path / "after" / "state")
    again = Driver(window, dialogs, user.qtbot)
    try:
        assert window.parts.recovery.offer()
        again.settle()
        pairs = {len(again.session.pairs)}
        assert again.session.mesh(SOURCE) is not None
        dialogs.unsaved = Answer.DISCARD
        again.trigger("restore")
        assert {*pairs, len(again.session.pairs)} == {6, 24}
    finally:
        close_window(window, dialogs)


def test_nothing_is_left_of_what_was_set_aside_when_the_window_has_closed(user, leg, state_folder):
    open_model(user, leg)
    choose_body(user, "thigh")
    pair_body(user)
    choose_body(user, "shank")
    choose_body(user, "thigh")
    choose_body(user, "hip")
    user.dialogs.unsaved = Answer.DISCARD
    user.window.close()
    assert list((state_folder / "windows").iterdir()) == []


def test_a_damaged_model_is_refused_with_its_line_and_loses_nothing(user, leg, tmp_path):
    open_model(user, leg)
    choose_body(user, "thigh")
    pair_body(user)
    session, model = user.session, bench(user)
    damaged = edited_model(
        copied_model("leg", tmp_path / "damaged"), ("</OpenSimDocument>", "</OpenSim>")
    )
    open_model(user, damaged)
    ((title, text),) = user.dialogs.errors
    assert title == "Opening leg.osim failed"
    assert "leg.osim" in text
    assert "line" in text
    assert user.session is session
    assert bench(user) is model
    assert user.editor.undo_label == "Pair the bone"


def test_a_missing_mesh_is_asked_for_and_the_body_before_stays(user, leg, tmp_path):
    elsewhere = tmp_path / "meshes"
    elsewhere.mkdir()
    open_model(user, leg)
    choose_body(user, "shank")
    user.trigger("close_model")
    shutil.move(leg.parent / "Geometry" / "thigh.vtp", elsewhere / "thigh.vtp")
    open_model(user, leg)
    session = user.session
    user.dialogs.choices = [1]
    choose_body(user, "thigh")
    assert "thigh.vtp" in user.dialogs.choice_questions[0][1]
    assert user.session is session
    assert panel(user).bodies.currentItem().text(NAME) == "shank"
    user.dialogs.choices = [0]
    user.dialogs.folders = [elsewhere]
    choose_body(user, "thigh")
    assert user.dialogs.errors == []
    assert user.session.source.path.name == "thigh"
    assert elements(user, SOURCE) is not None


def test_work_that_is_of_no_body_is_asked_about_before_a_bone_takes_its_place(user, leg):
    user.open_sample()
    user.click(SOURCE, user.free_place(SOURCE))
    session = user.session
    open_model(user, leg)
    assert user.session is session
    user.dialogs.unsaved = Answer.CANCEL
    choose_body(user, "thigh")
    assert user.dialogs.unsaved_questions == 1
    assert user.session is session
    user.dialogs.unsaved = Answer.DISCARD
    choose_body(user, "thigh")
    assert user.session.source.path.name == "thigh"


def test_the_window_can_be_closed_while_a_model_is_read(user, leg):
    user.dialogs.opens.append(leg)
    user.window.actions_by_key["open_model"].trigger()
    assert not user.window.jobs.is_idle
    user.window.close()
    assert not user.window.isVisible()


def test_the_report_and_a_picture_of_the_window_contain_the_model(user, leg):
    open_model(user, leg)
    choose_body(user, "thigh")
    pair_body(user)
    path = leg.parent / "thigh.html"
    user.window.parts.report.export(path)
    user.settle()
    text = path.read_text()
    assert "<h2>Model</h2>" in text
    assert f"{KNEE} (marker)" in text
    assert f"Model,{KNEE} (marker),moved," in path.with_suffix(".csv").read_text()
    view = user.window.viewports[SOURCE]
    assert ModelElements in {type(one) for one in _painted(PictureOrder(), view).drawables}


REAL = Path("/work/shared/data")
MODEL = REAL / "opensim-rajagopal2016" / "Rajagopal2016.osim"
SUBJECT = REAL / "opensim-creator-femur" / "subject_femur_r.obj"


@pytest.mark.skipif(not (MODEL.exists() and SUBJECT.exists()), reason="the real model is not here")
def test_the_femur_of_a_real_model_becomes_a_subjects_by_the_mouse(user, tmp_path):
    open_model(user, MODEL)
    assert panel(user).bodies.topLevelItemCount() == 22
    choose_body(user, "femur_r")
    user.window.parts.documents.open_mesh(DESTINATION, SUBJECT)
    user.settle()
    assert user.dialogs.choice_questions == [], "both are in metres"
    # Eight places down each bone, paired by clicks.
    rows = (user.places_down_the_bone(side, 8) for side in Side)
    for here, there in zip(*rows, strict=True):
        user.click_position(SOURCE, here)
        user.click_position(DESTINATION, there)
    assert len(user.session.pairs) == 8
    assert state_of(user, "femur_r") == "done*"
    drawn = elements(user, DESTINATION)
    assert drawn.is_of_muscle.sum() == 35
    assert (~drawn.is_of_muscle).sum() == 6

    new = tmp_path / "subject.osim"
    user.dialogs.saves.append(new)
    user.trigger("export_model")
    assert user.dialogs.errors == []
    (carried,) = user.dialogs.dry_runs
    assert {row.body for row in carried.rows} == {"femur_r"}
    moved = {row.path for row in carried.rows if row.is_warped}
    assert "/forceset/vasint_r/path/vasint_r-P1" in moved
    parts = bone_of(read_model(new), "/bodyset/femur_r").parts
    assert len(parts.points) == 41
