"""The guide: asks for the landmarks of a list one after the other."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from pinwarp.core.landmarks import Landmark, Role
from pinwarp.session.session import Session


@dataclass(frozen=True)
class GuideStep:
    """Where the guide stands.

    Parameters
    ----------
    name
        The landmark that is asked for; None when all are complete.
    place
        Its number in the list, from 1.
    total
        How many there are.
    complete
        How many of them have both sides.
    """

    name: str | None
    place: int
    total: int
    complete: int


def asked_for(session: Session) -> tuple[Landmark, ...]:
    """Return the landmarks that a guide asks for: enabled ones that are to become pairs."""
    return tuple(x for x in session.landmarks if x.role is Role.PAIR and x.enabled)


def step_at(session: Session, name: str | None) -> GuideStep:
    """Say where the guide stands when it asks for a landmark.

    Examples
    --------
    >>> step_at(Session(landmarks=(Landmark("a"), Landmark("b"))), "b")
    GuideStep(name='b', place=2, total=2, complete=0)
    """
    landmarks = asked_for(session)
    names = [landmark.name for landmark in landmarks]
    complete = sum(landmark.is_complete for landmark in landmarks)
    place = names.index(name) + 1 if name in names else 0
    return GuideStep(name if place else None, place, len(names), complete)


def next_incomplete(session: Session, after: str | None, *, backwards: bool = False) -> str | None:
    """Return the next landmark that lacks a side, going round the list; None when there is none.

    Parameters
    ----------
    after
        Where to start; None starts at the beginning.
    backwards
        Go the other way.

    Examples
    --------
    >>> pair = Landmark("b", (0, 0, 0), (1, 1, 1))
    >>> session = Session(landmarks=(Landmark("a"), pair, Landmark("c")))
    >>> next_incomplete(session, "a"), next_incomplete(session, "c")
    ('c', 'a')
    """
    landmarks = list(session.landmarks)
    if backwards:
        landmarks.reverse()
    names = [landmark.name for landmark in landmarks]
    begin = names.index(after) + 1 if after in names else 0
    asked = {landmark.name for landmark in asked_for(session)}
    for landmark in landmarks[begin:] + landmarks[:begin]:
        if landmark.name in asked and not landmark.is_complete:
            return landmark.name
    return None


def with_template(session: Session, names: Iterable[str]) -> Session:
    """Return the session with a landmark for each name that it lacks, not placed yet."""
    known = {landmark.name for landmark in session.landmarks}
    new = tuple(Landmark(name) for name in dict.fromkeys(names) if name not in known)
    return replace(session, landmarks=session.landmarks + new)
