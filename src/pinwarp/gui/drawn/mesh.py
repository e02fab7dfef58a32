"""A mesh as drawn in a viewport: in full while it rests, by a stand-in while things move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkCommonDataModel import vtkPlane

from pinwarp.core.mesh import Mesh
from pinwarp.gui.drawn.depth import WHOLE_DEPTH, Depth, squeeze
from pinwarp.gui.drawn.surface import triangles

# The array of point data that a map's levels stand in.
_LEVELS = "map"
# Colours are read off a map: little of the light may change them.
_READABLE = {"ambient": 0.45, "diffuse": 0.62, "specular": 0.0}


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
        self._clip: vtkPlane | None = None
        self._culling = "none"
        self._plain: dict[str, float] = {}
        self._depth = WHOLE_DEPTH
        self.is_coloured = False
        self.polydata: pv.PolyData | None = None
        self.actor: pv.Actor | None = None

    def remove(self) -> None:
        """Take the mesh out of the picture."""
        self._plotter.remove_actor(self._name, render=False)
        self._faces = self.polydata = self.actor = None
        self.is_coloured = False

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
        self._culling = look.get("culling", "none")
        self._plain = {key: getattr(self.actor.prop, key) for key in _READABLE}
        self.is_coloured = False
        self._depth = WHOLE_DEPTH
        self.set_clip(self._clip)

    def write(
        self, mesh: Mesh, vertices: NDArray[np.float32], normals: NDArray[np.float32], **look: Any
    ) -> None:
        """Draw a mesh's triangles over other vertices; in place where they are the same."""
        if self.polydata is None or self._faces is not mesh.faces:
            # Copies, since VTK takes arrays as they are and they are written into later: the
            # solver keeps its own.
            polydata = triangles(vertices.copy(), mesh.faces)
            polydata.point_data["Normals"] = normals.copy()
            polydata.point_data.active_normals_name = "Normals"
            self.show(polydata, **look)
            self._faces = mesh.faces
            return
        if look.get("culling", self._culling) != self._culling:
            self._culling = look["culling"]
            self.set_clip(self._clip)
        self.polydata.points[:] = vertices
        self.polydata.point_data["Normals"][:] = normals
        self.polydata.GetPoints().Modified()
        self.polydata.GetPointData().GetNormals().Modified()
        self.polydata.Modified()

    def colour(self, levels: NDArray[np.float32] | None, table: vtkLookupTable | None) -> None:
        """Colour the vertices by what a table says of their levels; plain without any."""
        if self.actor is None or self.polydata is None:
            return
        mapper = self.actor.mapper
        self.is_coloured = levels is not None
        for key, value in (_READABLE if self.is_coloured else self._plain).items():
            setattr(self.actor.prop, key, value)
        mapper.SetScalarVisibility(self.is_coloured)
        if levels is None:
            return
        data = self.polydata.point_data
        if _LEVELS in data:
            data[_LEVELS][:] = levels
            self.polydata.GetPointData().GetArray(_LEVELS).Modified()
        else:
            data.set_array(levels.copy(), _LEVELS)
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray(_LEVELS)
        mapper.SetLookupTable(table)
        mapper.SetUseLookupTableScalarRange(True)
        # The colour is looked up for each pixel: between vertices no colour comes out of nowhere.
        mapper.SetInterpolateScalarsBeforeMapping(True)

    def set_depth(self, depth: Depth) -> None:
        """Draw it in a share of the picture's depth, before or behind other things."""
        if self.actor is not None and depth != self._depth:
            self._depth = depth
            squeeze(self.actor, depth)

    def set_clip(self, plane: vtkPlane | None) -> None:
        """Draw only what lies on the positive side of a plane, or everything."""
        self._clip = plane
        if self.actor is None:
            return
        mapper = self.actor.mapper
        mapper.RemoveAllClippingPlanes()
        if plane is not None:
            mapper.AddClippingPlane(plane)
        # Where it is cut one looks at its inside, which must not be culled.
        self.actor.prop.culling = "none" if plane is not None else self._culling

    def set_wireframe(self, wireframe: bool) -> None:
        """Draw its edges, or its triangles."""
        style = "wireframe" if wireframe else "surface"
        self._look["style"] = style
        if self.actor is not None:
            self.actor.prop.style = style

    def set_visible(self, visible: bool) -> None:
        """Draw it, or not."""
        if self.actor is not None:
            self.actor.SetVisibility(visible)
