"""What judges a warp: leave-one-out errors, derivatives, uncertainty and distances."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pyvista as pv
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkDoubleArray
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance

from pinwarp.core import surface_distance
from pinwarp.core.factor import factorise
from pinwarp.core.folds import folds_of
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.mesh import Mesh
from pinwarp.core.prediction import prediction_of
from pinwarp.core.quality import leave_one_out, penalty_curve
from pinwarp.core.spline import solve
from pinwarp.core.surface_comparison import compare_surfaces
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.core.suspects import suspects
from tests.benchmarks.shapes import landmark_pairs, surface_points, true_warp
from tests.benchmarks.timing import in_turn
from tests.core.mistaken import made_up

Row = dict[str, Any]
# Of the real femur that the aims were set for.
SURFACE_VERTICES = 89_666


def judging() -> Iterator[Row]:
    """Figures of the pairs, then maps over the surface."""
    for count in (50, 200, 1000):
        source, destination = landmark_pairs(count)
        factor = factorise(source)
        _ = factor.modes_at_landmarks
        ways = {"pinwarp": lambda f=factor, d=destination: leave_one_out(f, d, 1.0)}
        if count <= 200:
            ways["one by one"] = lambda s=source, d=destination: _one_by_one(s, d)
        yield {"what": "leave-one-out", "pairs": count} | in_turn(ways)
        curve = in_turn({"pinwarp": lambda f=factor, d=destination: penalty_curve(f, d)})
        yield {"what": "curve of 61 penalties", "pairs": count} | curve
    for count in (10, 25, 50, 200, 600):
        for what, displaced in (("which pair is wrong", 0), ("the same, one displaced", 1)):
            case = made_up(count, 0, displaced=displaced)
            _ = case.factor.modes_at_landmarks
            ways = {"pinwarp": lambda c=case: suspects(c.factor, c.destination)}
            yield {"what": what, "pairs": count} | in_turn(ways)
    yield from _mapping()


def _one_by_one(source: np.ndarray, destination: np.ndarray) -> list[np.ndarray]:
    """Leave each pair out and solve anew, as a script would."""
    errors = []
    for row in range(len(source)):
        others = np.arange(len(source)) != row
        warp = solve(factorise(source[others]), destination[others], 1.0)
        errors.append(destination[row] - warp.evaluate(source[row : row + 1])[0])
    return errors


def _mapping() -> Iterator[Row]:
    source, destination = landmark_pairs(200)
    factor = factorise(source)
    warp, points = solve(factor, destination, 1.0), surface_points(100_000)
    prediction = prediction_of(factor, destination, 1.0)
    determinant = determinants(jacobians(warp, points))
    mesh = Mesh(points, np.arange(99_999).reshape(-1, 3))
    sizes = {"vertices": 100_000, "pairs": 200}
    for what, way in (
        ("det J", lambda: determinants(jacobians(warp, points))),
        ("folds, from det J on", lambda: folds_of(determinant, mesh, warp)),
        ("uncertainty", lambda: prediction.standard_deviation(points)),
    ):
        yield {"what": what} | sizes | in_turn({"pinwarp": way})
    bone, other = _surfaces()
    surface_distance.warm_up()
    index = SurfaceIndex(other)
    vtk_distance = vtkImplicitPolyDataDistance()
    cells = np.column_stack([np.full(len(other.faces), 3), other.faces]).ravel()
    vtk_distance.SetInput(pv.PolyData(other.vertices, cells))
    places, found = numpy_to_vtk(bone.vertices.copy(), deep=True), vtkDoubleArray()
    sizes = {"vertices": len(bone.vertices)}
    ways = {
        "pinwarp": lambda: index.distances(bone.vertices),
        "vtk": lambda: vtk_distance.FunctionValue(places, found),
    }
    yield {"what": "distance one way"} | sizes | in_turn(ways, 1.0, 5)
    before = SurfaceIndex(bone)

    def both_ways() -> None:
        # As the map does after each change of the warp.
        compare_surfaces(bone, other, index_a=SurfaceIndex(bone, like=before), index_b=index)

    both = in_turn({"pinwarp": both_ways}, 1.0, 5)
    yield {"what": "distance both ways"} | sizes | both
    yield (
        {"what": "index, once a mesh"}
        | sizes
        | in_turn({"pinwarp": lambda: SurfaceIndex(other)}, 1.0, 5)
    )


def _surfaces() -> tuple[Mesh, Mesh]:
    """A bone of that many vertices and what it is warped to, some millimetres beside it."""
    around = int(np.sqrt(SURFACE_VERTICES / 4))
    ball = pv.ParametricEllipsoid(30, 40, 210, u_res=around, v_res=4 * around).clean().triangulate()
    bone = Mesh(np.asarray(ball.points, dtype=float), ball.regular_faces)
    target = true_warp(bone.vertices)
    source, _ = landmark_pairs(50)
    spline = solve(factorise(source), true_warp(source) + 1.5)
    return Mesh(spline.evaluate(bone.vertices), bone.faces), Mesh(target, bone.faces)
