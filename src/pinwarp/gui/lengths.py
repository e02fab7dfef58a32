"""Lengths in words and round numbers."""

from __future__ import annotations

import math

from pinwarp.gui.scale_bar import round_length


def format_length(value: float, unit: str, digits: int = 4) -> str:
    """Return a length with a sensible number of digits and its unit.

    Examples
    --------
    >>> format_length(2.40047, "mm"), format_length(float("inf"), "mm")
    ('2.4 mm', 'affine')
    """
    if math.isinf(value):
        return "affine"
    return f"{value:.{digits}g} {unit}"


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
