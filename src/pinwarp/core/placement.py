"""Where a frame is in another: rotation and place, and OpenSim's angles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

Matrix = NDArray[np.float64]

# Closer to a right angle than this, two of three angles turn about one axis.
_LOCKED = 1e-9


@dataclass(frozen=True, eq=False)
class Placement:
    """The map ``x -> rotation @ x + origin`` from a frame to the one it stands in.

    Attributes
    ----------
    rotation : (3, 3) float64
        Proper.
    origin : (3,) float64

    Examples
    --------
    >>> quarter = Placement.from_angles([0, 0, np.pi / 2], [1, 0, 0])
    >>> quarter.out([[1, 0, 0]]).round(9).tolist()
    [[1.0, 1.0, 0.0]]
    >>> quarter.into(quarter.out([[1, 2, 3]])).round(9).tolist()
    [[1.0, 2.0, 3.0]]
    """

    rotation: Matrix
    origin: Matrix

    @classmethod
    def from_angles(cls, angles: ArrayLike, origin: ArrayLike) -> Placement:
        """Make one of body-fixed x-y-z angles in radians, as OpenSim writes them."""
        rotation = Rotation.from_euler("XYZ", np.asarray(angles, dtype=np.float64)).as_matrix()
        return cls(rotation, np.array(origin, dtype=np.float64))

    @property
    def angles(self) -> Matrix:
        """The body-fixed x-y-z angles in radians, (3,)."""
        R = self.rotation
        level = np.hypot(R[0, 0], R[0, 1])
        y = np.arctan2(R[0, 2], level)
        if level < _LOCKED:
            return np.array([np.arctan2(R[2, 1], R[1, 1]), y, 0.0])
        return np.array([np.arctan2(-R[1, 2], R[2, 2]), y, np.arctan2(-R[0, 1], R[0, 0])])

    def out(self, places: ArrayLike) -> Matrix:
        """Return (m, 3) places of the frame as seen from the one it stands in."""
        return np.asarray(places, dtype=np.float64) @ self.rotation.T + self.origin

    def into(self, places: ArrayLike) -> Matrix:
        """Return (m, 3) places of the outer frame as seen from this one."""
        return np.asarray((np.asarray(places, dtype=np.float64) - self.origin) @ self.rotation)

    def holding(self, inner: Placement) -> Placement:
        """Return where a frame is that stands in this one, as seen from the outer one."""
        return Placement(self.rotation @ inner.rotation, self.out(inner.origin[None])[0])

    def seen_from(self, other: Placement) -> Placement:
        """Return this placement as seen from another frame that stands where this one does."""
        return Placement(other.rotation.T @ self.rotation, other.into(self.origin[None])[0])


HERE = Placement(np.eye(3), np.zeros(3))


def frame_of_stations(stations: ArrayLike, ab_axis: str, ab_x_ac_axis: str) -> Placement:
    """Return the frame that four stations define, as OpenSim's ``StationDefinedFrame``.

    Parameters
    ----------
    stations
        (4, 3) places of a, b, c and the origin.
    ab_axis, ab_x_ac_axis
        Which axis points from a to b, and which along the cross product of ab and ac: ``"+x"``,
        ``"-x"`` and so on, not of one letter.

    Raises
    ------
    ValueError
        When an axis is none of these, both are of one letter, or the stations lie in a line.

    Examples
    --------
    >>> frame = frame_of_stations([[0, 0, 0], [0, 2, 0], [1, 0, 0], [5, 5, 5]], "+y", "-z")
    >>> frame.rotation.tolist(), frame.origin.tolist()
    ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [5.0, 5.0, 5.0])
    """
    a, b, c, origin = np.asarray(stations, dtype=np.float64)
    known = {sign + letter for sign in "+-" for letter in "xyz"}
    if not {ab_axis, ab_x_ac_axis} <= known or ab_axis[1] == ab_x_ac_axis[1]:
        raise ValueError(f"{ab_axis!r} and {ab_x_ac_axis!r} are no two axes of a frame")
    across = np.cross(b - a, c - a)
    long, wide = np.linalg.norm(b - a), np.linalg.norm(across)
    if not wide > 1e-12 * long * np.linalg.norm(c - a) > 0:
        raise ValueError("its stations a, b and c lie in a line")
    first, second = "xyz".index(ab_axis[1]), "xyz".index(ab_x_ac_axis[1])
    third = 3 - first - second
    rotation = np.zeros((3, 3))
    rotation[:, first] = (b - a) / long * (-1 if ab_axis[0] == "-" else 1)
    rotation[:, second] = across / wide * (-1 if ab_x_ac_axis[0] == "-" else 1)
    rotation[:, third] = np.cross(rotation[:, (third + 1) % 3], rotation[:, (third + 2) % 3])
    # Zeros without a sign.
    return Placement(rotation + 0.0, origin)


def turn_in_degrees(rotation: Matrix) -> float:
    """Return by how much a rotation turns, from 0 to 180 degrees.

    Examples
    --------
    >>> round(turn_in_degrees(Placement.from_angles([0, 0.5, 0], [0, 0, 0]).rotation), 4)
    28.6479
    """
    return float(np.degrees(Rotation.from_matrix(rotation).magnitude()))
