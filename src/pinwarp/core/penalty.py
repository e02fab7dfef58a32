"""The warping penalty: what may be one, and the equations that it can enter."""

from __future__ import annotations

import math
import reprlib
from enum import StrEnum

import numpy as np

from pinwarp.core.basis import Basis
from pinwarp.core.errors import PenaltyError, PenaltyTypeError
from pinwarp.core.positions import is_real_number


class PenaltyConvention(StrEnum):
    """Which equation the warping penalty enters, and with which sign.

    ``REGULARISING`` solves ``K - s I`` with ``U = +r``: it penalises at every value, from
    interpolation at 0 to the affine fit at infinity. ``OPYNSIM`` solves the published
    ``K + alpha I`` with ``U = +r``, as OPynSim and thin-plate-spline >= 1.2 do, poles included.

    Examples
    --------
    >>> PenaltyConvention("opynsim").sign, PenaltyConvention.REGULARISING.sign
    (-1, 1)
    """

    REGULARISING = "regularising"
    OPYNSIM = "opynsim"

    @property
    def sign(self) -> int:
        """The sign with which the penalty is added to the eigenvalues of ``N``."""
        return 1 if self is PenaltyConvention.REGULARISING else -1

    def within(self, basis: Basis) -> PenaltyConvention:
        """Return the equation that it is with a basis: for ``r^2 log r`` both are one.

        K is positive there, and the published ``K + alpha I`` regularises.

        Examples
        --------
        >>> PenaltyConvention.OPYNSIM.within(Basis.R2_LOG_R).value
        'regularising'
        """
        return self if basis is Basis.R else PenaltyConvention.REGULARISING


def check_penalty(penalty: object) -> float:
    """Return the penalty as a float; infinity, the affine fit, is allowed.

    Examples
    --------
    >>> check_penalty(np.float32(0.5)), check_penalty(math.inf)
    (0.5, inf)
    """
    if type(penalty) is float and penalty >= 0:
        return penalty
    if isinstance(penalty, np.ndarray) and penalty.ndim == 0:
        # An array without dimensions is a number; one that is masked stays what it is.
        penalty = penalty[()]
    if not is_real_number(penalty):
        raise PenaltyTypeError(
            f"The warping penalty is {reprlib.repr(penalty)}, which is not a number; "
            "it must be 0 or more."
        )
    try:
        value = float(penalty)
    except OverflowError:
        raise PenaltyError("The warping penalty is too large for a number.") from None
    if math.isnan(value) or value < 0:
        raise PenaltyError(f"The warping penalty is {value}; it must be 0 or more.")
    return value


def check_convention(convention: PenaltyConvention | str) -> PenaltyConvention:
    """Return the convention, which may be given by its value.

    Examples
    --------
    >>> check_convention("opynsim") is PenaltyConvention.OPYNSIM
    True
    >>> check_convention("published")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    pinwarp.core.errors.PenaltyError: The convention is 'published'; it must be ...
    """
    try:
        return PenaltyConvention(convention)
    except ValueError:
        known = " or ".join(repr(member.value) for member in PenaltyConvention)
        raise PenaltyError(
            f"The convention is {reprlib.repr(convention)}; it must be {known}."
        ) from None
