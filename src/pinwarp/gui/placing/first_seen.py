"""Nothing is accepted unseen: the view turns first, and only the next key accepts."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from pinwarp.core.landmarks import Position, Side
from pinwarp.gui.views.canvas import Canvas
from pinwarp.gui.views.controls import ViewControls


class FirstSeen:
    """Shows a place before it is accepted.

    Parameters
    ----------
    views
        Turn.
    canvases
        Where one looks.
    turned
        Called with the landmark for which a view has turned.
    """

    def __init__(
        self, views: ViewControls, canvases: Mapping[Side, Canvas], turned: Callable[[str], None]
    ) -> None:
        self._views, self._canvases, self._turned = views, canvases, turned
        # Of how it is looked at only the hash: the key itself would hold the surface for ever.
        self._shown: tuple[str, Side, int] | None = None

    def is_seen(self, name: str, side: Side, position: Position) -> bool:
        """Whether a landmark's place is seen, or was just shown as well as can be; else show it."""
        if not self.is_out_of_sight(name, side, position):
            return True
        self._views.show_place(side, position)
        self._shown = (name, side, hash(self._canvases[side].view_key()))
        self._turned(name)
        return False

    def is_out_of_sight(self, name: str, side: Side, position: Position) -> bool:
        """Whether a view turns to a landmark's place before it is accepted."""
        canvas = self._canvases[side]
        # Where the bone hides it from everywhere one need not ask for ever.
        is_shown = self._shown == (name, side, hash(canvas.view_key()))
        return not is_shown and not canvas.sees(position)
