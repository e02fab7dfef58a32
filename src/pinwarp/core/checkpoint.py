"""Where something slow tells how far it is, and may be stopped."""

from __future__ import annotations

from collections.abc import Callable, Iterator

Checkpoint = Callable[[float], None]
"""Called with the share that is done, from 0 to 1; what it raises ends the work at once."""


def go_on(_share: float) -> None:
    """Pass every checkpoint."""


def within(checkpoint: Checkpoint, begin: float, end: float) -> Checkpoint:
    """Return the checkpoint of a part of the work.

    Examples
    --------
    >>> told = []
    >>> within(told.append, 0.5, 1.0)(0.5)
    >>> told
    [0.75]
    """
    return lambda share: checkpoint(begin + (end - begin) * share)


def parts(count: int, size: int, checkpoint: Checkpoint) -> Iterator[slice]:
    """Yield the parts of so many rows, with a checkpoint before each.

    Examples
    --------
    >>> [part.start for part in parts(5, 2, go_on)]
    [0, 2, 4]
    """
    for first in range(0, count, size):
        checkpoint(first / count)
        yield slice(first, min(first + size, count))
