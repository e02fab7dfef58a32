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
        canvas = self._canvases[side]
        if self._shown == (name, side, hash(canvas.view_key())):
            # Where the bone hides it from everywhere one need not ask for ever.
            return True
        if not self._views.show_place(side, position):
            return True
        self._shown = (name, side, hash(canvas.view_key()))
        self._turned(name)
        return False
