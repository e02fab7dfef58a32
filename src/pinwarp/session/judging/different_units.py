"""Meshes that must be in different units: what checks, reports and the window say."""

from __future__ import annotations

from dataclasses import dataclass

from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.landmarks import Side
from pinwarp.session.judging.quality import NamedFinding
from pinwarp.session.mesh_units import scalings, size_ratio, size_words
from pinwarp.session.session import Session


@dataclass(frozen=True)
class DifferentUnits(NamedFinding):
    """A finding that one mesh is far larger than the other.

    Attributes
    ----------
    ways
        What either side would have to be multiplied by, as pairs; none where no unit explains it.
    """

    ways: tuple[tuple[Side, float], ...]


def different_units(session: Session) -> tuple[DifferentUnits, ...]:
    """Return what is noticed about the sizes of the meshes.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> from pinwarp.session.mesh_units import scale_side
    >>> session = read_session(sample_session())
    >>> different_units(session)
    ()
    >>> (found,) = different_units(scale_side(session, Side.SOURCE, 0.001))
    >>> found.ways[0]
    (<Side.SOURCE: 'source'>, 1000.0)
    """
    ratio, words = size_ratio(session), size_words(session)
    if ratio is None:
        return ()
    finding = Finding(FindingKind.UNITS, (), ratio)
    # That the warp takes care of it is told where one is asked.
    return (DifferentUnits(finding, (), " ".join(words[:-1]), tuple(scalings(session).items())),)
