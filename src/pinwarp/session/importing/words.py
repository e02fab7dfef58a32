"""What becomes of all landmarks of a file together, in words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pinwarp.core.words import NAMED
from pinwarp.session.importing.landmarks import Arrival, Arriving, Fate, awaiting
from pinwarp.session.session import Session


def left_waiting(session: Session, arriving: Arriving, found: Iterable[Arrival]) -> tuple[str, ...]:
    """Return the pairs that still lack a position when others have found theirs.

    Examples
    --------
    >>> from pathlib import Path
    >>> from pinwarp.core.landmarks import Landmark, Side
    >>> from pinwarp.io.landmark_files import LandmarkReading
    >>> from pinwarp.session.importing.landmarks import ImportChoice, Pairing, arrivals
    >>> session = Session(landmarks=(Landmark("a", (1, 2, 3)), Landmark("b", (4, 5, 6))))
    >>> reading = LandmarkReading((Landmark("a", None, (7, 8, 9)),), False, ())
    >>> file = Arriving(Path("a.csv"), reading, Side.DESTINATION)
    >>> left_waiting(session, file, arrivals(session, file, ImportChoice(Pairing.BY_NAME)))
    ('b',)
    """
    met = {x.target for x in found if x.fate is Fate.PAIRS}
    if arriving.side is None or not met:
        return ()
    return tuple(name for name in awaiting(session, arriving.side) if name not in met)


def summary(found: Iterable[Arrival], waiting: Sequence[str] = ()) -> str:
    """Say what becomes of all together, and name those that are few.

    Parameters
    ----------
    found
        What becomes of each.
    waiting
        Pairs of the session that nothing came for.

    Examples
    --------
    >>> from pinwarp.core.landmarks import Landmark
    >>> fates = zip("abcdef", [Fate.PAIRS] * 5 + [Fate.NEW])
    >>> summary([Arrival(Landmark(name), name, fate, "") for name, fate in fates], ["g"])
    '5 pair up, 1 is new (f). 1 of the session still waits (g).'
    """
    names: dict[Fate, list[str]] = {}
    for arrival in found:
        names.setdefault(arrival.fate, []).append(arrival.landmark.name)
    parts = []
    for fate in Fate:
        who = names.get(fate, [])
        if who:
            few = _named(who) if len(names) > 1 else ""
            parts.append(f"{len(who):,} {fate.value if len(who) == 1 else fate.of_several}{few}")
    # A file may hold nothing but curves.
    words = f"{', '.join(parts)}." if parts else ""
    if waiting:
        wait = "still waits" if len(waiting) == 1 else "still wait"
        words += f" {len(waiting):,} of the session {wait}{_named(waiting)}."
    return words


def _named(names: Sequence[str]) -> str:
    return f" ({', '.join(names)})" if len(names) <= NAMED else ""
