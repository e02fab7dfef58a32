"""Where the semilandmarks of a session rest, kept with it for when a mesh is missing."""

from __future__ import annotations

from dataclasses import replace

from pinwarp.core.landmarks import Position, as_position
from pinwarp.io.group_record import SlidRecord
from pinwarp.session.session import Session
from pinwarp.session.warp.fingerprint import fingerprint, group_parts, mesh_parts
from pinwarp.session.warp.sliding import SlidGroups


def rest_in_use(session: Session) -> SlidRecord | None:
    """Return where the semilandmarks were at rest, where that belongs to what the session is now.

    Examples
    --------
    >>> rest_in_use(Session()) is None
    True
    """
    slid = session.slid
    return slid if slid is not None and slid.inputs == _inputs_of(session) else None


def with_rest(session: Session, at_rest: SlidGroups | None) -> Session:
    """Return a session that knows where its semilandmarks are at rest.

    Parameters
    ----------
    session
        What is to be written.
    at_rest
        Of its warp; None where they cannot slide, as without a mesh: what it knew of old is then
        kept as long as it belongs to it.
    """
    if at_rest is None:
        return replace(session, slid=rest_in_use(session))
    source: list[Position] = []
    destination: list[Position | None] = []
    for group in at_rest.groups:
        rest = {
            number: None if freed else as_position(place)
            for number, freed, place in zip(
                group.numbers.tolist(), group.is_freed, group.positions, strict=True
            )
        }
        points = group.points
        # One at the place of another took no part.
        wanted = [n for n in range(group.group.count) if n not in group.group.excluded]
        source += [points[n] for n in wanted]
        destination += [rest.get(n) for n in wanted]
    record = SlidRecord(tuple(source), tuple(destination), _inputs_of(session))
    return replace(session, slid=record)


def _inputs_of(session: Session) -> str:
    """Return a hash of all that the rest of semilandmarks follows from: no names."""
    places = tuple((pair.source, pair.destination) for pair in session.pairs)
    groups = tuple(group_parts(session, session.groups))
    return fingerprint((places, groups, mesh_parts(session)))
