"""What leaves a session: its warp as applied, and what that does to mesh and landmarks.

Each takes a session, or its :class:`~pinwarp.session.warp.solved.SolvedWarp` where more than one
thing leaves: then it is solved once.
"""

from __future__ import annotations

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Landmark
from pinwarp.core.mesh import Mesh
from pinwarp.io.coefficients import Coefficients
from pinwarp.session.session import Session
from pinwarp.session.warp.provenance import session_hash
from pinwarp.session.warp.refined import fitted_names
from pinwarp.session.warp.slid_words import point_names
from pinwarp.session.warp.solved import SolvedWarp, solved, source_of
from pinwarp.version import __version__


def warped_mesh(session: Session | SolvedWarp) -> Mesh:
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
    if isinstance(session, Session):
        # What is missing first is told first, and costs no solve.
        source_of(session)
    return solved(session).mesh


def warped_passengers(session: Session | SolvedWarp) -> tuple[Landmark, ...]:
    """Return the passengers with the positions that the warp carries them to as destinations.

    Raises
    ------
    PinwarpError
        When there is no passenger, no pair, or the solve fails; the message says what to do.

    Examples
    --------
    >>> from pinwarp.core.landmarks import Role
    >>> apex = Landmark("apex", source=(0, 0, 0), destination=(0, 0, 5))
    >>> muscle = Landmark("muscle", source=(1, 0, 0), role=Role.PASSENGER)
    >>> warped_passengers(Session(landmarks=(apex, muscle)))[0].destination
    (1.0, 0.0, 5.0)
    """
    warp = solved(session)
    if not warp.session.passengers:
        raise PinwarpError("There is no passenger on the source.")
    return warp.carried(warp.session.passengers)


def warped_landmarks(session: Session | SolvedWarp) -> tuple[Landmark, ...]:
    """Return the pairs with the positions that the warp carries their source to as destinations.

    At penalty 0 the whole warp carries them to their destinations; what is applied in part, or
    with a penalty, misses them by the residuals.

    Raises
    ------
    PinwarpError
        When there is no pair, or the solve fails; the message says what to do.
    """
    warp = solved(session)
    return warp.carried(warp.session.pairs)


def session_coefficients(session: Session | SolvedWarp) -> Coefficients:
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
    warp = solved(session)
    session = warp.session
    source, destination = session.source, session.destination
    names = [pair.name for pair in session.pairs]
    at_rest = warp.result.semilandmarks
    if at_rest is not None:
        names += point_names(at_rest, names)
    else:
        names += fitted_names(warp.fitted or 0, names)
    return Coefficients(
        spline=warp.applied,
        # A fit of the landmarks has no others.
        names=tuple(names[: len(warp.applied.source)]),
        unit=session.unit,
        settings=session.settings,
        source_sha256=source.sha256 if source is not None else "",
        destination_sha256=destination.sha256 if destination is not None else "",
        source_mirrored=source.mirrored if source is not None else "",
        destination_mirrored=destination.mirrored if destination is not None else "",
        source_scaled=source.scaled if source is not None else 1.0,
        destination_scaled=destination.scaled if destination is not None else 1.0,
        version=__version__,
        session=session_hash(session),
    )
