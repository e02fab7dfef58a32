"""The same warp by other libraries: each can solve, and evaluate what it solved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import tps
from scipy.interpolate import RBFInterpolator
from scipy.spatial.distance import cdist
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkSMPTools
from vtkmodules.vtkCommonTransforms import vtkThinPlateSplineTransform

try:
    from opynsim import tps3d as opynsim_tps3d
except ImportError:
    opynsim_tps3d = None
ABSENT = () if opynsim_tps3d is not None else ("OPynSim",)


@dataclass(frozen=True)
class Peer:
    """One library: how to solve, how to evaluate, and up to what size it is asked to."""

    name: str
    solve: Callable[[np.ndarray, np.ndarray], Callable[[np.ndarray], np.ndarray]]
    most_landmarks: int = 5000
    most_distances: float = 2e9
    points_in_a_loop: bool = False


def _scipy(source, destination):
    return RBFInterpolator(source, destination, kernel="linear", degree=1)


def _thin_plate_spline(source, destination):
    return tps.ThinPlateSpline(alpha=0.0).fit(source, destination).transform


def _numpy(source, destination):
    count = len(source)
    bordered = np.zeros((count + 4, count + 4))
    bordered[:count, :count] = cdist(source, source)
    bordered[:count, count] = 1
    bordered[:count, count + 1 :] = source
    bordered[count:, :count] = bordered[:count, count:].T
    solved = np.linalg.solve(bordered, np.vstack([destination, np.zeros((4, 3))]))

    def evaluate(points):
        out = solved[count] + points @ solved[count + 1 :]
        for first in range(0, len(points), 20_000):
            part = slice(first, first + 20_000)
            out[part] += cdist(points[part], source) @ solved[:count]
        return out

    return evaluate


def _vtk(source, destination):
    # The fastest backend of the wheels; TBB is not among them.
    vtkSMPTools.SetBackend("STDThread")
    transform = vtkThinPlateSplineTransform()
    transform.SetBasisToR()
    for setter, landmarks in (
        (transform.SetSourceLandmarks, source),
        (transform.SetTargetLandmarks, destination),
    ):
        points = vtkPoints()
        points.SetData(numpy_to_vtk(np.ascontiguousarray(landmarks), deep=True))
        setter(points)
    transform.Update()

    def evaluate(vertices):
        given, out = vtkPoints(), vtkPoints()
        out.SetDataTypeToDouble()
        given.SetData(numpy_to_vtk(vertices))
        transform.TransformPoints(given, out)
        return vtk_to_numpy(out.GetData())

    return evaluate


class _OneByOne:
    """What OPynSim solved: it warps one point a call."""

    def __init__(self, source, destination):
        self.one = opynsim_tps3d.solve_coefficients(source, destination).warp_point

    def __call__(self, points):
        return np.array([self.one(point) for point in points])


def _opynsim() -> tuple[Peer, ...]:
    """OPynSim where it is installed, which takes Python 3.12."""
    if opynsim_tps3d is None:
        return ()
    # A dense QR: 28 s at 5000 landmarks. Two microseconds a point and more for each landmark.
    return (Peer("OPynSim", _OneByOne, 200, 1e7, points_in_a_loop=True),)


PEERS = (
    *_opynsim(),
    Peer("scipy", _scipy),
    # Allocates the whole matrix of distances several times over.
    Peer("thin-plate-spline", _thin_plate_spline, most_distances=2.1e7),
    # Jacobi rotations: 40 s at 1000 landmarks.
    Peer("VTK", _vtk, most_landmarks=200, most_distances=2.1e8),
    Peer("numpy LU", _numpy, most_distances=2.1e8),
)
