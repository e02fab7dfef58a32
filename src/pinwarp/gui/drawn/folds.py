"""Where the warp turns the surface inside out, drawn so that it cannot be overlooked."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyvista as pv
from vtkmodules.vtkCommonDataModel import vtkPlane

from pinwarp.gui.drawn.depth import Depth
from pinwarp.gui.drawn.mesh import DrawnMesh
from pinwarp.gui.drawn.surface import triangles
from pinwarp.gui.scene.drawables import FoldedSurface
from pinwarp.gui.style import theme

# In the picture's depth: a little before the surface that they are a part of, and before all
# bones, where they shine through.
RAISED = 0.9999
BEFORE_ALL = (0.0, 0.001)
_SHINE_THROUGH = 0.5


class DrawnFolds:
    """The folded triangles: in full where they are seen, faintly where bone hides them.

    Parameters
    ----------
    plotter
        Where they are drawn.
    """

    def __init__(self, plotter: Any) -> None:
        # Their normals point anywhere: they are lit from everywhere alike.
        look = {"color": theme.FOLD_COLOUR, "ambient": 0.75, "diffuse": 0.3, "specular": 0.0}
        rim = {"color": theme.OUTLINE, "line_width": 2, "lighting": False}
        self._seen = DrawnMesh(plotter, "folds", **look)
        self._hidden = DrawnMesh(plotter, "hidden folds", **look, opacity=_SHINE_THROUGH)
        self._rim = DrawnMesh(plotter, "rim of the folds", **rim)
        self._all = (self._seen, self._hidden, self._rim)

    def show(self, folded: FoldedSurface | None) -> None:
        """Draw these, or none."""
        for drawn in self._all:
            if folded is None and drawn.actor is not None:
                drawn.remove()
        if folded is not None:
            drawn = triangles(folded.vertices, folded.faces)
            self._seen.show(drawn)
            self._hidden.show(drawn)
            self._rim.show(_edges(folded))
        self._hidden.set_depth(BEFORE_ALL)
        self._rim.set_depth(BEFORE_ALL)

    def set_depth(self, depth: Depth) -> None:
        """Draw them a little before a surface that takes this share of the picture's depth."""
        self._seen.set_depth((depth[0], depth[1] * RAISED))

    def set_visible(self, visible: bool) -> None:
        """Draw them, or not."""
        for drawn in self._all:
            drawn.set_visible(visible)

    def set_clip(self, plane: vtkPlane | None) -> None:
        """Draw only what lies on the positive side of a plane, or everything."""
        for drawn in self._all:
            drawn.set_clip(plane)


def _edges(folded: FoldedSurface) -> pv.PolyData:
    """Return VTK's picture of the rim."""
    if not len(folded.rim):
        return pv.PolyData()
    cells = np.insert(folded.rim, 0, 2, axis=1)
    return pv.PolyData(folded.vertices, lines=cells.ravel())
