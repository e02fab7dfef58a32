"""How often the judgement of pairs is right: shares of made-up sets with and without mistakes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from pinwarp.core.findings import Finding, FindingKind, Severity
from pinwarp.core.mirror import is_mirrored
from pinwarp.core.suspects import suspects
from tests.core.mistaken import MadeUp, heavy_tailed, made_up, smooth, stationary

Row = dict[str, Any]
Found = list[Finding]
Judged = tuple[MadeUp, Found]

FIELDS = {"stationary": stationary, "smooth": smooth, "heavy-tailed": heavy_tailed}
SIZES = (7, 10, 16, 25, 60, 150, 300, 600)
# About how many landmarks are judged in each cell of the table; no fewer sets than the least.
WORK, LEAST, MOST = 9000, 20, 600
# Larger sets are only looked at without a mistake.
LARGE = 150


def rates() -> Iterator[Row]:
    """Shares of the sets, in per cent: what should not be said, then what should."""
    for name, field in FIELDS.items():
        for count in SIZES:
            yield rates_of(name, field, count)


def rates_of(name: str, field: Any, count: int) -> Row:
    """Return the shares of one field and size."""
    sets = min(max(WORK // count, LEAST), MOST)

    def judged(**mistakes: Any) -> list[Judged]:
        cases = (made_up(count, seed, field, **mistakes) for seed in range(sets))
        return [(case, list(suspects(case.factor, case.destination))) for case in cases]

    row: Row = {"what": name, "pairs": count, "sets": sets}
    clean = judged()
    row["clean: strict"] = _share(lambda _m, found: bool(_strict(found)), clean)
    row["clean: a look"] = _share(_worth, clean)
    if count <= LARGE:
        displaced, two = judged(displaced=1), judged(displaced=2, off=0.15)
        row["one named"] = _share(_all_named, displaced)
        row["two named"] = _share(_all_named, two)
        if count // 10 > 1:
            row["tenth named"] = _share(_all_named, judged(displaced=count // 10, off=0.15))
        row["innocents"] = _share(_innocents, displaced)
        row["false swaps"] = _share(_false_swaps, displaced)
        row["swap exactly"] = _share(_exactly, judged(swap=True))
        row["swap and one"] = _share(_all_named, judged(swap=True, displaced=1))
        row["mirror and one"] = _share(_mirrored, displaced)
    return row


def _share(says: Callable[[MadeUp, Found], bool], judged: list[Judged]) -> float:
    """Return of how many sets something is so, in per cent."""
    return 100 * sum(says(case, found) for case, found in judged) / len(judged)


def _strict(found: Found) -> Found:
    return [x for x in found if x.severity is Severity.WRONG]


def _worth(_case: MadeUp, found: Found) -> bool:
    return any(x.kind is FindingKind.WORTH_A_LOOK for x in found)


def _all_named(case: MadeUp, found: Found) -> bool:
    named = {row for finding in _strict(found) for row in finding.rows}
    return case.wrong <= named


def _innocents(case: MadeUp, found: Found) -> bool:
    return any(not case.wrong.intersection(finding.rows) for finding in _strict(found))


def _false_swaps(case: MadeUp, found: Found) -> bool:
    swaps = (x.rows for x in found if x.kind is FindingKind.SWAPPED)
    return any(not case.wrong.intersection(rows) for rows in swaps)


def _exactly(case: MadeUp, found: Found) -> bool:
    kinds = [x.kind for x in _strict(found) if set(x.rows) == set(case.swapped)]
    return kinds == [FindingKind.SWAPPED]


def _mirrored(case: MadeUp, _found: Found) -> bool:
    """Whether the set is known for one where it is mirrored."""
    return is_mirrored(case.factor.source, case.destination * [1, 1, -1])
