"""Where the warp turns the surface inside out, drawn so that it cannot be overlooked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.vtkCommonDataModel import vtkPlane

from pinwarp.core.folds import Folds
from pinwarp.gui.drawn.depth import Depth
from pinwarp.gui.drawn.mesh import DrawnMesh
from pinwarp.gui.drawn.surface import triangles
from pinwarp.gui.style import theme

# In the picture's depth: a little before the surface that they are a part of, and before all
# bones, where they shine through.
RAISED = 0.9999
BEFORE_ALL = (0.0, 0.001)
_SHINE_THROUGH = 0.5


@dataclass(frozen=True, eq=False)
class FoldedSurface:
    """The triangles of the warped source that touch a fold, and the edges around them."""

    triangles: pv.PolyData
    rim: pv.PolyData

    @classmethod
    def of(cls, folds: Folds, faces: NDArray, vertices: NDArray) -> FoldedSurface | None:
        """Return what is folded of a warped mesh; None where nothing is."""
        folded = faces[folds.is_folded[faces].any(axis=1)]
        if not len(folded):
            return None
        rows, corners = np.unique(folded, return_inverse=True)
        drawn = triangles(vertices[rows], corners.reshape(-1, 3))
        rim = drawn.extract_feature_edges(
            boundary_edges=True,
            feature_edges=False,
            manifold_edges=False,
            non_manifold_edges=False,
        )
        return cls(drawn, rim)


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
            self._seen.show(folded.triangles)
            self._hidden.show(folded.triangles)
            self._rim.show(folded.rim)
        self._hidden.set_depth(BEFORE_ALL)
        self._rim.set_depth(BEFORE_ALL)

    def set_depth(self, depth: Depth) -> None:
        """Draw them a little before a surface that takes this share of the picture's depth."""
        self._seen.set_depth((depth[0], depth[1] * RAISED))

    @property
    def is_shown(self) -> bool:
        """Whether there are any."""
        return self._seen.actor is not None

    def set_visible(self, visible: bool) -> None:
        """Draw them, or not."""
        for drawn in self._all:
            drawn.set_visible(visible)

    def set_clip(self, plane: vtkPlane | None) -> None:
        """Draw only what lies on the positive side of a plane, or everything."""
        for drawn in self._all:
            drawn.set_clip(plane)
