"""A mesh as drawn in a viewport: in full while it rests, by a stand-in while things move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from pinwarp.core.mesh import Mesh
from pinwarp.gui.surface import triangles


@dataclass(frozen=True, eq=False)
class OverlayWarp:
    """The warped source as drawn: triangles, vertices, normals, and whether its inside is out."""

    mesh: Mesh
    vertices: NDArray[np.float32]
    normals: NDArray[np.float32]
    inside_out: bool


class DrawnMesh:
    """One actor whose vertices can be rewritten in place.

    Re-adding a mesh costs a frame or more; writing its points and normals costs next to nothing.

    Parameters
    ----------
    plotter
        Where it is drawn.
    name
        The actor's name in the plotter.
    look
        Colour, opacity and light, as ``add_mesh`` takes them.
    """

    def __init__(self, plotter: Any, name: str, **look: Any) -> None:
        self._plotter = plotter
        self._name = name
        self._look = look
        self._faces: NDArray | None = None
        self.polydata: pv.PolyData | None = None
        self.actor: pv.Actor | None = None

    def remove(self) -> None:
        """Take the mesh out of the picture."""
        self._plotter.remove_actor(self._name, render=False)
        self._faces = self.polydata = self.actor = None

    def show(self, polydata: pv.PolyData, **look: Any) -> None:
        """Draw a mesh that has its normals already."""
        self.polydata = polydata
        self.actor = self._plotter.add_mesh(
            polydata,
            name=self._name,
            copy_mesh=False,
            interpolation="phong",
            reset_camera=False,
            render=False,
            pickable=False,
            **(self._look | look),
        )

    def write(
        self, mesh: Mesh, vertices: NDArray[np.float32], normals: NDArray[np.float32], **look: Any
    ) -> None:
        """Draw a mesh's triangles over other vertices; in place where they are the same."""
        if self.polydata is None or self._faces is not mesh.faces:
            polydata = triangles(vertices, mesh.faces)
            polydata.point_data["Normals"] = normals
            polydata.point_data.active_normals_name = "Normals"
            self.show(polydata, **look)
            self._faces = mesh.faces
            return
        self.polydata.points[:] = vertices
        self.polydata.point_data["Normals"][:] = normals
        self.polydata.GetPoints().Modified()
        self.polydata.GetPointData().GetNormals().Modified()
        self.polydata.Modified()

    def set_visible(self, visible: bool) -> None:
        """Draw it, or not."""
        if self.actor is not None:
            self.actor.SetVisibility(visible)
