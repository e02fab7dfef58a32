"""A regular lattice through a bone, to be warped with it: D'Arcy Thompson's picture of a change.

Warped by the spline, the straight lines show how the space between the landmarks is bent
(Thompson, On Growth and Form, 1917; Bookstein, IEEE PAMI 11, 1989).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.mirror import AXES

Matrix = NDArray[np.float64]

# The lattice is larger than the box by this share.
GROWN = 0.05
# More lines than these hide one another.
READABLE = 250
# Straight pieces of a line per cell, so that it looks smooth when it is bent.
PIECES = 8


def box_lattice(low: ArrayLike, high: ArrayLike, cells: int = 12) -> Matrix:
    """Return the lines of a lattice around a box, of cells as near to cubes as fit.

    Parameters
    ----------
    low, high
        (3,) corners of the box, such as a mesh's bounds, in its frame and unit. The lattice
        is 5 % larger and has the same middle.
    cells
        How many cells fill the longest side, at least 1; fewer are made where the lattice would
        have more lines than can be told apart.

    Returns
    -------
    (lines, samples, 3) float64
        Straight lines, first those along x, then y, then z; a spline takes ``reshape(-1, 3)``.
        A flat box has the lines of a plane, a single place has none.

    Raises
    ------
    ValueError
        When there are no cells, or the corners are not finite or not in order.

    Examples
    --------
    >>> box_lattice([0, 0, 0], [30, 10, 10], cells=6).shape
    (51, 49, 3)
    """
    middle, extent = _box(low, high, cells)
    counts = _counts(extent, cells)
    while cells > 1 and _line_count(counts) > READABLE:
        cells -= 1
        counts = _counts(extent, cells)
    return _lattice(middle, extent, counts)


def plane_lattice(
    low: ArrayLike, high: ArrayLike, axis: str, share: float = 0.5, cells: int = 20
) -> Matrix:
    """Return the lines of a lattice in one plane across a box, of cells as near to squares as fit.

    Parameters
    ----------
    low, high
        As for :func:`box_lattice`.
    axis
        ``"x"``, ``"y"`` or ``"z"``, the axis across the plane.
    share
        Where the plane crosses that axis: 0 at the low side of the box, 1 at the high side.
    cells
        How many cells fill the plane's longest side, at least 1.

    Returns
    -------
    (lines, samples, 3) float64
        Straight lines, those along the first of the other two axes first.

    Raises
    ------
    ValueError
        As for :func:`box_lattice`; also for another axis.

    Examples
    --------
    >>> plane = plane_lattice([0, 0, 0], [30, 10, 8], "z", share=0.25, cells=6)
    >>> plane.shape, np.unique(plane[:, :, 2]).tolist()
    ((10, 49, 3), [2.0])
    """
    middle, extent = _box(low, high, cells)
    across = AXES.index(axis)
    middle[across] += (share - 0.5) * extent[across]
    extent[across] = 0.0
    return _lattice(middle, extent, _counts(extent, cells))


def _box(low: ArrayLike, high: ArrayLike, cells: int) -> tuple[Matrix, Matrix]:
    """Return the middle and the extent of a box."""
    first, last = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    extent = last - first
    if cells < 1:
        raise ValueError(f"A lattice of {cells} cells has no lines.")
    if not np.isfinite(extent).all() or (extent < 0).any():
        raise ValueError(f"{first.tolist()} to {last.tolist()} is no box.")
    return first + extent / 2, extent


def _counts(extent: Matrix, cells: int) -> tuple[int, ...]:
    """Return how many cells lie along each axis; none where the box is flat."""
    side = float(extent.max()) / cells
    return tuple(max(1, round(length / side)) if length else 0 for length in extent.tolist())


def _line_count(counts: tuple[int, ...]) -> int:
    x, y, z = (count + 1 for count in counts)
    return x * y + y * z + z * x


def _lattice(middle: Matrix, extent: Matrix, counts: tuple[int, ...]) -> Matrix:
    """Return the lines of a lattice around a middle, along each axis that has an extent."""
    ends = (1 + GROWN) / 2 * extent
    samples = PIECES * max(counts) + 1
    steps = [np.linspace(-end, end, count + 1) for end, count in zip(ends, counts, strict=True)]
    parts = [np.empty((0, samples, 3))]
    for along in np.flatnonzero(extent).tolist():
        # At every crossing with the other two axes, from one end to the other.
        axes = list(steps)
        axes[along] = np.linspace(-ends[along], ends[along], samples)
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        parts.append(np.moveaxis(grid, along, 2).reshape(-1, samples, 3))
    return np.concatenate(parts) + middle
