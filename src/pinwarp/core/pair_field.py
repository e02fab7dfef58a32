"""The pairs as a random field over the source: how rough it may be, and how noisy.

A spline interpolates as if the warp were a field of generalised covariance ``-|h|`` (Wahba,
Spline Models for Observational Data, 1990, section 2.4). Bones bend more smoothly than that;
``|h|^3`` has the same affine maps for its null space and stands for fields that are smooth.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist

from pinwarp.core.factor import SourceFactor

Matrix = NDArray[np.float64]

# Noise levels tried: nearly none, then evenly on a logarithmic scale between these multiples of
# the median and of the largest mode.
LEVELS = 14
NO_NOISE, LEAST_NOISE, MOST_NOISE = 1e-4, 0.02, 20.0
# A mode below this share of the median one is no softer than that.
SOFTEST = 1e-9
# So many neighbours are looked at, at most such a part of the set, and two more in place of some
# that are left out.
NEIGHBOURS, PART = 6, 8
SPARE = 2


class Roughness(Enum):
    """How rough a field is: the power of the distance in its generalised covariance."""

    SPLINE = 1
    SMOOTH = 3


@dataclass(frozen=True, eq=False)
class PairField:
    """What depends on the source landmarks alone.

    Attributes
    ----------
    modes : (n, m) float64
        The field's modes at the landmarks, orthonormal columns.
    noise : (k,)
        The noise levels, as variances in units of the field's.
    certainty : (k, m)
        ``1 / (lambda + noise)``.
    precision : (k, n)
        The diagonal of ``G = modes certainty modes'``.
    log_det : (k,)
        Minus the logarithm of the determinant of the field's variance.
    near : (n, k)
        The nearest other landmarks of each, the nearest first.
    """

    modes: Matrix
    noise: Matrix
    certainty: Matrix
    precision: Matrix
    log_det: Matrix
    near: NDArray[np.intp]

    @classmethod
    def of(cls, factor: SourceFactor, roughness: Roughness = Roughness.SPLINE) -> PairField:
        """Prepare a field for any destination.

        Parameters
        ----------
        factor
            The source landmarks, from :func:`~pinwarp.core.factor.factorise`; two or more, of
            which some determine more than an affine map.
        roughness
            The spline's own field, whose modes are known already, or a smooth one.

        Examples
        --------
        >>> from pinwarp.core.factor import factorise
        >>> source = np.random.default_rng(0).normal(size=(12, 3))
        >>> PairField.of(factorise(source)).modes.shape
        (12, 8)
        """
        values, modes = _modes(factor, roughness)
        middle, top = float(np.median(values)), float(values[-1])
        values = np.maximum(values, SOFTEST * middle)
        steps = np.geomspace(LEAST_NOISE * middle, MOST_NOISE * top, LEVELS - 1)
        noise = np.concatenate([[NO_NOISE * middle], steps])
        certainty = 1.0 / (values + noise[:, None])
        count = min(NEIGHBOURS + SPARE, len(factor.source) - 1)
        # Rows are taken again and again.
        modes = np.ascontiguousarray(modes)
        return cls(
            modes=modes,
            noise=noise,
            certainty=certainty,
            precision=certainty @ (modes * modes).T,
            log_det=np.log(certainty).sum(axis=1),
            near=_nearest(factor.source, count),
        )

    @property
    def neighbours(self) -> int:
        """How many make a neighbourhood."""
        return int(np.clip(len(self.modes) // PART, 1, NEIGHBOURS))

    def column(self, row: int) -> Matrix:
        """Return a column of ``G`` at every noise level, (k, n)."""
        if row not in self._columns:
            self._columns[row] = (self.certainty * self.modes[row]) @ self.modes.T
        return self._columns[row]

    @cached_property
    def _columns(self) -> dict[int, Matrix]:
        return {}

    def block(self, levels: slice, rows: list[int]) -> Matrix:
        """Return ``G`` between some landmarks at some noise levels, (levels, rows, rows)."""
        modes = self.modes[rows]
        weighed = modes * self.certainty[levels, None]
        # One product for all levels.
        found = weighed.reshape(-1, modes.shape[1]) @ modes.T
        return np.asarray(found.reshape(-1, len(rows), len(rows)))

    def near_entries(self, level: int) -> Matrix:
        """Return ``G`` between each landmark and its neighbours at a noise level.

        (n, :attr:`neighbours` + 1): of one more than needed another may be left out.
        """
        if level not in self._near_entries:
            # All of G takes less time than what is needed of it: a product with its own transpose.
            root = self.modes * np.sqrt(self.certainty[level])
            near = self.near[:, : self.neighbours + 1]
            self._near_entries[level] = np.take_along_axis(root @ root.T, near, axis=1)
        return self._near_entries[level]

    @cached_property
    def _near_entries(self) -> dict[int, Matrix]:
        return {}


def _modes(factor: SourceFactor, roughness: Roughness) -> tuple[Matrix, Matrix]:
    """Return the eigenvalues of the field's variance, ascending, and its modes at the landmarks."""
    if roughness is Roughness.SPLINE:
        usable = factor.usable_modes
        return factor.modes[0][usable], factor.modes_at_landmarks[:, usable]
    unit = (factor.source - factor.centre) / factor.scale
    fixed = factor.rank + 1
    apart = cdist(unit, unit)
    # A square and a product take a tenth of the time of a cube.
    kernel = apart ** (roughness.value - 1) * apart
    variance = factor.reflections.conjugate(kernel)[fixed:, fixed:]
    values, vectors = np.linalg.eigh(variance)
    # What duplicate landmarks leave undetermined.
    usable = values > 8 * len(unit) * np.finfo(np.float64).eps * max(float(values[-1]), 1.0)
    modes = factor.rotate_back(np.vstack([np.zeros((fixed, len(vectors))), vectors]))
    return values[usable], modes[:, usable]


def _nearest(places: Matrix, count: int) -> NDArray[np.intp]:
    """Return the nearest other rows of each row, the nearest first."""
    rows = np.asarray(KDTree(places).query(places, k=count + 1)[1])
    # Of several at one place a landmark need not be its own first.
    own = rows == np.arange(len(places))[:, None]
    own[~own.any(axis=1), -1] = True
    return np.asarray(rows[~own].reshape(len(places), count))
