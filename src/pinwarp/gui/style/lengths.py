"""Lengths in words and round numbers."""

from __future__ import annotations

import math


def round_length(longest: float) -> float:
    """Return the largest of 1, 2, 5, 10, ... that is no longer than this.

    Examples
    --------
    >>> round_length(73.2), round_length(0.0199)
    (50.0, 0.01)
    """
    if not (math.isfinite(longest) and longest > 0):
        return 0.0
    exponent = math.floor(math.log10(longest))
    # The power of ten is divided where it is negative: 5 / 100 is 0.05, 5 * 0.01 may not be.
    lengths = [
        digit * 10.0**power if power >= 0 else digit / 10.0**-power
        for power in (exponent - 1, exponent, exponent + 1)
        for digit in (1, 2, 5)
    ]
    return max(length for length in lengths if length <= longest)


def ticks(largest: float) -> tuple[float, ...]:
    """Return 0 and one to three round lengths up to the largest, evenly apart.

    Examples
    --------
    >>> ticks(11.6), ticks(0.0)
    ((0.0, 5.0, 10.0), (0.0,))
    """
    # 1.5 to 3.75 steps: neither a lonely label nor a ladder.
    step = round_length(largest / 1.5)
    return tuple(step * i for i in range(int(largest / step) + 1)) if step else (0.0,)
