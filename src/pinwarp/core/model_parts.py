"""What stands on one body of a musculoskeletal model, as values: the input of a model's warp.

Lengths are in the unit of the model (metres), angles in radians. A part knows its frame by the
frame's path, and the element it was read from by a key that only the reader understands.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.coordinate_function import CoordinateFunction
from pinwarp.core.mesh import Mesh
from pinwarp.core.placement import Placement

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Part:
    """One element.

    Parameters
    ----------
    key
        Of the element, for whoever read it.
    path
        Its path as OpenSim writes it, such as ``/markerset/KNEE``.
    kind
        What it is, in the words of the report.
    line
        Where it is in the file.
    """

    key: int
    path: str
    kind: str
    line: int


@dataclass(frozen=True, eq=False)
class PointPart(Part):
    """A place in a frame: a path point, a marker, a station.

    Parameters
    ----------
    frame
        Path of its frame.
    location
        (3,) in that frame.
    is_of_path
        Whether a muscle or ligament runs through it.
    wraps
        Paths of the wraps that this muscle uses.
    """

    frame: str
    location: Matrix
    is_of_path: bool = False
    wraps: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class OffsetPart(Part):
    """A frame that stands in another.

    Parameters
    ----------
    frame
        Path of the frame that it stands in.
    placement
        Where in that.
    """

    frame: str
    placement: Placement


@dataclass(frozen=True, eq=False)
class StationFramePart(Part):
    """A frame that OpenSim makes of four stations.

    Parameters
    ----------
    stations
        Keys of the stations a, b, c and of the origin.
    ab_axis, ab_x_ac_axis
        See :func:`~pinwarp.core.placement.frame_of_stations`.
    """

    stations: tuple[int, int, int, int]
    ab_axis: str
    ab_x_ac_axis: str


@dataclass(frozen=True, eq=False)
class TrajectoryPart(Part):
    """A place that depends on a coordinate: a moving path point, the translations of a joint.

    Parameters
    ----------
    frame
        Path of the frame that it moves in.
    axes
        (3, 3) whose columns are the directions that the functions move it along.
    functions
        One for each axis.
    coordinates
        The coordinate that each function depends on; empty where it is a constant.
    function_keys
        Of the elements of the functions.
    """

    frame: str
    axes: Matrix
    functions: tuple[CoordinateFunction, CoordinateFunction, CoordinateFunction]
    coordinates: tuple[str, str, str]
    function_keys: tuple[int, int, int]


class WrapShape(StrEnum):
    """What muscles wrap over.

    Examples
    --------
    >>> WrapShape("WrapSphere").name
    'SPHERE'
    """

    CYLINDER = "WrapCylinder"
    ELLIPSOID = "WrapEllipsoid"
    SPHERE = "WrapSphere"


@dataclass(frozen=True, eq=False)
class WrapPart(Part):
    """A surface that muscles wrap over.

    Parameters
    ----------
    shape
        Which.
    frame
        Path of its frame.
    placement
        Where in that; a cylinder's axis is z.
    size
        Radius and length of a cylinder, three half axes of an ellipsoid, radius of a sphere.
    """

    shape: WrapShape
    frame: str
    placement: Placement
    size: Matrix


@dataclass(frozen=True, eq=False)
class MeshPart(Part):
    """A mesh that is drawn.

    Parameters
    ----------
    frame
        Path of its frame.
    mesh
        As its file has it.
    scale
        (3,) factors that it is drawn with; a negative product mirrors it.
    """

    frame: str
    mesh: Mesh
    scale: Matrix

    def on(self, placement: Placement) -> Mesh:
        """Return the mesh as drawn, in the frame that its own is placed in."""
        faces = self.mesh.faces
        mirrored = bool(np.prod(self.scale) < 0)
        return Mesh(
            placement.out(self.mesh.vertices * self.scale), faces[:, ::-1] if mirrored else faces
        )


@dataclass(frozen=True, eq=False)
class JointPart(Part):
    """A joint that stands on the body's own frame, whose origin no rule moves."""


@dataclass(frozen=True, eq=False)
class KeptPart(Part):
    """What is left as it is.

    Parameters
    ----------
    words
        Why, as a clause.
    flag
        What to look at, as a sentence; empty where nothing is.
    """

    words: str
    flag: str = ""


@dataclass(frozen=True, eq=False)
class BodyParts:
    """A body and all that stands on it.

    Parameters
    ----------
    path
        Of the body, such as ``/bodyset/femur_r``.
    mass_centre
        The body's own, as a point in its frame.
    frames, points, trajectories, wraps, meshes, joints, kept
        The parts, each once, in the order of the file.
    """

    path: str
    mass_centre: PointPart
    frames: Mapping[str, OffsetPart | StationFramePart] = field(default_factory=dict)
    points: tuple[PointPart, ...] = ()
    trajectories: tuple[TrajectoryPart, ...] = ()
    wraps: tuple[WrapPart, ...] = ()
    meshes: tuple[MeshPart, ...] = ()
    joints: tuple[JointPart, ...] = ()
    kept: tuple[KeptPart, ...] = ()

    @property
    def name(self) -> str:
        """The body's name."""
        return self.path.rsplit("/", 1)[-1]

    @property
    def paths(self) -> frozenset[str]:
        """The paths of all parts that a rule can be chosen for."""
        groups = (self.points, self.trajectories, self.wraps, self.meshes)
        return frozenset(part.path for group in groups for part in group) | self.frames.keys()
