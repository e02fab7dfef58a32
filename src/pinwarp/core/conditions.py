"""The thin-plate spline under linear conditions, each with a penalty of its own.

Condition a says where the warp takes place i(a) along one direction of the destination:
``d_a . f(u_i(a)) = v_a``. A landmark is three conditions, a point that may slide along a curve
two (across its tangent), one that may slide on a surface one (along its normal). With
``U = +r`` the spline that minimises

    sum_a (d_a . f(u_i(a)) - v_a)^2 / s_a + bending energy of f / (8 pi),   s_a a length, 0: met

solves

    (M + diag s) g + C b = v,   C^T g = 0,
    M_ab = -|u_i(a) - u_i(b)| (d_a . d_b),   C = [D, u_x D, u_y D, u_z D]   (c x 12),

and is an ordinary spline with the weights ``w_i = -sum of g_a d_a over the conditions of i``. As
in :mod:`pinwarp.core.factor` the system is solved in the space that the side conditions leave:
``C = Q [R; 0]``, ``Q = [Q1 Q2]``, ``N = Q2^T (M + diag s) Q2`` is positive definite, and
``g = Q2 N^-1 Q2^T v``. It is the dual form of the sliding of Bookstein (Medical Image Analysis 1,
1997) and of Gunz, Mitteroecker and Bookstein (Semilandmarks in Three Dimensions, 2005), which is
written with the tangents along which a point may move and needs the inverse of ``M``; a plane
costs one row here where they need two, and a penalty costs nothing.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.distance import cdist

from pinwarp.core import kernel
from pinwarp.core.errors import LandmarkError, PenaltyError, SingularSystemError
from pinwarp.core.factor import is_well_spaced
from pinwarp.core.householder import Reflections
from pinwarp.core.positions import as_positions
from pinwarp.core.spline import (
    PenaltyConvention,
    Spline,
    cholesky,
    cholesky_solve,
    cholesky_solve_again,
)

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]

# Twelve numbers make an affine map; below this share of the best known, one is not known at all.
AFFINE = 12
KNOWN = 1e-6


@dataclass(frozen=True, eq=False)
class Conditions:
    """Directions of the destination along which places of the source are held.

    Attributes
    ----------
    rows : (c,) int64
        The place that each condition holds.
    directions : (c, 3) float64
        Unit vectors; those of one place are orthogonal to one another.
    """

    rows: Rows
    directions: Matrix

    @classmethod
    def joined(cls, parts: Iterable[Conditions]) -> Conditions:
        """Return conditions one after the other.

        Examples
        --------
        >>> both = Conditions.joined([held([0]), held_along([1], [[0, 0, 1]])])
        >>> both.rows.tolist()
        [0, 0, 0, 1]
        """
        several = list(parts)
        return cls(
            np.concatenate([part.rows for part in several]),
            np.vstack([part.directions for part in several]),
        )


def held(rows: ArrayLike) -> Conditions:
    """Return the three conditions of each place that is held wholly, as landmarks are."""
    places = np.asarray(rows, dtype=np.int64)
    return Conditions(np.repeat(places, 3), np.tile(np.eye(3), (len(places), 1)))


def held_along(rows: ArrayLike, normals: ArrayLike) -> Conditions:
    """Return the one condition of each place that may slide across a (n, 3) unit normal."""
    directions = np.asarray(normals, dtype=np.float64).reshape(-1, 3)
    return Conditions(np.asarray(rows, dtype=np.int64), directions)


def held_across(rows: ArrayLike, tangents: ArrayLike) -> Conditions:
    """Return the two conditions of each place that may slide along a (n, 3) unit tangent."""
    places = np.asarray(rows, dtype=np.int64)
    return Conditions(np.tile(places, 2), np.vstack(across(np.asarray(tangents, np.float64))))


def across(directions: Matrix) -> tuple[Matrix, Matrix]:
    """Return two unit vectors across each (n, 3) unit vector, and across one another.

    Duff et al., Journal of Computer Graphics Techniques 6 (2017).

    Examples
    --------
    >>> [vector.tolist() for vector in across(np.array([[0.0, 0.0, 1.0]]))]
    [[[1.0, -0.0, -0.0]], [[-0.0, 1.0, -0.0]]]
    """
    x, y, z = directions.T
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return (
        np.column_stack([1.0 + sign * x * x * a, sign * b, -sign * x]),
        np.column_stack([b, sign + y * y * a, -y]),
    )


@dataclass(frozen=True, eq=False)
class ConditionFactor:
    """What depends on places and directions alone; made by :func:`factorise_conditions`.

    Attributes
    ----------
    source : (n, 3) float64
        The places, in source mesh units.
    conditions
        How they are held.
    centre, scale
        Their mean, and their RMS distance from it.
    """

    source: Matrix
    conditions: Conditions
    centre: Matrix
    scale: float
    reflections: Reflections
    projected: Matrix
    well_spaced: bool

    def solve(
        self, destination: ArrayLike, penalties: ArrayLike = 0.0, pulls: ArrayLike | None = None
    ) -> Spline:
        """Return the spline that meets the conditions as well as their penalties ask.

        Parameters
        ----------
        destination
            (n, 3) where the places would go; of each only its conditions' directions count.
        penalties
            One for all conditions or (c,), lengths in source mesh units; 0 meets a condition.
        pulls
            (n, 3) weights that the places have besides, across their conditions' directions:
            forces that keep them from sliding any further. Without them nothing pulls.

        Returns
        -------
        Spline
            Of penalty 0: solved anew from the pairs ``(source, f(source))`` it is the same.

        Raises
        ------
        LandmarkError
            When the counts differ or a row cannot be used.
        PenaltyError
            When a penalty is negative or not a number, or infinite: leave its condition out.
        SingularSystemError
            When the equations have no usable solution.
        """
        values, target = self._values(destination)
        shifted = self._shifted(penalties)
        weights = np.zeros_like(self.source)
        first = np.zeros((AFFINE, 1))
        if pulls is not None:
            # The side conditions are of all weights: those of the pulls are taken off.
            weights += np.asarray(pulls, dtype=np.float64) * self.scale
            unit = (self.source - self.centre) / self.scale
            moments = np.vstack([weights.sum(axis=0), unit.T @ weights]).reshape(-1, 1)
            first = np.linalg.solve(self.reflections.upper.T, moments)
            pulled = cdist(unit, unit) @ weights
            along = self.conditions.directions * pulled[self.conditions.rows]
            values = values - along.sum(axis=1, keepdims=True)
        rotated = self.reflections.rotate(values) - shifted[:, :AFFINE] @ first
        gamma = self._inverse(shifted, rotated[AFFINE:])
        top = np.linalg.solve(
            self.reflections.upper, rotated[:AFFINE] - shifted[:AFFINE, AFFINE:] @ gamma
        )
        g = self.reflections.rotate_back(np.vstack([first, gamma]))
        np.add.at(weights, self.conditions.rows, -self.conditions.directions * g)
        linear = top[3:].reshape(3, 3) / self.scale
        affine = np.vstack([target + top[:3, 0] - self.centre @ linear, linear])
        if not (np.isfinite(weights).all() and np.isfinite(affine).all()):
            raise SingularSystemError(
                "The coordinates are too large or too far apart to solve with: check the unit "
                "and the outliers."
            )
        return Spline(
            self.source, weights / self.scale, affine, 0.0, PenaltyConvention.REGULARISING
        )

    def leave_one_out(
        self, destination: ArrayLike, rows: ArrayLike, penalties: ArrayLike = 0.0
    ) -> Matrix:
        """Return how far places miss their destination once they are left out of the solve.

        The other conditions stay as they are: what slides keeps its line or plane, not its
        place. With ``G = Q2 N^-1 Q2^T`` and G_i its block of the conditions of place i the error
        is ``G_i^-1 (G v)_i``, the block form of :func:`pinwarp.core.quality.leave_one_out`.

        Parameters
        ----------
        destination, penalties
            As for :meth:`solve`.
        rows
            (k,) the places judged, each held wholly.

        Returns
        -------
        (k, 3) float64
            Destination minus warp; NaN where the others leave the affine part open.

        Raises
        ------
        LandmarkError
            When a place is not held wholly: a point that slides has no such error.
        """
        judged = np.asarray(rows, dtype=np.int64)
        of_place = [np.flatnonzero(self.conditions.rows == row) for row in judged]
        if any(len(own) != 3 for own in of_place):
            raise LandmarkError("Only what is held wholly, as landmarks are, can be left out.")
        values, _ = self._values(destination)
        own = np.concatenate(of_place) if of_place else np.zeros(0, np.int64)
        chosen = np.zeros((len(values), len(own) + 1))
        chosen[own, np.arange(len(own))] = 1.0
        chosen[:, -1:] = values
        rotated = self.reflections.rotate(chosen)[AFFINE:]
        solved = self._inverse(self._shifted(penalties), rotated)
        G = rotated[:, :-1].T @ solved
        errors = np.full((len(judged), 3), np.nan)
        for k in range(len(judged)):
            part = slice(3 * k, 3 * k + 3)
            block = G[part, part]
            # What nothing but itself determines cannot be judged.
            if np.linalg.eigvalsh(block)[0] > KNOWN**2 * np.trace(G) / max(1, len(own)):
                along = np.linalg.solve(block, G[part, -1])
                errors[k] = along @ self.conditions.directions[own[part]]
        return errors

    def _values(self, destination: ArrayLike) -> tuple[Matrix, Matrix]:
        """Return (c, 1) what the conditions ask for about a (3,) centre, and that centre."""
        places = as_positions(destination, "destination place")
        if len(places) != len(self.source):
            raise LandmarkError(
                f"There are {len(self.source)} source places but {len(places)} destination places."
            )
        target = places.mean(axis=0)
        asked = places[self.conditions.rows] - target
        return np.sum(self.conditions.directions * asked, axis=1, keepdims=True), target

    def _shifted(self, penalties: ArrayLike) -> Matrix:
        """Return ``Q^T (M + diag s) Q``."""
        count = len(self.conditions.rows)
        given = np.broadcast_to(np.asarray(penalties, dtype=np.float64), (count,))
        usable = np.isfinite(given) & (given >= 0)
        if not usable.all():
            value = float(given[~usable][0])
            raise PenaltyError(f"The penalty of a condition is {value}; it must be 0 or more.")
        if not given.any():
            return self.projected
        shifted = self.reflections.conjugate_diagonal(given / self.scale)
        shifted += self.projected
        return shifted

    def _inverse(self, shifted: Matrix, values: Matrix) -> Matrix:
        """Return ``N^-1 values``, of least norm where places coincide."""
        matrix = shifted[AFFINE:, AFFINE:]
        if self.well_spaced:
            # Who solves once has no use for the factor itself.
            if shifted is self.projected and self.is_prepared and self.lower is not None:
                return cholesky_solve_again(self.lower, values)
            solved = cholesky_solve(matrix.copy(), values)
            if solved is not None:
                return solved
        numbers, vectors = np.linalg.eigh(matrix)
        least = 8 * len(matrix) * np.finfo(np.float64).eps * max(1.0, float(numbers.max(initial=0)))
        inverse = np.divide(1.0, numbers, out=np.zeros_like(numbers), where=numbers > least)
        return np.asarray(vectors @ (inverse[:, None] * (vectors.T @ values)))

    @property
    def is_prepared(self) -> bool:
        """Whether the Cholesky factor is there already."""
        return "lower" in self.__dict__

    @cached_property
    def lower(self) -> Matrix | None:
        """The Cholesky factor of N without penalties, for solve after solve; None without one."""
        return cholesky(self.projected[AFFINE:, AFFINE:].copy())


def factorise_conditions(source: ArrayLike, conditions: Conditions) -> ConditionFactor:
    """Factorise places of the source and how they are held.

    Parameters
    ----------
    source
        (n, 3) places in source mesh units.
    conditions
        How they are held; see :func:`held`, :func:`held_across` and :func:`held_along`.

    Returns
    -------
    ConditionFactor

    Raises
    ------
    LandmarkError
        When a row cannot be used, or the conditions leave a part of the affine map open, as
        landmarks in one plane do.

    Examples
    --------
    Four landmarks, and a place that may slide on the plane z = 2:

    >>> source = np.vstack([np.zeros(3), np.eye(3), np.ones(3)])
    >>> conditions = Conditions.joined([held([0, 1, 2, 3]), held_along([4], [[0, 0, 1]])])
    >>> raised = source + np.array([[0, 0, 0]] * 4 + [[7, 7, 1]])
    >>> warp = factorise_conditions(source, conditions).solve(raised)
    >>> warp.evaluate(source[4:]).round(9).tolist()
    [[1.0, 1.0, 2.0]]
    """
    places = as_positions(source, "source place")
    directions = np.asarray(conditions.directions, dtype=np.float64)
    rows = np.asarray(conditions.rows, dtype=np.int64)
    if directions.shape != (len(rows), 3):
        raise LandmarkError(f"{len(rows)} conditions have directions of shape {directions.shape}.")
    if len(rows) and not (rows.min() >= 0 and rows.max() < len(places)):
        raise LandmarkError("A condition names a place that does not exist.")
    lengths = np.linalg.norm(directions, axis=1)
    if not (np.abs(lengths - 1) < 1e-6).all():
        row = int(rows[np.flatnonzero(~(np.abs(lengths - 1) < 1e-6))[0]])
        raise LandmarkError(f"Place {row} is held along a direction that is no unit vector.")
    if len(rows) < AFFINE:
        raise LandmarkError(_open(f"{len(rows)} conditions are fewer than the {AFFINE} of"))
    centre = places.mean(axis=0)
    scale = float(np.sqrt(np.mean(np.sum((places - centre) ** 2, axis=1)))) or 1.0
    unit = (places - centre) / scale
    own = unit[rows]
    basis = np.hstack([directions, *(own[:, [k]] * directions for k in range(3))])
    reflections = Reflections.of(basis)
    extents = np.linalg.svd(reflections.upper, compute_uv=False)
    if not extents[-1] > KNOWN * extents[0]:
        raise LandmarkError(_open("The conditions do not determine"))
    return ConditionFactor(
        source=places,
        conditions=Conditions(rows, directions),
        centre=centre,
        scale=scale,
        reflections=reflections,
        projected=reflections.conjugate(kernel.pulls(own, directions)),
        well_spaced=is_well_spaced(unit),
    )


def _open(what: str) -> str:
    return f"{what} an affine map: place at least four landmarks that do not lie in one plane."
