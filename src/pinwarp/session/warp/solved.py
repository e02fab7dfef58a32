"""The warp of a session solved once, and what follows from it, found when first asked for.

Whatever leaves a session (meshes, landmarks, coefficients, figures, reports) takes it from here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.components import Components, applied
from pinwarp.core.errors import PinwarpError
from pinwarp.core.factor import SourceFactor
from pinwarp.core.folds import Folds, folds_of
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.landmarks import Landmark, Side, positions
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import Spline
from pinwarp.core.surface_comparison import SurfaceComparison, compare_surfaces
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs, WarpResult
from pinwarp.session.warp.solver import WarpSolver

Matrix = NDArray[np.float64]

NO_PAIR = "There is no pair yet: place a landmark on both meshes first."
# So many vertices between two looks at whether the user cancelled: a tenth of a second.
PART = 50_000


@dataclass(frozen=True, eq=False)
class SolvedWarp:
    """The warp of a session, and what it does to all that the session holds.

    Parameters
    ----------
    session
        What was solved.
    factor, spline
        The source landmarks, without semilandmarks, and the whole warp, before any part of it is
        chosen.
    result
        The same as the window has it: what is drawn, residuals, and what goes with them.

    Examples
    --------
    >>> shift = Landmark("apex", (0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
    >>> solved(Session(landmarks=(shift,))).applied.evaluate([[1, 1, 1]]).tolist()
    [[2.0, 3.0, 4.0]]
    """

    session: Session
    factor: SourceFactor
    spline: Spline
    result: WarpResult

    @cached_property
    def destination(self) -> Matrix:
        """The (n, 3) destination landmarks."""
        return np.array(self.result.inputs.destination)

    @property
    def fit(self) -> tuple[SourceFactor, Matrix]:
        """What it was solved from: pairs and, below them, semilandmarks at rest."""
        assert self.result.fit is not None, "what is solved was solved from something"
        return self.result.fit

    @property
    def fitted(self) -> int | None:
        """How many places it was fitted to beside the pairs.

        None where it is not refined, and no semilandmark slid.
        """
        refined, at_rest = self.result.inputs.refinement, self.result.semilandmarks
        if refined is not None:
            return len(refined.source) - len(self.destination)
        return None if at_rest is None else at_rest.count

    @property
    def residuals(self) -> Matrix:
        """How far each pair's source is carried from its destination, (n,)."""
        assert self.result.residuals is not None, "what is solved has residuals"
        return self.result.residuals

    def part(self, components: Components, blend: float = 1.0) -> Spline:
        """Return a part of it; see :func:`pinwarp.core.components.applied`."""
        return applied(self.spline, *self.fit, components, blend)

    @cached_property
    def drawn(self) -> Spline:
        """What is drawn over the destination: what is applied, with the pose put back."""
        assert self.result.shown is not None, "what is solved is shown"
        return self.result.shown

    @cached_property
    def applied(self) -> Spline:
        """What is exported: the chosen components as far as they are blended in."""
        settings = self.session.settings
        if settings == settings.drawn:
            return self.drawn
        return self.part(settings.components, settings.blend)

    @property
    def source(self) -> Mesh:
        """The source mesh; see :func:`source_of`."""
        return source_of(self.session)

    @cached_property
    def mesh(self) -> Mesh:
        """The warped source mesh in double precision, as it is exported."""
        return self.source.with_vertices(self.applied.evaluate(self.source.vertices))

    @cached_property
    def drawn_mesh(self) -> Mesh:
        """The warped source mesh where the destination is."""
        if self.applied is self.drawn:
            return self.mesh
        return self.source.with_vertices(self.drawn.evaluate(self.source.vertices))

    @cached_property
    def folds(self) -> Folds | None:
        """Where the surface is turned inside out; None without a source mesh."""
        mesh = self.session.mesh(Side.SOURCE)
        if mesh is None:
            return None
        determinant = determinants(jacobians(self.drawn, mesh.vertices))
        return folds_of(determinant, mesh, self.drawn, len(self.destination))

    @cached_property
    def destination_index(self) -> SurfaceIndex | None:
        """The destination's surface, made ready for measuring; None without that mesh."""
        mesh = self.session.mesh(Side.DESTINATION)
        return None if mesh is None else SurfaceIndex(mesh)

    def distances(self, told: Callable[[float], None] = lambda _share: None) -> Matrix | None:
        """Return how far each warped vertex is from the destination's surface, (m,).

        Parameters
        ----------
        told
            Told the share that is done; may raise to cancel.

        Returns
        -------
        (m,) float64 or None
            None where either mesh is missing.
        """
        index = self.destination_index
        if index is None or self.session.mesh(Side.SOURCE) is None:
            return None
        return in_parts(index.distances, self.drawn_mesh.vertices, told)

    @cached_property
    def comparison(self) -> SurfaceComparison | None:
        """How far the warped source and the destination lie apart, both ways; None as above."""
        destination = self.session.mesh(Side.DESTINATION)
        if destination is None or self.session.mesh(Side.SOURCE) is None:
            return None
        return compare_surfaces(self.drawn_mesh, destination, index_b=self.destination_index)

    def carried(self, landmarks: tuple[Landmark, ...]) -> tuple[Landmark, ...]:
        """Return landmarks with the positions their source is carried to as destinations."""
        places = self.applied.evaluate(positions(landmarks, Side.SOURCE))
        return tuple(
            landmark.placed(Side.DESTINATION, place)
            for landmark, place in zip(landmarks, places, strict=True)
        )


def solved(session: Session | SolvedWarp, known: WarpResult | None = None) -> SolvedWarp:
    """Solve a session.

    Parameters
    ----------
    session
        What is solved; a warp that is solved already is returned as it is.
    known
        A result, taken where it is that of this very session.

    Raises
    ------
    PinwarpError
        When there is no pair, or the solve fails.
    """
    if isinstance(session, SolvedWarp):
        return session
    result = known
    if known is None or known.inputs != WarpInputs.of(session, known.inputs.stand_in):
        # The solver would warp the mesh in single precision, for the screen.
        result = WarpSolver().solve_landmarks(replace(WarpInputs.of(session), mesh=None))
    if result is None or result.factor is None or result.spline is None:
        raise PinwarpError((result and result.problem) or NO_PAIR)
    return SolvedWarp(session, result.factor, result.spline, result)


def source_of(session: Session) -> Mesh:
    """Return the source mesh of a session.

    Raises
    ------
    PinwarpError
        When there is none; the message says what to do.
    """
    mesh = session.mesh(Side.SOURCE)
    if mesh is None and session.source is not None:
        place = session.source.path
        raise PinwarpError(f"The source mesh {place} is not there. Was it moved or renamed?")
    if mesh is None:
        raise PinwarpError("There is no source mesh to warp: open one first.")
    return mesh


def in_parts(
    function: Callable[[Matrix], Matrix], places: ArrayLike, told: Callable[[float], None]
) -> Matrix:
    """Apply a function to (m, 3) places part by part, telling how far it is in between."""
    places = np.asarray(places, dtype=np.float64)
    parts = []
    for first in range(0, max(len(places), 1), PART):
        told(first / max(len(places), 1))
        parts.append(function(places[first : first + PART]))
    return np.concatenate(parts)
