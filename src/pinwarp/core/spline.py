"""Solve the 3D thin-plate spline for any penalty, and evaluate it.

``f(v) = a1 + a2 v_x + a3 v_y + a4 v_z + sum_i w_i |u_i - v|`` (Bookstein, IEEE PAMI 11 (1989);
basis ``U(r) = r`` in 3D: Gunz, Mitteroecker and Bookstein 2005). The weights shown to the user
belong to ``U = +r``, as in the equation, whatever the solver uses inside; with another
:class:`~pinwarp.core.basis.Basis` ``U(|u_i - v|)`` takes the place of the distance. The story of
the penalty's sign is told in :mod:`pinwarp.tps3d`.
"""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import solve_triangular
from scipy.linalg.lapack import dposv, dpotrf
from scipy.spatial.distance import pdist

from pinwarp.core import kernel
from pinwarp.core.alignment import fit_similarity
from pinwarp.core.basis import Basis
from pinwarp.core.errors import LandmarkCountError, SingularSystemError
from pinwarp.core.factor import SourceFactor, factorise, solve_upper
from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.lengths import rounding_among
from pinwarp.core.penalty import PenaltyConvention, check_convention, check_penalty
from pinwarp.core.positions import as_positions, in_range, quiet

Matrix = NDArray[np.float64]

# LAPACK called through scipy is the fastest Cholesky but keeps the interpreter's lock: 10 ms for
# this many landmarks. Beyond, a worker takes numpy's, so that the window lives meanwhile.
HOLDS_UP_LITTLE = 1200


@dataclass(frozen=True, eq=False)
class Spline:
    """A solved thin-plate spline.

    Attributes
    ----------
    source : (n, 3) float64
        The source landmarks, in mesh units.
    weights : (n, 3) float64
        ``w_i`` for ``U = +r`` (dimensionless) or ``+r^2 log r`` (one per source length).
    affine : (4, 3) float64
        Rows ``a1 ... a4``; ``a1`` in mesh units of the destination.
    penalty, convention
        What it was solved with.
    findings
        What the solve noticed.
    basis
        What it is built of.
    """

    source: Matrix
    weights: Matrix
    affine: Matrix
    penalty: float
    convention: PenaltyConvention
    findings: tuple[Finding, ...] = ()
    basis: Basis = Basis.R

    @quiet
    def evaluate(self, points: ArrayLike) -> Matrix:
        """Warp (m, 3) points in double precision; RangeError where no number can hold one."""
        points = kernel.as_points(points)
        warped = kernel.evaluate(self.source, self.weights, self.affine, points, self.basis)
        return in_range(warped, points)


@quiet
def solve(
    factor: SourceFactor,
    destination: ArrayLike,
    penalty: float = 0.0,
    convention: PenaltyConvention | str = PenaltyConvention.REGULARISING,
) -> Spline:
    """Solve the spline that takes the factorised source landmarks to a destination.

    Parameters
    ----------
    factor
        The source landmarks, from :func:`~pinwarp.core.factor.factorise`, and the basis.
    destination
        (n, 3) destination landmarks, in the destination's mesh unit.
    penalty
        The warping penalty, a length in mesh units or, with the basis ``r^2 log r``, an area;
        infinity is the affine fit.
    convention
        The equation that it enters, or its value; with the basis ``r^2 log r`` both are one.

    Returns
    -------
    Spline

    Raises
    ------
    LandmarkError
        When the counts differ or a row cannot be used.
    PenaltyError
        When the penalty is negative or no number, or there is no such convention.
    SingularSystemError
        When an OPYNSIM penalty hits a pole.

    Examples
    --------
    >>> import numpy as np
    >>> source = np.vstack([np.zeros(3), np.eye(3), np.ones(3)])
    >>> spline = solve(factorise(source), source + 0.1 * source ** 2)
    >>> np.allclose(spline.evaluate(source), source + 0.1 * source ** 2)
    True
    """
    displacement, target, linear = displacements(factor, destination)
    penalty, convention = check_penalty(penalty), check_convention(convention)
    convention = convention.within(factor.basis)
    weights, affine, findings = solve_values(factor, displacement, penalty, convention)
    linear = linear + affine[1:]
    coefficients = np.vstack([target + affine[0] - factor.centre @ linear, linear])
    if not (np.isfinite(weights).all() and np.isfinite(coefficients).all()):
        raise SingularSystemError(
            "The landmarks' coordinates are too large or too far apart to solve with: "
            "check the unit and the outliers."
        )
    target_positions = np.asarray(destination, dtype=np.float64)
    return Spline(
        source=factor.source,
        weights=weights,
        affine=coefficients,
        penalty=penalty,
        convention=convention,
        findings=(*factor.findings, *_conflicts(factor, target_positions, penalty), *findings),
        basis=factor.basis,
    )


def displacements(factor: SourceFactor, destination: ArrayLike) -> tuple[Matrix, Matrix, Matrix]:
    """Check the destination and take from it what the spline does not have to explain.

    Parameters
    ----------
    destination
        (n, 3) destination landmarks.

    Returns
    -------
    displacement : (n, 3)
        ``destination - target - (source - centre) @ linear``.
    target : (3,)
        Mean of the destination.
    linear : (3, 3)
        A similarity where the landmarks leave the affine part open (rank < 3), else 0.
    """
    destination = as_positions(destination, "destination landmark")
    if len(destination) != len(factor.source):
        raise LandmarkCountError(
            f"There are {len(factor.source)} source landmarks but {len(destination)} destination "
            "landmarks: each needs its counterpart."
        )
    target = destination.mean(axis=0)
    displacement = destination - target
    linear = np.zeros((3, 3))
    if factor.rank < 3:
        # The affine part is open: start from a similarity, the spline adds only what data fix.
        similarity = fit_similarity(factor.source, destination)
        linear = similarity.scale * similarity.rotation.T
        displacement = displacement - (factor.source - factor.centre) @ linear
    return displacement, target, linear


@quiet
def solve_values(
    factor: SourceFactor,
    values: Matrix,
    penalty: float,
    convention: PenaltyConvention = PenaltyConvention.REGULARISING,
) -> tuple[Matrix, Matrix, tuple[Finding, ...]]:
    """Solve for any values at the source landmarks; linear in them.

    Parameters
    ----------
    values
        (n, k) values, one column per scalar spline.

    Returns
    -------
    weights : (n, k)
        For ``U = +r`` or ``+r^2 log r``, as the factor's basis says.
    affine : (4, k)
        Constant, x, y and z, *about the centre of the source landmarks*.
    findings
        What the solve noticed.
    """
    if penalty == 0 and factor.duplicates and not factor.has_modes:
        places = factor.places
        if places.rank == factor.rank == 3:
            return _solve_places(factor, places, values)
    columns = factor.rank + 1
    rotated = factor.rotate(values / factor.scale)
    gamma, findings = _bend(factor, rotated[columns:], penalty, convention)
    weights, affine = back_to_landmarks(factor, gamma, rotated[:columns])
    return weights, affine, findings


def _solve_places(
    factor: SourceFactor, places: SourceFactor, values: Matrix
) -> tuple[Matrix, Matrix, tuple[Finding, ...]]:
    """Solve at penalty 0 with each place once: what the eigenvalues would say, but sooner.

    Landmarks at one place can only be met in the middle, and share its weight.
    """
    place_of, shares = factor.place_of, np.bincount(factor.place_of)[:, None]
    means = np.zeros((len(shares), values.shape[1]))
    np.add.at(means, place_of, values)
    weights, affine, findings = solve_values(places, means / shares, 0.0)
    affine[0] += (factor.centre - places.centre) @ affine[1:]
    return (weights / shares)[place_of], affine, findings


def back_to_landmarks(
    factor: SourceFactor, gamma: Matrix, top: Matrix | float = 0.0
) -> tuple[Matrix, Matrix]:
    """Return the weights and the affine part about the centre that belong to ``gamma``."""
    columns = factor.rank + 1
    affine = solve_upper(factor, top - factor.coupling @ gamma)
    weights = factor.rotate_back(np.vstack([np.zeros((columns, gamma.shape[1])), gamma]))
    weights *= factor.basis.sign * factor.scale / factor.strength
    constant = factor.scale * affine[:1]
    if factor.basis is Basis.R2_LOG_R:
        # The logarithm was of lengths in units of the scale: sum w_i |u_i - v|^2 is the same for
        # every v, by the side conditions.
        squares = np.sum((factor.source - factor.centre) ** 2, axis=1)
        constant = constant - math.log(factor.scale) * (squares @ weights)
    return weights, np.vstack([constant, factor.directions.T @ affine[1:]])


def _bend(
    factor: SourceFactor, values: Matrix, penalty: float, convention: PenaltyConvention
) -> tuple[Matrix, tuple[Finding, ...]]:
    """Solve ``(N +- penalty I) gamma = values``, the part of the system beyond the affine one."""
    at_one_place = factor.rank == 0 and penalty == 0
    if not len(values) or math.isinf(penalty) or at_one_place:
        return np.zeros_like(values), ()
    convention = convention.within(factor.basis)
    regularising = convention is PenaltyConvention.REGULARISING or penalty == 0
    if regularising and factor.well_spaced and not factor.has_modes:
        # One solve alone: Cholesky is a tenth of the eigendecomposition's work.
        shifted = factor.bending.copy()
        shifted.flat[:: len(shifted) + 1] += penalty / factor.strength
        solved = cholesky_solve(shifted, values)
        if solved is not None:
            return solved, ()
    eigenvalues, vectors = factor.modes
    shifts = eigenvalues + convention.sign * penalty
    usable = np.abs(shifts) > factor.smallest_mode
    findings: tuple[Finding, ...] = ()
    if not regularising:
        findings = _check_poles(factor, penalty)
    inverse = np.divide(factor.strength, shifts, out=np.zeros_like(shifts), where=usable)
    return vectors @ (inverse[:, None] * (vectors.T @ values)), findings


def cholesky_solve(matrix: Matrix, values: Matrix) -> Matrix | None:
    """Solve ``matrix x = values``; None where the matrix is not positive definite.

    Parameters
    ----------
    matrix
        (n, n), symmetric; overwritten.
    values
        (n, k).
    """
    if _holds_up_little(len(matrix)):
        # Symmetric: the transpose is the same matrix in the order that LAPACK wants.
        _, solved, info = dposv(matrix.T, values, lower=1, overwrite_a=1)
        return np.asarray(solved) if info == 0 else None
    lower = cholesky(matrix)
    return None if lower is None else cholesky_solve_again(lower, values)


def cholesky(matrix: Matrix) -> Matrix | None:
    """Return the lower factor of a symmetric matrix, overwritten; None where it has none."""
    if _holds_up_little(len(matrix)):
        lower, info = dpotrf(matrix.T, lower=1, overwrite_a=1)
        return np.asarray(lower) if info == 0 else None
    try:
        return np.asarray(np.linalg.cholesky(matrix))
    except np.linalg.LinAlgError:
        return None


def cholesky_solve_again(lower: Matrix, values: Matrix) -> Matrix:
    """Solve ``lower lower^T x = values``."""
    half = solve_triangular(lower, values, lower=True, check_finite=False)
    return np.asarray(solve_triangular(lower, half, lower=True, trans=1, check_finite=False))


def _holds_up_little(size: int) -> bool:
    """Whether LAPACK may be called through scipy here, with the interpreter's lock."""
    is_worker = threading.current_thread() is not threading.main_thread()
    return size <= HOLDS_UP_LITTLE or not is_worker


def _check_poles(factor: SourceFactor, penalty: float) -> tuple[Finding, ...]:
    """Refuse an OPYNSIM penalty on a pole, and report one that no longer smooths."""
    poles = factor.poles
    if not len(poles) or penalty <= 0.1 * poles[0]:
        return ()
    nearest = float(poles[np.argmin(np.abs(poles - penalty))])
    if abs(nearest - penalty) <= factor.smallest_mode:
        raise SingularSystemError(
            f"The warping penalty {penalty:.6g} lies on a pole of the OPYNSIM convention, where "
            "its equations have no solution: choose another penalty or the regularising convention."
        )
    return (Finding(FindingKind.POLE, (), nearest),)


def _conflicts(factor: SourceFactor, destination: Matrix, penalty: float) -> tuple[Finding, ...]:
    """Name the landmarks at one source place whose destinations cannot all be met."""
    if penalty > 0:
        return ()
    found = []
    for rows in factor.duplicates:
        apart = float(pdist(destination[list(rows)]).max())
        if apart > rounding_among(destination):
            found.append(Finding(FindingKind.CONFLICT, rows, apart))
    return tuple(found)


def identity(source: ArrayLike = ()) -> Spline:
    """Return the spline that leaves everything where it is."""
    source = np.asarray(source, dtype=np.float64).reshape(-1, 3)
    affine = np.vstack([np.zeros(3), np.eye(3)])
    return Spline(source, np.zeros_like(source), affine, 0.0, PenaltyConvention.REGULARISING)


__all__ = [
    "PenaltyConvention",
    "Spline",
    "check_convention",
    "check_penalty",
    "factorise",
    "identity",
    "solve",
]
