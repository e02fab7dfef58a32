"""A user who draws curves and patches."""

from __future__ import annotations

import numpy as np
from qtpy.QtCore import QPoint, QPointF, Qt
from qtpy.QtTest import QTest

from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.drawables import Dots, Handles, Paths

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
SHIFT, CTRL = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.ControlModifier


def part(user):
    """The capability under test."""
    return user.window.parts.semilandmarks


def panel(user):
    """Its panel."""
    return part(user).panel


def names(user):
    return [group.name for group in user.session.groups]


def spots(user, count=4, first=0.3, last=0.7, across=0.5):
    """Places on the screen down the shaft of the source."""
    view = user.window.viewports[SOURCE]
    found = []
    for y in np.linspace(first, last, count) * view.height():
        row = [x for x in range(view.width()) if view.pick(QPointF(x, y)) is not None]
        found.append(QPoint(row[int(across * (len(row) - 1))], int(y)))
    return found


def clear_spots(user, count=4, **where):
    """As `spots`, none of them near a landmark."""
    view = user.window.viewports[SOURCE]
    for across in (0.5, 0.35, 0.65, 0.25, 0.75):
        found = spots(user, count, across=across, **where)
        if all(view.layer.nearest(at.toPointF(), 14) is None for at in found):
            return found
    raise AssertionError("landmarks everywhere")


def ring(user, count=8, height=0.5, share=0.35):
    """Places on the screen around a middle of the source, seen from nearby."""
    view = user.window.viewports[SOURCE]
    user.editor.select("midshaft_anterior")
    user.trigger("focus")
    user.editor.select()
    user.settle()
    y = height * view.height()
    row = [x for x in range(view.width()) if view.pick(QPointF(x, y)) is not None]
    middle, radius = np.mean(row), share * (row[-1] - row[0])
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False)
    around = [
        QPoint(round(middle + radius * np.cos(a)), round(y + radius * np.sin(a))) for a in angles
    ]
    return QPoint(round(middle), round(y)), around


def draw(user, places, end=Qt.Key.Key_Return):
    """Draw a curve by clicks; closed where `end` is None."""
    view = user.window.viewports[SOURCE]
    user.press(Qt.Key.Key_C)
    for at in places:
        QTest.mouseMove(view, at)
        QTest.mouseClick(view, LEFT, PLAIN, at)
    if end is None:
        QTest.mouseClick(view, LEFT, PLAIN, places[0])
        user.settle()
    else:
        user.press(end)


def choose(user, name, number=None):
    """Click a row of the list; a point's where a number is given."""
    tree = panel(user).tree
    dock = panel(user).parentWidget()
    dock.show()
    dock.raise_()
    user.settle()
    if number is not None:
        tree.expand(panel(user).model.index_of(name))
    index = panel(user).model.index_of(name, number)
    tree.scrollTo(index)
    QTest.mouseClick(tree.viewport(), LEFT, PLAIN, tree.visualRect(index).center())
    user.settle()


def dots(user, side):
    return user.window.viewports[side].drawn(Dots)


def lines(user, side):
    drawn = user.window.viewports[side].drawn(Paths)
    return drawn.lines if drawn is not None else ()


def handles(user, side):
    drawn = user.window.viewports[side].drawn(Handles)
    return drawn.handles if drawn is not None else ()


def drag_handle(user, side, number, by, release=True):
    """Drag a handle of the first curve that has such a number."""
    handle = next(x for x in handles(user, side) if x.number == number)
    start = user.place_of(side, handle.position)
    user.drag(user.window.viewports[side], start, start + by, release=release)
    return handle
