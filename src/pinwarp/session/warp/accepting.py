"""A curve is accepted on the destination as it is expected there, between its handles too."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.curves import CurvePath, PathFinder
from pinwarp.core.errors import PinwarpError
from pinwarp.core.groups import Curve, Handle
from pinwarp.core.landmarks import as_position
from pinwarp.core.spline import Spline
from pinwarp.session import edits
from pinwarp.session.session import Session
from pinwarp.session.warp.expected import expected_handles

Matrix = NDArray[np.float64]

# Where the short way between two handles leaves the expected one by more than this share of its
# length, there is a handle more between them; so often at most one between two others.
ASTRAY = 0.1
HALVINGS = 2


def accepted(
    session: Session, name: str, spline: Spline, source: PathFinder, destination: PathFinder
) -> Session:
    """Return a session in which a curve is drawn on the destination where it is expected.

    Over a rim, or around a hollow, the short way from handle to handle may be another than that of
    the curve: there it gets handles more, on both bones.

    Parameters
    ----------
    session
        What is edited.
    name
        The curve; one that is drawn already stays as it is.
    spline
        The warp.
    source, destination
        Of ways over both bones.

    Raises
    ------
    LandmarkError
        When the curve, or a landmark of it, is not there.
    """
    curve = session.group(name)
    if not isinstance(curve, Curve) or curve.is_drawn:
        return session
    places = expected_handles(curve, spline, destination.surface)
    ends = [*range(len(curve.handles)), *([0] if curve.is_closed else [])]
    more = {
        a: _between(
            np.array([curve.handles[k].source for k in (a, b)]),
            places[[a, b]],
            spline,
            (source, destination),
            HALVINGS,
        )
        for a, b in itertools.pairwise(ends)
    }
    session = edits.add_handles(session, name, more)
    curve = session.group(name)
    assert isinstance(curve, Curve), "it has only more handles"
    expected = expected_handles(curve, spline, destination.surface)
    return edits.accept_curve(session, name, [as_position(place) for place in expected])


def _between(
    ends: Matrix, aims: Matrix, spline: Spline, finders: tuple[PathFinder, PathFinder], depth: int
) -> tuple[Handle, ...]:
    """Return what is to be added between two handles, in order."""
    source, destination = finders
    try:
        way = source.through(ends).places
        short = destination.through(aims)
    except PinwarpError:
        # Told where the curve is drawn.
        return ()
    carried = destination.surface.closest(spline.evaluate(way)).positions
    off = np.linalg.norm(short.closest(carried)[0] - carried, axis=1).max()
    if depth == 0 or off <= ASTRAY * CurvePath(carried).length:
        return ()
    middle = source.surface.closest(CurvePath(way).points(3)[1:2]).positions
    aim = destination.surface.closest(spline.evaluate(middle)).positions
    return (
        *_between(
            np.vstack([ends[:1], middle]), np.vstack([aims[:1], aim]), spline, finders, depth - 1
        ),
        Handle(as_position(middle[0])),
        *_between(
            np.vstack([middle, ends[1:]]), np.vstack([aim, aims[1:]]), spline, finders, depth - 1
        ),
    )
