"""Which of many places the bone hides, found bit by bit while things move."""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterator

import numpy as np
from numpy.typing import NDArray

from pinwarp.gui.scene.projection import Projection

# So many are looked at in one paint while the camera moves, and while they move themselves, which
# takes them behind the bone more seldom: 10 us each, and there are two views.
IN_ONE_PAINT, WHILE_THEY_MOVE = 250, 50


class HiddenPlaces:
    """Remembers what is hidden of places that move, or are looked at from elsewhere.

    What was hidden a moment ago mostly still is: of many places only some are looked at anew in
    each paint, and after a few paints all have been.

    Parameters
    ----------
    projection
        Sees the bone.
    """

    def __init__(self, projection: Projection) -> None:
        self._projection = projection
        self._positions: NDArray | None = None
        self._key: Hashable = None
        self._hidden: NDArray[np.bool_] = np.zeros(0, np.bool_)
        self._next = self._stale = 0
        self._in_one_paint = IN_ONE_PAINT

    @property
    def is_stale(self) -> bool:
        """Whether some were not looked at since things moved."""
        return self._stale > 0

    def of(self, positions: NDArray, *, exactly: bool = False) -> NDArray[np.bool_]:
        """Return which of (n, 3) positions the bone hides, as far as is known.

        Parameters
        ----------
        positions
            The same array as long as nothing has moved.
        exactly
            Whether all are looked at that have to be.
        """
        count, key = len(positions), self._projection.view_key()
        if count != len(self._hidden):
            # Others than before: nothing is known of them.
            self._hidden, self._next = np.zeros(count, np.bool_), 0
            self._stale, exactly = count, True
        elif key != self._key:
            self._stale, self._in_one_paint = count, IN_ONE_PAINT
        elif positions is not self._positions:
            self._stale, self._in_one_paint = count, WHILE_THEY_MOVE
        self._positions, self._key = positions, key
        number = self._stale if exactly else min(self._in_one_paint, self._stale)
        if number:
            rows = np.arange(self._next, self._next + number) % count
            self._hidden[rows] = self._projection.behind_surface(positions[rows])
            self._next = int(rows[-1] + 1) % count
            self._stale -= number
        return self._hidden


def runs(places: NDArray, behind: NDArray[np.bool_]) -> Iterator[tuple[NDArray, bool]]:
    """Yield the pieces of a line that are hidden, or not, from end to end; they meet."""
    edges = [0, *(np.flatnonzero(np.diff(behind)) + 1).tolist(), len(places)]
    for begin, end in itertools.pairwise(edges):
        yield places[max(0, begin - 1) : end], bool(behind[begin])
