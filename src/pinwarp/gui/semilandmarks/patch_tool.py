"""The tool that asks which side of a closed curve a patch fills."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from qtpy.QtCore import QPointF, Qt
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Position, Side, as_position
from pinwarp.gui.semilandmarks.view_tool import ENDING, ViewTool, named
from pinwarp.gui.views.canvas import OUTLINE_REACH, Canvas
from pinwarp.gui.views.viewport import Viewport


class PatchTool(ViewTool):
    """Asks for a place on one side of a closed curve, or takes the whole surface.

    Parameters
    ----------
    viewports, window
        As every tool needs them.
    fill
        Called with the place; with None for the whole surface.
    """

    def __init__(
        self,
        viewports: Mapping[Side, Viewport],
        window: QWidget,
        fill: Callable[[Position | None], None],
    ) -> None:
        super().__init__(viewports, window)
        self._fill = fill

    @property
    def words(self) -> str:
        """What it asks for now, in few words."""
        return f"Click inside a closed curve\n{named(ENDING[0])} covers the whole surface"

    @property
    def hint(self) -> str:
        """What can be done now."""
        end, leave = map(named, (ENDING[0], Qt.Key.Key_Escape))
        return (
            "Click inside a closed curve, or on the side of it that you mean. "
            f"{end} covers the whole surface, {leave} leaves."
        )

    def click(self, view: Canvas, at: QPointF, twice: bool) -> None:
        """Take the place that was clicked."""
        if twice:
            return
        position = view.pick(at, OUTLINE_REACH) if view.side is Side.SOURCE else None
        if position is None:
            self.said.emit("A patch is laid over the source: click on it there.")
        else:
            self._fill(as_position(position))

    def end(self) -> None:
        """Take the whole surface."""
        self._fill(None)
