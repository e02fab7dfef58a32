"""Placing landmarks: new ones, sides of known ones, and taking them away."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from pinwarp.core.landmarks import Landmark, Position, Role, Side
from pinwarp.session.edits.landmarks import all_changed, changed, existing
from pinwarp.session.naming import NAME_PATTERN, PASSENGER_PATTERN, is_automatic
from pinwarp.session.session import Session

__all__ = [
    "accept",
    "add_passenger",
    "confirm",
    "move",
    "next_name",
    "next_to_place",
    "place",
    "remove",
    "remove_side",
    "swap_destinations",
]


def next_name(session: Session, pattern: str = NAME_PATTERN) -> str:
    """Return the name that the next new landmark gets.

    Parameters
    ----------
    pattern
        Holds ``{n}`` where the number goes.

    Examples
    --------
    >>> next_name(Session(landmarks=(Landmark("landmark_4"), Landmark("fovea"))))
    'landmark_5'
    """
    before, _, after = pattern.partition("{n}")
    numbered = re.compile(re.escape(before) + r"(\d+)" + re.escape(after))
    matches = (numbered.fullmatch(landmark.name) for landmark in session.landmarks)
    return f"{before}{max((int(m[1]) for m in matches if m), default=-1) + 1}{after}"


def next_to_place(session: Session, side: Side) -> str | None:
    """Return the first landmark that a click on this side would fill, None for a new one."""
    for landmark in session.landmarks:
        if landmark.role is Role.PAIR and landmark.enabled and landmark.position(side) is None:
            return landmark.name
    return None


def place(
    session: Session,
    side: Side,
    position: Position,
    *,
    target: str | None = None,
    pattern: str = NAME_PATTERN,
) -> tuple[Session, str]:
    """Place a landmark: the one that is asked for, else the first that lacks this side, else new.

    Parameters
    ----------
    target
        The landmark that is asked for, if any.
    pattern
        What a new one is called; see :func:`next_name`.

    Returns
    -------
    session, name
        The changed session, and which landmark was placed.
    """
    name = target or next_to_place(session, side)
    if name is not None:
        return move(session, name, side, position), name
    name = next_name(session, pattern)
    landmark = Landmark(name).placed(side, position)
    return replace(session, landmarks=(*session.landmarks, landmark)), name


def add_passenger(session: Session, position: Position) -> tuple[Session, str]:
    """Add a passenger on the source; it is carried by the warp but not solved for."""
    name = next_name(session, PASSENGER_PATTERN)
    landmark = Landmark(name, role=Role.PASSENGER).placed(Side.SOURCE, position)
    return replace(session, landmarks=(*session.landmarks, landmark)), name


def move(session: Session, name: str, side: Side, position: Position) -> Session:
    """Put one side of a landmark somewhere; a destination is no longer only suggested then."""
    return changed(session, name, lambda landmark: _put(landmark, side, position))


def accept(session: Session, name: str, side: Side, position: Position) -> Session:
    """Put one side of a landmark where it is expected, and remember that it was not chosen.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("a", (0, 0, 0)),))
    >>> there = accept(session, "a", Side.DESTINATION, (1, 0, 0))
    >>> moved = move(there, "a", Side.DESTINATION, (1, 0, 2))
    >>> there.landmark("a").is_accepted, moved.landmark("a").is_accepted
    (True, False)
    """
    return changed(session, name, lambda landmark: _put(landmark, side, position).accepted())


def confirm(session: Session, name: str) -> Session:
    """Say that somebody has looked at a destination that was only suggested, and left it there.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("a", (0, 0, 0)).suggested((1, 0, 0)),))
    >>> confirm(session, "a").landmark("a").state.value
    'paired'
    """
    return changed(session, name, Landmark.accepted)


def _put(landmark: Landmark, side: Side, position: Position | None) -> Landmark:
    placed = landmark.placed(side, position)
    # Nobody has looked at a suggested destination because its source was moved.
    return placed if placed.is_suggested and side is Side.SOURCE else placed.by_hand()


def swap_destinations(session: Session, name: str, other: str) -> Session:
    """Exchange the destinations of two landmarks, as when they were clicked in the wrong order.

    What was only suggested stays so, for the other landmark.

    Examples
    --------
    >>> ends = [(1.0, 0.0, 0.0), (2.0, 0.0, 0.0)]
    >>> session = Session(landmarks=tuple(map(Landmark, "ab", [None, None], ends)))
    >>> swap_destinations(session, "a", "b").landmark("a").destination
    (2.0, 0.0, 0.0)
    """
    there = {name: existing(session, other), other: existing(session, name)}

    def swapped(landmark: Landmark) -> Landmark:
        given = there[landmark.name]
        place = given.destination
        if place is not None and given.is_suggested:
            return landmark.suggested(place)
        return _put(landmark, Side.DESTINATION, place)

    return all_changed(session, there, swapped)


def remove_side(session: Session, name: str, side: Side) -> Session:
    """Remove one position; a landmark that had no other goes too, unless somebody named it."""
    landmark = existing(session, name)
    bare = _put(landmark, side, None)
    nothing_left = bare.source is None and bare.destination is None
    # Nobody chose that name: such a landmark may go with its last side.
    if nothing_left and is_automatic(name) and not landmark.note:
        return remove(session, [name])
    return changed(session, name, lambda _: bare)


def remove(session: Session, names: Iterable[str]) -> Session:
    """Remove landmarks altogether."""
    gone = set(names)
    kept = tuple(landmark for landmark in session.landmarks if landmark.name not in gone)
    return replace(session, landmarks=kept)
