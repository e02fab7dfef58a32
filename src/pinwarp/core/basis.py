"""The function of the distance that a spline is built of, and what of the solve depends on it.

``r`` is the thin-plate spline of three dimensions. ``r^2 log r`` is that of the plane; Bookstein's
name for it made it what many programs offer in space too, where it gives another warp. On the
weights that the side conditions allow ``r`` makes K negative definite and ``r^2 log r`` positive
(conditional definiteness of order 1 and 2: Micchelli, Constructive Approximation 2 (1986)).
"""

from __future__ import annotations

import reprlib
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.errors import PenaltyError

Matrix = NDArray[np.float64]

# Keeps the logarithm of a distance of 0 away, and is lost to rounding in any other.
TINIEST_SQUARE = float(np.finfo(np.float64).tiny)


class Basis(StrEnum):
    """The basis ``U`` of the distance r.

    Examples
    --------
    >>> Basis("r2logr").formula, Basis.R.sign, Basis.R2_LOG_R.sign
    ('r² log r', -1, 1)
    >>> Basis.R2_LOG_R.of(np.array([1.0, 2.0])).round(3).tolist()
    [0.0, 2.773]
    """

    R = "r"
    R2_LOG_R = "r2logr"

    @property
    def formula(self) -> str:
        """How people write it."""
        return "r" if self is Basis.R else "r² log r"

    @property
    def sign(self) -> int:
        """The sign of K on the weights that the side conditions allow."""
        return -1 if self is Basis.R else 1

    @property
    def power(self) -> int:
        """The power of a length that K has, and a warping penalty with it."""
        return 1 if self is Basis.R else 2

    def of(self, distances: Matrix) -> Matrix:
        """Return ``U(r)`` of distances of any shape, which may be overwritten."""
        if self is Basis.R:
            return distances
        squares = np.multiply(distances, distances, out=distances)
        return np.asarray(0.5 * squares * np.log(squares + TINIEST_SQUARE))

    def slope(self, distances: Matrix) -> Matrix:
        """Return ``U'(r) / r``, and 0 at r = 0: times ``v - u`` it is the gradient there."""
        some = distances > 0
        if self is Basis.R:
            return np.divide(1.0, distances, out=np.zeros_like(distances), where=some)
        logarithms = np.log(distances, out=np.full_like(distances, -0.5), where=some)
        return 2 * logarithms + 1

    def penalty_unit(self, unit: str) -> str:
        """Return the unit of a warping penalty, of a mesh's unit.

        Examples
        --------
        >>> [x.penalty_unit("mm") for x in Basis], Basis.R2_LOG_R.penalty_unit("")
        (['mm', 'mm²'], '')
        """
        return f"{unit}²" if unit and self.power == 2 else unit


def check_basis(basis: Basis | str) -> Basis:
    """Return the basis, which may be given by its value or as people write it.

    Examples
    --------
    >>> check_basis("r^2 log r") is check_basis("r2logr") is Basis.R2_LOG_R
    True
    >>> check_basis("cubic")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    pinwarp.core.errors.PenaltyError: The basis is 'cubic'; it must be 'r' or 'r2logr'.
    """
    plain: Any = basis
    if isinstance(basis, str):
        plain = basis.lower().replace("²", "2").translate({ord(sign): None for sign in " ^*_"})
    try:
        return Basis(plain)
    except ValueError:
        known = " or ".join(repr(member.value) for member in Basis)
        raise PenaltyError(f"The basis is {reprlib.repr(basis)}; it must be {known}.") from None
