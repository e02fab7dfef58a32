"""User stories: editing that forgives."""

from __future__ import annotations

import numpy as np
import pytest
from qtpy.QtCore import QPoint, QPointF, Qt
from qtpy.QtTest import QTest
from tests.gui.drawing import clear_spots, draw

from pinwarp.core.landmarks import LandmarkState, Role, Side
from pinwarp.session import edits
from pinwarp.session.warp.ghost import Ghost

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
# What an entry of the sheet of shortcuts may begin with: "Source Landmarks" says not what is done.
VERBS = {
    *("Accept", "Add", "Begin", "Choose", "Close", "Compare", "Copy", "Cut", "Delete", "Disable"),
    *("Draw", "Export", "Filter", "Fit", "Focus", "Import", "Load", "Lock", "Look", "Make", "Move"),
    *("Nudge", "Open", "Orbit", "Paste", "Place", "Play", "Put", "Quit", "Redo", "Refine"),
    *("Rename", "Return", "Save", "Select", "Shape", "Show", "Slide", "Snap", "Suggest", "Switch"),
    *("Take", "Turn", "Undo", "Write", "Click"),
}
SHIFT, CTRL = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.ControlModifier


def without(user, side, *names):
    """The sample session, with some positions taken away."""
    user.open_sample()
    session = user.session
    for name in names:
        session = edits.remove_side(session, name, side)
    user.editor.commit(session, "Take away")
    user.settle()


# Off the surface and back


def test_shift_drag_moves_a_landmark_off_the_surface_and_s_snaps_it_back(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    name = "femoral_head_anterior"
    before = np.array(user.session.landmark(name).source)
    start = user.place_of(SOURCE, before)
    QTest.mousePress(viewport, Qt.MouseButton.LeftButton, SHIFT, start)
    for step in range(1, 9):
        user.move_with(
            viewport, (start + QPoint(5 * step, 0)).toPointF(), Qt.MouseButton.LeftButton, SHIFT
        )
    QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, SHIFT, start + QPoint(40, 0))
    user.settle()
    moved = np.array(user.session.landmark(name).source)
    along = np.array(viewport.camera.direction)
    assert np.linalg.norm(moved - before) > 5
    assert abs((moved - before) @ along) < 1e-6 * np.linalg.norm(moved - before) + 1e-3
    assert viewport.surface.closest(moved)[1] > 0.5
    user.editor.look(hovered=name)
    assert "off the source surface" in user.window.parts.guidance.hint.text()
    user.press(Qt.Key.Key_S)
    assert viewport.surface.closest(user.session.landmark(name).source)[1] < 1e-3
    assert user.editor.undo_label == f"Snap {name}"


@pytest.mark.parametrize(
    ("key", "across", "upwards"),
    [
        (Qt.Key.Key_Right, 1, 0),
        (Qt.Key.Key_Left, -1, 0),
        (Qt.Key.Key_Up, 0, 1),
        (Qt.Key.Key_Down, 0, -1),
    ],
)
def test_arrow_keys_nudge_along_the_screen_by_the_step(user, key, across, upwards):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    name = "midshaft_anterior"
    user.editor.look(nudge=3.0)
    user.click_position(SOURCE, user.session.landmark(name).source)
    before = np.array(user.session.landmark(name).source)
    user.press(key, widget=viewport)
    moved = np.array(user.session.landmark(name).source) - before
    right, up = viewport.view_axes()
    assert moved @ (across * right + upwards * up) == pytest.approx(3.0, abs=0.8)
    assert viewport.surface.closest(before + moved)[1] < 1e-3


def test_many_nudges_in_a_row_are_one_step_to_undo(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    before = user.session
    user.click_position(SOURCE, before.landmark("midshaft_anterior").source)
    for _ in range(4):
        user.press(Qt.Key.Key_Up, widget=viewport)
    user.trigger("undo")
    assert user.session == before


def test_the_nudge_step_is_asked_for_in_mesh_units(user):
    user.open_sample()
    user.dialogs.texts = ["0,25", "far"]
    user.trigger("set_nudge")
    assert user.editor.view.nudge == 0.25
    user.trigger("set_nudge")
    assert user.editor.view.nudge == 0.25
    assert "not a length" in user.dialogs.errors[0][1]


# No accidents


def test_the_lock_freezes_all_landmarks(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    before = user.session
    user.press(Qt.Key.Key_L)
    start = user.place_of(SOURCE, before.landmark("midshaft_anterior").source)
    user.drag(viewport, start, start + QPoint(0, 40))
    assert user.session == before
    user.editor.select("midshaft_anterior", side=SOURCE)
    user.press(Qt.Key.Key_Delete)
    user.press(Qt.Key.Key_Up, widget=viewport)
    assert user.session == before
    assert "L unlocks" in user.window.statusBar().currentMessage()
    viewport.look_at_all()
    user.click(SOURCE, viewport.rect().center() + QPoint(0, 60))
    assert user.session == before
    user.press(Qt.Key.Key_L)
    user.press(Qt.Key.Key_Delete)
    assert user.session != before


def test_no_key_changes_the_session_under_a_drag_and_undo_takes_the_drag_back(user):
    user.open_sample()
    viewport, name = user.window.viewports[SOURCE], "midshaft_anterior"
    at = user.place_of(SOURCE, user.session.landmark(name).source)
    user.drag(viewport, at, at + QPoint(0, 40))
    before, label = user.session, user.editor.undo_label
    at = user.place_of(SOURCE, before.landmark(name).source)
    user.drag(viewport, at, at + QPoint(0, 30), release=False)
    viewport.setFocus()
    user.press(Qt.Key.Key_Delete, CTRL, viewport)
    assert user.editor.is_previewing
    user.press(Qt.Key.Key_Z, CTRL, viewport)
    assert not user.editor.is_previewing
    user.move_with(viewport, QPointF(at + QPoint(0, 50)), Qt.MouseButton.LeftButton)
    QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, pos=at + QPoint(0, 50))
    user.settle()
    assert (user.session, user.editor.undo_label) == (before, label)
    # What is deleted by anything else is gone, and the drag goes on with nothing.
    user.drag(viewport, at, at + QPoint(0, 30), release=False)
    user.editor.commit(edits.remove(before, [name]), f"Delete {name}")
    user.move_with(viewport, QPointF(at + QPoint(0, 50)), Qt.MouseButton.LeftButton)
    QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, pos=at + QPoint(0, 50))
    user.settle()
    assert user.editor.undo_label == f"Delete {name}"
    user.press(Qt.Key.Key_Z, CTRL)
    assert (user.session, user.editor.undo_label) == (before, label)


def test_one_locked_landmark_stays_while_others_move(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    user.editor.commit(edits.set_locked(user.session, ["midshaft_anterior"], True), "Lock")
    before = user.session
    for name in ("midshaft_anterior", "femoral_head_anterior"):
        start = user.place_of(SOURCE, user.session.landmark(name).source)
        user.drag(viewport, start, start + QPoint(0, 14))
        viewport.look_at_all()
    assert user.session.landmark("midshaft_anterior") == before.landmark("midshaft_anterior")
    assert user.session.landmark("femoral_head_anterior") != before.landmark(
        "femoral_head_anterior"
    )


def test_a_shaky_click_on_a_landmark_selects_and_moves_nothing(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    before = user.session
    start = user.place_of(SOURCE, before.landmark("midshaft_anterior").source)
    user.drag(viewport, start, start + QPoint(3, 2), steps=2)
    assert user.session == before
    assert user.editor.selection.names == ("midshaft_anterior",)


# The ghost


@pytest.mark.parametrize("side", list(Side))
def test_space_accepts_the_ghost_near_where_the_landmark_was(user, side):
    user.open_sample()
    name = "femoral_head_anterior"
    truth = np.array(user.session.landmark(name).position(side))
    without(user, side, name)
    ghost = user.window.parts.ghosts.at(side)
    assert ghost.name == name
    assert 0 < ghost.deviation < 30
    # Also while the mouse rests on the landmark that was just placed.
    user.editor.look(hovered=name)
    hint = user.window.parts.guidance.hint.text()
    assert hint.startswith(f"{name}: ")
    assert hint.endswith("  Space accepts the ghost.")
    assert np.linalg.norm(np.array(ghost.position) - truth) < 8
    assert user.window.viewports[side].drawn(Ghost) == ghost
    user.press(Qt.Key.Key_Space)
    placed = user.session.landmark(name).position(side)
    assert placed == ghost.position
    assert user.window.viewports[side].surface.closest(placed)[1] < 1e-3
    assert user.editor.undo_label == f"Accept {name}"
    assert user.window.parts.ghosts.at(side) is None


def test_a_click_elsewhere_overrides_the_ghost(user):
    without(user, DESTINATION, "femoral_head_anterior")
    viewport = user.window.viewports[DESTINATION]
    elsewhere = user.place_of(DESTINATION, user.session.landmark("midshaft_anterior").destination)
    user.click(DESTINATION, elsewhere + QPoint(0, 60))
    placed = user.session.landmark("femoral_head_anterior").destination
    assert placed is not None
    assert viewport.drawn(Ghost) is None


def test_below_three_pairs_there_is_no_ghost(user):
    user.open_sample()
    names = [x.name for x in user.session.landmarks]
    session = edits.remove(user.session, names[2:])
    session = edits.remove_side(session, names[1], DESTINATION)
    user.editor.commit(session, "Keep two")
    user.settle()
    assert [user.window.parts.ghosts.at(side) for side in Side] == [None, None]
    user.press(Qt.Key.Key_Space)
    assert "nothing to accept" in user.window.statusBar().currentMessage()


def see_its_disc(user):
    """The ghost on the destination has a tint that goes with its landmark."""
    viewport = user.window.viewports[DESTINATION]
    ghost = viewport.drawn(Ghost)
    radius = ghost.deviation * viewport.pixels_per_unit(np.array(ghost.position))
    at = user.place_of(DESTINATION, ghost.position)
    # Within the disc, and not on the ring.
    reach = min(radius - 1.5, 20) if radius > 13 else 4
    assert radius > reach
    around = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    spots = [at + QPoint(round(reach * np.cos(a)), round(reach * np.sin(a))) for a in around]
    pictures = [viewport.grab().toImage()]
    user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert viewport.drawn(Ghost) is None
    pictures.append(viewport.grab().toImage())
    user.press(
        Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
    )
    seen, bare = ([picture.pixelColor(spot).getRgb() for spot in spots] for picture in pictures)
    assert sum(one != other for one, other in zip(seen, bare, strict=True)) >= 8


def test_a_ghost_has_its_disc_with_three_pairs_and_with_five(user):
    user.open_sample_meshes()
    places = {side: user.places_down_the_bone(side, 8) for side in Side}
    # From end to end, then between.
    order = [0, 7, 3, 5, 1, 6]
    for count, row in enumerate(order):
        user.click_position(SOURCE, places[SOURCE][row])
        if count in (3, 5):
            see_its_disc(user)
        user.click_position(DESTINATION, places[DESTINATION][row])
        assert len(user.session.pairs) == count + 1


def test_where_semilandmarks_slide_the_ghost_has_the_disc_of_the_pairs(user):
    without(user, DESTINATION, "femoral_head_anterior")
    viewport = user.window.viewports[DESTINATION]
    alone = viewport.drawn(Ghost)
    draw(user, clear_spots(user, 3, first=0.3, last=0.7))
    slid = viewport.drawn(Ghost)
    assert slid.position != alone.position
    assert slid.deviation == pytest.approx(alone.deviation)
    assert slid.deviation > 0


def test_with_three_or_four_pairs_the_disc_comes_of_the_bones_size(user):
    """Where the bone hides the ghost it says so, and Space shows the place before it accepts."""
    user.open_sample()
    names = [x.name for x in user.session.landmarks]
    keep = [
        "fovea_capitis",
        "greater_trochanter_lateral",
        "lateral_epicondyle",
        "midshaft_anterior",
        "medial_epicondyle",
    ]
    truth = np.array(user.session.landmark("medial_epicondyle").destination)
    session = edits.remove(user.session, [n for n in names if n not in keep])
    session = edits.remove_side(session, "medial_epicondyle", DESTINATION)
    user.editor.commit(session, "Keep four")
    user.settle()
    viewport = user.window.viewports[DESTINATION]
    for pairs in (4, 3):
        assert len(user.session.pairs) == pairs
        ghost = viewport.drawn(Ghost)
        missed = np.linalg.norm(np.array(ghost.position) - truth)
        assert max(missed / 3, 2) < ghost.deviation < 60
        user.editor.select("midshaft_anterior")
        user.press(Qt.Key.Key_Delete, CTRL)
    user.press(Qt.Key.Key_Z, CTRL)
    ghost = viewport.drawn(Ghost)
    at = viewport.rect().center()
    for _ in range(8):
        if not viewport.sees(ghost.position):
            break
        user.drag(viewport, at, at + QPoint(60, 0))
    assert not viewport.sees(ghost.position)
    hint, status = user.window.parts.guidance.hint, user.window.statusBar()
    assert "Space turns the view to the ghost" in hint.text()
    viewport.setFocus()
    user.press(Qt.Key.Key_Space)
    assert not user.session.landmark(ghost.name).is_complete
    assert viewport.sees(ghost.position)
    assert "Space accepts it" in status.currentMessage()
    assert "Space accepts the ghost" in hint.text()
    user.press(Qt.Key.Key_Space)
    assert user.session.landmark(ghost.name).destination == ghost.position
    assert status.currentMessage() == ""


# The guide


def test_the_guide_asks_for_each_name_of_a_template_in_turn(user, tmp_path):
    user.open_sample_meshes()
    path = tmp_path / "femur.txt"
    path.write_text("fovea\ntrochanter\nepicondyle\n")
    user.dialogs.opens = [path]
    user.trigger("load_template")
    bar = user.window.parts.guidance.bar
    assert bar.isVisible()
    assert "fovea" in bar.words.text()
    assert (bar.progress.value(), bar.progress.maximum()) == (0, 3)
    places = {side: user.places_down_the_bone(side, 4) for side in Side}
    user.click_position(SOURCE, places[SOURCE][0])
    assert "click it on the destination" in bar.words.text()
    user.click_position(SOURCE, places[SOURCE][2])
    assert "already" in user.window.statusBar().currentMessage()
    user.click_position(DESTINATION, places[DESTINATION][0])
    assert user.session.landmark("fovea").is_pair
    assert "trochanter" in bar.words.text()
    assert bar.progress.value() == 1
    user.qtbot.mouseClick(bar.skip, Qt.MouseButton.LeftButton)
    assert "epicondyle" in bar.words.text()
    user.qtbot.mouseClick(bar.back, Qt.MouseButton.LeftButton)
    assert "trochanter" in bar.words.text()
    user.qtbot.mouseClick(bar.end, Qt.MouseButton.LeftButton)
    assert not bar.isVisible()
    assert not user.window.actions_by_key["guide"].isChecked()


def test_the_guide_shows_where_the_landmark_lies_on_the_source(user):
    without(user, DESTINATION, "femoral_head_anterior", "midshaft_anterior")
    user.press(Qt.Key.Key_G)
    labelled = [m.name for m in user.window.viewports[SOURCE].layer.markers if m.labelled]
    assert labelled == ["femoral_head_anterior"]
    assert "1" in user.window.parts.guidance.bar.words.text()
    user.press(Qt.Key.Key_Space)
    user.press(Qt.Key.Key_Space)
    assert "All 16 landmarks are placed" in user.window.parts.guidance.bar.words.text() or (
        user.editor.view.guided is None
    )


def test_a_previous_session_serves_as_a_template(user, sample_copy):
    user.open_sample_meshes()
    user.dialogs.opens = [sample_copy]
    user.trigger("load_template")
    assert len(user.session.landmarks) == 20
    assert user.session.landmarks[0].state is LandmarkState.EMPTY
    user.trigger("undo")
    assert user.session.landmarks == ()
    assert not user.window.parts.guidance.bar.isVisible()


def test_new_names_follow_the_pattern_that_was_set(user):
    user.open_sample_meshes()
    user.dialogs.texts = ["no number", "left_{n}"]
    user.trigger("set_pattern")
    assert "must hold {n}" in user.dialogs.errors[0][1]
    user.trigger("set_pattern")
    for place in user.places_down_the_bone(SOURCE, 3)[:2]:
        user.click_position(SOURCE, place)
    assert [x.name for x in user.session.landmarks] == ["left_0", "left_1"]


# Passengers


def test_ctrl_click_on_the_source_adds_a_passenger(user, tmp_path):
    user.open_sample()
    user.click(SOURCE, user.free_place(SOURCE), CTRL)
    passenger = user.session.landmarks[-1]
    assert (passenger.name, passenger.role) == ("passenger_0", Role.PASSENGER)
    assert len(user.session.pairs) == 16
    carried = [m.name for m in user.window.viewports[DESTINATION].layer.markers]
    assert "passenger_0" in carried
    path = tmp_path / "carried.csv"
    user.dialogs.saves = [path]
    user.trigger("export_passengers")
    lines = path.read_text().splitlines()
    assert len(lines) == 6
    result = user.window.parts.warps.result
    assert np.allclose([float(x) for x in lines[-1].split(",")[1:]], result.passengers[-1])


def test_ctrl_click_on_the_destination_says_where_passengers_belong(user):
    user.open_sample()
    before = user.session
    user.click(DESTINATION, user.free_place(DESTINATION), CTRL)
    assert user.session == before
    assert "placed on the source" in user.window.statusBar().currentMessage()


def test_exporting_passengers_without_any_says_how_to_add_one(user, tmp_path):
    user.open_sample_meshes()
    user.dialogs.saves = [tmp_path / "none.csv"]
    user.trigger("export_passengers")
    assert "Ctrl+click" in user.dialogs.errors[0][1]


# Finding out


def test_the_sheet_of_shortcuts_lists_every_key_and_closes_with_any(user):
    user.press(Qt.Key.Key_Question)
    sheet = user.window.shortcuts
    assert sheet.isVisible()
    listed = {key for _, lines in sheet.lines() for key, _ in lines}
    for action in user.window.actions_by_key.values():
        keys = ", ".join(key.toString() for key in action.shortcuts())
        assert not keys or keys in listed, action.text()
    verbs = {words.split()[0] for _, lines in sheet.lines() for _, words in lines}
    assert {verb.capitalize().rstrip(",") for verb in verbs} <= VERBS
    assert ("Ctrl+Shift+1", "Import Source Landmarks") in dict(sheet.lines())["File"]
    before = user.session
    user.press(Qt.Key.Key_Delete, widget=sheet)
    assert not sheet.isVisible()
    assert user.session == before


def test_every_action_has_a_tip_that_names_its_key(user):
    for action in user.window.actions_by_key.values():
        assert action.toolTip()
        if not action.shortcut().isEmpty():
            assert action.shortcut().toString() in action.toolTip()


def test_the_status_bar_says_what_a_click_would_do(user):
    without(user, DESTINATION, "femoral_head_anterior")
    hint = user.window.parts.guidance.hint.text()
    assert "on the source places a new landmark, on the destination femoral_head_anterior" in hint
    assert "Space accepts" in hint
    user.press(Qt.Key.Key_L)
    assert "locked" in user.window.parts.guidance.hint.text()


# Many


def test_five_hundred_landmarks_can_be_placed_and_selected(user):
    user.open_sample_meshes()
    surfaces = {side: user.window.viewports[side].surface.mesh.vertices for side in Side}
    session = user.session
    for i in range(500):
        session, name = edits.place(session, SOURCE, tuple(surfaces[SOURCE][20 * i]))
        session = edits.move(session, name, DESTINATION, tuple(surfaces[DESTINATION][20 * i]))
    user.editor.commit(session, "Place 500")
    user.settle()
    place = user.places_down_the_bone(SOURCE, 7)[3]
    count = len(user.session.landmarks)
    user.click_position(SOURCE, place)
    assert len(user.session.landmarks) - count in (0, 1)
    assert len(user.editor.selection.names) == 1
