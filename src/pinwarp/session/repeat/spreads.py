"""The spreads that a session keeps, and lengths told in units of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from pinwarp.core.landmarks import Landmark, Side, positions
from pinwarp.core.noise import linear_size
from pinwarp.session.session import Session


def kept_variance(landmarks: Iterable[Landmark], side: Side) -> float | None:
    """Return the pooled variance of one coordinate that spreads on one side stand for.

    Examples
    --------
    >>> kept_variance([Landmark("apex", source_spread=3.0), Landmark("tip")], Side.SOURCE)
    3.0
    """
    spreads = [x for landmark in landmarks if (x := landmark.spread(side)) is not None]
    return sum(x * x for x in spreads) / (3 * len(spreads)) if spreads else None


def has_spreads(session: Session) -> bool:
    """Whether any landmark has a spread."""
    return any(x.spread(side) is not None for x in session.landmarks for side in Side)


def spreads_on_destination(session: Session) -> Mapping[str, float]:
    """Return how far each pair may be off on the destination, because of how it was digitised.

    What was measured on both sides is added as variances; that of the source is carried over by
    the affine fit of all pairs, see :func:`~pinwarp.core.noise.carried_variance`.

    Returns
    -------
    Mapping
        Lengths in destination units by name; pairs without a spread, or with one of 0, have none.

    Examples
    --------
    >>> apex = Landmark("apex", (0, 0, 0), (0, 0, 0), source_spread=3.0, destination_spread=4.0)
    >>> spreads_on_destination(Session(landmarks=(apex,)))
    {'apex': 5.0}
    """
    if not has_spreads(session):
        return {}
    pairs = session.pairs
    size = linear_size(positions(pairs, Side.SOURCE), positions(pairs, Side.DESTINATION))
    found = {
        x.name: math.hypot(size * (x.source_spread or 0), x.destination_spread or 0) for x in pairs
    }
    return {name: spread for name, spread in found.items() if spread > 0}


def times_spread(length: float, spread: float | None) -> str:
    """Say a length in units of a spread; empty where there is none.

    Examples
    --------
    >>> times_spread(4.6, 2.0).split()[0], times_spread(4.6, None)
    ('2.3', '')
    """
    if spread is None or not spread > 0 or not math.isfinite(length):
        return ""
    return f"{length / spread:.1f} × its spread"
