"""Placing by the keyboard alone: a crosshair that arrow keys move over the bones."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np
from qtpy.QtCore import QPointF, Qt

from pinwarp.core.landmarks import Position, Side
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.placing.ghosts import Ghosts
from pinwarp.gui.views.viewport import Viewport
from pinwarp.session.editor import Editor


class Crosshair(Capability):
    """Stands in one view at a time; what a click does, Enter does there.

    Parameters
    ----------
    editor
        Whose selected landmark it begins at.
    ghosts
        Where it begins else.
    views
        One per side.
    """

    def __init__(self, editor: Editor, ghosts: Ghosts, views: Mapping[Side, Viewport]) -> None:
        self._editor = editor
        self._ghosts = ghosts
        self._views = views
        self.actions = (
            Action(
                "crosshair",
                "Keyboard Cross&hair",
                switches=self.switch,
                checked=lambda: any(view.crosshair is not None for view in views.values()),
                at="Place.15",
                keys="H",
                deed="Switch Keyboard Crosshair On or Off",
                tip="Arrow keys move it over the bone, Enter clicks, Tab goes to the other bone",
            ),
        )
        for side, view in views.items():
            view.crosshair_left.connect(partial(self._on_left, side))

    def switch(self, on: bool) -> None:
        """Put it onto the bone that is worked on, or take it away."""
        for view in self._views.values():
            view.put_crosshair(None)
        if on:
            self._begin(self._editor.selection.side)

    def _begin(self, side: Side) -> None:
        view = self._views[side]
        place = self._expected(side)
        middle = QPointF(view.width() / 2, view.height() / 2)
        if place is not None:
            ((x, y),) = view.project(np.array([place]))
            if view.rect().contains(round(x), round(y)):
                middle = QPointF(x, y)
        view.put_crosshair(middle)
        view.setFocus(Qt.FocusReason.ShortcutFocusReason)

    def _expected(self, side: Side) -> Position | None:
        """Return where the hand is likely to go: to the next ghost, or what is selected."""
        ghost = self._ghosts.at(side)
        if ghost is not None:
            return ghost.position
        names = self._editor.selection.names
        landmark = self._editor.session.landmark(names[0]) if names else None
        return None if landmark is None else landmark.position(side)

    def _on_left(self, side: Side, for_other: bool) -> None:
        self._views[side].put_crosshair(None)
        if for_other:
            self._begin(side.other)
        for action in self.actions:
            action.renew()
