"""The grid: straight on the source, and bent by the warp as it is shown on the destination."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QObject
from qtpy.QtGui import QAction, QActionGroup

from pinwarp.core.landmarks import Side
from pinwarp.core.lattice import box_lattice, plane_lattice
from pinwarp.core.live import PreviewPoints, preview
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import Spline
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.views.canvas import Canvas
from pinwarp.gui.warp.warps import Presenter
from pinwarp.session.editor import Editor
from pinwarp.session.view import GridKind

GRID_ACTIONS = {kind: f"grid_{kind.name.lower()}" for kind in GridKind}


@dataclass(frozen=True, eq=False)
class _Grid:
    """The lines on the source, and the same places made ready for the warp."""

    lines: NDArray[np.float64]
    points: PreviewPoints


@dataclass(frozen=True)
class _Request:
    grid: _Grid
    spline: Spline


class GridPresenter(QObject):
    """Draws the grid that the view state asks for; warps it off the UI thread.

    Parameters
    ----------
    editor
        Its view state is what the actions change.
    presenter
        Where the warps come from.
    views
        One per side.
    actions
        The window's actions by key.
    parent
        The window.
    """

    def __init__(
        self,
        editor: Editor,
        presenter: Presenter,
        views: Mapping[Side, Canvas],
        actions: Mapping[str, QAction],
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._editor = editor
        self._presenter = presenter
        self._views = views
        self._actions = actions
        self._drawn_for: tuple[Mesh, GridKind, float] | None = None
        self._bounds: tuple[Mesh, NDArray[np.float64]] | None = None
        self._grid: _Grid | None = None
        self._asked: _Request | None = None
        self._warps = LatestWins(_warped)
        self._warps.computed.connect(self._on_warped)
        self._warps.failed.connect(self._on_failure)
        kinds = QActionGroup(self)
        for kind, key in GRID_ACTIONS.items():
            kinds.addAction(actions[key])
            actions[key].triggered.connect(lambda _checked=False, kind=kind: editor.look(grid=kind))
        actions["grid_next"].triggered.connect(lambda _checked=False: self._next())
        editor.session_changed.connect(self._on_change)
        editor.view_changed.connect(self._on_change)
        presenter.result_changed.connect(self._on_result)
        self._on_change()

    @property
    def is_settled(self) -> bool:
        """Whether the grid is drawn as it was asked for."""
        return self._warps.is_idle

    def shut_down(self) -> None:
        """Stop the worker and let go of the editor."""
        self._presenter.result_changed.disconnect(self._on_result)
        self._editor.session_changed.disconnect(self._on_change)
        self._editor.view_changed.disconnect(self._on_change)
        self._warps.shut_down()

    def _next(self) -> None:
        kinds = list(GridKind)
        following = kinds[(kinds.index(self._editor.view.grid) + 1) % len(kinds)]
        self._editor.look(grid=following)

    def _on_change(self, _changed: object = None) -> None:
        view = self._editor.view
        self._actions[GRID_ACTIONS[view.grid]].setChecked(True)
        mesh = self._editor.session.mesh(Side.SOURCE)
        wanted = None
        if mesh is not None and view.grid is not GridKind.NONE:
            wanted = (mesh, view.grid, view.grid_share)
        if wanted == self._drawn_for:
            return
        self._drawn_for = wanted
        self._grid = self._grid_of(*wanted) if wanted is not None else None
        self._views[Side.SOURCE].show_grid(self._grid.lines if self._grid is not None else None)
        self._ask()

    def _grid_of(self, mesh: Mesh, kind: GridKind, share: float) -> _Grid:
        if self._bounds is None or self._bounds[0] is not mesh:
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
        grid, result = self._grid, self._presenter.result
        mesh = self._drawn_for[0] if self._drawn_for is not None else None
        if grid is None or result is None or result.shown is None or result.inputs.mesh is not mesh:
            if self._asked is not None:
                self._views[Side.DESTINATION].show_grid(None)
            self._asked = None
            return
        request = _Request(grid, result.shown)
        if request != self._asked:
            self._asked = request
            self._warps.request(request)

    def _on_warped(self, warped: tuple[_Request, NDArray[np.float32]]) -> None:
        request, lines = warped
        # One that is late still shows the way while something moves, unless the grid is another.
        if self._asked is not None and request.grid is self._grid:
            self._views[Side.DESTINATION].show_grid(lines)

    def _on_failure(self, error: Exception) -> None:
        raise error


def _warped(request: _Request) -> tuple[_Request, NDArray[np.float32]]:
    """Warp the places of a grid; runs in the worker."""
    places = preview(request.spline, request.grid.points)
    return request, places.reshape(request.grid.lines.shape)
