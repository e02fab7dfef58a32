"""Puts together what the viewports show, and shows it once per turn of the event loop."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from typing import Any, Protocol

from qtpy.QtCore import QObject, Qt, Signal

from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.drawables import Drawable
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.views.canvas import Canvas


class Contributor(Protocol):
    """Whoever has something to show; no two of them the same kind on one side."""

    def drawables(self, side: Side) -> Iterable[Drawable]:
        """Return what is to be seen on a side as things are now."""


class Scenes(QObject):
    """The scenes of all viewports.

    Contributors say that something is new, and are asked for it later: however many say so in one
    turn of the event loop, and however often, one scene is shown.

    Parameters
    ----------
    views
        One per side.
    parent
        The window.

    Attributes
    ----------
    shown : Signal
        Emitted once all viewports show what is new.
    shows : int
        How many scenes were shown, each another than the one before in its view.
    """

    shown = Signal()
    _due = Signal()

    def __init__(self, views: Mapping[Side, Canvas], parent: QObject) -> None:
        super().__init__(parent)
        self._views = views
        self._contributors: tuple[Contributor, ...] = ()
        self._parts: dict[tuple[Contributor, Side], tuple[Drawable, ...]] = {}
        self._is_due = False
        self.shows = 0
        # Posted, so that it comes behind all that has arrived already, and before the next paint.
        self._due.connect(self.show_now, Qt.ConnectionType.QueuedConnection)

    @property
    def is_settled(self) -> bool:
        """Whether what is shown is what contributors have to show."""
        return not self._is_due

    def show_from(self, *contributors: Contributor) -> None:
        """Show what these have to show from now on, and nothing else."""
        self._contributors = contributors
        self._parts.clear()
        self.renew()

    def renew(self, *_changed: Any) -> None:
        """Say that there is something new to be shown, soon."""
        if not self._is_due:
            self._is_due = True
            self._due.emit()

    def show_now(self) -> None:
        """Show what is new at once: for who looks at the picture in this very turn."""
        if not self._is_due:
            return
        self._is_due, before = False, self.shows
        for side, view in self._views.items():
            for contributor in self._contributors:
                self._ask(contributor, side)
            parts = (self._parts.get((one, side), ()) for one in self._contributors)
            scene = Scene(side, tuple(thing for part in parts for thing in part))
            if scene != view.scene:
                self.shows += 1
                view.show_scene(scene)
        if self.shows != before:
            self.shown.emit()

    def _ask(self, contributor: Contributor, side: Side) -> None:
        """Ask for a part; where that fails, the last one stays and the others are still shown."""
        try:
            self._parts[contributor, side] = tuple(contributor.drawables(side))
        except Exception as error:  # whatever it is, it is not the other contributors'
            sys.excepthook(type(error), error, error.__traceback__)

    def shut_down(self) -> None:
        """Show nothing any more: the views are about to close."""
        self._due.disconnect(self.show_now)
        self._contributors = ()
        self._parts.clear()
        self._is_due = False
