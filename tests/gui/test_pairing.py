"""User stories: pairing landmarks by clicking."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt
from qtpy.QtWidgets import QLineEdit, QWidget

from pinwarp.core.landmarks import Landmark, LandmarkState, Side

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


@pytest.fixture
def anterior_pairs(user):
    """Six places on the front of both bones, from top to bottom, far enough apart to click."""
    user.open_sample_meshes()
    columns = [user.places_down_the_bone(side, 6) for side in Side]
    return [
        Landmark(f"place_{i}", tuple(source), tuple(destination))
        for i, (source, destination) in enumerate(zip(*columns, strict=True))
    ]


def test_a_click_on_the_bone_places_a_landmark_where_the_mouse_was(user):
    user.open_sample_meshes()
    viewport = user.window.viewports[SOURCE]
    at = QPoint(viewport.width() // 2, viewport.height() // 2)
    user.click(SOURCE, at)
    (landmark,) = user.session.landmarks
    assert landmark.name == "landmark_0"
    assert landmark.state is LandmarkState.SOURCE_ONLY
    back = user.place_of(SOURCE, landmark.source)
    assert (back - at).manhattanLength() <= 1


def test_a_click_beside_the_bone_places_nothing(user):
    user.open_sample_meshes()
    user.click(SOURCE, QPoint(8, 200))
    assert user.session.landmarks == ()


def test_clicks_on_both_sides_fill_pairs_in_order(user, anterior_pairs):
    first, second = anterior_pairs[:2]
    user.click_position(SOURCE, first.source)
    user.click_position(SOURCE, second.source)
    user.click_position(DESTINATION, first.destination)
    assert [x.state for x in user.session.landmarks] == [
        LandmarkState.PAIRED,
        LandmarkState.SOURCE_ONLY,
    ]
    user.click_position(DESTINATION, second.destination)
    assert [x.name for x in user.session.pairs] == ["landmark_0", "landmark_1"]


def test_five_clicked_pairs_and_the_slider_survive_saving_and_reopening(
    user, anterior_pairs, tmp_path
):
    assert len(anterior_pairs) >= 5
    for landmark in anterior_pairs[:5]:
        user.click_position(SOURCE, landmark.source)
        user.click_position(DESTINATION, landmark.destination)
    assert len(user.session.pairs) == 5
    slider = user.window.parts.penalty.panel.slider
    assert slider.isEnabled()
    middle = slider.rect().center()
    user.drag(slider, QPoint(8, middle.y()), middle)
    assert user.session.settings.penalty > 0
    assert user.editor.undo_label == "Change penalty"
    path = tmp_path / "clicked.pinwarp.csv"
    user.dialogs.saves = [path]
    user.press(Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
    saved = user.session
    overlay = user.window.viewports[DESTINATION].overlay_points
    assert not user.editor.is_dirty
    user.trigger("open_sample")
    user.dialogs.opens = [path]
    user.trigger("open_session")
    assert user.session.landmarks == saved.landmarks
    assert user.session.settings.penalty == saved.settings.penalty
    assert user.session.source.path == saved.source.path
    assert np.allclose(user.window.viewports[DESTINATION].overlay_points, overlay)


def test_the_overlay_follows_clicks_undo_and_the_slider(user, anterior_pairs):
    viewport = user.window.viewports[DESTINATION]
    assert viewport.overlay_points is None
    pictures = []
    for landmark in anterior_pairs[:6]:
        user.click_position(SOURCE, landmark.source)
        user.click_position(DESTINATION, landmark.destination)
        pictures.append(viewport.overlay_points)
    assert all(not np.allclose(a, b) for a, b in itertools.pairwise(pictures))
    user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert np.allclose(viewport.overlay_points, pictures[-2])
    user.press(
        Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
    )
    assert np.allclose(viewport.overlay_points, pictures[-1])
    slider = user.window.parts.penalty.panel.slider
    user.drag(slider, QPoint(8, slider.height() // 2), slider.rect().center(), release=False)
    assert not np.allclose(viewport.overlay_points, pictures[-1])
    assert user.editor.is_previewing


def test_undoing_all_leads_back_to_the_empty_window_and_redo_to_the_end(user, anterior_pairs):
    for landmark in anterior_pairs[:3]:
        user.click_position(SOURCE, landmark.source)
        user.click_position(DESTINATION, landmark.destination)
    end = user.session
    while user.editor.undo_label:
        user.trigger("undo")
    assert user.session.landmarks == ()
    assert user.session.source is None
    assert user.window.viewports[SOURCE].surface is None
    while user.editor.redo_label:
        user.trigger("redo")
    assert user.session == end


def test_the_menu_names_what_undo_takes_back(user, anterior_pairs):
    user.click_position(SOURCE, anterior_pairs[0].source)
    assert user.window.actions_by_key["undo"].text() == "&Undo Place landmark_0"
    user.trigger("undo")
    assert user.window.actions_by_key["redo"].text() == "&Redo Place landmark_0"


def test_clicking_a_landmark_selects_it_everywhere_and_moves_nothing(user, anterior_pairs):
    for landmark in anterior_pairs[:2]:
        user.click_position(SOURCE, landmark.source)
        user.click_position(DESTINATION, landmark.destination)
    before = user.session
    user.click_position(SOURCE, before.landmarks[0].source)
    assert user.session == before
    assert user.editor.selection.names == ("landmark_0",)
    assert [i.row() for i in user.window.parts.table.table.selectionModel().selectedRows()] == [0]
    selected = [m for v in user.window.viewports.values() for m in v.layer.markers if m.selected]
    assert [m.name for m in selected] == ["landmark_0", "landmark_0"]
    assert all(m.labelled for m in selected)


def test_clicking_a_table_row_selects_the_landmark_in_the_views(user, anterior_pairs):
    user.click_position(SOURCE, anterior_pairs[0].source)
    user.click_position(SOURCE, anterior_pairs[1].source)
    table = user.window.parts.table.table
    where = table.visualRect(table.index_of("landmark_0")).center()
    user.qtbot.mouseClick(table.viewport(), Qt.MouseButton.LeftButton, pos=where)
    user.settle()
    assert user.editor.selection.names == ("landmark_0",)
    markers = user.window.viewports[SOURCE].layer.markers
    assert [m.selected for m in markers] == [True, False]


def test_a_left_drag_orbits_and_places_nothing(user):
    user.open_sample_meshes()
    viewport = user.window.viewports[SOURCE]
    before = np.array(viewport.camera.position)
    centre = viewport.rect().center()
    user.drag(viewport, centre, centre + QPoint(60, 10))
    assert user.session.landmarks == ()
    assert np.linalg.norm(np.array(viewport.camera.position) - before) > 10


@pytest.mark.parametrize("button", [Qt.MouseButton.RightButton, Qt.MouseButton.MiddleButton])
def test_a_right_or_middle_drag_pans(user, button):
    user.open_sample_meshes()
    viewport = user.window.viewports[SOURCE]
    position, focus = np.array(viewport.camera.position), np.array(viewport.camera.focal_point)
    centre = viewport.rect().center()
    user.drag(viewport, centre, centre + QPoint(40, 30), button=button)
    moved = np.array(viewport.camera.position) - position
    assert np.linalg.norm(moved) > 5
    assert np.allclose(np.array(viewport.camera.focal_point) - focus, moved, atol=1e-6)
    again = np.array(viewport.camera.position)
    user.qtbot.mouseMove(viewport, centre + QPoint(-50, -50))
    assert np.allclose(np.array(viewport.camera.position), again)


def test_the_wheel_zooms(user):
    from qtpy.QtCore import QPointF
    from qtpy.QtGui import QWheelEvent
    from qtpy.QtWidgets import QApplication

    user.open_sample_meshes()
    viewport = user.window.viewports[SOURCE]
    before = viewport.camera.distance
    at = QPointF(viewport.rect().center())
    event = QWheelEvent(
        at,
        QPointF(viewport.mapToGlobal(at.toPoint())),
        QPoint(0, 0),
        QPoint(0, 120),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(viewport, event)
    assert viewport.camera.distance < before


def test_dragging_a_landmark_slides_it_over_the_bone_in_one_step(user, anterior_pairs):
    user.click_position(SOURCE, anterior_pairs[0].source)
    placed = user.session.landmarks[0].source
    viewport = user.window.viewports[SOURCE]
    start = user.place_of(SOURCE, placed)
    user.drag(viewport, start, start + QPoint(3, 30))
    moved = user.session.landmarks[0].source
    assert np.linalg.norm(np.subtract(moved, placed)) > 5
    assert user.editor.undo_label == "Move landmark_0"
    user.trigger("undo")
    assert user.session.landmarks[0].source == placed


def test_escape_during_a_drag_puts_the_landmark_back(user, anterior_pairs):
    user.click_position(SOURCE, anterior_pairs[0].source)
    before = user.session
    viewport = user.window.viewports[SOURCE]
    start = user.place_of(SOURCE, before.landmarks[0].source)
    user.drag(viewport, start, start + QPoint(0, 25), release=False)
    assert user.session != before
    user.press(Qt.Key.Key_Escape, widget=viewport)
    assert user.session == before
    user.qtbot.mouseRelease(viewport, Qt.MouseButton.LeftButton, pos=start + QPoint(0, 25))
    assert user.session == before


def test_delete_removes_the_selected_side_and_ctrl_delete_the_landmark(user, anterior_pairs):
    landmark = anterior_pairs[0]
    user.click_position(SOURCE, landmark.source)
    user.click_position(DESTINATION, landmark.destination)
    user.click_position(DESTINATION, user.session.landmarks[0].destination)
    user.press(Qt.Key.Key_Delete)
    assert user.session.landmarks[0].state is LandmarkState.SOURCE_ONLY
    user.trigger("undo")
    user.press(Qt.Key.Key_Delete, Qt.KeyboardModifier.ControlModifier)
    assert user.session.landmarks == ()


def test_a_landmark_is_renamed_in_the_table(user, anterior_pairs):
    user.click_position(SOURCE, anterior_pairs[0].source)
    user.trigger("rename")
    field = user.window.parts.table.table.findChild(QLineEdit)
    user.qtbot.keyClicks(field, "fovea")
    user.qtbot.keyClick(field, Qt.Key.Key_Return)
    user.settle()
    assert user.session.landmarks[0].name == "fovea"
    assert user.editor.selection.names == ("fovea",)


def test_a_name_that_is_taken_is_refused_with_the_reason(user, anterior_pairs):
    user.click_position(SOURCE, anterior_pairs[0].source)
    user.click_position(SOURCE, anterior_pairs[1].source)
    user.trigger("rename")
    field = user.window.parts.table.table.findChild(QLineEdit)
    user.qtbot.keyClicks(field, "landmark_0")
    user.qtbot.keyClick(field, Qt.Key.Key_Return)
    user.settle()
    assert [x.name for x in user.session.landmarks] == ["landmark_0", "landmark_1"]
    assert "already a landmark called landmark_0" in user.window.statusBar().currentMessage()


def test_a_tick_in_the_table_lets_a_pair_sit_out(user):
    user.open_sample()
    table = user.window.parts.table.table
    before = user.window.viewports[DESTINATION].overlay_points
    cell = table.visualRect(table.order.index(0, 0))
    user.qtbot.mouseClick(
        table.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(cell.left() + 10, cell.center().y())
    )
    user.settle()
    assert user.session.landmarks[0].state is LandmarkState.DISABLED
    assert len(user.session.pairs) == 15
    assert not np.allclose(user.window.viewports[DESTINATION].overlay_points, before)


def test_landmarks_behind_the_bone_do_not_catch_the_mouse(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    hidden = [m for m, h in zip(viewport.layer.markers, viewport.layer.hidden(), strict=True) if h]
    assert hidden
    behind = next(
        m for m in hidden if viewport.pick(user.place_of(SOURCE, m.position).toPointF()) is not None
    )
    assert viewport.layer.nearest(user.place_of(SOURCE, behind.position).toPointF(), 2) is None


def test_hovering_a_landmark_shows_its_name_on_both_sides(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    seen = [
        m for m, h in zip(viewport.layer.markers, viewport.layer.hidden(), strict=True) if not h
    ]
    user.qtbot.mouseMove(viewport, QPoint(5, 5))
    user.qtbot.mouseMove(viewport, user.place_of(SOURCE, seen[0].position))
    user.qtbot.waitUntil(lambda: user.editor.view.hovered == seen[0].name)
    user.settle()
    labelled = [
        m.name for v in user.window.viewports.values() for m in v.layer.markers if m.labelled
    ]
    assert labelled == [seen[0].name] * 2
    assert seen[0].name in user.window.parts.guidance.hint.text()


def test_passengers_are_carried_by_the_warp(user):
    user.open_sample()
    markers = user.window.viewports[DESTINATION].layer.markers
    passengers = [m for m in markers if m.state is LandmarkState.PASSENGER]
    assert len(passengers) == 4
    assert not any(m.movable for m in passengers)


def test_many_requests_in_one_turn_render_once(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    user.qtbot.wait(50)
    before = viewport.renders
    for _ in range(10):
        viewport.camera.Azimuth(1)
        viewport.update()
        viewport.update()
    user.qtbot.wait(50)
    assert viewport.renders == before + 1


def test_what_lies_above_a_picture_is_painted_without_a_frame(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    user.qtbot.wait(50)
    before = viewport.renders
    viewport.layer.update()
    # As the desktop asks when another window has been before this one.
    QWidget.update(viewport)
    user.qtbot.wait(50)
    shown = viewport.grab().toImage().pixelColor(viewport.rect().center())
    assert viewport.renders == before
    assert shown == viewport.picture().pixelColor(viewport.rect().center())


def test_a_view_that_is_closed_shows_its_last_picture(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    before, rest = viewport.picture().copy(), viewport.renders
    viewport.close()
    viewport.update()
    assert viewport.picture() == before
    assert (viewport.renders, viewport.graphics) == (rest, "unknown")
