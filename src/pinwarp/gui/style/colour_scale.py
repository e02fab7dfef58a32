"""Which colour stands for which value of a map, and what the legend writes beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.maps import MapKind, Range
from pinwarp.gui.style import theme
from pinwarp.gui.style.lengths import round_length

# Fewer numbers are no scale: ratios are written in powers of two only where there are as many.
FEWEST = 3
# The least that there is between the ends of a scale: of its level, in doublings, as a length.
LEAST_SHARE = 1e-6
LEAST_DOUBLINGS = 1e-6
LEAST_LENGTH = 1e-30
_FRACTIONS = {-1: "½", -2: "¼", -3: "⅛"}


@dataclass(frozen=True)
class ColourScale:
    """The colours of one map between two values.

    Parameters
    ----------
    kind
        Lengths run from dark to light; ratios from blue to orange, neutral at 1.
    range
        The lowest and the highest value shown; what lies beyond takes the colour of the end.
    factor
        What lengths are multiplied by to be in the unit that is written.

    Examples
    --------
    >>> scale = ColourScale(MapKind.VOLUME, (0.25, 4.0))
    >>> [tick.text for tick in scale.ticks()]
    ['¼', '½', '1', '2', '4']
    """

    kind: MapKind
    range: Range
    factor: float = 1.0

    @property
    def ends(self) -> Range:
        """The range on the scale that is drawn: doublings for ratios."""
        low, high = self.kind.levels(np.array(self.range, dtype=np.float64)).tolist()
        # A range of next to nothing is widened: neither VTK nor the ticks can divide by it.
        least = max(abs(low), abs(high)) * LEAST_SHARE
        least = max(least, LEAST_DOUBLINGS if self.kind.is_ratio else LEAST_LENGTH)
        if high - low < least:
            low, high = 0.5 * (low + high - least), 0.5 * (low + high + least)
        return low, high

    def colours(self, levels: ArrayLike) -> NDArray[np.uint8]:
        """Return the (k, 3) colours of levels."""
        low, high = self.ends
        if self.kind.is_ratio:
            # As far up as down, so that 1 is neutral whatever the range.
            reach = max(abs(low), abs(high))
            low, high = -reach, reach
            anchors = theme.DIVERGING_COLOURS
        else:
            anchors = theme.SEQUENTIAL_COLOURS
        known = np.array([[int(name[i : i + 2], 16) for i in (1, 3, 5)] for name in anchors])
        places = np.linspace(low, high, len(anchors))
        columns = [np.interp(np.asarray(levels), places, channel) for channel in known.T]
        return np.round(np.column_stack(columns)).astype(np.uint8)

    def ticks(self) -> list[Tick]:
        """Return the values to be written beside the colours, the lowest first."""
        low, high = self.ends
        found = self._powers(low, high) if self.kind.is_ratio else []
        if len(found) < FEWEST:
            factor = 1.0 if self.kind.is_ratio else self.factor
            ends = (2.0**low, 2.0**high) if self.kind.is_ratio else (factor * low, factor * high)
            values = _round_values(*ends)
            levels = self.kind.levels(np.array(values) / factor).tolist()
            found = list(zip(levels, _as_short_as_differs(values), strict=True))
        return [Tick((level - low) / (high - low), text) for level, text in found]

    def _powers(self, low: float, high: float) -> list[tuple[float, str]]:
        step = max(1, math.ceil((high - low) / 8))
        powers = range(math.ceil(low - 1e-6), math.floor(high + 1e-6) + 1)
        return [(float(power), _power_text(power)) for power in powers if power % step == 0]


@dataclass(frozen=True)
class Tick:
    """A value on a legend: its share of the way up, and what is written there."""

    share: float
    text: str


def _power_text(power: int) -> str:
    if power >= 0:
        return f"{2**power}"
    return _FRACTIONS.get(power, f"1/{2**-power}")


def _as_short_as_differs(values: list[float]) -> list[str]:
    """Return numbers in six digits, or in as many more as it takes to tell them apart."""
    for digits in range(6, 17):
        texts = [f"{value:.{digits}g}" for value in values]
        if len(set(texts)) == len(texts):
            break
    return texts


def _round_values(low: float, high: float) -> list[float]:
    """Return round numbers from low to high, five to ten of them."""
    step = round_length((high - low) / 4)
    first, last = math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6)
    return [i * step for i in range(first, last + 1)]
