"""Which pairs of a session the program has placed: seen by nobody yet, or accepted unmoved."""

from __future__ import annotations

from pinwarp.core.findings import Finding, FindingKind
from pinwarp.session.judging.quality import NamedFinding
from pinwarp.session.session import Session


def about_suggested(session: Session) -> tuple[NamedFinding, ...]:
    """Return what is to be said of pairs that the program has placed; nothing where none are.

    Parameters
    ----------
    session
        Only its pairs count: what takes no part does no harm.

    Examples
    --------
    >>> from pinwarp.core.landmarks import Landmark
    >>> apex = Landmark("apex", (0, 0, 0)).suggested((0, 0, 1))
    >>> tip = Landmark("tip", (1, 0, 0), (1, 0, 1))
    >>> [x.sentence for x in about_suggested(Session(landmarks=(apex, tip)))]
    ['1 of 2 destination landmarks is only suggested: look at it.']
    """
    pairs = session.pairs
    suggested = [row for row, pair in enumerate(pairs) if pair.is_suggested]
    accepted = [row for row, pair in enumerate(pairs) if pair.is_accepted]
    told = []
    for kind, rows in ((FindingKind.SUGGESTED, suggested), (FindingKind.ACCEPTED, accepted)):
        if rows:
            finding = Finding(kind, tuple(rows), len(rows), (len(pairs),))
            names = tuple(pairs[row].name for row in rows)
            told.append(NamedFinding(finding, names, finding.describe()))
    return tuple(told)
