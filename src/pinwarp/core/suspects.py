"""Which pairs are wrong, and in what way: facts to show beside the landmarks, never acted upon.

Explanations compete by their likelihood: nothing wrong, one pair displaced, two exchanged. The
best is taken if sets without a mistake hardly ever show as much, its pairs are left out or put
right, and the others are judged again without them. A displaced pair must be strange whether the
bones differ as roughly as the spline supposes or smoothly: of either field alone, one clean set
in ten has such a pair. Single landmarks of honest bones are placed a little differently, too: a
pair that is off by little beside the bone is wrong only if that is all the clearer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.chance import Chance
from pinwarp.core.evidence import Evidence
from pinwarp.core.exchanges import best_exchange
from pinwarp.core.factor import SourceFactor
from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.positions import quiet
from pinwarp.core.quality import ROUNDING
from pinwarp.core.spline import displacements
from pinwarp.core.witnesses import LEAST_FREEDOM, Asked, Witnesses

Matrix = NDArray[np.float64]

# How often a set without a mistake may show as much: for a finding, and for a remark.
STRICT, WORTH_A_LOOK = 0.06, 0.4
# A mistake that is off by less than this share of the landmarks' RMS radius must be clearer: so
# far off are single landmarks of real bones that were only placed a little differently.
LARGE = 0.2
# No more than this share of the pairs is called wrong.
MOST_WRONG = 0.3
# Explanations closer than this many nats are not told apart; so many are looked at.
ALIKE, LOOKED_AT = 1.0, 3
# What each free coordinate of a displaced pair costs against an exchange, in nats.
FREE_COORDINATE = 2.0
# Of more pairs than this each of two exchanged must be as unlikely as that by itself, and those
# that hide one another are looked for from the strangest alone.
FEW, DOUBTFUL = 40, 0.02
# ... and leaving out both must not explain more than their exchange by this share of its gain.
BOTH_DISPLACED = 0.2
# Of those that hide one another so many at most are left out one after the other, each for so many
# nats besides the choice of it; chosen together, each must be so many times clearer.
MOST_HIDDEN, PLAIN, CLEARER = 60, 3.0, 4.0
# Exchanges are tried among so many of the strangest pairs.
EXCHANGED = 30
_TINY = 1e-300

_Judge = Callable[[list[Asked], float], list[Chance]]


@quiet
def suspects(factor: SourceFactor, destination: ArrayLike) -> tuple[Finding, ...]:
    """Judge the pairs by what they say about one another, at no penalty and in the basis r.

    The fields and the chances are of the basis r whatever the factor's: a mistake is one by
    whichever spline the bones are warped.

    Parameters
    ----------
    factor
        The source landmarks, from :func:`~pinwarp.core.factor.factorise`.
    destination
        (n, 3) destination landmarks, in mesh units.

    Returns
    -------
    tuple of Finding
        In the order in which they were found, the clearest first, each landmark at most once:
        SWAPPED, DISPLACED, EITHER (one of two), then WORTH_A_LOOK. Nothing below seven pairs in
        space, six in a plane.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> source = np.random.default_rng(0).normal(size=(12, 3))
    >>> destination = source + 0.1 * np.sin(source)
    >>> destination[[3, 7]] = destination[[7, 3]]
    >>> destination[5] += [0, 1, 0]
    >>> for finding in suspects(factorise(source), destination):
    ...     print(finding.kind.value, sorted(finding.rows))
    swapped [3, 7]
    displaced [5]
    """
    factor = factor.in_basis_r
    unexplained, _, _ = displacements(factor, destination)
    target = np.asarray(destination, dtype=np.float64)
    rounding = ROUNDING * float(np.abs(target).max())
    target = target - target.mean(axis=0)
    unit = float(np.linalg.norm(target))
    if np.sum(factor.usable_modes) < LEAST_FREEDOM or not unit:
        return ()
    bent = factor.modes_at_landmarks.T @ unexplained
    if float(np.linalg.norm(bent)) <= rounding * np.sqrt(len(target)):
        # An affine map meets every pair: what is left is rounding.
        return ()
    search = _Search(factor, target / unit, unit)
    return _settled(chain(search.mistakes(), search.remarks()))


def _settled(found: Iterable[Finding]) -> tuple[Finding, ...]:
    """Of two of which either was wrong, name the one alone where the other is named by itself."""
    settled: list[Finding] = []
    named: set[int] = set()
    for finding in reversed(list(found)):
        if finding.kind is FindingKind.EITHER and named.intersection(finding.rows):
            finding = replace(finding, kind=FindingKind.DISPLACED, rows=finding.rows[:1])
        named.update(finding.rows)
        settled.append(finding)
    return tuple(reversed(settled))


class _Search:
    """Finds one explanation after the other."""

    def __init__(self, factor: SourceFactor, destination: Matrix, unit: float) -> None:
        self._pairs = Witnesses(factor, destination)
        self._unit = unit
        self._left_out: list[int] = []
        self._free = np.ones(len(destination), dtype=np.bool_)

    def mistakes(self) -> Iterator[Finding]:
        """Yield what sets without a mistake hardly ever show."""
        while self._may_go_on():
            seen = self._without()
            if self._free_count(seen) == 0:
                return
            exchange = self._exchanged(seen)
            found = (
                [exchange] if exchange else self._one_or_two(seen, STRICT, self._beside_the_bone)
            )
            found = found or self._hidden(seen)
            if not found:
                return
            yield from found

    def remarks(self) -> Iterator[Finding]:
        """Yield what some of them show as well."""
        while self._may_go_on():
            found = self._one_or_two(self._without(), WORTH_A_LOOK, self._pairs.agreed)
            if not found:
                return
            # However unlikely, what is small beside the bone is no rarer than a mistake.
            (x,) = found
            value = max(x.value, STRICT)
            yield replace(x, kind=FindingKind.WORTH_A_LOOK, rows=x.rows[:1], value=value)

    # What is left

    def _may_go_on(self) -> bool:
        named = int(np.sum(~self._free))
        freedom = self._pairs.freedom - len(self._left_out)
        return named < max(1, MOST_WRONG * len(self._free)) and freedom >= LEAST_FREEDOM

    def _without(self, *rows: int) -> Evidence:
        out = tuple(sorted((*self._left_out, *rows)))
        return self._pairs.without(out)

    def _free_count(self, seen: Evidence) -> int:
        return int(np.sum(seen.kept & self._free))

    def _leave_out(self, row: int) -> None:
        self._left_out.append(row)
        self._free[row] = False
        self._pairs.leave_out(row)

    # One pair, or one of two

    def _one_or_two(self, seen: Evidence, limit: float, judge: _Judge) -> list[Finding]:
        """Find the pair whose leaving out explains most, or the two that do so equally well."""
        count = self._free_count(seen)
        rows = self._strangest(seen, ALIKE)
        chances = judge([(seen, row) for row in rows], limit / count)
        judged = zip(rows, chances, strict=True)
        passed = sorted((x for x in judged if x[1].value * count < limit), key=lambda x: x[1].value)
        if not passed:
            return []
        named = tuple(row for row, _ in passed[:2])
        self._leave_out(named[0])
        return [self._finding(named, passed[0][1], passed[0][1].value * count)]

    def _strangest(self, seen: Evidence, within: float = np.inf) -> list[int]:
        """Return the rows whose leaving out explains most, the best first."""
        alone = np.where(seen.kept & self._free, seen.one_wrong[seen.level], -np.inf)
        order = np.argsort(-alone)[:LOOKED_AT].tolist()
        return [row for row in order if alone[row] > max(alone[order[0]] - within, -np.inf)]

    def _hidden(self, seen: Evidence) -> list[Finding]:
        """Find some that hide one another: each is judged without the others."""
        few = len(self._free) <= FEW
        starts = self._strangest(seen) if few else self._telling(seen)
        found = (self._clearer(self._hiding(start), seen) for start in starts)
        return next(filter(None, found), [])

    def _hiding(self, start: int) -> list[int]:
        """Return a pair and what is strange without it, left out one by one."""
        named = len(self._free) - int(np.sum(self._free))
        rows, out = [start], self._without(start)
        while len(rows) < min(MOST_HIDDEN, MOST_WRONG * len(self._free) - named):
            following = self._telling(out) if out.freedom > LEAST_FREEDOM else []
            if not following:
                break
            rows += following
            out = self._without(*rows)
        return rows

    def _telling(self, seen: Evidence) -> list[int]:
        """Return the strangest pair where leaving it out explains a lot."""
        clear = np.log(self._free_count(seen)) + PLAIN + seen.nothing_wrong[seen.level]
        rows = self._strangest(seen)[:1]
        return [row for row in rows if seen.one_wrong[seen.level, row] > clear]

    def _clearer(self, rows: list[int], seen: Evidence) -> list[Finding]:
        """Name those of some that are strange without the others, two or more."""
        count = self._free_count(seen)
        while len(rows) > 1:
            judged = self._each(rows, WORTH_A_LOOK / count)
            doubted = [row for row, x in judged if x.value < WORTH_A_LOOK / count]
            if doubted == rows:
                chosen = CLEARER * count
                found = [(row, x) for row, x in judged if x.value * chosen < STRICT]
                if len(found) == 1:
                    # By itself it hides nobody.
                    return []
                for row, _ in found:
                    self._leave_out(row)
                return [self._finding((row,), x, x.value * chosen) for row, x in found]
            # Those that are ordinary without the others are among the others.
            rows = doubted
        return []

    def _each(self, rows: list[int], limit: float) -> list[tuple[int, Chance]]:
        """Judge each of some pairs without the others of them."""
        asked = [(self._without(*(other for other in rows if other != row)), row) for row in rows]
        return list(zip(rows, self._beside_the_bone(asked, limit), strict=True))

    def _beside_the_bone(self, asked: list[Asked], limit: float) -> list[Chance]:
        """Judge pairs: those that are off by little beside the bone are the less unlikely."""
        large = LARGE / np.sqrt(len(self._free))
        return [
            replace(x, value=x.value / float(np.clip((x.shift / large) ** 2, _TINY, 1.0)))
            for x in self._pairs.agreed(asked, limit)
        ]

    def _finding(self, rows: tuple[int, ...], chance: Chance, of_a_set: float) -> Finding:
        shift, usual = chance.shift * self._unit, chance.usual * self._unit
        kind = FindingKind.DISPLACED if len(rows) == 1 else FindingKind.EITHER
        return Finding(kind, rows, of_a_set, (shift, usual))

    # Two exchanged

    def _exchanged(self, seen: Evidence) -> Finding | None:
        """Find two pairs whose exchange explains more than any single displaced one."""
        free = seen.kept & self._free
        count = int(np.sum(free))
        strange = np.where(free, seen.gains.max(axis=0), -1.0)
        rows = np.argsort(-strange)[: min(EXCHANGED, count)]
        if count < 2:
            return None
        before = float(seen.nothing_wrong.max())
        likely, i, j = best_exchange(seen, rows)
        gain = likely - before - np.log(count * (count - 1) / 2)
        alone = float(seen.one_wrong[:, free].max()) - before - np.log(count) - 3 * FREE_COORDINATE
        if gain <= max(ALIKE, alone):
            return None
        if len(free) > FEW:
            without = seen.likelihood(self._without(i, j).misfit, seen.log_det).max()
            if without - likely > BOTH_DISPLACED * gain or self._doubtful(i, j):
                return None
        self._pairs.exchange(i, j)
        self._free[[i, j]] = False
        return Finding(FindingKind.SWAPPED, (i, j), float(np.exp(-gain)))

    def _doubtful(self, i: int, j: int) -> bool:
        """Whether one of two is ordinary with the other left out."""
        asked = [(self._without(out), row) for out, row in ((i, j), (j, i))]
        asked = [(others, row) for others, row in asked if others.kept[row]]
        return any(x.value >= DOUBTFUL for x in self._pairs.chances(asked))
