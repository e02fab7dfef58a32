"""How far a refined session lies from the surface that it was fitted to, and did before."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pinwarp.core.errors import RangeError
from pinwarp.core.landmarks import Side
from pinwarp.core.surface_comparison import DistanceFigures
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.session import edits
from pinwarp.session.session import Session
from pinwarp.session.warp.solved import solved


@dataclass(frozen=True)
class Fit:
    """Mean distances to the destination, in its unit; None where they cannot be measured.

    Attributes
    ----------
    refinement
        Which one.
    before, after
        By the warp of the landmarks, and refined.
    """

    refinement: RefinementRecord | None
    before: float | None = None
    after: float | None = None


def fit_of(session: Session) -> Fit:
    """Measure the whole warp of a refined session, and that of its landmarks.

    Parameters
    ----------
    session
        A session whose refinement is in use.
    """
    refined = session.refinement
    source, destination = (session.mesh(side) for side in Side)
    if refined is None or source is None or destination is None:
        return Fit(refined)
    index = SurfaceIndex(destination)
    whole = replace(session, settings=session.settings.whole)
    means = []
    for one in (edits.set_refinement(whole, None), whole):
        try:
            vertices = solved(one).drawn_mesh.vertices
        except RangeError:
            return Fit(refined)
        means.append(DistanceFigures.of(index.distances(vertices)[source.on_surface]).mean)
    return Fit(refined, *means)
