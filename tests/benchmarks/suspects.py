"""How often the judgement of pairs is right: shares of made-up sets with and without mistakes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from pinwarp.core.findings import Finding, FindingKind, Severity
from pinwarp.core.mirror import is_mirrored
from pinwarp.core.suspects import suspects
from tests.core.mistaken import MadeUp, made_up, smooth, stationary

Row = dict[str, Any]
Found = list[Finding]

FIELDS = {"stationary": stationary, "smooth": smooth}
SIZES = (7, 10, 16, 25, 60, 150, 300, 600)
# About how many landmarks are judged in each cell of the table; no fewer sets than the least.
WORK, LEAST, MOST = 9000, 20, 600
# Larger sets are only looked at without a mistake.
LARGE = 150


def rates() -> Iterator[Row]:
    """Shares of the sets, in per cent: what should not be said, then what should."""
    for name, field in FIELDS.items():
        for count in SIZES:
            sets = min(max(WORK // count, LEAST), MOST)
            share = _shares(count, sets, field)
            row: Row = {"what": name, "pairs": count, "sets": sets}
            row["clean: strict"] = share(lambda _m, found: bool(found))
            row["clean: a look"] = share(_worth, everything=True)
            if count <= LARGE:
                row["one named"] = share(_all_named, displaced=1)
                row["two named"] = share(_all_named, displaced=2, off=0.15)
                row["innocents"] = share(_innocents, displaced=1)
                row["false swaps"] = share(_false_swaps, displaced=1)
                row["swap exactly"] = share(_exactly, swap=True)
                row["swap and one"] = share(_all_named, swap=True, displaced=1)
                row["mirror and one"] = 100 * _mirrors(count, sets, field)
            yield row


def _shares(count: int, sets: int, field: Any) -> Callable[..., float]:
    def share(
        says: Callable[[MadeUp, Found], bool], *, everything: bool = False, **mistakes: Any
    ) -> float:
        said = 0
        for seed in range(sets):
            case = made_up(count, seed, field, **mistakes)
            found = suspects(case.factor, case.destination)
            strict = [x for x in found if everything or x.severity is Severity.WRONG]
            said += says(case, strict)
        return 100 * said / sets

    return share


def _worth(_case: MadeUp, found: Found) -> bool:
    return any(x.kind is FindingKind.WORTH_A_LOOK for x in found)


def _all_named(case: MadeUp, found: Found) -> bool:
    named = {row for finding in found for row in finding.rows}
    return case.wrong <= named


def _innocents(case: MadeUp, found: Found) -> bool:
    return any(not case.wrong.intersection(finding.rows) for finding in found)


def _false_swaps(case: MadeUp, found: Found) -> bool:
    return any(x.kind is FindingKind.SWAPPED and not case.wrong.intersection(x.rows) for x in found)


def _exactly(case: MadeUp, found: Found) -> bool:
    return [x.kind for x in found if set(x.rows) == set(case.swapped)] == [FindingKind.SWAPPED]


def _mirrors(count: int, sets: int, field: Any) -> float:
    """The share of mirrored sets that are known, one of them displaced."""
    cases = (made_up(count, seed, field, displaced=1) for seed in range(sets))
    told = [is_mirrored(x.factor.source, x.destination * [1, 1, -1]) for x in cases]
    return sum(told) / sets
