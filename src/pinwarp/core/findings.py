"""What was noticed about a set of landmarks: facts as data, turned into words on demand."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum, StrEnum
from typing import Protocol, TypeVar

from pinwarp.core.lengths import Ruler
from pinwarp.core.words import counted, listed


class Severity(IntEnum):
    """How bad a finding is.

    Something ``WRONG`` should be put right before the warp is used; a ``WARNING`` says that it may
    be; a ``REMARK`` is only worth knowing.
    """

    REMARK = 0
    WARNING = 1
    WRONG = 2


# A chance smaller than one in so many is no better known.
RAREST = 1000
# Where landmarks lie that span no, one or two directions, and what to place besides.
_SPANS = (
    ("at one place", "others elsewhere"),
    ("on one line", "two away from the line"),
    ("in one plane", "one off the plane"),
)
# Of more landmarks than this a sentence names the first, and says how many more there are.
MOST_NAMED = 4


class FindingKind(StrEnum):
    """What was noticed.

    Examples
    --------
    >>> FindingKind.FOLD.severity.name, FindingKind.POLE.severity.name
    ('WRONG', 'WARNING')
    """

    CONFLICT = "conflict"
    CLOSE = "close"
    NEARLY_PLANAR = "nearly planar"
    PLANAR = "planar"
    POLE = "pole"
    FOLD = "fold"
    MIRRORED = "mirrored"
    SWAPPED = "swapped"
    DISPLACED = "displaced"
    EITHER = "either of two"
    WORTH_A_LOOK = "worth a look"
    ISOLATED = "isolated"
    SUGGESTED = "suggested"
    ACCEPTED = "accepted unmoved"
    ELSEWHERE = "elsewhere"
    FAR = "far from the mesh"
    UNITS = "different units"

    @property
    def severity(self) -> Severity:
        """How bad it is: what lists, marks, their order and strict checks go by."""
        match self:
            case (
                FindingKind.WORTH_A_LOOK
                | FindingKind.ISOLATED
                | FindingKind.ACCEPTED
                | FindingKind.UNITS
            ):
                return Severity.REMARK
            case (
                FindingKind.CLOSE
                | FindingKind.NEARLY_PLANAR
                | FindingKind.PLANAR
                | FindingKind.POLE
                | FindingKind.SUGGESTED
                | FindingKind.FAR
            ):
                return Severity.WARNING
            case _:
                return Severity.WRONG


@dataclass(frozen=True, slots=True)
class Finding:
    """One fact about a set of pairs.

    Parameters
    ----------
    kind
        What was noticed.
    rows
        The pairs concerned, by their row in the solve.
    value
        The figure that goes with it: for a conflict the largest distance on the destination, for
        close landmarks the smallest on the source (mesh units), for nearly planar landmarks the
        ratio of the smallest to the largest extent, for planar ones how many directions they span,
        for a pole its penalty (mesh units), for a
        fold the number of its vertices. For swapped or displaced pairs, either of two and what is
        worth a look, the chance that a set without a mistake shows as much; for an isolated
        landmark the distance to the nearest; for a mirrored set what a reflection leaves of the
        misfit, for suggested destinations and accepted pairs how many there are. For landmarks
        elsewhere, in another frame or unit than their mesh, or far from it, the median distance
        from it; for meshes in different units how many times as large as the source the
        destination is.
    others
        Further figures (mesh units): for a displaced pair, either of two and what is worth a look
        how far it lies from where the other pairs expect it and how far is usual there; for an
        isolated landmark its leave-one-out error; for suggested destinations and accepted pairs of
        how many they are, and for the latter the leave-one-out error of the others alone where
        it is known; for landmarks elsewhere their distance when they are read right, for
        those far from their mesh how large it is.
    """

    kind: FindingKind
    rows: tuple[int, ...]
    value: float
    others: tuple[float, ...] = ()

    @property
    def severity(self) -> Severity:
        """How bad it is."""
        return self.kind.severity

    @property
    def is_grave(self) -> bool:
        """Whether something is or may be wrong."""
        return self.severity > Severity.REMARK

    def describe(
        self,
        names: Sequence[str] | None = None,
        unit: Ruler | str = "",
        spreads: Mapping[str, float] | None = None,
    ) -> str:
        """Say it in a sentence.

        Parameters
        ----------
        names
            The landmarks' names by row; without them the rows are counted from 0.
        unit
            How lengths are told, or only the unit put behind them.
        spreads
            How far landmarks may be off because of how they were digitised (mesh units), by
            name, where that was measured: what a pair is off is told in units of it as well.

        Examples
        --------
        >>> Finding(FindingKind.CONFLICT, (0, 1), 2.5).describe(["apex", "tip"], "mm")
        'apex and tip lie at the same place on the source but 2.5 mm apart on the destination.'
        >>> off = Finding(FindingKind.DISPLACED, (0,), 0.01, (4.1, 1.2))
        >>> off.describe(["apex"], "mm", {"apex": 0.5}).split(";")[0]
        'apex lies 4.1 mm from where the other pairs expect it, 8.2 times its own spread'
        """
        told = [names[row] if names else f"landmark {row}" for row in self.rows]
        who = _who(told)
        ruler = Ruler.of(unit)
        length = ruler.text(self.value)
        other, usual = (*(ruler.text(figure, 3) for figure in self.others), "", "")[:2]
        expected = f"{other} from where the other pairs expect it"
        if told and self.others and (spread := (spreads or {}).get(told[0], 0.0)) > 0:
            expected += f", {_multiple(self.others[0] / spread)} times its own spread"
        match self.kind:
            case FindingKind.CONFLICT:
                apart = length if len(self.rows) == 2 else f"up to {length}"
                return (
                    f"{who} lie at the same place on the source but {apart} apart "
                    "on the destination."
                )
            case FindingKind.CLOSE:
                apart = length if len(self.rows) == 2 else f"{length} or little more"
                return f"{who} are only {apart} apart on the source: the warp bends hard there."
            case FindingKind.NEARLY_PLANAR:
                return (
                    "The source landmarks lie nearly in one plane: "
                    "far from the landmarks the warp is unreliable."
                )
            case FindingKind.PLANAR:
                where, away = _SPANS[min(int(self.value), 2)]
                return (
                    f"The source landmarks lie {where}: off it they say nothing, and the warp only "
                    f"moves, turns and sizes what is there. Place {away}."
                )
            case FindingKind.POLE:
                return (
                    f"The penalty is near or above the pole at {length}: under the OPYNSIM "
                    "convention it over-warps there instead of smoothing."
                )
            case FindingKind.FOLD:
                fold = "1 vertex folds" if self.value == 1 else f"{self.value:,.0f} vertices fold"
                near = f" near {who}" if who else ""
                return f"{fold}{near}: the warp turns the surface inside out there."
            case FindingKind.ISOLATED:
                free = f"{_round_down(ruler.shown(self.value))} {ruler.unit}".rstrip()
                return (
                    f"{who} is isolated: no landmark within {free}. "
                    f"That the other pairs miss it by {other} says little about it."
                )
            case FindingKind.SWAPPED:
                return (
                    f"{who} look swapped: exchanging their destinations explains the set better "
                    f"than any single displaced pair. The other pairs were judged "
                    "with them put right."
                )
            case FindingKind.DISPLACED:
                return (
                    f"{who} lies {expected}; {usual} is usual "
                    f"there. A set without a mistake shows as much about once in "
                    f"{_times(self.value)}. The other pairs were judged without it."
                )
            case FindingKind.EITHER:
                return (
                    f"{' or '.join(told)} is wrong: leaving out either explains the set "
                    f"about equally well. {told[0]} lies {expected}; "
                    f"{usual} is usual there. The other pairs were judged without "
                    f"{told[0]}."
                )
            case FindingKind.WORTH_A_LOOK:
                return (
                    f"{who} lies {expected}; {usual} is usual "
                    f"there. About one set without a mistake in {_times(self.value)} has such a "
                    "pair."
                )
            case FindingKind.MIRRORED:
                return (
                    "The destination looks like a mirror image of the source: "
                    "are they a left and a right bone?"
                )
            case FindingKind.SUGGESTED:
                verb, each = ("is", "it") if self.value == 1 else ("are", "each")
                return (
                    f"{self.value:.0f} of {counted(int(self.others[0]), 'destination landmark')} "
                    f"{verb} only suggested: look at {each}."
                )
            case FindingKind.ACCEPTED:
                verb, proves = ("is", "It proves") if self.value == 1 else ("are", "They prove")
                counts = "the leave-one-out error and the uncertainty count them as if they did"
                alone = f"the leave-one-out error of the others alone is {usual}"
                return (
                    f"{self.value:.0f} of {counted(int(self.others[0]), 'pair')} {verb} as "
                    f"proposed, accepted unmoved. {proves} nothing: {alone if usual else counts}."
                )
            case FindingKind.ELSEWHERE:
                return (
                    f"The landmarks lie {length} from their mesh in the median, but {other} when "
                    "they are read in another frame or unit."
                )
            case FindingKind.FAR:
                return (
                    f"The landmarks lie {length} from their mesh in the median, and it is {other} "
                    "across: is it the one that they were placed on?"
                )
            case FindingKind.UNITS:
                larger, smaller = ("destination", "source")[:: 1 if self.value > 1 else -1]
                times = max(self.value, 1 / self.value)
                return f"The {larger} mesh is {times:,.0f} times as large as the {smaller}."


def _who(names: Sequence[str]) -> str:
    """Say one or several; of many the first, and how many more."""
    if len(names) > MOST_NAMED:
        names = [*names[: MOST_NAMED - 1], f"{len(names) - MOST_NAMED + 1} more"]
    return listed(names)


class _Judged(Protocol):
    @property
    def severity(self) -> Severity: ...


_Found = TypeVar("_Found", bound=_Judged)


def gravest_first(found: Iterable[_Found]) -> tuple[_Found, ...]:
    """Sort findings by their severity; those of one severity keep their order.

    Examples
    --------
    >>> kinds = [FindingKind.ISOLATED, FindingKind.CLOSE, FindingKind.EITHER, FindingKind.FOLD]
    >>> [one.kind.value for one in gravest_first(Finding(kind, (), 1.0) for kind in kinds)]
    ['either of two', 'fold', 'close', 'isolated']
    """
    return tuple(sorted(found, key=lambda one: -one.severity))


def _times(chance: float) -> str:
    """Say about how often a chance comes true: once in so many."""
    times = 1 / max(chance, 1 / RAREST)
    return f"{times:,.0f}" if times < 10 else f"{float(f'{times:.1g}'):,.0f}"


def _multiple(times: float) -> str:
    return f"{times:.1f}" if times < 10 else f"{times:,.0f}"


def _round_down(value: float) -> str:
    """Say a length in two digits that it is not below."""
    if not value > 0:
        return "0"
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    # Rounding must not turn the 7 of 7.0 into a 6.9.
    return f"{math.floor(value / step * (1 + 1e-12)) * step:.6g}"
