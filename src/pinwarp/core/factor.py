"""The source landmarks, factorised once for every destination and every penalty.

The saddle-point system of the thin-plate spline is solved in the space that its side conditions
leave free (numerics: Wahba, Spline Models for Observational Data, 1990, section 2.4). With the
centred and scaled source ``u``, ``P = [1, u] = Q R``, ``Q = [Q1 Q2]`` and ``K_ij = |u_i - u_j|``,
the matrix ``N = -Q2^T K Q2`` is symmetric and positive definite: ``|u_i - u_j|`` is conditionally
*negative* definite, hence the minus. With the basis ``r^2 log r``, whose K is conditionally
positive definite, ``N = Q2^T K Q2``. Its K in other units of length differs by a multiple of
``r^2``, which on those weights is nothing, and at any place the same constant.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import solve_triangular
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist

from pinwarp.core.basis import Basis
from pinwarp.core.errors import LandmarkCountError, PinwarpError
from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.householder import Reflections
from pinwarp.core.positions import as_positions

Matrix = NDArray[np.float64]

# A direction whose extent is below this share of the largest is not there at all ...
RANK_TOLERANCE = 1e-5
# ... and below this one the landmarks are called nearly planar.
PLANAR_TOLERANCE = 0.05
# Nor has any direction where all are so small.
TINIEST = 1e-290
# Nor squares of them that any digits are left of.
TINIEST_SQUARED = 1e-140
# Landmarks closer than this share of the median spacing are reported.
CLOSE_TOLERANCE = 1e-4


@dataclass(frozen=True, eq=False)
class SourceFactor:
    """What depends on the source landmarks alone; made by :func:`factorise`.

    Attributes
    ----------
    source : (n, 3) float64
        The landmarks, in mesh units.
    centre, scale
        Their mean, and their RMS distance from it: ``u = (source - centre) / scale``.
    directions : (r, 3)
        Orthonormal directions that the landmarks span; r = 3 in general position.
    findings
        What is noteworthy about them.
    duplicates
        The places where several landmarks lie: the rows of each, ascending.
    basis
        What the spline is built of.
    """

    source: Matrix
    centre: Matrix
    scale: float
    directions: Matrix
    findings: tuple[Finding, ...]
    duplicates: tuple[tuple[int, ...], ...]
    reflections: Reflections
    corner: Matrix
    coupling: Matrix
    bending: Matrix
    well_spaced: bool
    basis: Basis = Basis.R

    @property
    def strength(self) -> float:
        """What an eigenvalue of ``N`` is multiplied by in mesh units: a length, or its square."""
        return self.scale**self.basis.power

    @cached_property
    def in_basis_r(self) -> SourceFactor:
        """The same for the basis r, by which landmarks are judged whatever they warp with."""
        return self if self.basis is Basis.R else factorise(self.source)

    @property
    def rank(self) -> int:
        """How many directions the landmarks span: 0 a place, 1 a line, 2 a plane, 3 space."""
        return len(self.directions)

    @cached_property
    def modes(self) -> tuple[Matrix, Matrix]:
        """Eigenvalues of ``N`` in units of the penalty (ascending), its eigenvectors as columns."""
        values, vectors = np.linalg.eigh(self.bending)
        return values * self.strength, vectors

    @cached_property
    def modes_at_landmarks(self) -> Matrix:
        """What each mode is at the landmarks: ``Q2 Z`` (n, modes), orthonormal columns."""
        _, vectors = self.modes
        return self.rotate_back(np.vstack([np.zeros((self.rank + 1, len(vectors))), vectors]))

    @cached_property
    def place_of(self) -> NDArray[np.intp]:
        """The number of each landmark's place: those of duplicates are the same."""
        first = np.arange(len(self.source))
        for rows in self.duplicates:
            first[list(rows)] = rows[0]
        return np.asarray(np.unique(first, return_inverse=True)[1])

    @cached_property
    def places(self) -> SourceFactor:
        """The same with each place once."""
        rows = np.unique(self.place_of, return_index=True)[1]
        return factorise(self.source[rows], basis=self.basis)

    def certainty(self, penalties: Matrix) -> tuple[Matrix, Matrix]:
        """Return ``(stiffest + s) / (lambda + s)`` of every mode for (k,) penalties.

        Relative to the stiffest mode, so that it has a limit, 1, at an infinite penalty.

        Returns
        -------
        certainty : (modes, k)
            0 for the modes that the solve drops: what duplicate landmarks leave undetermined.
        noise : (k,)
            ``s / (stiffest + s)``.
        """
        values, _ = self.modes
        largest = self.stiffest_mode + penalties
        finite = np.isfinite(largest)
        noise = np.divide(penalties, largest, out=np.ones_like(largest), where=finite)
        shifts = values[:, None] + penalties
        certainty = np.zeros_like(shifts)
        np.divide(largest, shifts, out=certainty, where=finite & (shifts > self.smallest_mode))
        certainty[:, ~finite] = 1.0
        return certainty, noise

    @property
    def has_modes(self) -> bool:
        """Whether the eigendecomposition has been computed already."""
        return "modes" in self.__dict__

    @property
    def usable_modes(self) -> NDArray[np.bool_]:
        """Modes that are not the numerical null space left by duplicate landmarks."""
        return np.asarray(self.modes[0] > self.smallest_mode)

    @property
    def smallest_mode(self) -> float:
        """What an eigenvalue must exceed to be told from rounding."""
        return float(8 * len(self.source) * np.finfo(np.float64).eps * self.stiffest_mode)

    @property
    def stiffest_mode(self) -> float:
        """The largest eigenvalue, but no less than :attr:`strength`."""
        values, _ = self.modes
        # With duplicates alone left, the largest eigenvalue is rounding too: compare to the scale.
        return max(float(values[-1]) if len(values) else 0.0, self.strength)

    @property
    def poles(self) -> Matrix:
        """Penalties at which the OPYNSIM convention is singular, ascending, in mesh units."""
        return self.modes[0][self.usable_modes]

    def rotate(self, values: Matrix) -> Matrix:
        """Return ``Q^T values``."""
        return self.reflections.rotate(values)

    def rotate_back(self, values: Matrix) -> Matrix:
        """Return ``Q values``."""
        return self.reflections.rotate_back(values)

    def flexibility(self, penalty: float) -> float:
        """Return the share of non-affine freedom left: 1 interpolates, 0 is the affine fit.

        ``mean(lambda / (lambda + penalty))``, the effective degrees of freedom beyond the affine
        ones (Wahba 1990, eq. 4.3.1), of the regularising convention. NaN without any modes.
        """
        if not len(self.poles):
            return float("nan")
        return float(self._flexibilities(np.array([penalty]))[0])

    def _flexibilities(self, penalties: Matrix) -> Matrix:
        return np.asarray(np.mean(self.poles / (self.poles + penalties[:, None]), axis=1))

    def penalty_at(self, flexibility: float) -> float:
        """Return the penalty that leaves that much flexibility (inverse of :meth:`flexibility`).

        Parameters
        ----------
        flexibility
            From 0 (gives infinity) to 1 (gives 0).
        """
        values = self.poles
        if flexibility >= 1 or not len(values):
            return 0.0
        if flexibility <= 0:
            return float("inf")
        # In log(penalty) the curve is a smooth falling S: to cut it up never fails. In 64 parts,
        # since a slider asks at every move: numpy takes no longer for those than for two.
        low, high = np.log(values[0]) - 40.0, np.log(values[-1]) + 40.0
        for _ in range(10):
            tried = np.linspace(low, high, 65)
            left = self._flexibilities(np.exp(tried))
            reached = int(np.clip(np.searchsorted(-left, -flexibility), 1, 64))
            low, high = tried[reached - 1], tried[reached]
        return float(np.exp(0.5 * (low + high)))


def factorise(source: ArrayLike, *, planar: bool = False, basis: Basis = Basis.R) -> SourceFactor:
    """Factorise a set of source landmarks.

    Parameters
    ----------
    source
        (n, 3) positions in mesh units, n >= 1.
    planar
        Treat nearly planar landmarks as planar: the affine part is then free only within the
        plane and a similarity across it, which keeps the warp tame far from the landmarks. Only
        with the basis r: with the other the equations then lose their definiteness.
    basis
        What the spline is built of.

    Returns
    -------
    SourceFactor

    Raises
    ------
    LandmarkError
        When there are none, or a row cannot be used.
    PinwarpError
        When they are to be treated as planar with another basis than r.

    Examples
    --------
    >>> factorise([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]).rank
    3
    """
    check_planar(planar, basis)
    source = as_positions(source, "source landmark")
    if not len(source):
        raise LandmarkCountError("There are no landmark pairs: place at least one.")
    count = len(source)
    centre = source.mean(axis=0)
    offsets = source - centre
    extent = float(np.abs(offsets).max())
    # Dividing by the extent first keeps the squares of tiny coordinates from vanishing.
    scale = (
        extent * float(np.sqrt(np.mean(np.sum((offsets / extent) ** 2, axis=1)))) if extent else 0
    )
    tiniest = TINIEST if basis.power == 1 else TINIEST_SQUARED
    # What is next to nothing has no reciprocal: it is taken for nothing.
    at_one_place = scale <= max(1e-12 * float(np.abs(centre).max()), tiniest)
    if at_one_place:
        scale = 1.0
    unit = np.zeros_like(offsets) if at_one_place else offsets / scale
    _, extents, directions = np.linalg.svd(unit, full_matrices=False)
    tolerance = PLANAR_TOLERANCE if planar else RANK_TOLERANCE
    rank = 0 if at_one_place else int(np.sum(extents > tolerance * extents[0]))
    directions = directions[:rank]

    columns_of = np.column_stack([np.ones(count), unit @ directions.T])
    # Fewer landmarks than columns cannot happen: n centred landmarks span n - 1 directions.
    reflections = Reflections.of(columns_of)
    columns = rank + 1
    distances = cdist(unit, unit)
    np.fill_diagonal(distances, np.inf)
    findings, duplicates, well_spaced = _spacing(distances, scale, basis)
    np.fill_diagonal(distances, 0.0)
    # N and its neighbours are of K with the sign that makes N positive.
    projected = reflections.conjugate(basis.of(distances))
    if basis.sign < 0:
        np.negative(projected, out=projected)
    if rank == 3 and extents[2] < PLANAR_TOLERANCE * extents[0]:
        findings += (Finding(FindingKind.NEARLY_PLANAR, (), float(extents[2] / extents[0])),)
    return SourceFactor(
        source=source,
        centre=centre,
        scale=float(scale),
        directions=directions,
        findings=findings,
        duplicates=duplicates,
        reflections=reflections,
        corner=projected[:columns, :columns].copy(),
        coupling=projected[:columns, columns:].copy(),
        bending=projected[columns:, columns:],
        well_spaced=well_spaced,
        basis=basis,
    )


def check_planar(planar: bool, basis: Basis) -> None:
    """Refuse what cannot be: PinwarpError where planar landmarks meet another basis than r."""
    if planar and basis is not Basis.R:
        raise PinwarpError(
            "Landmarks can be treated as planar with the basis r only: choose it, or do not treat "
            "them as planar."
        )


def _spacing(
    distances: Matrix, scale: float, basis: Basis
) -> tuple[tuple[Finding, ...], tuple[tuple[int, ...], ...], bool]:
    """Find places where several landmarks lie, and places suspiciously close together."""
    count = len(distances)
    if count < 2:
        return (), (), True
    nearest = distances.min(axis=1)
    same, close = _thresholds(nearest, basis)
    if nearest.min() > close:
        return (), (), True
    duplicates = _clusters(distances <= same)
    # Of landmarks at one place the first speaks for all.
    others = [row for place in duplicates for row in place[1:]]
    near = np.asarray(distances <= close)
    near[others] = near[:, others] = False
    findings = tuple(
        Finding(FindingKind.CLOSE, rows, float(distances[np.ix_(rows, rows)].min() * scale))
        for rows in _clusters(near)
    )
    return findings, duplicates, False


def _thresholds(nearest: Matrix, basis: Basis = Basis.R) -> tuple[float, float]:
    """Return up to which distance landmarks lie at one place, and up to which suspiciously close.

    From the distance of each to the nearest, in units of their RMS radius.
    """
    count = len(nearest)
    # The largest eigenvalue is at most n times the largest distance (about 6 in these units).
    same = float(8 * count * np.finfo(np.float64).eps * count) ** (1 / basis.power)
    return same, max(CLOSE_TOLERANCE * float(np.median(nearest)), same)


def is_well_spaced(unit: Matrix) -> bool:
    """Whether no two of (n, 3) places lie suspiciously close, in units of their RMS radius."""
    if len(unit) < 2:
        return True
    nearest = np.asarray(KDTree(unit).query(unit, k=2)[0])[:, 1]
    return bool(nearest.min() > _thresholds(nearest)[1])


def _clusters(near: NDArray[np.bool_]) -> tuple[tuple[int, ...], ...]:
    """Return the rows that hang together in a symmetric (n, n) relation; none stands alone."""
    found = []
    left = np.asarray(near.any(axis=1))
    while left.any():
        rows = last = np.flatnonzero(left)[:1]
        left[last] = False
        # Every row is looked at once: a thousand at one place are no more work than in a chain.
        while len(last):
            last = np.flatnonzero(near[last].any(axis=0) & left)
            left[last] = False
            rows = np.concatenate([rows, last])
        found.append(tuple(sorted(rows.tolist())))
    return tuple(found)


def affine_coordinates(factor: SourceFactor, points: Matrix) -> Matrix:
    """Return ``R^-T p_v`` for (m, 3) points as (m, r + 1), ``p_v`` their row of ``P``.

    Its square length is the leverage of the affine fit at the point.
    """
    spanned = (points - factor.centre) @ (factor.directions.T / factor.scale)
    rows = np.column_stack([np.ones(len(points)), spanned])
    solved = solve_triangular(factor.reflections.upper, rows.T, trans=1, check_finite=False)
    return np.asarray(solved.T)


def solve_upper(factor: SourceFactor, values: Matrix) -> Matrix:
    """Return ``R^-1 values``, the affine part from the top block."""
    # Four by four at most: numpy is done before scipy has looked at its arguments.
    return np.asarray(np.linalg.solve(factor.reflections.upper, values), dtype=np.float64)
