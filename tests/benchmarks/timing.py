"""Time several ways of doing one thing in turn, so that a slow moment hits all of them."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable


def in_turn(
    ways: dict[str, Callable[[], object]], budget: float = 2.0, most: int = 15
) -> dict[str, float]:
    """Return the median seconds of each way, run A B C A B C ... after one warm-up round.

    Stops after ``most`` rounds, or once the budget is used up and there were three of them.
    """
    seconds: dict[str, list[float]] = {name: [] for name in ways}
    for way in ways.values():
        way()
    begin = time.perf_counter()
    for round_ in range(most):
        if round_ >= 3 and time.perf_counter() - begin > budget:
            break
        for name, way in ways.items():
            start = time.perf_counter()
            way()
            seconds[name].append(time.perf_counter() - start)
    return {name: statistics.median(times) for name, times in seconds.items()}
