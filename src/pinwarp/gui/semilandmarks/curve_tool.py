"""The tool that draws a curve over the source, click by click."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QPointF, Qt
from qtpy.QtWidgets import QWidget

from pinwarp.core.errors import PinwarpError
from pinwarp.core.groups import Handle
from pinwarp.core.landmarks import Position, Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.gui.semilandmarks.view_tool import ENDING, ViewTool, named
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.views.canvas import OUTLINE_REACH, Canvas
from pinwarp.gui.views.viewport import REACH, Viewport
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session
from pinwarp.session.warp.sliding import Finders

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class _Ask:
    """The places so far, whether the curve closes, and where the mouse is."""

    mesh: Mesh
    stops: tuple[Position, ...]
    closes: bool = False
    cursor: Position | None = None


@dataclass(frozen=True, eq=False)
class _Found:
    """The ways between them; or which place cannot be reached, and why."""

    ask: _Ask
    ways: tuple[Matrix, ...] = ()
    to_cursor: Matrix | None = None
    unreached: int | None = None
    problem: str = ""


@dataclass(frozen=True, eq=False)
class Drawing:
    """What is seen while one draws.

    Attributes
    ----------
    key
        What it follows from.
    way : (p, 3) float64 or None
        Through the places so far, as far as it is found.
    to_cursor : (p, 3) float64 or None
        From the last place to the mouse.
    """

    key: tuple[object, ...]
    way: Matrix | None
    to_cursor: Matrix | None


class CurveTool(ViewTool):
    """Draws a curve; the ways between the clicks are found by a worker.

    Parameters
    ----------
    editor
        What is edited.
    viewports, window
        As every tool needs them.
    finders
        Of ways over the source.
    """

    def __init__(
        self,
        editor: Editor,
        viewports: Mapping[Side, Viewport],
        window: QWidget,
        finders: Finders,
    ) -> None:
        super().__init__(viewports, window)
        self._editor = editor
        self._finders = finders
        self._worker = LatestWins(self._find)
        self._worker.computed.connect(self._on_found)
        self._worker.failed.connect(self._on_failure)
        self._mesh: Mesh | None = None
        self._cursor: Position | None = None
        # Whether it ends as soon as its ways are found, and closes then.
        self._ending: bool | None = None
        self._found: _Found | None = None
        self._drawing: Drawing | None = None
        self.stops: tuple[Handle, ...] = ()
        editor.session_changed.connect(self._on_session)

    def shut_down(self) -> None:
        """Leave, and let go of the editor."""
        self.stop()
        self._editor.session_changed.disconnect(self._on_session)
        self._worker.shut_down()

    @property
    def is_settled(self) -> bool:
        """Whether the way that was asked for last is found."""
        return self._worker.is_idle

    @property
    def words(self) -> str:
        """What it asks for now, in few words."""
        if len(self.stops) < 2:
            return "Click the next place" if self.stops else "Click along a crest of the source"
        closing = "\nA click on the first place closes it" if len(self.stops) > 2 else ""
        return f"Click on, {named(ENDING[0])} ends the curve{closing}"

    @property
    def hint(self) -> str:
        """What can be done now."""
        back, leave = map(named, (Qt.Key.Key_Backspace, Qt.Key.Key_Escape))
        if not self.stops:
            return f"A click on a landmark anchors the curve there, {leave} leaves."
        if len(self.stops) == 1:
            return f"Click the next place. {back} takes the last one back, {leave} leaves."
        closing = ", a click on the first place closes it" if len(self.stops) > 2 else ""
        return (
            f"{named(ENDING[0])} or a double click ends the curve{closing}. {back} takes the last "
            f"place back, {leave} leaves."
        )

    # What is seen while one draws

    @property
    def drawing(self) -> Drawing | None:
        """What there is to be seen of the curve, the same object until that is something else."""
        found = self._found
        if not self.is_active or found is None:
            return None
        places = tuple(stop.source for stop in self.stops)
        if self._drawing is None or self._drawing.key != (found, places, self._cursor):
            wanted = set(itertools.pairwise(places))
            steps = zip(found.ways, _steps(found.ask), strict=False)
            known = [way for way, step in steps if step in wanted]
            from_last = self._cursor is not None and places and found.ask.stops[-1:] == places[-1:]
            self._drawing = Drawing(
                (found, places, self._cursor),
                np.vstack(known) if known else None,
                found.to_cursor if from_last else None,
            )
        return self._drawing

    # The mouse and the keys

    def start(self) -> None:
        """Begin a curve on the source."""
        mesh = self._editor.session.mesh(Side.SOURCE)
        if mesh is None:
            self.said.emit("A curve is drawn over the source mesh: open it first.")
            return
        if not self.is_active:
            self._mesh, self.stops, self._found, self._ending = mesh, (), None, None
            self._cursor = None
            super().start()
            # What finds ways is made ready while the hand is on its way.
            self._ask()

    def stop(self) -> None:
        """Leave: what was clicked is forgotten."""
        self.stops, self._found, self._mesh, self._cursor = (), None, None, None
        self._drawing = None
        super().stop()

    def click(self, view: Canvas, at: QPointF, twice: bool) -> None:
        """Add a place, close the curve on its first one, or end it by a double click."""
        if view.side is not Side.SOURCE:
            self.said.emit(
                "A curve is drawn on the source: on the destination it shows where it is expected."
            )
            return
        if twice and len(self.stops) > 1:
            self.end()
            return
        if len(self.stops) > 2 and self._is_near(view, at, self.stops[0]):
            self._end(closes=True)
            return
        stop = self._stop_at(view, at)
        if stop is None:
            self.said.emit("That is beside the bone: click on it.")
            return
        if any(self._is_near(view, at, x) or _is_same(x, stop) for x in self.stops[-1:]):
            if not twice:
                self.said.emit("The curve is there already: click the next place.")
            return
        if any(_is_same(other, stop) for other in self.stops):
            self.said.emit(f"The curve goes through {stop.landmark or 'that place'} already.")
            return
        self.stops = (*self.stops, stop)
        self._ending = None
        self._ask()
        self.changed.emit()

    def hover(self, view: Canvas, at: QPointF | None) -> None:
        """Show the way to the mouse."""
        stop = self._stop_at(view, at) if at is not None and view.side is Side.SOURCE else None
        cursor = stop.source if stop is not None else None
        if at is not None and len(self.stops) > 2 and self._is_near(view, at, self.stops[0]):
            cursor = self.stops[0].source
        if cursor != self._cursor:
            self._cursor = cursor
            if self.stops:
                self._ask()
                self.changed.emit()

    def end(self) -> None:
        """Leave the curve open and be done."""
        self._end(closes=False)

    def take_back(self) -> None:
        """Take back the last click."""
        if self.stops:
            self.stops, self._ending = self.stops[:-1], None
            self._ask()
            self.changed.emit()

    def _end(self, *, closes: bool) -> None:
        if len(self.stops) < 2:
            self.said.emit(
                "A curve goes through at least two places: click another one, or leave by "
                f"{named(Qt.Key.Key_Escape)}."
            )
            return
        self._ending = closes
        self._ask()

    def _stop_at(self, view: Canvas, at: QPointF) -> Handle | None:
        """Return what a click would add: a landmark that is near, else a place on the bone."""
        marker = view.layer.nearest(at, REACH)
        landmark = self._editor.session.landmark(marker.name) if marker is not None else None
        if landmark is not None and landmark.source is not None:
            return Handle(landmark.source, landmark.destination, landmark.name)
        position = view.pick(at, OUTLINE_REACH)
        return None if position is None else Handle(as_position(position))

    def _is_near(self, view: Canvas, at: QPointF, stop: Handle) -> bool:
        ((x, y),) = view.project(np.array([stop.source]))
        # The first place is aimed at; two others may be close together.
        reach = REACH if stop is self.stops[0] else REACH / 2
        return math.hypot(x - at.x(), y - at.y()) <= reach

    # The ways

    def _ask(self) -> None:
        if self._mesh is not None:
            stops = tuple(stop.source for stop in self.stops)
            cursor = self._cursor if self._ending is None else None
            self._worker.request(_Ask(self._mesh, stops, bool(self._ending), cursor))

    def _find(self, ask: _Ask) -> _Found:
        """Find the ways; runs in the worker."""
        finder = self._finders.of(Side.SOURCE, ask.mesh)
        ways = []
        for number, (a, b) in enumerate(_steps(ask), 1):
            try:
                ways.append(finder.through([a, b]).places)
            except PinwarpError as error:
                return _Found(ask, tuple(ways), None, number, str(error))
        to_cursor = None
        if ask.stops and ask.cursor is not None and ask.cursor != ask.stops[-1]:
            try:
                to_cursor = finder.through([ask.stops[-1], ask.cursor]).places
            except PinwarpError:
                to_cursor = None
        return _Found(ask, tuple(ways), to_cursor)

    def _on_found(self, found: _Found) -> None:
        if not self.is_active or found.ask.mesh is not self._mesh:
            return
        places = tuple(stop.source for stop in self.stops)
        if found.unreached is not None:
            if found.ask.stops == places:
                # The click is not taken.
                kept = [x for row, x in enumerate(self.stops) if row != found.unreached]
                self.stops, self._ending = tuple(kept), None
                self.said.emit(found.problem)
                self._ask()
                self.changed.emit()
            return
        self._found = found
        is_whole = found.ask.stops == places and found.ask.closes == bool(self._ending)
        if self._ending is not None and is_whole:
            self._commit(found.ask.mesh, self._ending)
        else:
            self.changed.emit()

    def _commit(self, mesh: Mesh, closes: bool) -> None:
        self._ending = None
        try:
            # The ways are known by now: this takes no time.
            finder = self._finders.of(Side.SOURCE, mesh)
            session, name = edits.add_curve(
                self._editor.committed, self.stops, finder, is_closed=closes
            )
        except PinwarpError as error:
            self.said.emit(str(error))
            return
        self.stop()
        self._editor.commit(session, f"Draw {name}")
        self._editor.look(group=name)

    def _on_session(self, session: Session) -> None:
        if not self.is_active:
            return
        if session.mesh(Side.SOURCE) is not self._mesh:
            self.stop()
            self.said.emit("The source is another: the curve that was being drawn is gone.")
            return
        stops = tuple(_anchored(stop, session) for stop in self.stops)
        if stops != self.stops:
            self.stops = stops
            self._ask()
            self.changed.emit()

    def _on_failure(self, error: Exception) -> None:
        self.stop()
        raise error


def _steps(ask: _Ask) -> list[tuple[Position, Position]]:
    stops = (*ask.stops, *ask.stops[:1]) if ask.closes else ask.stops
    return list(itertools.pairwise(stops))


def _is_same(a: Handle, b: Handle) -> bool:
    return a.source == b.source or bool(a.landmark and a.landmark == b.landmark)


def _anchored(stop: Handle, session: Session) -> Handle:
    """Return a place where its landmark is now; one whose landmark is gone stays."""
    landmark = session.landmark(stop.landmark) if stop.landmark else None
    if landmark is None or landmark.source is None:
        return replace(stop, landmark="") if stop.landmark else stop
    return Handle(landmark.source, landmark.destination, landmark.name)
