"""A whole session on a real hemipelvis, by mouse and keys alone, from nothing and back."""

from __future__ import annotations

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt
from qtpy.QtTest import QTest

from pinwarp.core.landmarks import LandmarkState, Side
from pinwarp.session.session import Session

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


@pytest.fixture
def pelvis(user, shared_data):
    folder = shared_data / "msk-morph-pelvis"
    for side, name in ((SOURCE, "template_pelvis_r.stl"), (DESTINATION, "target_pelvis_r.stl")):
        user.window.parts.documents.open_mesh(side, folder / name)
    user.settle()
    return user


def spread_over_the_view(user, side, count):
    """Places on the bone, far apart on the screen."""
    viewport = user.window.viewports[side]
    grid = [
        QPoint(x, y)
        for y in range(60, viewport.height() - 60, 12)
        for x in range(30, viewport.width() - 30, 12)
        if viewport.pick(QPoint(x, y).toPointF()) is not None
    ]
    chosen = [grid[0]]
    while len(chosen) < count:
        apart = [min((p - q).manhattanLength() for q in chosen) for p in grid]
        chosen.append(grid[int(np.argmax(apart))])
    return chosen


def test_twelve_pairs_three_drags_one_disabled_and_all_the_way_back(pelvis):
    user = pelvis
    source, destination = (user.window.viewports[side] for side in (SOURCE, DESTINATION))
    # The two stand alike: what is at a place in one view is near it in the other.
    places = spread_over_the_view(user, SOURCE, 12)
    accepted = 0
    for number, at in enumerate(places):
        source.setFocus()
        user.click(SOURCE, at)
        name = user.editor.selection.names[0]
        assert user.session.landmark(name).source is not None, f"click {number} missed"
        if user.window.parts.ghosts.at(DESTINATION) is not None:
            user.press(Qt.Key.Key_Space, widget=source)
            if not user.session.landmark(name).is_pair:
                # The bone hid it: the view has turned, and the second press accepts.
                user.press(Qt.Key.Key_Space, widget=source)
                user.press(Qt.Key.Key_Home, Qt.KeyboardModifier.ShiftModifier)
            accepted += 1
        else:
            assert number < 3
            found = next(
                near
                for radius in range(0, 200, 6)
                for near in (
                    at + QPoint(dx, dy)
                    for dx in (-radius, 0, radius)
                    for dy in (-radius, 0, radius)
                )
                if destination.pick(near.toPointF()) is not None
            )
            user.click(DESTINATION, found)
        assert user.session.landmark(name).is_pair
    assert len(user.session.pairs) == 12
    assert accepted == 9

    dragged = 0
    for marker in destination.layer.markers:
        start = user.place_of(DESTINATION, marker.position)
        seen = destination.layer.nearest(start.toPointF(), 2)
        end = start + QPoint(8, 8)
        if seen is None or seen.name != marker.name or destination.pick(end.toPointF()) is None:
            continue
        before = user.session
        user.drag(destination, start, end)
        assert user.session != before
        assert user.editor.undo_label == f"Move {marker.name}"
        dragged += 1
        if dragged == 3:
            break
    assert dragged == 3

    table = user.window.parts.table.table
    cell = table.visualRect(table.index_of(user.session.landmarks[5].name))
    user.qtbot.mouseClick(
        table.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(cell.left() + 10, cell.center().y())
    )
    user.settle()
    assert user.session.landmarks[5].state is LandmarkState.DISABLED
    assert len(user.session.pairs) == 11

    end, steps = user.session, 0
    control = Qt.KeyboardModifier.ControlModifier
    while user.editor.undo_label is not None:
        user.press(Qt.Key.Key_Z, control)
        steps += 1
    assert user.session == Session()
    assert user.window.viewports[SOURCE].surface is None
    # Two meshes, twelve places on either side, three drags, one tick.
    assert steps == 2 + 24 + 3 + 1
    # Back faster than any of it can be shown.
    while user.editor.redo_label is not None:
        QTest.keyClick(user.window, Qt.Key.Key_Z, control | Qt.KeyboardModifier.ShiftModifier)
    user.settle()
    assert user.session == end
    assert np.isfinite(user.window.parts.warps.result.vertices).all()
