"""Rigid and similarity fits of one set of positions to another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

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


def fit_similarity(
    source: ArrayLike, destination: ArrayLike, *, scaling: bool = True
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
    centre, target = u.mean(axis=0), v.mean(axis=0)
    u, v = u - centre, v - target
    size_u, size_v = float(np.abs(u).max(initial=0)), float(np.abs(v).max(initial=0))
    if size_u == 0 or size_v == 0:
        return Similarity(np.eye(3), 1.0, target - centre)
    u, v = u / size_u, v / size_v
    correlation = v.T @ u
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
        fitted = float(np.trace(rotation.T @ correlation) / np.sum(u * u)) * size_v / size_u
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
