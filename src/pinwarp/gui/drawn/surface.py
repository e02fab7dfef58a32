"""A mesh made ready for the screen: VTK data, shading normals, and a locator for picking."""

from __future__ import annotations

import math
import weakref
from collections.abc import Sequence

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkBinnedDecimation, vtkTriangleMeshPointNormals

from pinwarp.core.mesh import Mesh

# Never 0: a ray through an exact edge would fall between two triangles.
TOLERANCE = 1e-9
# Meshes above this many triangles get a stand-in of about that many for while things move.
LARGE = 40_000
STAND_IN = 10_000


class Surface:
    """A mesh with all that drawing and picking need.

    Built in the job that loads the mesh, since the locator of a million triangles takes 0.1 s.

    Parameters
    ----------
    mesh
        The mesh; its arrays are copied in single precision for drawing.

    Attributes
    ----------
    stand_in
        A coarse copy of a large mesh, drawn while something moves; None for smaller ones.
    """

    def __init__(self, mesh: Mesh) -> None:
        # Not the mesh itself: who remembers a surface for as long as its mesh lives would keep both
        # for ever.
        self._mesh = weakref.ref(mesh)
        self.polydata = shaded(mesh.vertices, mesh.faces)
        self.diagonal = mesh.diagonal
        self.stand_in = _stand_in(self.polydata) if len(mesh.faces) > LARGE else None
        self.inside_out = _signed_volume(mesh) < 0
        self._locator = vtkStaticCellLocator()
        self._locator.SetDataSet(self.polydata)
        self._locator.BuildLocator()

    @property
    def mesh(self) -> Mesh | None:
        """The mesh, as long as somebody else holds it."""
        return self._mesh()

    def first_hit(self, start: NDArray, end: NDArray) -> NDArray | None:
        """Return where a ray first meets the surface, None where it misses."""
        where, local = [0.0] * 3, [0.0] * 3
        t, sub, cell = reference(0.0), reference(0), reference(0)
        hit = self._locator.IntersectWithLine(  # type: ignore[call-overload]  # stubs miss references
            start, end, TOLERANCE, t, where, local, sub, cell
        )
        return np.array(where) if hit else None

    def closest(self, point: Sequence[float] | NDArray) -> tuple[NDArray, float]:
        """Return the place on the surface nearest to a point, and how far off it is."""
        where = [0.0] * 3
        sub, cell, squared = reference(0), reference(0), reference(0.0)
        self._locator.FindClosestPoint(  # type: ignore[call-overload]  # stubs miss references
            tuple(point), where, cell, sub, squared
        )
        return np.array(where), math.dist(point, where)

    def hidden(self, eyes: NDArray, points: NDArray) -> NDArray[np.bool_]:
        """Return which points the surface hides from their eyes; points on it are seen.

        Parameters
        ----------
        eyes
            (n, 3) from where each is looked at, or (3,) for all.
        points
            (n, 3) positions.
        """
        towards = eyes - points
        distances = np.linalg.norm(towards, axis=1)
        clearance = 0.012 * self.diagonal
        shares = clearance / np.maximum(distances, clearance)
        ends = points + towards * shares[:, None]
        starts = np.broadcast_to(eyes, points.shape).tolist()
        where, local = [0.0] * 3, [0.0] * 3
        t, sub, cell = reference(0.0), reference(0), reference(0)
        meets = self._locator.IntersectWithLine
        # Made ready all at once: asked one by one, a thousand took a frame.
        met = [
            distance > clearance and bool(meets(start, end, TOLERANCE, t, where, local, sub, cell))  # type: ignore[call-overload]  # stubs miss references
            for start, end, distance in zip(starts, ends.tolist(), distances.tolist(), strict=True)
        ]
        return np.array(met, np.bool_)


def triangles(vertices: NDArray, faces: NDArray) -> pv.PolyData:
    """Return VTK's picture of a triangle mesh, in single precision."""
    cells = np.empty((len(faces), 4), dtype=np.int64)
    cells[:, 0] = 3
    cells[:, 1:] = faces
    return pv.PolyData(np.asarray(vertices, dtype=np.float32), cells.ravel())


def shading_normals(polydata: pv.PolyData) -> NDArray[np.float32]:
    """Return point normals, the mean of the triangles around."""
    # Ten times as fast as the usual filter, which also splits and reorients.
    if not polydata.n_points:
        return np.zeros((0, 3), np.float32)
    algorithm = vtkTriangleMeshPointNormals()
    algorithm.SetInputData(polydata)
    algorithm.Update()
    normals = pv.wrap(algorithm.GetOutput()).point_data["Normals"]
    return np.array(normals, dtype=np.float32)


def shaded(vertices: NDArray, faces: NDArray) -> pv.PolyData:
    """Return VTK's picture of a triangle mesh with its shading normals."""
    polydata = triangles(vertices, faces)
    polydata.point_data["Normals"] = shading_normals(polydata)
    polydata.point_data.active_normals_name = "Normals"
    return polydata


def _stand_in(polydata: pv.PolyData) -> Mesh | None:
    """Merge the vertices of a large mesh bin by bin; a million triangles take a quarter second."""
    size = np.maximum(np.array(polydata.bounds_size), 1e-12)
    # A surface crosses about two triangles' worth of each bin that it touches.
    bin_size = np.sqrt(2 * polydata.area / STAND_IN)
    divisions = np.clip(np.ceil(size / bin_size), 2, 1000).astype(int)
    algorithm = vtkBinnedDecimation()
    algorithm.SetInputData(polydata)
    algorithm.SetNumberOfDivisions(*divisions.tolist())
    algorithm.AutoAdjustNumberOfDivisionsOff()
    algorithm.SetPointGenerationModeToBinAverages()
    algorithm.Update()
    coarse = pv.wrap(algorithm.GetOutput())
    if not coarse.n_cells:
        return None
    return Mesh(coarse.points, coarse.regular_faces)


def _signed_volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, i]] - mesh.vertices[0] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)))
