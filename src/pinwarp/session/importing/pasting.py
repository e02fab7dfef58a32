"""Rows that are pasted onto a session that is paired: what they bring that would only wait."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.io.clipboard_table import PastedLandmark
from pinwarp.session.importing.landmarks import is_paired
from pinwarp.session.session import Session


def halves(session: Session, rows: Iterable[PastedLandmark]) -> tuple[PastedLandmark, ...]:
    """Return the rows that name new landmarks on one side only, where all others are paired.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("head", (1, 2, 3), (4, 5, 6)),))
    >>> rows = [PastedLandmark(1, "soleus", {"source": (1, 2, 3)}), PastedLandmark(2, "tip")]
    >>> [row.name for row in halves(session, rows)]
    ['soleus']
    """
    if not is_paired(session):
        return ()
    return tuple(
        row
        for row in rows
        if session.landmark(row.name) is None and _is_half(row.onto(Landmark(row.name)))
    )


def as_passengers(row: PastedLandmark) -> PastedLandmark:
    """Return a row that brings a passenger."""
    return replace(row, values={**row.values, "role": Role.PASSENGER})


def _is_half(landmark: Landmark) -> bool:
    placed = [landmark.position(side) is not None for side in Side]
    return landmark.role is Role.PAIR and any(placed) and not all(placed)
