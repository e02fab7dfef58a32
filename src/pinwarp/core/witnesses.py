"""What pairs say about one of them: asked again and again, worked out once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.chance import Chance, chances_of
from pinwarp.core.evidence import Evidence, evidence
from pinwarp.core.factor import SourceFactor, factorise
from pinwarp.core.pair_field import PairField, Roughness

Matrix = NDArray[np.float64]

# With fewer modes left nothing can be judged: seven pairs in space.
LEAST_FREEDOM = 3
# A smooth field is fitted to so many pairs around the one in question.
AROUND = 80

# A pair that is asked about, and what is left of the others besides.
Asked = tuple[Evidence, int]
# Those left out, and the one that is asked about.
_Key = tuple[tuple[int, ...], int]


class Witnesses:
    """The pairs, to be asked about one another while some are left out and others exchanged.

    Parameters
    ----------
    factor
        The source landmarks; three usable modes or more.
    destination
        (n, 3) destinations about their middle, of about unit length in all.
    """

    def __init__(self, factor: SourceFactor, destination: Matrix) -> None:
        self._factor = factor
        self._field = PairField.of(factor)
        self._destination = destination.copy()
        self._all = evidence(self._field, self._destination)
        self._seen: dict[tuple[int, ...], Evidence] = {}
        self._chances: dict[_Key, Chance] = {}
        self._smooth: dict[tuple[int, ...], Evidence | None] = {}
        self._agreed: dict[_Key, Chance] = {}

    @property
    def freedom(self) -> int:
        """How many modes all pairs have."""
        return self._all.freedom

    def without(self, rows: Iterable[int]) -> Evidence:
        """Return what the others say without some."""
        out = tuple(sorted(rows))
        if out not in self._seen:
            # From those that lack most of them already.
            known = max((x for x in self._seen if {*x} <= {*out}), key=len, default=())
            seen = self._seen.get(known, self._all)
            self._seen[out] = seen.without([row for row in out if row not in known])
        return self._seen[out]

    def leave_out(self, row: int) -> None:
        """Leave a pair out for good: what was said with it is not asked for again."""
        self._seen = {out: seen for out, seen in self._seen.items() if row in out}
        self._chances = {key: known for key, known in self._chances.items() if row in key[0]}

    def exchange(self, i: int, j: int) -> None:
        """Exchange two destinations: from now on that is what the pairs are."""
        self._destination[[i, j]] = self._destination[[j, i]]
        self._all = evidence(self._field, self._destination)
        for known in (self._seen, self._chances, self._smooth, self._agreed):
            known.clear()

    def chances(self, asked: Sequence[Asked]) -> list[Chance]:
        """Return the chances of pairs in the spline's own field."""
        new = {(seen.left_out, row): (seen, row) for seen, row in asked}
        new = {key: pair for key, pair in new.items() if key not in self._chances}
        if new:
            self._chances.update(zip(new, chances_of([*new.values()]), strict=True))
        return [self._chances[seen.left_out, row] for seen, row in asked]

    def agreed(self, asked: Sequence[Asked], limit: float) -> list[Chance]:
        """Return the chances of pairs; below a limit, those in a smooth field if larger."""
        return [
            chance if chance.value >= limit else self._agreed_by_both((seen.left_out, row), chance)
            for (seen, row), chance in zip(asked, self.chances(asked), strict=True)
        ]

    def _agreed_by_both(self, key: _Key, chance: Chance) -> Chance:
        if key not in self._agreed:
            self._agreed[key] = self._smoother(*key, chance)
        return self._agreed[key]

    def _smoother(self, left_out: tuple[int, ...], row: int, chance: Chance) -> Chance:
        smooth, place = self._smoothly(left_out, row)
        if smooth is None or not smooth.kept[place]:
            return chance
        (other,) = chances_of([(smooth, place)])
        return replace(chance, value=max(chance.value, other.value))

    def _smoothly(self, left_out: tuple[int, ...], row: int) -> tuple[Evidence | None, int]:
        """Return a smooth field of the pairs around one, if it can be judged, and its place."""
        source = self._factor.source
        apart = np.linalg.norm(source - source[row], axis=1)
        apart[list(left_out)] = np.inf
        # Of duplicates at its place none comes before it.
        apart[row] = -1
        rows = np.sort(np.argsort(apart, kind="stable")[: min(AROUND, len(apart) - len(left_out))])
        key = tuple(rows.tolist())
        if key not in self._smooth:
            self._smooth[key] = self._fitted(rows)
        return self._smooth[key], int(np.searchsorted(rows, row))

    def _fitted(self, rows: NDArray[np.intp]) -> Evidence | None:
        whole = len(rows) == len(self._destination)
        factor = self._factor if whole else factorise(self._factor.source[rows])
        if int(factor.place_of.max()) - factor.rank < LEAST_FREEDOM:
            return None
        near = self._destination[rows]
        return evidence(PairField.of(factor, Roughness.SMOOTH), near - near.mean(axis=0))
