"""The pairs as a random field over the source: how rough it may be, and how noisy.

A spline interpolates as if the warp were a field of generalised covariance ``-|h|`` (Wahba,
Spline Models for Observational Data, 1990, section 2.4). Bones bend more smoothly than that;
``|h|^3`` has the same affine maps for its null space and stands for fields that are smooth.
"""

from __future__ import annotations

from collections.abc import Sequence
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
    certainty : (m, k)
        ``1 / (lambda + noise)``.
    precision : (n, k)
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
        certainty = 1.0 / (values[:, None] + noise)
        count = min(NEIGHBOURS + SPARE, len(factor.source) - 1)
        # Rows are taken again and again.
        modes = np.ascontiguousarray(modes)
        return cls(
            modes=modes,
            noise=noise,
            certainty=certainty,
            precision=(modes * modes) @ certainty,
            log_det=np.sum(np.log(certainty), axis=0),
            near=_nearest(factor.source, count),
        )

    @property
    def neighbours(self) -> int:
        """How many make a neighbourhood."""
        return int(np.clip(len(self.modes) // PART, 1, NEIGHBOURS))

    def entries(
        self, level: int | slice, rows: Sequence[int], of: Sequence[int] | None = None
    ) -> Matrix:
        """Return the columns of ``G`` of some landmarks, of all rows or some.

        At a noise level, or at some of them: (..., of, rows).
        """
        modes = self.modes if of is None else self.modes[list(of)]
        certainty = np.ascontiguousarray(self.certainty.T[level])
        weighed = self.modes[list(rows)] * certainty[..., None, :]
        # One product for all levels.
        found = modes @ weighed.reshape(-1, modes.shape[1]).T
        shape = (len(modes), *certainty.shape[:-1], len(rows))
        return np.asarray(np.moveaxis(found.reshape(shape), 0, -2))

    @cached_property
    def near_entries(self) -> Matrix:
        """``G`` between each landmark and its neighbours at every noise level.

        (levels, n, :attr:`neighbours` + 1): of one more than needed another may be left out.
        """
        nearest = self.near.T[: self.neighbours + 1]
        columns = [(self.modes * self.modes[rows]) @ self.certainty for rows in nearest]
        return np.ascontiguousarray(np.stack(columns).transpose(2, 1, 0))


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
