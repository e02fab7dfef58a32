"""Lengths: which of them are only rounding, the one figure for many, and how they are told."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

# A length below this share of the largest coordinate is rounding, and is taken for 0.
ROUNDING = 1e-9
# From here on a number is written with a power of ten.
_LARGEST = 1e6
# What a length may be typed in, in metres.
METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "µm": 1e-6, "um": 1e-6}
_TYPED = re.compile(r"\s*(.*?)\s*(mm|cm|µm|um|m)?\s*", re.IGNORECASE | re.DOTALL)


def rounding_among(*places: ArrayLike) -> float:
    """Return the length below which there is only rounding among coordinates of any shape.

    Examples
    --------
    >>> rounding_among([[0.0, -40.0, 3.0]], [1.0]) == 40 * ROUNDING
    True
    """
    return ROUNDING * max((float(np.abs(x).max(initial=0.0)) for x in places), default=0.0)


def rms(lengths: ArrayLike) -> float:
    """Return the root mean square of at least one length.

    Examples
    --------
    >>> rms([3.0, 4.0]) == 12.5**0.5
    True
    """
    values = np.asarray(lengths, dtype=np.float64)
    return float(np.sqrt(np.mean(values * values)))


def format_number(value: float, digits: int = 3) -> str:
    """Return a number with some significant digits, and never less than its whole part.

    Examples
    --------
    >>> format_number(2.40047), format_number(1473.2), format_number(0.0)
    ('2.4', '1473', '0')
    """
    if 10**digits <= abs(value) < _LARGEST:
        return f"{value:.0f}"
    return f"{value:.{digits}g}"


@dataclass(frozen=True)
class Ruler:
    """How lengths are told: in which unit, and which of them are only rounding.

    Parameters
    ----------
    unit
        What stands behind them; may be empty.
    factor
        What a length is multiplied by to be in that unit.
    least
        No longer ones, before they are multiplied, are told as 0.

    Examples
    --------
    >>> ruler = Ruler("mm", 1000.0, 4e-10)
    >>> ruler.text(0.0076912), ruler.text(1.275e-19), ruler.text(float("inf"))
    ('7.691 mm', '0 mm', 'affine')
    >>> ruler.length("5"), ruler.length("0,5 cm")
    (0.005, 0.005)
    """

    unit: str = ""
    factor: float = 1.0
    least: float = 0.0

    @classmethod
    def of(cls, ruler: Ruler | str) -> Ruler:
        """Return a ruler; of a unit the one that tells lengths as they are."""
        return cls(ruler) if isinstance(ruler, str) else ruler

    def shown(self, length: float) -> float:
        """Return a length in the unit that is shown; 0 for what is only rounding."""
        return 0.0 if abs(length) <= self.least else self.factor * length

    def number(self, length: float, digits: int = 4) -> str:
        """Return a length with some significant digits, without its unit."""
        return "affine" if math.isinf(length) else format_number(self.shown(length), digits)

    def text(self, length: float, digits: int = 4) -> str:
        """Return a length with some significant digits and its unit."""
        number = self.number(length, digits)
        return number if math.isinf(length) else f"{number} {self.unit}".rstrip()

    def to_the(self, power: int) -> Ruler:
        """Return the ruler of areas for the power 2; itself for 1.

        Examples
        --------
        >>> Ruler("mm", 1000.0).to_the(2).text(3e-6)
        '3 mm²'
        """
        if power == 1:
            return self
        return Ruler(f"{self.unit}²" if self.unit else "", self.factor**power)

    def length(self, text: str) -> float:
        """Return a typed length as it is stored: in the unit that is shown unless it names one.

        Raises
        ------
        ValueError
            Where it is none.
        """
        found = _TYPED.fullmatch(text)
        number, unit = ("", None) if found is None else (found[1], found[2])
        if unit is None and self.unit:
            number = number.removesuffix(self.unit).strip()
        value = float(number.replace(",", "."))
        if unit is None or unit.lower() == self.unit.lower():
            return self.stored(value)
        if self.unit not in METRES:
            raise ValueError(f"{unit} cannot be told in {self.unit or 'an unknown unit'}")
        return self.stored(value * METRES[unit.lower()] / METRES[self.unit])

    def stored(self, shown: float) -> float:
        """Return a length in the unit that is shown as it is stored.

        Multiplied or divided by a whole number, 5 mm are 0.005 m to the last digit.
        """
        return shown / self.factor if self.factor >= 1 else shown * round(1 / self.factor, 9)
