"""What is shown of semilandmarks, as drawables."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pinwarp.core.groups import Curve
from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.drawables import (
    CurveHandle,
    DotKind,
    Dots,
    Drawable,
    Handles,
    PathLine,
    Paths,
    Slides,
)
from pinwarp.gui.semilandmarks.curve_tool import CurveTool
from pinwarp.gui.semilandmarks.shown import Shown, ShownGroup
from pinwarp.session.session import Session
from pinwarp.session.view import ViewState


class Picture:
    """What a side shows: the same objects as long as nothing has changed.

    Parameters
    ----------
    side
        Which side.
    tool
        What draws curves there, if anything.
    """

    def __init__(self, side: Side, tool: CurveTool | None = None) -> None:
        self._side = side
        self._tool = tool
        self._dots: tuple[object, Dots | None] = (None, None)
        self._paths: tuple[object, Paths] = (None, Paths(()))
        self._slides: tuple[object, Slides | None] = (None, None)

    def of(
        self, session: Session, view: ViewState, shown: Shown, point: tuple[str, int] | None
    ) -> Iterator[Drawable]:
        """Return what is shown.

        Parameters
        ----------
        session, view
            As they are now.
        shown
            As far as it is worked out.
        point
            The point that is chosen.
        """
        if self._dots[0] != (shown, point):
            self._dots = ((shown, point), dots_of(shown, self._side, point))
        if self._dots[1] is not None:
            yield self._dots[1]
        paths = self._paths_of(shown, view.group)
        if paths.lines:
            yield paths
        handles = handles_of(session, shown, self._side, movable=not view.locked)
        if self._tool is not None:
            colour = len(session.groups)
            handles += tuple(
                CurveHandle("", number, stop.source, colour, movable=False)
                for number, stop in enumerate(self._tool.stops)
            )
        if handles:
            yield Handles(handles)
        if self._side is Side.DESTINATION and view.slides:
            if self._slides[0] is not shown:
                self._slides = (shown, slides_of(shown))
            if self._slides[1] is not None:
                yield self._slides[1]
        else:
            self._slides = (None, None)

    def _paths_of(self, shown: Shown, chosen: str) -> Paths:
        drawing = self._tool.drawing if self._tool is not None else None
        if self._paths[0] != (shown, chosen, drawing):
            lines = lines_of(shown, self._side, chosen)
            colour = len(shown.groups)
            if drawing is not None and drawing.way is not None:
                lines.append(PathLine(drawing.way, colour, is_chosen=True))
            if drawing is not None and drawing.to_cursor is not None:
                lines.append(PathLine(drawing.to_cursor, colour, is_ghost=True))
            self._paths = ((shown, chosen, drawing), Paths(tuple(lines)))
        return self._paths[1]


def dots_of(shown: Shown, side: Side, chosen: tuple[str, int] | None) -> Dots | None:
    """Return the dots of a side; one of them may be chosen. None where there are none."""
    positions, colours, kinds = [], [], []
    for row, one in enumerate(shown.groups):
        places = one.source if side is Side.SOURCE else one.destination
        kind = np.full(len(places), int(DotKind.AT_REST))
        kind[one.is_freed] = int(DotKind.FREED)
        kind[list(one.group.excluded)] = int(DotKind.EXCLUDED)
        if chosen is not None and chosen[0] == one.group.name and chosen[1] < len(kind):
            kind[chosen[1]] = int(DotKind.CHOSEN)
        there = np.isfinite(places).all(axis=1)
        positions.append(places[there])
        kinds.append(kind[there])
        colours.append(np.full(len(positions[-1]), row))
    if not any(map(len, positions)):
        return None
    return Dots(np.vstack(positions), np.concatenate(colours), np.concatenate(kinds))


def lines_of(shown: Shown, side: Side, chosen: str) -> list[PathLine]:
    """Return the curves of a side."""
    lines = []
    for row, one in enumerate(shown.groups):
        curve = one.group
        if isinstance(curve, Curve) and side in one.paths:
            is_ghost = side is Side.DESTINATION and not curve.is_drawn
            lines.append(PathLine(one.paths[side], row, is_ghost, curve.name == chosen))
    return lines


def handles_of(
    session: Session, shown: Shown, side: Side, *, movable: bool
) -> tuple[CurveHandle, ...]:
    """Return the handles of a side; where one is a landmark, that is what is moved."""
    handles = []
    for row, curve in enumerate(session.groups):
        if not isinstance(curve, Curve):
            continue
        one = shown.group(curve.name)
        for number, handle in enumerate(curve.handles):
            place, is_ghost = handle.position(side), False
            if place is None and one is not None:
                place, is_ghost = _expected(one, number), True
            elif handle.landmark:
                continue
            if place is not None:
                handles.append(CurveHandle(curve.name, number, place, row, is_ghost, movable))
    return tuple(handles)


def slides_of(shown: Shown) -> Slides | None:
    """Return from where to where semilandmarks slid on the destination."""
    starts, ends, colours = [], [], []
    for row, one in enumerate(shown.groups):
        did = np.isfinite(one.destination).all(axis=1) & ~one.is_freed
        starts.append(one.start[did])
        ends.append(one.destination[did])
        colours.append(np.full(int(did.sum()), row))
    if not any(map(len, starts)):
        return None
    return Slides(np.vstack(starts), np.vstack(ends), np.concatenate(colours))


def _expected(one: ShownGroup, number: int) -> tuple[float, float, float] | None:
    expected = one.expected
    return expected[number] if expected is not None and number < len(expected) else None
