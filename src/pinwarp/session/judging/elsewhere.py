"""Landmarks that are not where their mesh is: what checks, reports and the window say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from pinwarp.core.errors import RangeError
from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.groups import Curve
from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.session.importing.fit import Fit, distance_from_mesh, fits_of, is_far
from pinwarp.session.judging.quality import NamedFinding
from pinwarp.session.rulers import Rulers, rulers_of
from pinwarp.session.session import Session


@dataclass(frozen=True)
class Elsewhere(NamedFinding):
    """A finding that the landmarks of a side do not lie on its mesh.

    Attributes
    ----------
    side
        The side.
    size
        How large the mesh is.
    fit
        How they would have to be read to lie on it; None where no other reading helps.
    what
        What was looked at: curves and patches where there is no landmark.
    """

    side: Side
    size: float
    fit: Fit | None
    what: str = "landmarks"

    def by(self, rulers: Rulers) -> Elsewhere:
        """Return the same, its lengths told by other rulers."""
        ruler, fit = rulers.on(self.side), self.fit
        far = distance_from_mesh(self.finding.value, self.size, ruler, "their mesh")
        sentence = f"The {self.side.value} {self.what} lie {far} in the median"
        if fit is None:
            sentence += (
                f", and it is {ruler.text(self.size, 3)} across: is it the one that they were "
                "placed on?"
            )
        else:
            lie = distance_from_mesh(fit.distance, self.size, ruler, "it")
            other = " and ".join(["frame"] * fit.flips + ["unit"] * (fit.factor != 1))
            sentence += f". {fit.describe()} they lie {lie}: they are in another {other}."
        return replace(self, sentence=sentence)


def elsewhere(
    session: Session, indexes: Mapping[Side, SurfaceIndex | None] = MappingProxyType({})
) -> tuple[Elsewhere, ...]:
    """Return what is noticed about the landmarks of either side and their mesh.

    Parameters
    ----------
    session
        A side without its mesh, or without landmarks, is not looked at.
    indexes
        The surfaces of meshes that are ready for measuring.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.importing.fit import fitted
    >>> from pinwarp.session.keeping.files import read_session
    >>> session = read_session(sample_session())
    >>> elsewhere(session)
    ()
    >>> (found,) = elsewhere(fitted(session, Side.SOURCE, Fit(flips=True)))
    >>> found.side.value, found.fit.action
    ('source', 'Negate x and y')
    """
    found = []
    for side in Side:
        mesh, (what, placed) = session.mesh(side), _placed(session, side)
        if mesh is None or not placed:
            continue
        index = indexes.get(side)
        if index is None or index.mesh is not mesh:
            index = _index_of(mesh)
        if index is None:
            continue
        stored, *others = fits_of(placed, side, index) or (Fit(),)
        size = mesh.diagonal
        if others:
            kind, fit, other = FindingKind.ELSEWHERE, others[0], others[0].distance
        elif is_far(placed, side, stored.distance, size):
            kind, fit, other = FindingKind.FAR, None, size
        else:
            continue
        finding = Finding(kind, (), stored.distance, (other,))
        found.append(Elsewhere(finding, (), "", side, size, fit, what).by(rulers_of(session)))
    return tuple(found)


class MeshGuard:
    """Looks whether landmarks lie on their meshes, which it makes ready for measuring once.

    For use by one thread at a time.
    """

    def __init__(self) -> None:
        self._indexes: dict[Side, SurfaceIndex] = {}

    def look(self, session: Session) -> tuple[Elsewhere, ...]:
        """Return what is noticed; see :func:`elsewhere`."""
        for side in Side:
            mesh, known = session.mesh(side), self._indexes.get(side)
            if mesh is None or known is None or known.mesh is not mesh:
                self._indexes.pop(side, None)
                if mesh is not None and (index := _index_of(mesh)):
                    self._indexes[side] = index
        return elsewhere(session, self._indexes)


def _placed(session: Session, side: Side) -> tuple[str, tuple[Landmark, ...]]:
    """Return what there is on a side, and what it is; curves and patches where no landmark is."""
    landmarks = tuple(x for x in session.landmarks if x.position(side) is not None)
    if landmarks:
        return "landmarks", landmarks
    places: list[Position | None] = []
    for group in session.groups:
        if isinstance(group, Curve):
            is_source = side is Side.SOURCE
            places += [x.source if is_source else x.destination for x in group.handles]
        elif side is Side.SOURCE:
            places += group.points
    points = [place for place in places if place is not None]
    return "curves and patches", tuple(
        Landmark(f"{row}").placed(side, place) for row, place in enumerate(points)
    )


def _index_of(mesh: Mesh) -> SurfaceIndex | None:
    try:
        return SurfaceIndex(mesh)
    except RangeError:
        # Nothing can be measured there, as whoever asks for distances is told.
        return None
