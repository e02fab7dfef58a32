"""Landmarks that arrive from files and spreadsheets."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.clipboard_table import PastedLandmark
from pinwarp.session.session import Session

__all__ = [
    "import_pairs",
    "import_side",
    "paste",
]


def import_side(session: Session, side: Side, landmarks: Iterable[Landmark]) -> Session:
    """Bring in positions for one side: by name where the name is known, else as new landmarks.

    A landmark without a position comes as a name to be placed; it takes no position away. Role,
    note, lock and whether it is enabled are those of the file where it is new; of one that is here
    only an empty note is filled.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("head", (1.0, 2.0, 3.0)),))
    >>> arriving = [Landmark("head"), Landmark("fovea")]
    >>> [x.source for x in import_side(session, Side.SOURCE, arriving).landmarks]
    [(1.0, 2.0, 3.0), None]
    """
    arriving = {landmark.name: landmark for landmark in landmarks}
    known = {landmark.name for landmark in session.landmarks}
    merged = tuple(
        landmark
        if landmark.name not in arriving
        else _with_position(landmark, side, arriving[landmark.name])
        for landmark in session.landmarks
    )
    new = tuple(
        Landmark(name, role=one.role, enabled=one.enabled, note=one.note, locked=one.locked).placed(
            side, one.position(side)
        )
        for name, one in arriving.items()
        if name not in known
    )
    return replace(session, landmarks=merged + new)


def _with_position(landmark: Landmark, side: Side, arriving: Landmark) -> Landmark:
    """Return a landmark that is here with what arrives of it: what it has itself stays."""
    position = arriving.position(side)
    placed = landmark if position is None else landmark.placed(side, position)
    return placed if landmark.note else replace(placed, note=arriving.note)


def import_pairs(session: Session, landmarks: Iterable[Landmark]) -> Session:
    """Bring in pairs: known names get the positions that arrive, others become new landmarks."""
    arriving = tuple(landmarks)
    for side in Side:
        session = import_side(session, side, arriving)
    return session


def paste(session: Session, rows: Iterable[PastedLandmark]) -> Session:
    """Bring in rows of a table: known names are changed, others become new landmarks at the end.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("head"),))
    >>> rows = [PastedLandmark(2, "fovea"), PastedLandmark(3, "head", {"enabled": False})]
    >>> [(x.name, x.enabled) for x in paste(session, rows).landmarks]
    [('head', False), ('fovea', True)]
    """
    arriving = {row.name: row for row in rows}
    known = {landmark.name for landmark in session.landmarks}
    merged = tuple(
        arriving[landmark.name].onto(landmark) if landmark.name in arriving else landmark
        for landmark in session.landmarks
    )
    new = tuple(row.onto(Landmark(name)) for name, row in arriving.items() if name not in known)
    return replace(session, landmarks=merged + new)
