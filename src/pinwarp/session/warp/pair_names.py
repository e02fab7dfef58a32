"""Which landmarks of a session the rows of a warp stand for, though the session has moved on."""

from __future__ import annotations

from pinwarp.core.landmarks import Position
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs

Places = tuple[Position | None, Position | None]


def pair_names(
    inputs: WarpInputs, session: Session, *, exactly: bool = False
) -> tuple[str | None, ...]:
    """Return the name of each pair of a warp in a session; None where it is no longer there.

    Pairs are known by their places, as a name may since mean another one. One that was moved on
    one side only, as by a drag, is known by the other.

    Parameters
    ----------
    inputs
        What the warp was computed from.
    session
        The session as it is now.
    exactly
        Whether a pair that was moved counts as another.

    Examples
    --------
    >>> from pinwarp.core.landmarks import Landmark
    >>> here = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)
    >>> inputs = WarpInputs.of(Session(landmarks=(Landmark("a", *here),)))
    >>> moved = Session(landmarks=(Landmark("b"), Landmark("c", (0, 0, 0), (9, 0, 0))))
    >>> pair_names(inputs, moved), pair_names(inputs, moved, exactly=True)
    (('c',), (None,))
    """
    pairs = session.pairs
    wanted: list[Places] = list(zip(inputs.source, inputs.destination, strict=True))
    places: list[Places] = [(pair.source, pair.destination) for pair in pairs]
    found: list[str | None] = [None] * len(wanted)
    free = dict(enumerate(pairs))
    # Nearly all stand where they stood: the rest is looked for.
    for row, (now, before) in enumerate(zip(places, wanted, strict=False)):
        if now == before:
            found[row] = free.pop(row).name
    if not free:
        return tuple(found)
    for key in (_both,) if exactly else (_both, _source, _destination):
        there = {key(places[i]): i for i in reversed(free)}
        for row, name in enumerate(found):
            i = there.get(key(wanted[row])) if name is None else None
            if i is not None and i in free:
                found[row] = free.pop(i).name
    return tuple(found)


def _both(places: Places) -> object:
    return places


def _source(places: Places) -> object:
    return places[0]


def _destination(places: Places) -> object:
    return places[1]
