"""What is still there of what was opened: to be asked where it should be gone."""

from __future__ import annotations

import gc
from collections import Counter
from collections.abc import Iterable


def alive(kinds: Iterable[type]) -> Counter[str]:
    """How many objects of each kind there are that this test has made."""
    wanted = set(kinds)
    gc.collect()
    counts = Counter({kind.__name__: 0 for kind in wanted})
    # What was there before the test is frozen, and not among these.
    counts.update(type(thing).__name__ for thing in gc.get_objects() if type(thing) in wanted)
    return counts
