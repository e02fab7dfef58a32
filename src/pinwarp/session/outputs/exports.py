"""What leaves a session: its warp as applied, and what that does to mesh and passengers."""

from __future__ import annotations

from dataclasses import dataclass

from pinwarp.core.components import Components, applied
from pinwarp.core.errors import PinwarpError
from pinwarp.core.factor import SourceFactor, factorise
from pinwarp.core.landmarks import Landmark, Role, Side, positions
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import Matrix, Spline, solve
from pinwarp.io.coefficients import Coefficients
from pinwarp.session.session import Session
from pinwarp.version import __version__


def warped_mesh(session: Session) -> Mesh:
    """Return the warped source mesh in double precision, for export.

    Raises
    ------
    PinwarpError
        When there is no source mesh, no pair, or the solve fails; the message says what to do.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> session = read_session(sample_session())
    >>> warped_mesh(session).vertices.shape
    (10000, 3)
    """
    mesh = session.mesh(Side.SOURCE)
    if mesh is None and session.source is not None:
        place = session.source.path
        raise PinwarpError(f"The source mesh {place} is not there. Was it moved or renamed?")
    if mesh is None:
        raise PinwarpError("There is no source mesh to warp: open one first.")
    return mesh.with_vertices(session_spline(session).evaluate(mesh.vertices))


def warped_passengers(session: Session) -> tuple[Landmark, ...]:
    """Return the passengers with the positions that the warp carries them to as destinations.

    Raises
    ------
    PinwarpError
        When there is no passenger, no pair, or the solve fails; the message says what to do.

    Examples
    --------
    >>> apex = Landmark("apex", source=(0, 0, 0), destination=(0, 0, 5))
    >>> muscle = Landmark("muscle", source=(1, 0, 0), role=Role.PASSENGER)
    >>> warped_passengers(Session(landmarks=(apex, muscle)))[0].destination
    (1.0, 0.0, 5.0)
    """
    passengers = [x for x in session.landmarks if x.role is Role.PASSENGER and x.source is not None]
    if not passengers:
        raise PinwarpError("There is no passenger: Ctrl+click on the source adds one.")
    carried = session_spline(session).evaluate(positions(passengers, Side.SOURCE))
    return tuple(
        passenger.placed(Side.DESTINATION, place)
        for passenger, place in zip(passengers, carried, strict=True)
    )


def warped_landmarks(session: Session) -> tuple[Landmark, ...]:
    """Return the pairs with the positions that the warp carries their source to as destinations.

    At penalty 0 the whole warp carries them to their destinations; what is applied in part, or
    with a penalty, misses them by the residuals.

    Raises
    ------
    PinwarpError
        When there is no pair, or the solve fails; the message says what to do.
    """
    carried = session_spline(session).evaluate(positions(session.pairs, Side.SOURCE))
    return tuple(
        pair.placed(Side.DESTINATION, place)
        for pair, place in zip(session.pairs, carried, strict=True)
    )


def session_coefficients(session: Session) -> Coefficients:
    """Return the coefficients of the warp as applied, with all that explains them.

    Raises
    ------
    PinwarpError
        When there is no pair, or the solve fails.

    Examples
    --------
    >>> shift = Landmark("apex", (0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
    >>> session_coefficients(Session(landmarks=(shift,))).spline.affine[0].tolist()
    [1.0, 2.0, 3.0]
    """
    source, destination = session.source, session.destination
    return Coefficients(
        spline=session_spline(session),
        names=tuple(pair.name for pair in session.pairs),
        unit=session.unit,
        settings=session.settings,
        source_sha256=source.sha256 if source is not None else "",
        destination_sha256=destination.sha256 if destination is not None else "",
        source_mirrored=source.mirrored if source is not None else "",
        destination_mirrored=destination.mirrored if destination is not None else "",
        source_scaled=source.scaled if source is not None else 1.0,
        destination_scaled=destination.scaled if destination is not None else 1.0,
        version=__version__,
    )


@dataclass(frozen=True, eq=False)
class SolvedWarp:
    """The whole warp of a session, and the pairs it was solved from.

    Attributes
    ----------
    factor
        The source landmarks.
    destination : (n, 3) float64
        The destination landmarks.
    spline
        The warp, before any part of it is chosen.
    """

    factor: SourceFactor
    destination: Matrix
    spline: Spline

    def applied(self, components: Components, blend: float = 1.0) -> Spline:
        """Return a part of it; see :func:`pinwarp.core.components.applied`."""
        return applied(self.spline, self.factor, self.destination, components, blend)


def solved(session: Session) -> SolvedWarp:
    """Solve a session anew.

    Raises
    ------
    PinwarpError
        When there is no pair, or the solve fails.
    """
    pairs = session.pairs
    if not pairs:
        raise PinwarpError("There is no pair yet: place a landmark on both meshes first.")
    factor = factorise(positions(pairs, Side.SOURCE), planar=session.settings.planar)
    destination = positions(pairs, Side.DESTINATION)
    spline = solve(factor, destination, session.settings.penalty, session.settings.convention)
    return SolvedWarp(factor, destination, spline)


def session_spline(session: Session) -> Spline:
    """Return the warp of a session, solved anew: the components of it that are applied.

    Raises
    ------
    PinwarpError
        When there is no pair, or the solve fails.
    """
    return solved(session).applied(session.settings.components, session.settings.blend)
