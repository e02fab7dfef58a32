"""A pose that lays one surface on another, found from nothing: no landmark, no unit, no hand.

Places spread over both surfaces are compared with their normals, in lengths of the destination's
size, so that no unit matters. From every way in which the principal axes can lie on one another
iterated closest points (Besl and McKay, IEEE PAMI 14 (1992)) run both ways, the furthest tenth
left out (Chetverikov et al., ICPR 2002); the best of each hand go on with more places. There is
no chance in it: the same surfaces give the same poses.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import KDTree

from pinwarp.core.mesh import Mesh
from pinwarp.core.plain_surface import rms_radius
from pinwarp.core.sampling import even_places
from pinwarp.core.surface import unit_vectors

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]
Mask = NDArray[np.bool_]
Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class _Step:
    """So many places, so many turns at most, and how many poses of each hand then go on.

    A turn that gains less than ``settled``, in RMS radii, is the last.
    """

    places: int
    turns: int
    survivors: int
    settled: float


STEPS = (
    _Step(150, 5, 20, 1e-4),
    _Step(300, 15, 6, 1e-4),
    _Step(1000, 60, 4, 1e-5),
    _Step(2500, 20, 3, 5e-6),
)
# Spins about each principal axis.
SPINS = 8
# The nearest of either cloud; what is further may have no counterpart.
KEPT = 0.9
# So many RMS radii a normal is worth when neighbours are looked for, and when poses are judged.
NORMAL = 0.3
NORMAL_COST = 0.05
# Poses that are turned by less and moved by less, in RMS radii, are one.
SAME_COSINE = float(np.cos(np.radians(8.0)))
SAME_OFFSET = 0.1
# A part may be larger or smaller by so much, and lie so far along the first axis.
PART_SCALES = (0.85, 1.0, 1.18)
PART_SHIFTS = 7
SCALE_LIMITS = (0.7, 1.4)


class Mirror(StrEnum):
    """Whether the destination may be the other hand: to be found out, known not to be, or known.

    Examples
    --------
    >>> Mirror("ask").hands, Mirror.YES.hands
    ((False, True), (True,))
    """

    ASK = "ask"
    NO = "no"
    YES = "yes"

    @property
    def hands(self) -> tuple[bool, ...]:
        """Which hands are tried: not mirrored, mirrored."""
        return {"ask": (False, True), "no": (False,), "yes": (True,)}[self.value]


@dataclass(frozen=True)
class PoseSettings:
    """What is known before a pose is looked for.

    Parameters
    ----------
    mirror
        Whether the destination is the source's other hand.
    partial
        Whether the destination is only a part of the bone. Its size then says nothing: the units
        must agree up to a factor of a thousand.
    """

    mirror: Mirror = Mirror.ASK
    partial: bool = False


@dataclass(frozen=True, eq=False)
class Pose:
    """The map ``x -> scale * rotation @ x + offset``, mirrored or not.

    Attributes
    ----------
    scale : float
        From the source's unit to the destination's.
    rotation : (3, 3) float64
        Orthogonal; its determinant is -1 where it mirrors.
    offset : (3,) float64
        In the destination's unit.
    cost : float
        How badly the surfaces agree, to be compared with other poses of the same two.
    """

    scale: float
    rotation: Matrix
    offset: Matrix
    cost: float = 0.0

    @property
    def mirrored(self) -> bool:
        """Whether it makes a left bone of a right one."""
        return bool(np.linalg.det(self.rotation) < 0)

    def apply(self, points: ArrayLike) -> Matrix:
        """Map (m, 3) points."""
        places = np.asarray(points, dtype=np.float64)
        return np.asarray(places @ (self.scale * self.rotation).T + self.offset)

    def back(self, points: ArrayLike) -> Matrix:
        """Map (m, 3) points the other way."""
        places = np.asarray(points, dtype=np.float64)
        return np.asarray((places - self.offset) @ self.rotation / self.scale)

    def after(self, first: Pose) -> Pose:
        """Return the pose that does another one first."""
        return Pose(
            self.scale * first.scale,
            self.rotation @ first.rotation,
            self.apply(first.offset[None])[0],
            self.cost,
        )

    def posed(self, mesh: Mesh) -> Mesh:
        """Return a mesh in this pose, its outside still outside."""
        return Mesh(self.apply(mesh.vertices), mesh.faces[:, ::-1] if self.mirrored else mesh.faces)


def _silent(_share: float, _words: str) -> None:
    pass


def find_poses(
    source: Mesh,
    destination: Mesh,
    settings: PoseSettings | None = None,
    *,
    progress: Progress = _silent,
) -> tuple[Pose, ...]:
    """Return the poses that lay the source best on the destination.

    Parameters
    ----------
    source, destination
        Surfaces of one bone each, facing outwards, in any units.
    settings
        What is known of them.
    progress
        Called with the share done and words; what it raises ends the search.

    Returns
    -------
    tuple of Pose
        The best first: of each hand the best few that differ.

    Raises
    ------
    MeshError
        When a mesh has no area.

    Examples
    --------
    >>> import pyvista as pv
    >>> egg = pv.ParametricSuperEllipsoid(1, 2, 4).triangulate().clean()
    >>> bent = Mesh(egg.points + 0.3 * egg.points[:, [2, 0, 1]] ** 2, egg.regular_faces)
    >>> turned = Mesh(7 + 1000 * bent.vertices[:, [1, 2, 0]], bent.faces)
    >>> pose, *others = find_poses(bent, turned)
    >>> round(pose.scale), pose.mirrored, pose.rotation.round().astype(int).tolist()
    (1000, False, [[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    """
    settings = settings or PoseSettings()
    a, b = (_Frame.of(mesh, STEPS[-1].places) for mesh in (source, destination))
    base = 1.0
    if settings.partial:
        # The size of a part says nothing: all that is known is that units go by thousands.
        base = 10.0 ** (3 * np.round(np.log10(b.size / a.size) / 3)) * a.size / b.size
    poses = _starts(a.cloud, b.cloud, settings, base)
    for number, step in enumerate(STEPS):
        search = _Search(
            a.cloud.thinned(step.places), b.cloud.thinned(step.places), settings.partial, base
        )
        settled = []
        for done, pose in enumerate(poses):
            progress(
                (number + done / len(poses)) / len(STEPS),
                f"looking for the pose, step {number + 1} of {len(STEPS)}",
            )
            settled.append(search.settled(pose, step))
        poses = _best(settled, step.survivors)
    return tuple(_between(pose, a, b) for pose in poses)


@dataclass(frozen=True, eq=False)
class _Cloud:
    """Places on a surface with unit normals."""

    positions: Matrix
    normals: Matrix

    def thinned(self, count: int) -> _Cloud:
        """Return some of them, as even as all are: they run along the surface as its file does."""
        rows = np.linspace(0, len(self.positions) - 1, count).astype(int)
        return _Cloud(self.positions[rows], self.normals[rows])

    @cached_property
    def _tree(self) -> KDTree:
        return KDTree(np.hstack([self.positions, NORMAL * self.normals]))

    def nearest(self, positions: Matrix, normals: Matrix) -> Rows:
        """Return the row nearest in place and direction to each of some places."""
        return np.asarray(self._tree.query(np.hstack([positions, NORMAL * normals]))[1])


@dataclass(frozen=True, eq=False)
class _Frame:
    """A surface about its middle, along its principal axes, at an RMS radius of 1."""

    cloud: _Cloud
    centre: Matrix
    axes: Matrix
    size: float

    @classmethod
    def of(cls, mesh: Mesh, count: int) -> _Frame:
        positions, triangles = even_places(mesh, count)
        a, b, c = (mesh.vertices[mesh.faces[triangles, i]] / mesh.diagonal for i in range(3))
        normals = unit_vectors(np.cross(b - a, c - a))
        centre = positions.mean(axis=0)
        size = rms_radius(positions)
        about = (positions - centre) / size
        _, _, axes = np.linalg.svd(about, full_matrices=False)
        axes[2] *= np.sign(np.linalg.det(axes))
        return cls(_Cloud(about @ axes.T, normals @ axes.T), centre, axes, size)


def _between(pose: Pose, a: _Frame, b: _Frame) -> Pose:
    """Return a pose between two frames as one between what they are frames of."""
    scale = b.size * pose.scale / a.size
    rotation = b.axes.T @ pose.rotation @ a.axes
    offset = b.centre + b.size * b.axes.T @ pose.offset - scale * rotation @ a.centre
    return Pose(scale, rotation, offset, pose.cost)


def _starts(a: _Cloud, b: _Cloud, settings: PoseSettings, base: float) -> list[Pose]:
    """Return every way to lay principal axes on one another, with spins about each."""
    turns: list[Matrix] = []
    for axis in range(3):
        for flip in (np.eye(3), _turn((axis + 1) % 3, np.pi)):
            for spin in range(SPINS):
                turn = _turn(axis, 2 * np.pi * spin / SPINS) @ flip
                if not any(np.allclose(turn, other, atol=1e-6) for other in turns):
                    turns.append(turn)
    scales: tuple[float, ...] = (1.0,)
    shifts = np.zeros(1)
    if settings.partial:
        longer = np.ptp(a.positions[:, 0]) * base - np.ptp(b.positions[:, 0])
        scales, shifts = PART_SCALES, np.linspace(-0.5, 0.5, PART_SHIFTS) * max(longer, 0.3)
    hands = [np.diag([1.0, 1.0, -1.0 if mirrored else 1.0]) for mirrored in settings.mirror.hands]
    return [
        # A shift is along the source's first axis, as it lies once it is turned.
        Pose(base * scale, turn @ hand, shift * (turn @ hand)[:, 0])
        for hand in hands
        for turn in turns
        for shift in shifts
        for scale in scales
    ]


def _turn(axis: int, angle: float) -> Matrix:
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[[i, j], [i, j]] = np.cos(angle)
    turn[j, i], turn[i, j] = np.sin(angle), -np.sin(angle)
    return turn


@dataclass(frozen=True, eq=False)
class _Search:
    """Two clouds, and how poses between them are improved and judged."""

    source: _Cloud
    destination: _Cloud
    partial: bool
    base: float

    def settled(self, pose: Pose, step: _Step) -> Pose:
        """Return a pose after iterated closest points, with its cost."""
        last = np.inf
        for _ in range(step.turns):
            met = self._met(pose)
            error = float(np.sqrt(np.mean([np.mean(way.off[way.near] ** 2) for way in met])))
            if abs(last - error) < step.settled:
                break
            last, pose = error, self._fitted(pose, met)
        met = self._met(pose)
        distance = np.sqrt(np.mean([np.mean(way.off[way.near] ** 2) for way in met]))
        turned = np.mean([np.mean(1 - way.cosines[way.near]) for way in met])
        return replace(pose, cost=float(distance + NORMAL_COST * turned))

    def _met(self, pose: Pose) -> list[_Way]:
        """Return which places meet in a pose: both ways, or only from a part to the whole."""
        now = pose.apply(self.source.positions)
        facing = self.source.normals @ pose.rotation.T
        back = pose.back(self.destination.positions)
        found: list[tuple[Rows | None, Rows | None]] = [
            (self.source.nearest(back, self.destination.normals @ pose.rotation), None)
        ]
        if not self.partial:
            found.append((None, self.destination.nearest(now, facing)))
        met = []
        for i, j in found:
            rows = slice(None) if i is None else i
            others = slice(None) if j is None else j
            aims = self.destination.positions[others]
            off = np.linalg.norm(aims - now[rows], axis=1)
            cosines = np.einsum("mk,mk->m", facing[rows], self.destination.normals[others])
            near = off <= np.quantile(off, KEPT)
            met.append(_Way(self.source.positions[rows], aims, off, cosines, near))
        return met

    def _fitted(self, pose: Pose, met: list[_Way]) -> Pose:
        """Return the similarity of the same hand that fits what met best (Umeyama 1991)."""
        x = np.vstack([way.places[way.near] for way in met])
        y = np.vstack([way.aims[way.near] for way in met])
        mean_x, mean_y = x.mean(axis=0), y.mean(axis=0)
        x, y = x - mean_x, y - mean_y
        U, values, Vt = np.linalg.svd(y.T @ x)
        signs = np.ones(3)
        signs[2] = np.sign(np.linalg.det(U) * np.linalg.det(Vt)) * (-1 if pose.mirrored else 1)
        rotation = (U * signs) @ Vt
        low, high = (limit * self.base for limit in SCALE_LIMITS)
        scale = float(np.clip(values @ signs / np.sum(x * x), low, high))
        return Pose(scale, rotation, mean_y - scale * rotation @ mean_x)


@dataclass(frozen=True, eq=False)
class _Way:
    """Places of the source, what they met, how far off, how much alike these face, who counts."""

    places: Matrix
    aims: Matrix
    off: Matrix
    cosines: Matrix
    near: Mask


def _best(poses: Sequence[Pose], count: int) -> list[Pose]:
    """Return the best of each hand, the best first, without those that are nearly another."""
    chosen: list[Pose] = []
    for pose in sorted(poses, key=lambda pose: pose.cost):
        alike = [other for other in chosen if other.mirrored == pose.mirrored]
        if len(alike) < count and not any(_is_same(pose, other) for other in alike):
            chosen.append(pose)
    return chosen


def _is_same(pose: Pose, other: Pose) -> bool:
    """Whether two poses between frames are nearly one."""
    cosine = (np.trace(pose.rotation.T @ other.rotation) - 1) / 2
    moved = float(np.linalg.norm(pose.offset - other.offset))
    return bool(cosine > SAME_COSINE and moved < SAME_OFFSET)
