"""The grid: straight on the source, and bent by the warp as it is shown on the destination."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QObject

from pinwarp.core.errors import RangeError
from pinwarp.core.landmarks import Side
from pinwarp.core.lattice import box_lattice, plane_lattice
from pinwarp.core.live import PreviewPoints, preview
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import Spline
from pinwarp.gui.capability.action import Action, one_of
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.scene.drawables import Drawable, GridLines
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.views.scenes import Scenes
from pinwarp.gui.warp.warps import Warps
from pinwarp.session.editor import Editor
from pinwarp.session.view import GridKind

GRID_ACTIONS = {kind: f"grid_{kind.name.lower()}" for kind in GridKind}
_ACTIONS = {
    GridKind.NONE: ("&None", "No grid", 11),
    GridKind.BOX: ("&Box", "Straight on the source, bent by the warp", 12),
    GridKind.PLANE_X: ("Plane Across &X", "Of the source's axes", 21),
    GridKind.PLANE_Y: ("Plane Across &Y", "Of the source's axes", 22),
    GridKind.PLANE_Z: ("Plane Across &Z", "Of the source's axes", 23),
}


@dataclass(frozen=True, eq=False)
class _Grid:
    """The lines on the source, and the same places made ready for the warp."""

    lines: NDArray[np.float64]
    points: PreviewPoints


@dataclass(frozen=True)
class _Request:
    grid: _Grid
    spline: Spline


class GridPresenter(Capability):
    """Draws the grid that the view state asks for; warps it off the UI thread.

    Parameters
    ----------
    editor
        Its view state is what the actions change.
    warps
        Where the warps come from.
    scenes
        Where it is shown.
    parent
        The window.
    """

    def __init__(
        self,
        editor: Editor,
        warps: Warps,
        scenes: Scenes,
        parent: QObject,
    ) -> None:
        self._editor = editor
        self._warps = warps
        self._scenes = scenes
        self._drawn_for: tuple[Mesh, GridKind, float] | None = None
        self._bounds: tuple[Mesh, NDArray[np.float64]] | None = None
        self._grid: _Grid | None = None
        self._lines: dict[Side, GridLines | None] = dict.fromkeys(Side)
        self._asked: _Request | None = None
        self._worker = LatestWins(_warped)
        self._worker.computed.connect(self._on_warped)
        self._worker.failed.connect(self._on_failure)
        self.following = Action(
            "grid_next", "N&ext Grid", self._next, at="grid.31", keys="D", deed="Show Next Grid"
        )
        self.actions = (*one_of(map(self._action_of, GridKind), parent), self.following)
        editor.session_changed.connect(self._on_change)
        editor.view_changed.connect(self._on_change)
        warps.result_changed.connect(self._on_result)
        self._on_change()

    @property
    def is_settled(self) -> bool:
        """Whether the grid is drawn as it was asked for."""
        return self._worker.is_idle

    def shut_down(self) -> None:
        """Stop the worker and let go of the editor."""
        self._warps.result_changed.disconnect(self._on_result)
        self._editor.session_changed.disconnect(self._on_change)
        self._editor.view_changed.disconnect(self._on_change)
        self._worker.shut_down()

    def _action_of(self, kind: GridKind) -> Action:
        text, tip, place = _ACTIONS[kind]
        return Action(
            GRID_ACTIONS[kind],
            text,
            lambda: self._editor.look(grid=kind),
            checked=lambda: self._editor.view.grid is kind,
            at=f"grid.{place}",
            tip=tip,
        )

    def _next(self) -> None:
        kinds = list(GridKind)
        following = kinds[(kinds.index(self._editor.view.grid) + 1) % len(kinds)]
        self._editor.look(grid=following)

    def _on_change(self, _changed: object = None) -> None:
        view = self._editor.view
        mesh = self._editor.session.mesh(Side.SOURCE)
        wanted = None
        if self._bounds is not None and self._bounds[0] is not mesh:
            # Else it would be kept for as long as no grid is asked for.
            self._bounds = None
        if mesh is not None and view.grid is not GridKind.NONE:
            wanted = (mesh, view.grid, view.grid_share)
        if wanted == self._drawn_for:
            return
        self._drawn_for = wanted
        self._grid = self._grid_of(*wanted) if wanted is not None else None
        self._show(Side.SOURCE, self._grid.lines if self._grid is not None else None)
        self._ask()

    def _grid_of(self, mesh: Mesh, kind: GridKind, share: float) -> _Grid:
        if self._bounds is None:
            self._bounds = (mesh, mesh.bounds)
        low, high = self._bounds[1]
        if kind.axis is None:
            lines = box_lattice(low, high)
        else:
            lines = plane_lattice(low, high, kind.axis, share)
        return _Grid(lines, PreviewPoints.of(lines.reshape(-1, 3)))

    def _on_result(self, _result: object, _at_rest: bool) -> None:
        self._ask()

    def _ask(self) -> None:
        """Ask for the warped grid, where it is another."""
        grid, result = self._grid, self._warps.result
        mesh = self._drawn_for[0] if self._drawn_for is not None else None
        if grid is None or result is None or result.shown is None or result.inputs.mesh is not mesh:
            if self._asked is not None:
                self._show(Side.DESTINATION, None)
            self._asked = None
            return
        request = _Request(grid, result.shown)
        if request != self._asked:
            self._asked = request
            self._worker.request(request)

    def _on_warped(self, warped: tuple[_Request, NDArray[np.float32] | None]) -> None:
        request, lines = warped
        # One that is late still shows the way while something moves, unless the grid is another.
        if self._asked is not None and request.grid is self._grid:
            self._show(Side.DESTINATION, lines)

    def _show(self, side: Side, lines: NDArray | None) -> None:
        self._lines[side] = GridLines(lines) if lines is not None else None
        self._scenes.renew()

    def drawables(self, side: Side) -> Iterator[Drawable]:
        """Return the grid of a side."""
        lines = self._lines[side]
        if lines is not None:
            yield lines

    def _on_failure(self, error: Exception) -> None:
        raise error


def _warped(request: _Request) -> tuple[_Request, NDArray[np.float32] | None]:
    """Warp the places of a grid, None where that cannot be drawn; runs in the worker."""
    try:
        places = preview(request.spline, request.grid.points)
    except RangeError:
        return request, None
    return request, places.reshape(request.grid.lines.shape)
