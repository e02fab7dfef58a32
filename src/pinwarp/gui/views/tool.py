"""What takes the clicks of viewports while it is chosen, before the hand does."""

from __future__ import annotations

from typing import Protocol

from qtpy.QtCore import QPointF

from pinwarp.gui.views.canvas import Canvas


class Tool(Protocol):
    """A tool: clicks and hovering are its own, drags still orbit."""

    def click(self, view: Canvas, at: QPointF, twice: bool) -> None:
        """Take a click, and whether it is the second of a double one."""

    def hover(self, view: Canvas, at: QPointF | None) -> None:
        """Notice where the mouse is over a view; None where it has left."""
