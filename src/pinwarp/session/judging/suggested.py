"""Which pairs of a session the program has placed: seen by nobody yet, or accepted unmoved."""

from __future__ import annotations

import numpy as np

from pinwarp.core.errors import PinwarpError
from pinwarp.core.factor import factorise
from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.landmarks import Side, positions
from pinwarp.core.lengths import Ruler
from pinwarp.core.quality import leave_one_out
from pinwarp.session.judging.quality import LEAST_PAIRS, NamedFinding
from pinwarp.session.rulers import rulers_of
from pinwarp.session.session import Session

# With more pairs a solve of some of them would be felt.
MOST_PAIRS = 300


def about_suggested(session: Session, ruler: Ruler | None = None) -> tuple[NamedFinding, ...]:
    """Return what is to be said of pairs that the program has placed; nothing where none are.

    Parameters
    ----------
    session
        Only its pairs count: what takes no part does no harm.
    ruler
        How lengths are told; without it as in the files.

    Examples
    --------
    >>> from pinwarp.core.landmarks import Landmark
    >>> apex = Landmark("apex", (0, 0, 0)).suggested((0, 0, 1))
    >>> tip = Landmark("tip", (1, 0, 0), (1, 0, 1))
    >>> [x.sentence for x in about_suggested(Session(landmarks=(apex, tip)))]
    ['1 of 2 destination landmarks is only suggested: look at it.']
    """
    pairs, told = session.pairs, ruler or rulers_of(session).destination
    suggested = [row for row, pair in enumerate(pairs) if pair.is_suggested]
    accepted = [row for row, pair in enumerate(pairs) if pair.is_accepted]
    found = []
    for kind, rows in ((FindingKind.SUGGESTED, suggested), (FindingKind.ACCEPTED, accepted)):
        if rows:
            alone = _alone(session) if kind is FindingKind.ACCEPTED else ()
            found.append(Finding(kind, tuple(rows), len(rows), (len(pairs), *alone)))
    return tuple(
        NamedFinding(
            finding, tuple(pairs[row].name for row in finding.rows), finding.describe(None, told)
        )
        for finding in found
    )


def _alone(session: Session) -> tuple[float, ...]:
    """Return the leave-one-out error of the pairs that somebody has placed, where there is one."""
    pairs = [pair for pair in session.pairs if pair.is_by_hand]
    settings = session.settings
    if not (LEAST_PAIRS <= len(pairs) <= MOST_PAIRS and settings.is_regular):
        return ()
    source, destination = (positions(pairs, side) for side in Side)
    try:
        factor = factorise(source, planar=settings.planar, basis=settings.basis)
        alone = leave_one_out(factor, destination, settings.penalty).rms if len(factor.poles) else 0
    except PinwarpError:
        return ()
    return (alone,) if np.isfinite(alone) and alone > 0 else ()
