"""Positions as they come from outside: taken when they are numbers, refused in words if not."""

from __future__ import annotations

import numbers
from collections.abc import Sequence
from decimal import Decimal
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.errors import LandmarkError, LandmarkTypeError, RangeError

Matrix = NDArray[np.float64]

# Squares of larger coordinates overflow.
LARGEST_COORDINATE = 1e150

# For functions whose figures are looked at, and refused in words: overflow on the way is no news.
quiet = np.errstate(over="ignore", invalid="ignore", divide="ignore")

# What arrays of other kinds hold, by numpy's letter.
_NO_NUMBERS = {
    "b": "true or false",
    "c": "complex numbers, which have no place in space",
    "S": "text",
    "U": "text",
    "T": "text",
    "M": "dates",
    "m": "durations",
    "V": "records with named fields: give their columns as one plain table",
}


def as_positions(values: ArrayLike, what: str, *, fresh: bool = True) -> Matrix:
    """Return positions as an (n, 3) float64 array of usable coordinates.

    Parameters
    ----------
    values
        (n, 3) integers or floats of any kind: lists, arrays, data frames.
    what
        What a row is called in a message, such as ``"source landmark"``.
    fresh
        Whether it must be a copy; otherwise an array that is right already is returned itself.

    Raises
    ------
    LandmarkError
        When the shape is another or a row cannot be used (masked, not finite, or so large that
        its square overflows); the message names the row.
    LandmarkTypeError
        When they are no real numbers.

    Examples
    --------
    >>> as_positions([[1, 2, 3]], "point").tolist()
    [[1.0, 2.0, 3.0]]
    >>> hidden = np.ma.array([[1, 2, 3], [4, 5, 6]], mask=[[0, 0, 0], [0, 1, 0]])
    >>> as_positions(hidden, "point")
    Traceback (most recent call last):
    pinwarp.core.errors.LandmarkError: The point in row 1 is masked: leave it out or unmask it.
    """
    array = as_numbers(values, what, fresh=fresh)
    if array.shape == (0,):
        # An empty list has no columns to count.
        return array.reshape(0, 3)
    if array.ndim != 2 or array.shape[1] != 3:
        raise LandmarkTypeError(
            f"The {_several(what)} have the shape {array.shape} instead of (n, 3)."
        )
    if not all_usable(array):
        row = first_row(~(np.abs(array) <= LARGEST_COORDINATE))
        x, y, z = array[row].tolist()
        raise LandmarkError(f"The {what} in row {row} is not usable: ({x}, {y}, {z}).")
    return array


def as_numbers(values: ArrayLike, what: str, *, fresh: bool = True) -> Matrix:
    """Return integers or floats of any shape as float64; see :func:`as_positions`."""
    if type(values) is not np.ndarray or values.dtype.kind not in "fiu":
        values = _plain(values, what)
    # A long double beyond the doubles becomes infinite, which the caller refuses.
    with np.errstate(over="ignore"):
        if fresh:
            return np.array(values, dtype=np.float64, order="C")
        return np.ascontiguousarray(values, dtype=np.float64)


def in_range(warped: Matrix, points: Matrix) -> Matrix:
    """Return warped points; RangeError where one is so far away that its square overflows.

    Parameters
    ----------
    warped
        (m, 3) where the points went.
    points
        (m, 3) where they came from, to say it.
    """
    if not all_usable(warped):
        x, y, z = points[first_row(~(np.abs(warped) <= LARGEST_COORDINATE))].tolist()
        raise RangeError(
            f"The warp leaves the range of numbers at ({x:.6g}, {y:.6g}, {z:.6g}): check the unit, "
            "and the landmarks for one that is far from all others."
        )
    return warped


def all_usable(array: Matrix) -> bool:
    """Whether every coordinate is finite and has a square."""
    # NaN is the minimum of all that hold one, and compares as false.
    return not array.size or bool(
        array.min() >= -LARGEST_COORDINATE and array.max() <= LARGEST_COORDINATE
    )


def first_row(wrong: NDArray[np.bool_]) -> int:
    """Return the first row in which anything is wrong.

    Examples
    --------
    >>> first_row(np.array([[False, False], [False, True]]))
    1
    """
    return int(np.flatnonzero(wrong.reshape(len(wrong), -1).any(axis=1))[0])


def _several(what: str) -> str:
    return "vertices" if what == "vertex" else f"{what}s"


def _plain(values: Any, what: str) -> NDArray[Any]:
    """Return an array of numbers; LandmarkError where anything else is among them."""
    _refuse_masked(values, what)
    if isinstance(values, Sequence) and not isinstance(values, str | bytes):
        _refuse_ragged(values, what)
    try:
        array = np.asarray(values)
    except (TypeError, ValueError, OverflowError) as error:
        raise LandmarkTypeError(
            f"The {_several(what)} are not a table of numbers: {error}"
        ) from error
    if array.dtype.kind == "O":
        return _numbers_among_objects(array, values, what)
    if array.dtype.kind in _NO_NUMBERS:
        kind = _NO_NUMBERS[array.dtype.kind]
        raise LandmarkTypeError(
            f"The {_several(what)} are not a table of numbers: they are {kind}."
        )
    return array


def _refuse_masked(values: Any, what: str) -> None:
    """Refuse values that are hidden: numpy would take what lies below the mask."""
    rows: Any
    if isinstance(values, np.ma.MaskedArray):
        rows = values if values.ndim and _is_masked(values) else [values]
    else:
        rows = values if isinstance(values, list | tuple) else ()
    for number, row in enumerate(rows):
        if any(_is_masked(part) for part in (row if isinstance(row, list | tuple) else (row,))):
            raise LandmarkError(f"The {what} in row {number} is masked: leave it out or unmask it.")


def _is_masked(values: object) -> bool:
    # The mask of records is one of records, too: they are refused for what they are.
    return (
        isinstance(values, np.ma.MaskedArray)
        and values.dtype.names is None
        and bool(np.ma.is_masked(values))
    )


def _refuse_ragged(rows: Sequence[Any], what: str) -> None:
    """Name the first row that is not as long as the others should be."""
    for number, row in enumerate(rows):
        if isinstance(row, Sequence) and not isinstance(row, str | bytes) and len(row) != 3:
            lengths = {len(other) for other in rows if isinstance(other, Sequence)}
            if len(lengths) > 1:
                raise LandmarkTypeError(
                    f"The {_several(what)} are not a table of numbers: row {number} has {len(row)} "
                    "instead of 3."
                )


def _numbers_among_objects(array: NDArray[Any], values: Any, what: str) -> NDArray[Any]:
    if array.ndim == 0:
        raise LandmarkTypeError(
            f"The {_several(what)} are not a table of numbers but one {type(values).__name__}."
        )
    for place, value in np.ndenumerate(array):
        if is_real_number(value):
            continue
        shown = repr(value) if len(repr(value)) < 40 else type(value).__name__
        raise LandmarkTypeError(
            f"The {_several(what)} are not a table of numbers: row {place[0]} holds {shown}."
        )
    # An integer beyond the doubles is as infinite to them.
    return np.array([_as_float(value) for value in array.flat]).reshape(array.shape)


def is_real_number(value: object) -> TypeGuard[float]:
    """Whether something is one real number: 2, 0.5, ``numpy.float32(0.5)``, a fraction, a decimal.

    Truth values count as none, nor does text that could be read as a number.

    Examples
    --------
    >>> [is_real_number(value) for value in (2, np.float32(0.5), True, "2", 1j, None)]
    [True, True, False, False, False, False]
    """
    return isinstance(value, numbers.Real | Decimal) and not isinstance(value, bool | np.bool_)


def _as_float(value: Any) -> float:
    try:
        return float(value)
    except OverflowError:
        return float("inf") if value > 0 else float("-inf")
