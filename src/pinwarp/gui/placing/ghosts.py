"""The ghosts: where landmarks that lack a side are expected."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.scene.drawables import Counterpart, Drawable, OtherGhosts
from pinwarp.gui.warp.warps import Warps
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.warp.ghost import Ghost, ghost_of


class Ghosts(Capability):
    """Knows which landmark a click fills, and where it is expected.

    The warp of the pairs expects the next landmark of each side. While somebody else expects all
    those that the destination lacks, theirs are shown instead: the next is the one that is
    selected, else the first of them.

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
        self._expected: Callable[[], Sequence[Ghost]] = tuple

    @property
    def renewed(self) -> Any:
        """The signal that there may be others."""
        return self._warps.result_changed

    def follow(self, expected: Callable[[], Sequence[Ghost]]) -> None:
        """Let somebody else expect landmarks on the destination, in the order of their turn."""
        self._expected = expected

    def target(self, side: Side) -> str | None:
        """Return the landmark that a click on a side fills; None for a new one."""
        editor = self._editor
        if editor.view.guided:
            return editor.view.guided
        if side is Side.DESTINATION and (names := [ghost.name for ghost in self._expected()]):
            selected = [name for name in editor.selection.names if name in names]
            return (selected or names)[0]
        return edits.next_to_place(editor.session, side)

    def at(self, side: Side) -> Ghost | None:
        """Return where the next landmark of a side should be, on that side's surface."""
        name = self.target(side)
        if side is Side.DESTINATION and (expected := self._expected()):
            return next((ghost for ghost in expected if ghost.name == name), None)
        editor, result = self._editor, self._warps.result
        mesh = editor.session.mesh(side)
        if mesh is None or result is None or editor.is_previewing:
            return None
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

    def next(self, worked_on: Side) -> Ghost | None:
        """Return the ghost that is accepted next.

        Parameters
        ----------
        worked_on
            The side where something was done last: the other one's turn comes first.
        """
        if self._expected():
            return self.at(Side.DESTINATION)
        return self.at(worked_on.other) or self.at(worked_on)

    def drawables(self, side: Side) -> Iterator[Drawable]:
        """Return the ghosts of a side, and of which landmark that of the other side is."""
        ghost = self.at(side)
        if ghost is not None:
            yield ghost
        if side is Side.DESTINATION:
            others = tuple(other for other in self._expected() if other != ghost)
            if others:
                yield OtherGhosts(others, self._editor.view.hovered)
        elif (landmark := self._expected_next()) is not None and landmark.source is not None:
            yield Counterpart(landmark.name, landmark.source)

    def _expected_next(self) -> Landmark | None:
        ghost = self.at(Side.DESTINATION) if self._expected() else None
        return None if ghost is None else self._editor.session.landmark(ghost.name)
