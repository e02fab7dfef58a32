"""Functions of a coordinate, as OpenSim's joints and moving points have them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import solve_banded

Matrix = NDArray[np.float64]


class FunctionKind(StrEnum):
    """What a function is between its knots.

    Examples
    --------
    >>> FunctionKind("SimmSpline").name
    'SPLINE'
    """

    SPLINE = "SimmSpline"
    LINEAR = "PiecewiseLinearFunction"
    CONSTANT = "Constant"


@dataclass(frozen=True, eq=False)
class CoordinateFunction:
    """A function by its knots; one of OpenSim's ``MultiplierFunction`` is already multiplied.

    Parameters
    ----------
    kind
        How it runs between the knots.
    knots
        (k,) increasing; none for a constant.
    values
        (k,) at the knots; (1,) for a constant.

    Examples
    --------
    >>> spline = CoordinateFunction(FunctionKind.SPLINE, [0, 1, 2], [0, 1, 0])
    >>> spline([0.5, 1, 4]).tolist()
    [0.75, 1.0, -4.0]
    """

    kind: FunctionKind
    knots: Matrix
    values: Matrix

    def __init__(self, kind: FunctionKind, knots: ArrayLike, values: ArrayLike) -> None:
        knots = np.array(knots, dtype=np.float64).ravel()
        values = np.array(values, dtype=np.float64).ravel()
        needed = 1 if kind is FunctionKind.CONSTANT else len(knots)
        if kind is not FunctionKind.CONSTANT and not len(knots):
            raise ValueError("it has no knots")
        if len(values) != needed:
            raise ValueError(f"it has {len(values)} values instead of {needed}")
        if not (np.isfinite(knots).all() and np.isfinite(values).all()):
            raise ValueError("it has a number that is not finite")
        if (np.diff(knots) <= 0).any():
            raise ValueError("its knots do not increase")
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "knots", knots)
        object.__setattr__(self, "values", values)

    @property
    def is_constant(self) -> bool:
        """Whether it has one value everywhere."""
        return bool((self.values == self.values[0]).all())

    def __call__(self, where: ArrayLike) -> Matrix:
        """Return its values, also beyond the knots, in the shape of ``where``."""
        where = np.asarray(where, dtype=np.float64)
        if self.is_constant:
            return np.full(where.shape, self.values[0])
        if self.kind is FunctionKind.LINEAR:
            slopes = np.diff(self.values) / np.diff(self.knots)
            index = np.clip(np.searchsorted(self.knots, where) - 1, 0, len(slopes) - 1)
            return np.asarray(self.values[index] + slopes[index] * (where - self.knots[index]))
        return _simm_spline(self.knots, self.values, where)


def _simm_spline(x: Matrix, y: Matrix, where: Matrix) -> Matrix:
    """Evaluate the cubic spline of Forsythe, Malcolm and Moler (1977, section 4.4).

    OpenSim's ``SimmSpline``: at either end the third derivative is that of the cubic through
    four knots, three knots have none there, and beyond the ends it goes on straight.
    """
    width, slope = np.diff(x), np.diff(y) / np.diff(x)
    count = len(x)
    diagonal = np.empty(count)
    diagonal[0], diagonal[-1] = -width[0], -width[-1]
    diagonal[1:-1] = 2 * (width[:-1] + width[1:])
    right = np.zeros(count)
    right[1:-1] = np.diff(slope)
    if count > 3:
        second = np.diff(slope) / (x[2:] - x[:-2])
        right[0] = (second[1] - second[0]) / (x[3] - x[0]) * width[0] ** 2
        right[-1] = -(second[-1] - second[-2]) / (x[-1] - x[-4]) * width[-1] ** 2
    if count == 2:
        sixth = np.zeros(2)
    else:
        bands = np.zeros((3, count))
        bands[0, 1:], bands[1], bands[2, :-1] = width, diagonal, width
        # Sixths of the second derivatives at the knots.
        sixth = solve_banded((1, 1), bands, right)
    index = np.clip(np.searchsorted(x, where, side="right") - 1, 0, count - 2)
    h = width[index]
    inside = np.clip(where, x[0], x[-1])
    t = (inside - x[index]) / h
    left, after = sixth[index], sixth[index + 1]
    within = (1 - t) * y[index] + t * y[index + 1]
    within = within - h**2 * t * (1 - t) * ((2 - t) * left + (1 + t) * after)
    first = slope[0] - width[0] * (2 * sixth[0] + sixth[1])
    last = slope[-1] + width[-1] * (sixth[-2] + 2 * sixth[-1])
    beyond = np.where(where < x[0], first * (where - x[0]), 0.0)
    return np.asarray(within + beyond + np.where(where > x[-1], last * (where - x[-1]), 0.0))


def union_of_knots(functions: list[CoordinateFunction]) -> Matrix:
    """Return the knots of all functions that vary, each once and increasing.

    Examples
    --------
    >>> linear = CoordinateFunction(FunctionKind.LINEAR, [0, 2], [0, 1])
    >>> union_of_knots([linear, CoordinateFunction(FunctionKind.CONSTANT, [], [3])]).tolist()
    [0.0, 2.0]
    """
    knots = [each.knots for each in functions if not each.is_constant]
    return np.unique(np.concatenate(knots)) if knots else np.empty(0)
