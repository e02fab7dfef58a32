"""Where a first guess puts the landmarks that are missing."""

from __future__ import annotations

from dataclasses import dataclass

from pinwarp.core.guessed import Reading, guessed
from pinwarp.core.landmarks import Position, Side, as_position, positions
from pinwarp.session.session import Session
from pinwarp.session.suggesting.guessing import known_pairs, missing_of


@dataclass(frozen=True)
class SuggestedPlace:
    """Where a landmark is expected on the destination.

    Parameters
    ----------
    name
        The landmark.
    position
        On the destination's surface, in its unit.
    radius
        The doubt, in the same unit: most lie closer, few at twice as far.
    """

    name: str
    position: Position
    radius: float


def ghosts_of(reading: Reading, session: Session) -> tuple[SuggestedPlace, ...]:
    """Return where the landmarks that are missing on the destination are expected.

    Parameters
    ----------
    reading
        A reading of the first guess for the meshes of this session.
    session
        As it is now: what was placed or accepted since moves the others.

    Returns
    -------
    tuple of SuggestedPlace
        The most certain first. Those that lie beyond the rim of the destination are not there,
        nor are passengers.
    """
    missing = missing_of(session)
    if not missing:
        return ()
    known = known_pairs(session)
    found = guessed(
        reading,
        positions(missing, Side.SOURCE),
        positions(known, Side.SOURCE),
        positions(known, Side.DESTINATION),
    )
    return tuple(
        SuggestedPlace(
            missing[row].name, as_position(found.positions[row]), float(found.radii[row])
        )
        for row in found.order
        if not found.beyond_rim[row]
    )
