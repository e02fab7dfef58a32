"""The ghosts: where the next landmark of each side is expected."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from pinwarp.core.landmarks import Side, as_position
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.scene.drawables import Drawable
from pinwarp.gui.warp.warps import Warps
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.warp.ghost import Ghost, ghost_of


class Ghosts(Capability):
    """Knows which landmark a click fills, and where the warp expects it.

    Parameters
    ----------
    editor
        The truth.
    warps
        What predicts.
    surfaces
        What ghosts lie on.
    """

    def __init__(self, editor: Editor, warps: Warps, surfaces: Surfaces) -> None:
        self._editor = editor
        self._warps = warps
        self._surfaces = surfaces
        self._known: dict[Side, Ghost | None] = {}
        self._known_for: dict[Side, object] = {}

    def target(self, side: Side) -> str | None:
        """Return the landmark that a click on a side fills; None for a new one."""
        return self._editor.view.guided or edits.next_to_place(self._editor.session, side)

    def at(self, side: Side) -> Ghost | None:
        """Predict where the next landmark of a side should be, on that side's surface."""
        editor, result = self._editor, self._warps.result
        mesh = editor.session.mesh(side)
        if mesh is None or result is None or editor.is_previewing:
            return None
        name = self.target(side)
        landmark = editor.session.landmark(name) if name else None
        key = (side, landmark, result)
        if self._known_for.get(side) != key:
            self._known_for[side] = key
            ghost = ghost_of(landmark, side, result)
            if ghost is not None:
                place, _ = self._surfaces.of(mesh).closest(ghost.position)
                ghost = replace(ghost, position=as_position(place))
            self._known[side] = ghost
        return self._known[side]

    def drawables(self, side: Side) -> Iterator[Drawable]:
        """Return the ghost of a side."""
        ghost = self.at(side)
        if ghost is not None:
            yield ghost
