"""Lines as drawn in a viewport."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import ArrayLike, NDArray

from pinwarp.gui.drawn.depth import WHOLE_DEPTH, Depth, squeeze


class DrawnLines:
    """One actor of lines whose places can be rewritten in place.

    Parameters
    ----------
    plotter
        Where it is drawn.
    name
        The actor's name in the plotter.
    look
        Colour, width and opacity, as ``add_mesh`` takes them.
    """

    def __init__(self, plotter: Any, name: str, **look: Any) -> None:
        self._plotter = plotter
        self._name = name
        self._look = look
        self._shape: tuple[int, ...] | None = None
        self._polydata: pv.PolyData | None = None
        self._actor: pv.Actor | None = None
        self._depth = WHOLE_DEPTH

    @property
    def lines(self) -> NDArray[np.float32] | None:
        """A copy of the (lines, samples, 3) places as drawn, None where there are none."""
        if self._polydata is None or self._shape is None:
            return None
        return np.array(self._polydata.points).reshape(self._shape)

    def remove(self) -> None:
        """Take the lines out of the picture."""
        self._plotter.remove_actor(self._name, render=False)
        self._polydata = self._shape = self._actor = None

    def write(self, lines: ArrayLike) -> None:
        """Draw (lines, samples, 3) places; in place where as many were drawn before."""
        # A copy, since VTK takes the array as it is and it is written into later.
        places = np.array(lines, dtype=np.float32)
        if self._polydata is None or self._shape != places.shape:
            self._show(places)
        else:
            self._polydata.points[:] = places.reshape(-1, 3)
            self._polydata.GetPoints().Modified()
            self._polydata.Modified()

    def set_depth(self, depth: Depth) -> None:
        """Draw them in a share of the picture's depth, before or behind other things."""
        if self._actor is not None and depth != self._depth:
            self._depth = depth
            squeeze(self._actor, depth)

    def _show(self, places: NDArray[np.float32]) -> None:
        count, samples, _ = self._shape = places.shape
        rows = np.arange(count * samples).reshape(count, samples)
        cells = np.insert(rows, 0, samples, axis=1)
        self._polydata = pv.PolyData(places.reshape(-1, 3), lines=cells.ravel())
        self._depth = WHOLE_DEPTH
        self._actor = self._plotter.add_mesh(
            self._polydata,
            name=self._name,
            copy_mesh=False,
            lighting=False,
            reset_camera=False,
            render=False,
            pickable=False,
            **self._look,
        )
