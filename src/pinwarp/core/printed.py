"""Coefficients as other programs print them: in rows or columns, the constant first or last."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.errors import LandmarkTypeError, PinwarpError
from pinwarp.core.positions import as_numbers, as_positions

Matrix = NDArray[np.float64]
Layout = Literal["rows", "columns"]
Constant = Literal["first", "last"]

# With four digits printed, a spline's weights balance to so much.
DIGITS = 1e-3
UNBALANCED = (
    "The weights do not balance (sum w_i and sum w_i u_i are not 0), as those of a thin-plate "
    "spline of these source landmarks do: check the layouts and the order of the landmarks, and "
    "that enough digits were printed."
)


def rows_of(
    given: ArrayLike, what: str, layout: Layout, parameter: str, count: int | None = None
) -> Matrix:
    """Return rows of three numbers from rows or columns of them.

    Parameters
    ----------
    given
        (count, 3), or (3, count) with the layout ``"columns"``.
    what, parameter
        What a row is called in a message, and the parameter that says the layout.
    count
        How many there must be; any number without.

    Raises
    ------
    LandmarkError
        When the shape is another, or a row is not finite.
    PinwarpError
        When there is no such layout.

    Examples
    --------
    >>> rows_of([[1, 4], [2, 5], [3, 6]], "weight", "columns", "weights_layout").tolist()
    [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
    """
    if layout not in get_args(Layout):
        raise PinwarpError(f"{parameter} is {layout!r}; it must be 'rows' or 'columns'.")
    array = as_numbers(given, what)
    rows, turned = (array, array.T) if layout == "rows" else (array.T, array)
    if _suits(rows, count):
        return as_positions(np.ascontiguousarray(rows), what)
    shape = f"{count or 'n'}, 3" if layout == "rows" else f"3, {count or 'n'}"
    message = f"The {what}s have the shape {array.shape} instead of ({shape})"
    if _suits(turned, count):
        other = "columns" if layout == "rows" else "rows"
        message += f"; if each is a {other[:-1]}, say {parameter}={other!r}"
    raise LandmarkTypeError(f"{message}.")


def terms_of(affine: ArrayLike, layout: Layout, constant: Constant) -> Matrix:
    """Return the (4, 3) rows ``a1 ... a4`` of an affine part; raises like :func:`rows_of`.

    Examples
    --------
    >>> terms_of([[1, 0, 0, 7], [0, 1, 0, 8], [0, 0, 1, 9]], "columns", "last")[0].tolist()
    [7.0, 8.0, 9.0]
    """
    if constant not in get_args(Constant):
        raise PinwarpError(f"constant is {constant!r}; it must be 'first' or 'last'.")
    terms = rows_of(affine, "affine term", layout, "affine_layout", 4)
    return np.roll(terms, 1, axis=0) if constant == "last" else terms


def is_balanced(source: Matrix, weights: Matrix) -> bool:
    """Whether ``sum w_i`` and ``sum w_i u_i`` are nothing, as far as printed digits tell.

    Examples
    --------
    >>> line = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])
    >>> is_balanced(line, np.array([[1.0], [-2], [1]])), is_balanced(line, np.eye(3))
    (True, False)
    """
    columns = np.column_stack([np.ones(len(source)), source - source.mean(axis=0)])
    sums, sizes = columns.T @ weights, np.abs(columns).T @ np.abs(weights)
    return bool((np.abs(sums) <= DIGITS * sizes.max(axis=1, keepdims=True, initial=0)).all())


def _suits(rows: Matrix, count: int | None) -> bool:
    return rows.ndim == 2 and rows.shape[1] == 3 and count in (None, len(rows))
