"""Landmarks that arrive from files and spreadsheets."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.clipboard_table import PastedLandmark
from pinwarp.session.edits.landmarks import set_enabled
from pinwarp.session.session import Session

__all__ = [
    "import_pairs",
    "import_side",
    "paste",
]


def import_side(session: Session, side: Side, landmarks: Iterable[Landmark]) -> Session:
    """Bring in positions for one side: by name where the name is known, else as new landmarks.

    A landmark without a position comes as a name to be placed; it takes no position away.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("head", (1.0, 2.0, 3.0)),))
    >>> arriving = [Landmark("head"), Landmark("fovea")]
    >>> [x.source for x in import_side(session, Side.SOURCE, arriving).landmarks]
    [(1.0, 2.0, 3.0), None]
    """
    arriving = {landmark.name: landmark.position(side) for landmark in landmarks}
    known = {landmark.name for landmark in session.landmarks}
    merged = tuple(
        landmark.placed(side, arriving[landmark.name])
        if arriving.get(landmark.name) is not None
        else landmark
        for landmark in session.landmarks
    )
    new = tuple(
        Landmark(name).placed(side, position)
        for name, position in arriving.items()
        if name not in known
    )
    return replace(session, landmarks=merged + new)


def import_pairs(session: Session, landmarks: Iterable[Landmark]) -> Session:
    """Bring in pairs: known names get the positions that arrive, others become new landmarks."""
    arriving = tuple(landmarks)
    known = {landmark.name for landmark in session.landmarks}
    for side in Side:
        session = import_side(session, side, arriving)
    # A new pair may come switched off; one that is here keeps its state.
    off = {landmark.name for landmark in arriving if not landmark.enabled} - known
    return set_enabled(session, off, False)


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
