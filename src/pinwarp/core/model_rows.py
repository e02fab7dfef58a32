"""What became of the elements of a model: a row for each, warped, kept or flagged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class Outcome(StrEnum):
    """What became of an element.

    Examples
    --------
    >>> Outcome.FLAGGED.value
    'flagged'
    """

    WARPED = "warped"
    KEPT = "kept"
    FLAGGED = "flagged"


@dataclass(frozen=True)
class ElementRow:
    """What became of one element; lengths in the unit of the model, NaN where there is none.

    Parameters
    ----------
    body
        The name of the body that it stands on.
    path, kind, line
        The element, what it is, and where in the file.
    is_warped
        Whether it was carried; it was kept otherwise.
    words
        By which rule, as a clause.
    moved
        How far the bone moves it.
    plus_minus
        How far that may be off: the standard deviation of one coordinate.
    turned
        By how many degrees the bone turns there.
    flag
        What to look at, as a sentence; empty where nothing is.

    Examples
    --------
    >>> ElementRow("thigh", "/markerset/KNEE", "marker", 7, True, "carried", 0.01).outcome.value
    'warped'
    """

    body: str
    path: str
    kind: str
    line: int
    is_warped: bool
    words: str
    moved: float = math.nan
    plus_minus: float = math.nan
    turned: float = math.nan
    flag: str = ""

    @property
    def outcome(self) -> Outcome:
        """Flagged where there is something to look at, whether it was warped or kept."""
        if self.flag:
            return Outcome.FLAGGED
        return Outcome.WARPED if self.is_warped else Outcome.KEPT

    def as_json(self) -> dict[str, Any]:
        """Return all of it as plain values for JSON; figures that are not known are None."""
        plain = {
            key: None if isinstance(value, float) and math.isnan(value) else value
            for key, value in asdict(self).items()
        }
        return {"outcome": self.outcome.value, **plain}


def counts(rows: Sequence[ElementRow]) -> dict[Outcome, int]:
    """Return how many rows there are of each outcome.

    Examples
    --------
    >>> counts([])[Outcome.KEPT]
    0
    """
    return {outcome: sum(row.outcome is outcome for row in rows) for outcome in Outcome}
