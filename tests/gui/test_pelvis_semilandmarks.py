"""A story of semilandmarks on a real hemipelvis: drawn by mouse, and all the way back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from qtpy.QtCore import QPoint, QPointF, Qt
from qtpy.QtTest import QTest
from tests.core.pelvis import pelvis_landmarks
from tests.gui.drawing import (
    CTRL,
    DESTINATION,
    SHIFT,
    SOURCE,
    choose,
    dots,
    drag_handle,
    draw,
    lines,
    names,
    panel,
    part,
)

from pinwarp.core.curves import CurvePath
from pinwarp.core.landmarks import Landmark, as_position
from pinwarp.gui.scene.drawables import DotKind


@pytest.fixture
def pelvis(user, shared_data):
    """Both bones with a dozen pairs: their vertices answer to one another."""
    folder = shared_data / "msk-morph-pelvis"
    # One is in metres: "Scale the Source by 1,000".
    user.dialogs.choices = [1]
    for side, name in ((SOURCE, "template_pelvis_r.stl"), (DESTINATION, "target_pelvis_r.stl")):
        user.window.parts.documents.open_mesh(side, folder / name)
    user.settle()
    return user


def on_the_bone(user):
    """Places on the screen well within the source."""
    view = user.window.viewports[SOURCE]

    def is_on(x, y):
        around = ((0, 0), (6, 0), (-6, 0), (0, 6), (0, -6))
        return all(view.pick(QPointF(x + dx, y + dy)) is not None for dx, dy in around)

    xs, ys = range(20, view.width() - 20, 8), range(50, view.height() - 60, 8)
    return [QPoint(x, y) for y in ys for x in xs if is_on(x, y)]


def test_two_patches_three_curves_accepted_shaped_and_all_the_way_back(pelvis):
    user = pelvis
    meshes = [user.session.mesh(side) for side in (SOURCE, DESTINATION)]
    pairs = tuple(
        Landmark(f"p{row}", *(as_position(mesh.vertices[row]) for mesh in meshes))
        for row in pelvis_landmarks(meshes[0], 14)
    )
    user.editor.replace_all(replace(user.session, landmarks=pairs), None)
    user.settle()
    begin, view = user.session, user.window.viewports[SOURCE]
    # Three curves down the bone, one of them closed.
    on = on_the_bone(user)
    left, right = min(at.x() for at in on), max(at.x() for at in on)
    top, low = min(at.y() for at in on), max(at.y() for at in on)

    def nearest(x, y):
        """The place on the bone that is nearest to shares of its width and height."""
        want = QPoint(int(left + x * (right - left)), int(top + y * (low - top)))
        return min(on, key=lambda at: (at - want).manhattanLength())

    def path(*shares):
        found = []
        for x, y in shares:
            at = nearest(x, y)
            if all((at - other).manhattanLength() > 16 for other in found):
                found.append(at)
        return found

    user.press(Qt.Key.Key_C)
    for place in path((0.1, 0.1), (0.35, 0.02), (0.6, 0.05)):
        user.click(SOURCE, place)
    QTest.mouseMove(view, nearest(0.85, 0.15))
    user.settle()
    user.click(SOURCE, nearest(0.85, 0.15))
    user.press(Qt.Key.Key_Return)
    draw(user, path((0.45, 0.45), (0.5, 0.6), (0.55, 0.72), (0.6, 0.85)))
    circle = [(0.45 + 0.22 * np.cos(a), 0.25 + 0.13 * np.sin(a)) for a in np.arange(0, 6.2, 0.7)]
    closed = path(*circle)
    draw(user, closed, end=None)
    assert names(user) == ["curve_1", "curve_2", "curve_3"]
    assert user.session.groups[2].is_closed
    assert [line.is_ghost for line in lines(user, DESTINATION)] == 3 * [True]
    panel(user).parentWidget().raise_()
    user.settle()
    for number in range(3):
        user.editor.look(group="")
        expected = lines(user, DESTINATION)[number].places
        user.press(Qt.Key.Key_Space)
        assert user.session.groups[number].is_drawn
        # The way that was accepted is the one that was shown, over the rim of the socket too.
        drawn = lines(user, DESTINATION)[number].places
        off = np.linalg.norm(expected[:, None] - drawn, axis=2).min(axis=1).max()
        assert off < 0.1 * CurvePath(drawn).length
    drag_handle(user, DESTINATION, 1, QPoint(7, 5))
    assert user.editor.undo_label == "Move handle of curve_1"
    # A patch inside the closed one, and one over all.
    user.press(Qt.Key.Key_C, SHIFT)
    user.click(SOURCE, nearest(0.45, 0.25))
    assert names(user)[3:] == ["patch_1"]
    assert user.session.groups[3].around == "curve_3"
    user.press(Qt.Key.Key_C, SHIFT)
    user.press(Qt.Key.Key_Return)
    assert names(user)[4:] == ["patch_2"]
    for name, count in (("curve_1", 40), ("patch_1", 60), ("patch_2", 500)):
        choose(user, name)
        panel(user).spin.setFocus()
        panel(user).spin.selectAll()
        QTest.keyClicks(panel(user).spin, str(count))
        QTest.keyClick(panel(user).spin, Qt.Key.Key_Return)
        user.settle()
    assert [group.count for group in user.session.groups] == [40, 20, 20, 60, 500]
    assert user.window.parts.warps.result.not_sliding is None
    user.press(Qt.Key.Key_A, SHIFT)
    choose(user, "curve_1", 4)
    user.press(Qt.Key.Key_A, SHIFT)
    for side in (SOURCE, DESTINATION):
        shown = dots(user, side)
        positions = shown.positions[shown.kinds != DotKind.FREED]
        surface = user.window.viewports[side].surface
        assert max(surface.closest(place)[1] for place in positions[::7]) < 0.5
    end, steps = user.session, 0
    while user.editor.undo_label is not None:
        user.press(Qt.Key.Key_Z, CTRL)
        steps += 1
    # Three drawn, three accepted, a handle, two patches, three counts.
    assert steps == 3 + 3 + 1 + 2 + 3
    assert user.session == begin
    assert dots(user, SOURCE) is None
    # Back faster than any of it can be shown.
    while user.editor.redo_label is not None:
        QTest.keyClick(user.window, Qt.Key.Key_Z, CTRL | SHIFT)
    user.settle()
    assert user.session == end
    assert part(user).note.text().startswith("640 semilandmarks")
