"""Where the warp turns the surface inside out, drawn so that it cannot be overlooked."""

from __future__ import annotations

from typing import Any

import pyvista as pv
from vtkmodules.vtkCommonDataModel import vtkPlane

from pinwarp.gui import theme
from pinwarp.gui.drawn_mesh import DrawnMesh

# How far in the picture's depth it is drawn in front of the surface that it is a part of, and in
# front of all bones, where it shows through them.
RAISED = -40.0
BEFORE_ALL = -60_000.0
_SHINE_THROUGH = 0.3


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
        edges = {"show_edges": True, "edge_color": theme.OUTLINE, "line_width": 1}
        self._seen = DrawnMesh(plotter, "folds", **look, **edges)
        self._hidden = DrawnMesh(plotter, "hidden folds", **look, opacity=_SHINE_THROUGH)

    def show(self, folded: pv.PolyData | None) -> None:
        """Draw these triangles, or none."""
        for drawn, offset in ((self._seen, RAISED), (self._hidden, BEFORE_ALL)):
            if folded is None or not folded.n_cells:
                if drawn.actor is not None:
                    drawn.remove()
                continue
            drawn.show(folded)
            drawn.set_depth(offset)

    @property
    def is_shown(self) -> bool:
        """Whether there are any."""
        return self._seen.actor is not None

    def set_visible(self, visible: bool) -> None:
        """Draw them, or not."""
        self._seen.set_visible(visible)
        self._hidden.set_visible(visible)

    def set_clip(self, plane: vtkPlane | None) -> None:
        """Draw only what lies on the positive side of a plane, or everything."""
        self._seen.set_clip(plane)
        self._hidden.set_clip(plane)
