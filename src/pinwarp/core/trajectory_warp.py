"""Carrying a place that depends on a coordinate: all of its way, not only where it is now."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.coordinate_function import (
    CoordinateFunction,
    FunctionKind,
    union_of_knots,
)
from pinwarp.core.local_affine import Warp

Matrix = NDArray[np.float64]

CLOSE_ENOUGH = 2e-5
"""Metres between the functions' way and the warped one; knots are added until it is reached."""
_ROUNDS = 4
# Looked at in each interval, as shares of it.
_BETWEEN = np.array([0.25, 0.5, 0.75])


class NotCarried(Exception):
    """Why a way cannot be carried, as a clause."""


@dataclass(frozen=True, eq=False)
class CarriedWay:
    """A way that was carried.

    Attributes
    ----------
    functions
        One for each axis.
    coordinate
        What they depend on; empty where nothing moves.
    knots : (k,) float64
        Where the way was carried.
    before, after : (k, 3) float64
        The way at the knots, along x, y and z of its frame.
    misfit : float
        How far it is at most from the warped way between the knots.
    """

    functions: tuple[CoordinateFunction, ...]
    coordinate: str
    knots: Matrix
    before: Matrix
    after: Matrix
    misfit: float


def carried_way(
    warp: Warp,
    axes: Matrix,
    functions: tuple[CoordinateFunction, ...],
    coordinates: tuple[str, ...],
) -> CarriedWay:
    """Carry the way of a place that functions move along axes.

    The way is warped at the knots of all functions together, solved back into the axes, and
    given further knots where it would leave the warped way in between.

    Parameters
    ----------
    warp
        Takes (m, 3) places of the frame that the way is in.
    axes
        (3, 3) whose columns are the directions.
    functions, coordinates
        One for each axis; a function of several coordinates has their names between blanks.

    Raises
    ------
    NotCarried
        When the functions depend on several coordinates, are of several kinds, or the axes do
        not span space.

    Examples
    --------
    >>> still = CoordinateFunction(FunctionKind.CONSTANT, [], [0.0])
    >>> bent = CoordinateFunction(FunctionKind.SPLINE, [0, 1, 2], [0, 0.1, 0])
    >>> way = carried_way(lambda x: 2 * x, np.eye(3), (bent, still, still), ("knee", "", ""))
    >>> way.functions[0].values.tolist(), way.functions[1].kind.value, way.coordinate
    ([0.0, 0.2, 0.0], 'Constant', 'knee')
    """
    lengths = np.linalg.norm(axes, axis=0)
    if not (lengths > 0).all() or abs(np.linalg.det(axes / lengths)) < 1e-6:
        raise NotCarried("its axes do not span space")
    varying = [i for i in range(3) if not functions[i].is_constant]
    used = {coordinates[i] for i in varying}
    kinds = {functions[i].kind for i in varying}
    names = sorted({name for words in used for name in words.split()})
    if len(names) > 1:
        raise NotCarried(f"it depends on {' and '.join(names)}")
    if len(kinds) > 1:
        raise NotCarried("its functions are of several kinds")

    def way(where: Matrix) -> Matrix:
        return np.array([function(where) for function in functions]).T @ axes.T

    if not varying:
        before = way(np.zeros(1))
        after = warp(before)
        values = np.linalg.solve(axes, after.T)
        made = tuple(
            CoordinateFunction(f.kind, f.knots, np.full(f.values.shape, value[0]))
            for f, value in zip(functions, values, strict=True)
        )
        return CarriedWay(made, "", np.empty(0), before, after, 0.0)
    kind, coordinate = kinds.pop(), used.pop()
    knots = union_of_knots(list(functions))
    for left in reversed(range(_ROUNDS)):
        before = way(knots)
        after = warp(before)
        made = tuple(
            CoordinateFunction(kind, knots, value) for value in np.linalg.solve(axes, after.T)
        )
        between = knots[:-1, None] + np.diff(knots)[:, None] * _BETWEEN
        reached = np.array([function(between.ravel()) for function in made]).T @ axes.T
        apart = np.linalg.norm(reached - warp(way(between.ravel())), axis=1)
        apart = apart.reshape(between.shape).max(axis=1, initial=0.0)
        wide = apart > CLOSE_ENOUGH
        if not left or not wide.any():
            break
        knots = np.sort(np.concatenate([knots, between[wide, 1]]))
    return CarriedWay(
        tuple(_as_plain_as(old, new) for old, new in zip(functions, made, strict=True)),
        coordinate,
        knots,
        before,
        after,
        float(apart.max(initial=0.0)),
    )


def _as_plain_as(old: CoordinateFunction, new: CoordinateFunction) -> CoordinateFunction:
    """Return a constant where there was one and it still is."""
    if old.kind is FunctionKind.CONSTANT and new.is_constant:
        return CoordinateFunction(FunctionKind.CONSTANT, [], new.values[:1])
    return new
