"""How often a set without a mistake has a pair as strange as this one.

Each pair is judged by what the others are like without it: their figures ``z_j = |U_j|^2 / 3 g_j``
after it is left out. What the field says of a pair's surroundings is mended twice, by how figures
grow with isolation and by what the nearest neighbours are like, since a bone is not everywhere
the same; what still scatters has a tail whose weight is learnt from the pairs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc, gammaln

from pinwarp.core.evidence import Evidence
from pinwarp.core.pair_field import NEIGHBOURS

Matrix = NDArray[np.float64]

# The belief that isolation means no more than the field says, as a sum of squares, and how much
# more it can mean: the variance of a smooth field grows with the cube of the spacing.
BELIEF, STEEPEST = 4.0, 2.5
# The whole set counts like so many neighbours; a neighbourhood is at most such a part of the set.
WHOLE_SET, PART = 4.0, 8
# Degrees of freedom that a tail may have, and what a heavy one costs.
TAILS = np.array([2.0, 2.5, 3.5, 5.0, 7.0, 10.0, 16.0, 30.0, 100.0])
HEAVY = 12.0
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


def chance_of(seen: Evidence, row: int) -> Chance:
    """Judge a pair, at the noise level of all pairs or at that of the others.

    The latter is the better model where the pair is far off, but is chosen in hindsight.

    Parameters
    ----------
    seen
        The pairs; three modes or more are left.
    row
        A pair that is kept.

    Examples
    --------
    >>> from pinwarp.core.evidence import evidence
    >>> from pinwarp.core.factor import factorise
    >>> from pinwarp.core.pair_field import PairField
    >>> source = np.random.default_rng(0).normal(size=(30, 3))
    >>> strange = 0.1 * np.sin(source)
    >>> strange[4] += 1
    >>> seen = evidence(PairField.of(factorise(source)), strange)
    >>> chance_of(seen, 4).value < 0.001 < chance_of(seen, 5).value
    True
    """
    chance = chance_at(seen, row, seen.level)
    level = seen.level_without(row)
    if level != seen.level:
        other = chance_at(seen, row, level)
        if HINDSIGHT * other.value < chance.value:
            return Chance(HINDSIGHT * other.value, other.shift, other.usual)
    return chance


def chance_at(seen: Evidence, row: int, level: int) -> Chance:
    """Judge a pair at one noise level."""
    others = _Others.of(seen, row, level)
    slope = _slope(others)
    grown = others.isolation**slope
    figures = np.where(others.kept, others.figures / grown, 0.0)
    before = float(np.mean(others.figures[others.kept]))
    shrunk = float(np.mean(figures[others.kept])) / max(before, _TINY)
    freedom = seen.freedom - 1
    middle = shrunk * float(seen.remaining[row, level]) / (3 * freedom)
    usual, own = _surroundings(others, figures, grown, middle)
    own *= float(grown[row])
    relative = figures[others.kept] / usual[others.kept]
    weight, scale = _tail(np.maximum(relative, NOTHING * relative.max()), freedom)
    gain = float(seen.gains[row, level])
    spread = 1 / (1 / TAILS + 1 / (3.0 * freedom))
    value = float(weight @ fdtrc(3, spread, gain / 3 / own / scale))
    precision = float(seen.precision[row, level])
    return Chance(
        value=value,
        shift=float(np.sqrt(gain / precision)),
        usual=float(np.sqrt(3 * own * float(weight @ scale) / precision)),
    )


@dataclass(frozen=True, eq=False)
class _Others:
    """The other pairs, one left out: everything by the rows of the whole set.

    ``isolation`` is ``1 / g`` in units of the median; of the one itself, with all the others.
    """

    seen: Evidence
    row: int
    level: int
    column: Matrix
    pulls: Matrix
    precision: Matrix
    kept: NDArray[np.bool_]
    figures: Matrix
    isolation: Matrix

    @classmethod
    def of(cls, seen: Evidence, row: int, level: int) -> _Others:
        column = seen.column(level, row)
        share = column / column[row]
        pulls = seen.pulls[:, :, level] - share[:, None] * seen.pulls[row, :, level]
        precision = seen.precision[:, level] - share * column
        kept = seen.kept & (precision > NOTHING * float(np.median(seen.precision[:, level])))
        kept[row] = False
        safe = np.where(kept, precision, 1.0)
        squares = np.einsum("nc,nc->n", pulls, pulls)
        isolation = 1 / safe / float(np.median(1 / safe[kept]))
        isolation[~kept] = 1 / float(seen.precision[row, level]) / float(np.median(1 / safe[kept]))
        return cls(
            seen=seen,
            row=row,
            level=level,
            column=column,
            pulls=pulls,
            precision=precision,
            kept=kept,
            figures=np.where(kept, squares / safe, 0.0) / 3,
            isolation=isolation,
        )


def _slope(others: _Others) -> float:
    """Return by which power of their isolation figures grow beyond what the field says."""
    figures = np.maximum(others.figures, max(NOTHING * float(others.figures.max()), _TINY))
    x, y = np.log(others.isolation[others.kept]), np.log(figures[others.kept])
    x = x - x.mean()
    return float(np.clip(x @ (y - y.mean()) / (x @ x + BELIEF), 0.0, STEEPEST))


def _surroundings(
    others: _Others, figures: Matrix, grown: Matrix, middle: float
) -> tuple[Matrix, float]:
    """Return what is usual around each pair, by its neighbours without it, and around the one."""
    seen, row, level = others.seen, others.row, others.level
    count = int(np.clip(len(figures) // PART, 1, NEIGHBOURS))
    near = seen.field.near[:, : count + 1]
    entries = seen.near_entries(level)[:, : count + 1]
    entries = entries - others.column[:, None] * others.column[near] / others.column[row]
    share = entries / np.where(others.kept, others.precision, np.inf)[:, None]
    pulls = others.pulls[near] - share[:, :, None] * others.pulls[:, None, :]
    precision = others.precision[near] - share * entries
    told = others.kept[near] & (precision > LITTLE * others.precision[near])
    squares = np.einsum("nkc,nkc->nk", pulls, pulls)
    theirs = np.where(told, squares / np.where(told, precision, 1.0), 0.0) / 3 / grown[near]
    # Of one neighbour more than needed the first that are there.
    told &= np.cumsum(told, axis=1) <= count
    number = told.sum(axis=1)
    usual = (WHOLE_SET * middle + np.sum(theirs * told, axis=1)) / (WHOLE_SET + number)
    around = [j for j in seen.field.near[row] if others.kept[j]][:count]
    own = (WHOLE_SET * middle + float(np.sum(figures[around]))) / (WHOLE_SET + len(around))
    return np.maximum(usual, max(1e-12 * middle, _TINY)), max(own, _TINY)


def _tail(figures: Matrix, freedom: int) -> tuple[Matrix, Matrix]:
    """Return how likely each of the tails is, and its scale: figures are scale times F(3, m)."""
    count = len(figures)
    x = figures[:, None]
    scale = np.full(len(TAILS), max(float(np.mean(figures)), _TINY))
    for _ in range(STEPS):
        weight = (TAILS + 3) / (TAILS + 3 * x / scale)
        scale = (np.sum(weight * x, axis=0) + SCALE) / (count + SCALE)
    # The density of F(3, m) without what is the same for all m.
    density = (
        gammaln((TAILS + 3) / 2)
        - gammaln(TAILS / 2)
        - 1.5 * np.log(TAILS)
        - (TAILS + 3) / 2 * np.log1p(3 * x / scale / TAILS)
    )
    likely = np.sum(density, axis=0) - 1.5 * count * np.log(scale)
    # So many dependent figures say no more than their freedom.
    likely *= freedom / count
    likely -= HEAVY / TAILS + 1.5 * SCALE * (1 / scale + np.log(scale) - 1)
    shares = np.exp(likely - likely.max())
    return shares / shares.sum(), scale
