"""User stories: clicks and drags with a key held, what comes too soon, and what a view says."""

from __future__ import annotations

import numpy as np
from qtpy.QtCore import QEvent, QPoint, QPointF, Qt
from qtpy.QtGui import QMouseEvent
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication

from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.drawables import NextClick
from pinwarp.gui.views.viewport import AFTER_DRAG_MS
from pinwarp.session import edits

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
SHIFT, CTRL = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.ControlModifier
LEFT = Qt.MouseButton.LeftButton


def select(user, name: str, side=DESTINATION) -> None:
    user.editor.select(name, side=side)
    user.settle()


def direction(view):
    """Return where a camera looks."""
    return np.array(view.camera.GetDirectionOfProjection())


def angle(one, other) -> float:
    return float(np.degrees(np.arccos(np.clip(one @ other, -1, 1))))


def send(view, kind, at: QPoint, held, time: int) -> None:
    """Send a mouse event of a given time."""
    where = QPointF(at)
    button = LEFT if kind != QEvent.Type.MouseMove else Qt.MouseButton.NoButton
    event = QMouseEvent(
        kind, where, QPointF(view.mapToGlobal(at)), button, held, Qt.KeyboardModifier.NoModifier
    )
    event.setTimestamp(time)
    QApplication.sendEvent(view, event)
    QApplication.processEvents()


def next_clicks(user):
    told = (user.window.viewports[side].drawn(NextClick) for side in Side)
    return [one.words if one is not None else "" for one in told]


# Shift+click


def test_shift_click_puts_the_selected_landmark_elsewhere_in_one_step(user):
    user.open_sample()
    before = user.session
    name = "lateral_epicondyle"
    select(user, name)
    at = user.free_place(DESTINATION)
    user.click(DESTINATION, at, SHIFT)
    moved = user.session.landmark(name)
    assert (user.place_of(DESTINATION, moved.destination) - at).manhattanLength() <= 1
    assert moved.source == before.landmark(name).source
    assert user.editor.undo_label == f"Re-place {name}"
    assert user.editor.selection.names == (name,)
    assert len(user.session.landmarks) == len(before.landmarks)
    # One that the bone hides, on the other side, and onto another landmark.
    hidden = next(
        marker.name
        for marker, out in zip(
            user.window.viewports[SOURCE].layer.markers,
            user.window.viewports[SOURCE].layer.hidden(),
            strict=True,
        )
        if out and user.session.landmark(marker.name).is_complete
    )
    select(user, hidden, SOURCE)
    other = user.session.landmark("midshaft_anterior")
    user.click_position(SOURCE, other.source)
    select(user, hidden, SOURCE)
    QTest.mouseClick(
        user.window.viewports[SOURCE], LEFT, SHIFT, user.place_of(SOURCE, other.source)
    )
    user.settle()
    assert np.allclose(user.session.landmark(hidden).source, other.source, atol=1.5)
    for _ in range(2):
        user.press(Qt.Key.Key_Z, CTRL)
    assert user.session == before


def test_shift_click_says_why_it_does_nothing(user):
    user.open_sample()
    said = []
    user.window.statusBar().messageChanged.connect(said.append)
    before = user.session
    user.click(DESTINATION, user.free_place(DESTINATION), SHIFT)
    assert "Select one landmark first" in said[-1]
    select(user, "iliopsoas_insertion")
    user.click(DESTINATION, user.free_place(DESTINATION), SHIFT)
    assert "is a passenger" in said[-1]
    select(user, "lateral_epicondyle")
    user.click(DESTINATION, QPoint(8, 200), SHIFT)
    assert "no surface here" in said[-1]
    user.press(Qt.Key.Key_L)
    user.click(DESTINATION, user.free_place(DESTINATION), SHIFT)
    assert "locked" in said[-1]
    assert user.session == before
    user.press(Qt.Key.Key_L)
    # A passenger may be put elsewhere on the source.
    select(user, "iliopsoas_insertion", SOURCE)
    user.click(SOURCE, user.free_place(SOURCE), SHIFT)
    assert user.editor.undo_label == "Re-place iliopsoas_insertion"


def test_shift_click_places_a_landmark_that_lacks_this_side(user):
    user.open_sample()
    name = "lateral_epicondyle"
    session = edits.remove_side(user.session, name, DESTINATION)
    session = edits.remove_side(session, "fovea_capitis", DESTINATION)
    user.editor.commit(session, "Remove two")
    select(user, name)
    user.click(DESTINATION, user.free_place(DESTINATION), SHIFT)
    assert user.session.landmark(name).is_complete
    assert not user.session.landmark("fovea_capitis").is_complete
    assert user.editor.undo_label == f"Place {name}"


# Ctrl+drag


def test_ctrl_drag_turns_one_bone_alone_and_they_keep_how_they_stand_then(user):
    user.open_sample_meshes()
    views = user.window.viewports
    here, there = views[SOURCE], views[DESTINATION]
    before = direction(there)
    at = QPoint(here.width() // 2, here.height() // 2)
    QTest.mousePress(here, LEFT, CTRL, at)
    for i in range(1, 7):
        user.move_with(here, QPointF(at + QPoint(12 * i, 0)), LEFT, CTRL)
    QTest.mouseRelease(here, LEFT, CTRL, at + QPoint(72, 0))
    user.settle()
    assert user.session.landmarks == (), "it was no Ctrl+click"
    assert np.allclose(direction(there), before)
    alone = direction(here)
    turned = angle(alone, before)
    assert turned > 10
    # It turned about the axis that is up on the screen, and did not spin in its plane.
    assert abs(np.dot(np.cross(alone, before), here.camera.GetViewUp())) > 0.9 * np.sin(
        np.radians(turned)
    )
    # From here on both turn together again, by the same amount.
    user.drag(here, at, at + QPoint(0, 60))
    assert not np.allclose(direction(there), before)
    by = [angle(direction(here), alone), angle(direction(there), before)]
    assert by[0] > 10
    assert abs(by[0] - by[1]) < 0.1


# What comes too soon


def test_a_click_right_after_a_drag_does_nothing_and_a_later_one_places(user):
    user.open_sample_meshes()
    view = user.window.viewports[SOURCE]
    at = QPoint(view.width() // 2, view.height() // 2)
    said = []
    user.window.statusBar().messageChanged.connect(said.append)
    send(view, QEvent.Type.MouseButtonPress, at, LEFT, 1_000)
    for step in range(1, 6):
        send(view, QEvent.Type.MouseMove, at + QPoint(4 * step, 0), LEFT, 1_000 + 20 * step)
    there, ended = at + QPoint(20, 0), 1_120
    send(view, QEvent.Type.MouseButtonRelease, there, Qt.MouseButton.NoButton, ended)
    for after, count in ((AFTER_DRAG_MS - 30, 0), (AFTER_DRAG_MS + 30, 1)):
        send(view, QEvent.Type.MouseButtonPress, at, LEFT, ended + after)
        released = Qt.MouseButton.NoButton
        send(view, QEvent.Type.MouseButtonRelease, at, released, ended + after + 10)
        user.settle()
        assert len(user.session.landmarks) == count
    assert any("click again" in message for message in said)


# What a view says


def test_a_view_says_what_the_next_click_does_until_nobody_needs_it(user):
    assert next_clicks(user) == ["", ""], "without bones there is nothing to click"
    user.open_sample_meshes()
    assert next_clicks(user) == ["Click a place on this bone,", "then the same place on this one"]
    places = [user.places_down_the_bone(side, 6) for side in Side]
    user.click_position(SOURCE, places[0][0])
    assert next_clicks(user) == ["", "Click: landmark_0"]
    user.click_position(DESTINATION, places[1][0])
    for i in range(1, 4):
        user.click_position(SOURCE, places[0][i])
        user.click_position(DESTINATION, places[1][i])
    assert next_clicks(user) == ["", ""]
    user.click_position(DESTINATION, places[1][5])
    assert next_clicks(user) == ["Click: landmark_4", ""]
    user.press(Qt.Key.Key_L)
    assert next_clicks(user) == ["", ""], "a click only selects"


def test_a_hint_names_one_landmark_once(user):
    user.open_sample_meshes()
    user.editor.commit(
        edits.place(user.session, SOURCE, (0.0, 0.0, 0.0), target=None, pattern="a_{n}")[0], "a"
    )
    session = edits.remove_side(user.session, "a_0", SOURCE)
    user.editor.commit(session, "b")
    user.trigger("guide")
    assert user.window.parts.guidance.hint.text() == "A click on either bone places a_0."
