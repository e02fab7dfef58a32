"""Where the landmarks that nobody has placed yet are expected, as more and more are accepted.

A first guess misses its landmarks by much the same where they lie close together. What it missed
those by that were accepted is therefore passed on to the others by kriging, with the covariance
``exp(-r / 0.5 size)`` and a nugget (Cressie, Statistics for Spatial Data, 1993): never by a
spline, which would swing far out between few of them.

The doubt is one length for the whole bone, since nothing tells its places apart honestly. It
begins as the misfit of the surfaces has it, and is updated by how far each accepted landmark lay
from where those before it had put it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import solve_triangular
from scipy.spatial.distance import cdist

from pinwarp.core.errors import LandmarkError
from pinwarp.core.pose import Pose
from pinwarp.core.positions import as_positions
from pinwarp.core.spline import Spline
from pinwarp.core.surface import Surface

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]
Mask = NDArray[np.bool_]

# The doubt as shares of the size: of any bone, and how it grows with the misfit.
LEAST_DOUBT, DOUBT_OF_FIT = 0.05, 3.0
# How far errors hang together, as a share of the size, and how much of one is a place's own.
REACH = 0.5
NUGGET = 0.1
# So many accepted landmarks the doubt that it begins with is worth.
PRIOR = 4
# What the warp leaves further from the surface than so many radii lies beyond the scanned part.
BEYOND = 2.0


def doubt_of(fit: float) -> float:
    """Return the doubt of a place as a share of the size, from how far the surfaces lie apart.

    Examples
    --------
    >>> round(doubt_of(0.0), 3), round(doubt_of(0.04), 3)
    (0.05, 0.13)
    """
    return float(np.hypot(LEAST_DOUBT, DOUBT_OF_FIT * fit))


@dataclass(frozen=True, eq=False)
class Reading:
    """One way in which the destination can be read: a pose, warped to the surface.

    Attributes
    ----------
    pose
        Where it began.
    spline : Spline
        The warp, from the source's unit to the destination's; it mirrors where the pose does.
    surface : Surface
        The destination's.
    size : float
        The bone's RMS radius in the destination's unit, also where only a part of it is there.
    fit : float
        How far the surfaces lie apart after a coarse warp, as a mean both ways, over the
        destination's RMS radius.
    radius : float
        The doubt of a place before any more is accepted, in the destination's unit.
    margin : float
        How many times the best reading's fit this one's is; of the best, the next one's.
    met : (n, 3), (n, 3) float64
        The pairs that were given and that the warp meets, on the source and the destination.
    """

    pose: Pose
    spline: Spline
    surface: Surface
    size: float
    fit: float
    radius: float
    margin: float = np.inf
    met: tuple[Matrix, Matrix] = (np.zeros((0, 3)), np.zeros((0, 3)))

    @property
    def mirrored(self) -> bool:
        """Whether the destination is read as the source's other hand."""
        return self.pose.mirrored

    def evaluate(self, points: ArrayLike) -> Matrix:
        """Return where (m, 3) places of the source lie on the destination's surface."""
        return self.surface.closest(self.spline.evaluate(points)).positions

    def after(self, first: Pose) -> Reading:
        """Return the same reading of a source that lay elsewhere before, as in a mirror."""
        return replace(
            self,
            pose=self.pose.after(first),
            spline=posed_first(self.spline, first),
            met=(first.back(self.met[0]), self.met[1]),
        )


@dataclass(frozen=True, eq=False)
class Guesses:
    """Expected places.

    Attributes
    ----------
    positions : (m, 3) float64
        On the destination's surface, in its unit.
    radii : (m,) float64
        The doubt of each: most true places lie closer, few at twice as far.
    beyond_rim : (m,) bool
        Whether the destination ends before it is reached; nothing should be shown there.
    order : (m,) int64
        Rows, the most certain first.
    """

    positions: Matrix
    radii: Matrix
    beyond_rim: Mask
    order: Rows


def guessed(
    reading: Reading,
    source: ArrayLike,
    accepted_source: ArrayLike = (),
    accepted_destination: ArrayLike = (),
) -> Guesses:
    """Return where places of the source are expected on the destination.

    Parameters
    ----------
    reading
        The first guess.
    source
        (m, 3) the places asked about, in the source's unit.
    accepted_source, accepted_destination
        (k, 3) row by row the landmarks that somebody placed or accepted, in the order in which
        that happened. Those that the reading met already may be among them: they keep others
        where they are, and prove nothing.

    Returns
    -------
    Guesses

    Raises
    ------
    LandmarkError
        When there are more of one than of the other, or a row cannot be used.

    Examples
    --------
    >>> from pinwarp.core.mesh import Mesh
    >>> from pinwarp.core.spline import factorise, solve
    >>> square = Mesh([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> corners = np.vstack([np.zeros(3), np.eye(3)])
    >>> same = solve(factorise(corners), corners)
    >>> pose = Pose(1.0, np.eye(3), np.zeros(3))
    >>> reading = Reading(pose, same, Surface(square), size=8.0, fit=0.01, radius=0.5)
    >>> found = guessed(reading, [[1, 0, 0], [8, 8, 0]], [[0, 0, 0]], [[0.5, 0, 0]])
    >>> found.positions.round(2).tolist(), found.order.tolist()
    ([[1.35, 0.0, 0.0], [8.03, 8.0, 0.0]], [0, 1])
    """
    asked = as_positions(source, "source landmark")
    u = as_positions(np.reshape(accepted_source, (-1, 3)), "accepted source landmark")
    v = as_positions(np.reshape(accepted_destination, (-1, 3)), "accepted destination landmark")
    if len(u) != len(v):
        raise LandmarkError(f"There are {len(u)} accepted source landmarks but {len(v)} of theirs.")
    met = _rows_among(np.hstack([u, v]), np.hstack(reading.met))
    # What the warp was made to meet comes first: what follows is judged with it known.
    order = np.argsort(~met, kind="stable")
    u, v, new = u[order], v[order], ~met[order]
    count = len(u)
    warped = reading.spline.evaluate(np.vstack([u, asked]))
    there = reading.surface.closest(warped).positions
    covariance = np.exp(-cdist(there, there[:count]) / (REACH * reading.size))
    lower = np.linalg.cholesky(covariance[:count] + NUGGET * np.eye(count))
    whitened = solve_triangular(lower, v - there[:count], lower=True)
    shares = solve_triangular(lower, covariance[count:].T, lower=True)
    expected = warped[count:] + shares.T @ whitened
    places = reading.surface.closest(expected)
    innovations = np.diag(lower)[:, None] * whitened
    known = PRIOR + len(reading.met[0])
    squares = known * reading.radius**2 + float(np.sum(innovations[new] ** 2))
    radius = float(np.sqrt(squares / (known + np.count_nonzero(new))))
    off = np.linalg.norm(places.positions - expected, axis=1)
    return Guesses(
        positions=places.positions,
        radii=np.full(len(asked), radius),
        # By the doubt of the shapes: accepting what is shown makes no part of the bone end.
        beyond_rim=places.on_rim | (off > BEYOND * reading.radius),
        # Of the doubt of one among others only this much is known: how near it is to an accepted
        # one, and whether the warp had reached the surface.
        order=np.argsort(radius**2 * (1 - np.sum(shares**2, axis=0)) + off**2, kind="stable"),
    )


def posed_first(spline: Spline, pose: Pose) -> Spline:
    """Return the spline that poses first and then warps: distances only grow by the scale.

    Examples
    --------
    >>> from pinwarp.core.spline import factorise, solve
    >>> rng = np.random.default_rng(0)
    >>> source, destination = rng.normal(size=(9, 3)), rng.normal(size=(9, 3))
    >>> spline = solve(factorise(source), destination)
    >>> pose = Pose(2.0, np.diag([1.0, -1.0, 1.0]), np.array([0.0, 5.0, 0.0]))
    >>> apart = posed_first(spline, pose).evaluate(source) - spline.evaluate(pose.apply(source))
    >>> bool(np.abs(apart).max() < 1e-9)
    True
    """
    linear = pose.scale * pose.rotation.T
    return replace(
        spline,
        source=pose.back(spline.source),
        weights=pose.scale * spline.weights,
        affine=np.vstack([[1.0, *pose.offset] @ spline.affine, linear @ spline.affine[1:]]),
    )


def _rows_among(rows: Matrix, others: Matrix) -> Mask:
    """Return which rows are also rows of others."""
    known = {row.tobytes() for row in others}
    return np.array([row.tobytes() in known for row in rows], np.bool_)
