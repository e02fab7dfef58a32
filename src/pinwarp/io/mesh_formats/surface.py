"""What every mesh file comes down to: points, and polygons over them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Report = Callable[[float], None]
"""Told the share that is done, 0 ... 1; may raise to cancel."""


class BrokenMeshError(Exception):
    """What is wrong with the bytes; :mod:`pinwarp.io.meshes` adds the file's name."""

    def __init__(self, reason: str, line: int | None = None) -> None:
        super().__init__(reason)
        self.line = line


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface as stored: polygons of any size, loose points, lines left out.

    Parameters
    ----------
    points
        (n, 3) positions in the order of the file.
    corners
        The vertex numbers of all polygons, one polygon after the other.
    sizes
        How many corners each polygon has.
    notes
        What was left out, as sentences for the user.
    """

    points: NDArray[np.float64]
    corners: NDArray[np.int64]
    sizes: NDArray[np.int64]
    notes: tuple[str, ...] = ()


def are_few(broken: int, all_of_them: int) -> bool:
    """Whether so few are broken that the rest is still the mesh: one of a hundred.

    Examples
    --------
    >>> are_few(1, 7000), are_few(1, 4)
    (True, False)
    """
    return 100 * broken <= all_of_them


def merge_equal(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Merge points at exactly the same place, keeping the order of their first occurrence.

    Parameters
    ----------
    points
        (n, 3) positions, all finite.

    Returns
    -------
    merged
        (m, 3) positions, each there once.
    numbers
        For every row of ``points`` its row in ``merged``.

    Examples
    --------
    >>> merged, numbers = merge_equal(np.array([[2.0, 0, 0], [1, 0, 0], [2, 0, 0]]))
    >>> merged[:, 0].tolist(), numbers.tolist()
    ([2.0, 1.0], [0, 1, 0])
    """
    # lexsort is stable: within a run of equal points the first occurrence comes first.
    order = np.lexsort((points[:, 2], points[:, 1], points[:, 0]))
    ranked = points[order]
    starts = np.ones(len(points), dtype=bool)
    starts[1:] = (ranked[1:] != ranked[:-1]).any(axis=1)
    first = order[starts]
    by_occurrence = np.argsort(first)
    renumber = np.empty(len(first), dtype=np.int64)
    renumber[by_occurrence] = np.arange(len(first))
    numbers = np.empty(len(points), dtype=np.int64)
    numbers[order] = renumber[np.cumsum(starts) - 1]
    return points[first[by_occurrence]], numbers


def cut_strips(corners: NDArray[np.int64], sizes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cut triangle strips into their triangles, all turned the same way.

    Parameters
    ----------
    corners
        The vertex numbers of all strips in a row.
    sizes
        How many belong to each strip.

    Returns
    -------
    ndarray
        (t, 3) vertex numbers.

    Examples
    --------
    >>> cut_strips(np.array([7, 8, 9, 10]), np.array([4])).tolist()
    [[7, 8, 9], [10, 9, 8]]
    """
    counts = np.maximum(sizes - 2, 0)
    strip_starts = np.repeat(np.cumsum(sizes) - sizes, counts)
    step = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    first = strip_starts + step
    # Every second triangle runs the other way round.
    odd = step % 2
    order = np.column_stack([first + 2 * odd, first + 1, first + 2 - 2 * odd])
    triangles: NDArray[np.int64] = corners[order].reshape(-1, 3)
    return triangles
