"""How often a set without a mistake has a pair as strange as this one.

Each pair is judged by what the others are like without it: their figures ``z_j = |U_j|^2 / 3 g_j``
after it is left out. What the field says of a pair's surroundings is mended twice, by how figures
grow with isolation and by what the nearest neighbours are like, since a bone is not everywhere
the same; what still scatters has a tail whose weight is learnt from the pairs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc, gammaln

from pinwarp.core.evidence import Evidence
from pinwarp.core.pair_field import PairField

Matrix = NDArray[np.float64]

# The belief that isolation means no more than the field says, as a sum of squares, and how much
# more it can mean: the variance of a smooth field grows with the cube of the spacing.
BELIEF, STEEPEST = 4.0, 2.5
# The whole set counts like so many neighbours.
WHOLE_SET = 4.0
# Degrees of freedom that a tail may have, and what a heavy one costs: so few free pairs do not tell
# it from a mistake; of twice as many it costs a quarter, since they do.
TAILS = np.array([2.0, 2.5, 3.5, 5.0, 7.0, 10.0, 16.0, 30.0, 100.0])
HEAVY, FEW_FREE = 12.0, 40
# What the density of F(3, m) has of m alone.
TAIL_DENSITY = gammaln((TAILS + 3) / 2) - gammaln(TAILS / 2) - 1.5 * np.log(TAILS)
# So many pairs' worth of belief that the scale is right; steps to find it.
SCALE, STEPS = 15.0, 12
# The price of choosing the noise level without the pair, in hindsight.
HINDSIGHT = 8.0
# Shares below which a figure is nothing.
NOTHING, LITTLE = 1e-9, 1e-6
_TINY = 1e-300


@dataclass(frozen=True, slots=True)
class Chance:
    """How strange a pair is.

    Attributes
    ----------
    value
        The chance that a given pair of a set without a mistake misses by so much.
    shift
        How far it lies from where the others expect it, in the evidence's units.
    usual
        How far that usually is there.
    """

    value: float
    shift: float
    usual: float


def chances_of(asked: Sequence[tuple[Evidence, int]]) -> list[Chance]:
    """Judge pairs, each at the noise level of all pairs or at that of the others.

    The latter is the better model where the pair is far off, but is chosen in hindsight. All are
    judged at once, since for one pair there is more to call than to compute.

    Parameters
    ----------
    asked
        The pairs as they are seen, all in one field, and one of those that are kept; three modes
        or more are left.

    Examples
    --------
    >>> from pinwarp.core.evidence import evidence
    >>> from pinwarp.core.factor import factorise
    >>> from pinwarp.core.pair_field import PairField
    >>> source = np.random.default_rng(0).normal(size=(30, 3))
    >>> strange = 0.1 * np.sin(source)
    >>> strange[4] += 1
    >>> seen = evidence(PairField.of(factorise(source)), strange)
    >>> off, other = chances_of([(seen, 4), (seen, 5)])
    >>> off.value < 0.001 < other.value
    True
    """
    levels = [(seen.level, seen.level_without(row)) for seen, row in asked]
    both = [(*pair, at) for pair, two in zip(asked, levels, strict=True) for at in sorted({*two})]
    judged = dict(zip(((id(x), row, at) for x, row, at in both), _judged(both), strict=True))
    found = []
    for (seen, row), (level, without) in zip(asked, levels, strict=True):
        chance, other = (judged[id(seen), row, at] for at in (level, without))
        if level != without and HINDSIGHT * other.value < chance.value:
            chance = Chance(HINDSIGHT * other.value, other.shift, other.usual)
        found.append(chance)
    return found


def _judged(asked: Sequence[tuple[Evidence, int, int]]) -> list[Chance]:
    """Judge pairs, each at one noise level."""
    others = _Others.of(asked)
    grown = others.isolation ** _slope(others)[:, None]
    figures = np.where(others.kept, others.figures / grown, 0.0)
    # The mean square, as far as isolation does not explain it.
    shrunk = figures.sum(axis=1) / np.maximum(others.figures.sum(axis=1), _TINY * others.count)
    freedom = np.array([seen.freedom - 1 for seen, _, _ in asked])
    remaining = np.array([seen.remaining[level, row] for seen, row, level in asked])
    usual, own = _surroundings(others, figures, grown, shrunk * remaining / (3 * freedom))
    own *= others.of_the_one(grown)
    relative = figures / usual
    least = NOTHING * relative.max(axis=1, keepdims=True)
    weight, scale = _tail(
        np.where(others.kept, np.maximum(relative, least), 0.0), others.count, freedom
    )
    gain = np.array([seen.gains[level, row] for seen, row, level in asked])
    precision = np.array([seen.precision[level, row] for seen, row, level in asked])
    spread = 1 / (1 / TAILS + 1 / (3.0 * freedom[:, None]))
    tails = fdtrc(3, spread, (gain / 3 / own)[:, None] / scale)
    values = (weight * tails).sum(axis=1)
    shifts = np.sqrt(gain / precision)
    usuals = np.sqrt(3 * own * (weight * scale).sum(axis=1) / precision)
    told = zip(values.tolist(), shifts.tolist(), usuals.tolist(), strict=True)
    return [Chance(*figures) for figures in told]


@dataclass(frozen=True, eq=False)
class _Others:
    """The other pairs, one left out, once for each that is asked about.

    Everything is (asked, n, ...), by the rows of the whole set. ``isolation`` is ``1 / g`` in
    units of the median; of the one itself, with all the others.
    """

    field: PairField
    near_entries: Matrix
    rows: NDArray[np.intp]
    column: Matrix
    pulls: Matrix
    precision: Matrix
    kept: NDArray[np.bool_]
    figures: Matrix
    isolation: Matrix

    @classmethod
    def of(cls, asked: Sequence[tuple[Evidence, int, int]]) -> _Others:
        rows = np.array([row for _, row, _ in asked])
        each = np.arange(len(asked))
        column = np.array([seen.column(level, row) for seen, row, level in asked])
        pulls = np.array([seen.pulls[level] for seen, _, level in asked])
        before = np.array([seen.precision[level] for seen, _, level in asked])
        share = column / column[each, rows, None]
        pulls = pulls - share[:, :, None] * pulls[each, rows, None]
        precision = before - share * column
        kept = np.array([seen.kept for seen, _, _ in asked])
        kept &= precision > NOTHING * _median(before, np.full(len(asked), before.shape[1]))
        kept[each, rows] = False
        safe = np.where(kept, precision, 1.0)
        own = 1 / before[each, rows, None]
        spacing = np.where(kept, 1 / safe, np.inf)
        squares = np.einsum("anc,anc->an", pulls, pulls)
        return cls(
            field=asked[0][0].field,
            near_entries=np.array([seen.near_entries(level) for seen, _, level in asked]),
            rows=rows,
            column=column,
            pulls=pulls,
            precision=precision,
            kept=kept,
            figures=np.where(kept, squares / safe, 0.0) / 3,
            isolation=np.where(kept, 1 / safe, own) / _median(spacing, kept.sum(axis=1)),
        )

    @cached_property
    def count(self) -> NDArray[np.intp]:
        """(asked,): how many are kept."""
        return np.asarray(self.kept.sum(axis=1))

    def of_the_one(self, values: Matrix) -> Matrix:
        """Return what (asked, n) values are of the one itself, (asked,)."""
        return np.asarray(values[np.arange(len(self.rows)), self.rows])


def _median(values: Matrix, count: NDArray[np.intp]) -> Matrix:
    """Return the median of each row, (asked, 1): so many of its values are not infinite."""
    ascending = np.sort(values, axis=1)
    each = np.arange(len(values))
    middle = ascending[each, (count - 1) // 2] + ascending[each, count // 2]
    return np.asarray(middle[:, None] / 2)


def _slope(others: _Others) -> Matrix:
    """Return by which power of their isolation figures grow beyond what the field says."""
    kept, count = others.kept, others.count[:, None]
    least = np.maximum(NOTHING * others.figures.max(axis=1, keepdims=True), _TINY)
    x = np.where(kept, np.log(others.isolation), 0.0)
    y = np.where(kept, np.log(np.maximum(others.figures, least)), 0.0)
    x = np.where(kept, x - x.sum(axis=1, keepdims=True) / count, 0.0)
    y = y - y.sum(axis=1, keepdims=True) / count
    slope = (x * y).sum(axis=1) / ((x * x).sum(axis=1) + BELIEF)
    return np.asarray(np.clip(slope, 0.0, STEEPEST))


def _surroundings(
    others: _Others, figures: Matrix, grown: Matrix, middle: Matrix
) -> tuple[Matrix, Matrix]:
    """Return what is usual around each pair, by its neighbours without it, and around the one."""
    count = others.field.neighbours
    near = others.field.near[:, : count + 1]
    column = others.column
    relative = column / others.of_the_one(column)[:, None]
    entries = others.near_entries - column[:, :, None] * relative.take(near, axis=1)
    share = entries / np.where(others.kept, others.precision, np.inf)[:, :, None]
    pulls = others.pulls.take(near, axis=1) - share[..., None] * others.pulls[:, :, None]
    before = others.precision.take(near, axis=1)
    precision = before - share * entries
    told = others.kept.take(near, axis=1) & (precision > LITTLE * before)
    squares = np.einsum("ankc,ankc->ank", pulls, pulls)
    theirs = (
        np.where(told, squares / np.where(told, precision, 1.0), 0.0) / 3 / grown.take(near, axis=1)
    )
    # Of one neighbour more than needed the first that are there.
    told &= np.cumsum(told, axis=2) <= count
    start = (WHOLE_SET * middle)[:, None]
    usual = (start + (theirs * told).sum(axis=2)) / (WHOLE_SET + told.sum(axis=2))
    around = np.arange(len(figures))[:, None], others.field.near[others.rows]
    there = others.kept[around]
    there &= np.cumsum(there, axis=1) <= count
    own = start[:, 0] + (figures[around] * there).sum(axis=1)
    own = own / (WHOLE_SET + there.sum(axis=1))
    return np.maximum(usual, np.maximum(1e-12 * middle, _TINY)[:, None]), np.maximum(own, _TINY)


def _tail(
    figures: Matrix, count: NDArray[np.intp], freedom: NDArray[np.intp]
) -> tuple[Matrix, Matrix]:
    """Return how likely each of the tails is, and its scale: figures are scale times F(3, m).

    Both are (asked, tails). Figures of 0 are none: so many count.
    """
    x, count, third = figures[:, None, :], count[:, None], TAILS / 3
    scale = np.maximum(x.sum(axis=2) / count, _TINY) + np.zeros(len(TAILS))
    share = np.empty((len(x), len(TAILS), x.shape[2]))
    step, rest = (third + 1) / (count + SCALE), SCALE / (count + SCALE)
    for _ in range(STEPS):
        # Each figure x counts (m + 3) / (m + 3 x / scale) times.
        np.add(x, (third * scale)[:, :, None], out=share)
        np.divide(x, share, out=share)
        scale = step * scale * share.sum(axis=2) + rest
    np.divide(x, (third * scale)[:, :, None], out=share)
    likely = count * (TAIL_DENSITY - 1.5 * np.log(scale))
    likely -= (TAILS + 3) / 2 * np.log1p(share, out=share).sum(axis=2)
    # So many dependent figures say no more than their freedom.
    likely *= freedom[:, None] / count
    heavy = HEAVY / np.maximum(freedom / FEW_FREE, 1.0) ** 2
    likely -= heavy[:, None] / TAILS + 1.5 * SCALE * (1 / scale + np.log(scale) - 1)
    shares = np.exp(likely - likely.max(axis=1, keepdims=True))
    return shares / shares.sum(axis=1, keepdims=True), scale
