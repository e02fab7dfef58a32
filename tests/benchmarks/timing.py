"""Time several ways of doing one thing in turn, so that a slow moment hits all of them."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

# How long a turn may last that is made of several runs, in seconds, and of how many.
TURN = 0.02
MOST_RUNS = 8


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
            # A quick way runs several times in its turn: motions come in rows, with warm caches.
            end = time.perf_counter() + TURN
            for _ in range(MOST_RUNS):
                start = time.perf_counter()
                way()
                seconds[name].append(time.perf_counter() - start)
                if time.perf_counter() > end:
                    break
    return {name: statistics.median(times) for name, times in seconds.items()}
