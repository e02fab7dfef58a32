"""Rigid and similarity fits of one set of positions to another, and what an affine map does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from pinwarp.core.positions import quiet

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Similarity:
    """The map ``x -> scale * rotation @ x + translation``; the rotation is proper.

    Attributes
    ----------
    rotation : (3, 3) float64
    scale : float
    translation : (3,) float64
    """

    rotation: Matrix
    scale: float
    translation: Matrix

    def apply(self, points: ArrayLike) -> Matrix:
        """Map (m, 3) points."""
        moved = np.asarray(points, dtype=np.float64) @ (self.scale * self.rotation).T
        return np.asarray(moved + self.translation)


@quiet
def fit_similarity(
    source: ArrayLike,
    destination: ArrayLike,
    *,
    scaling: bool = True,
    weights: ArrayLike | None = None,
) -> Similarity:
    """Fit a similarity (or rigid motion) in the least-squares sense, without reflection.

    Umeyama, IEEE PAMI 13 (1991), eq. 40-43. Where the positions leave the rotation open (one
    place, one line) the smallest rotation that fits is taken.

    Parameters
    ----------
    source, destination
        (n, 3) positions, row by row the same places, n >= 1.
    scaling
        False for a rigid motion.
    weights
        (n,) how much the square of each distance counts; all the same without them.

    Returns
    -------
    Similarity

    Examples
    --------
    >>> fit = fit_similarity([[0, 0, 0], [1, 0, 0]], [[5, 0, 0], [5, 2, 0]])
    >>> fit.apply([[0.5, 0, 0]]).round(6).tolist()
    [[5.0, 1.0, 0.0]]
    """
    u = np.asarray(source, dtype=np.float64)
    v = np.asarray(destination, dtype=np.float64)
    share = np.ones(len(u)) if weights is None else np.asarray(weights, dtype=np.float64)
    centre, target = (np.average(side, axis=0, weights=share) for side in (u, v))
    share = share[:, None]
    u, v = u - centre, v - target
    size_u, size_v = float(np.abs(u).max(initial=0)), float(np.abs(v).max(initial=0))
    if size_u == 0 or size_v == 0:
        return Similarity(np.eye(3), 1.0, target - centre)
    u, v = u / size_u, v / size_v
    correlation = (share * v).T @ u
    U, values, Vt = np.linalg.svd(correlation)
    rank = int(np.sum(values > 1e-9 * values[0])) if values[0] > 0 else 0
    if rank == 0:
        rotation = np.eye(3)
    elif rank == 1:
        rotation = _smallest_rotation(Vt[0], U[:, 0])
    else:
        handedness = np.sign(np.linalg.det(U @ Vt))
        rotation = U @ np.diag([1.0, 1.0, handedness]) @ Vt
    scale = 1.0
    if scaling:
        fitted = float(np.trace(rotation.T @ correlation) / np.sum(share * u * u)) * size_v / size_u
        # A mirrored set can ask for a vanishing scale: that would collapse the mesh.
        scale = fitted if fitted > 1e-6 * size_v / size_u else size_v / size_u
    return Similarity(rotation, scale, target - scale * rotation @ centre)


def _smallest_rotation(a: Matrix, b: Matrix) -> Matrix:
    """Return the rotation by the smallest angle that takes unit vector a to b."""
    cosine = float(a @ b)
    axis = np.cross(a, b)
    if cosine < -1 + 1e-12:
        # Opposite: half a turn about any axis across a.
        across = np.eye(3)[np.argmin(np.abs(a))]
        across = across - (across @ a) * a
        across /= np.linalg.norm(across)
        return np.asarray(2 * np.outer(across, across) - np.eye(3))
    x, y, z = axis
    W = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + W + W @ W / (1 + cosine))


@dataclass(frozen=True, eq=False)
class AffineParts:
    """An affine map taken apart: first it stretches, then turns, then moves.

    Attributes
    ----------
    translation : (3,) float64
        How far it moves the centre, in mesh units.
    axis : (3,)
        Unit vector that the rotation turns about; x where there is none.
    angle : float
        How far it turns, right-handed, in degrees from 0 to 180.
    scales : (3,)
        How lengths along x, y and z of the source grow: the diagonal of the stretch.
    shears : (3,)
        Its xy, xz and yz entries: how far y leans towards x, z towards x and z towards y.
    principal : (3,)
        The stretch along the directions that it does not turn, the largest first.
    directions : (3, 3)
        These directions, as rows.
    mirrored : bool
        Whether it makes a left bone of a right one; the last principal stretch is then below 0.
    """

    translation: Matrix
    axis: Matrix
    angle: float
    scales: Matrix
    shears: Matrix
    principal: Matrix
    directions: Matrix
    mirrored: bool


@quiet
def decompose(affine: ArrayLike, centre: ArrayLike = (0.0, 0.0, 0.0)) -> AffineParts:
    """Take the affine part of a spline apart by polar decomposition.

    ``v -> a1 + L v`` with ``L = R S``: the proper rotation nearest to L and a symmetric stretch
    (Higham, SIAM J. Sci. Stat. Comput. 7 (1986)).

    Parameters
    ----------
    affine
        (4, 3) rows ``a1 ... a4``, as in :class:`~pinwarp.core.spline.Spline`.
    centre
        (3,) place whose movement is called the translation; better the middle of the bone than
        an origin far away.

    Examples
    --------
    >>> quarter_turn = [[1, 0, 0], [0, 2, 0], [-2, 0, 0], [0, 0, 2]]
    >>> parts = decompose(quarter_turn)
    >>> round(parts.angle), parts.axis.round(9).tolist(), parts.scales.round(9).tolist()
    (90, [0.0, 0.0, 1.0], [2.0, 2.0, 2.0])
    """
    rows = np.asarray(affine, dtype=np.float64)
    place = np.asarray(centre, dtype=np.float64)
    linear = rows[1:].T
    U, values, Vt = np.linalg.svd(linear)
    mirrored = bool(np.linalg.det(U) * np.linalg.det(Vt) < 0 and values[2] > 0)
    if np.linalg.det(U) * np.linalg.det(Vt) < 0:
        # The rotation must be proper: the weakest direction takes the sign.
        U, values = U * [1, 1, -1], values * [1, 1, -1]
    stretch = Vt.T @ (values[:, None] * Vt)
    turn = Rotation.from_matrix(U @ Vt).as_rotvec()
    angle = float(np.linalg.norm(turn))
    return AffineParts(
        translation=rows[0] + linear @ place - place,
        axis=turn / angle if angle > 0 else np.array([1.0, 0.0, 0.0]),
        angle=float(np.degrees(angle)),
        scales=np.diag(stretch).copy(),
        shears=stretch[[0, 0, 1], [1, 2, 2]],
        principal=values,
        directions=Vt,
        mirrored=mirrored,
    )
