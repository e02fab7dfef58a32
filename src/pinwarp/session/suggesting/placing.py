"""Suggestions put into a session, each marked as such until somebody has looked at it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from pinwarp.core.guessed import Reading
from pinwarp.core.mirror import AXES
from pinwarp.core.pose import Pose
from pinwarp.io.meshes import MeshFile
from pinwarp.session import edits
from pinwarp.session.session import Session
from pinwarp.session.suggesting.ghosts import SuggestedPlace, ghosts_of


def with_suggestions(session: Session, reading: Reading) -> Session:
    """Place every landmark that is missing where a reading expects it, marked as suggested.

    Where the destination is the other hand the source is mirrored first; see
    :func:`mirrored_first`.

    Parameters
    ----------
    session
        With both meshes.
    reading
        Of these.

    Returns
    -------
    Session
        What lies beyond the rim of the destination stays missing.
    """
    session, reading = mirrored_first(session, reading)
    return with_ghosts(session, ghosts_of(reading, session))


def with_ghosts(session: Session, ghosts: Iterable[SuggestedPlace]) -> Session:
    """Place landmarks where they are expected, each marked as suggested.

    Examples
    --------
    >>> from pinwarp.core.landmarks import Landmark
    >>> session = Session(landmarks=(Landmark("apex", (0, 0, 0)), Landmark("tip", (1, 0, 0))))
    >>> apex, tip = with_ghosts(session, [SuggestedPlace("tip", (2, 0, 0), 0.5)]).landmarks
    >>> apex.is_complete, tip.note
    (False, 'suggested')
    """
    places = {ghost.name: ghost.position for ghost in ghosts}
    placed = tuple(
        landmark.suggested(places[landmark.name]) if landmark.name in places else landmark
        for landmark in session.landmarks
    )
    return replace(session, landmarks=placed)


def mirrored_first(session: Session, reading: Reading) -> tuple[Session, Reading]:
    """Mirror the source where the destination is its other hand, and read it as it is then.

    It is what somebody would do by hand, across the axis that leaves least to turn: no warp must
    turn the source inside out.

    Parameters
    ----------
    session
        With both meshes.
    reading
        Of these.

    Returns
    -------
    session, reading
        As they were where the reading does not mirror.
    """
    file = session.source
    if not reading.mirrored or not isinstance(file, MeshFile):
        return session, reading
    # Of a rotation the trace is the larger the less it turns, and a mirror turns one sign in it.
    axis = int(np.argmin(np.diag(reading.pose.rotation)))
    rotation = np.diag(np.where(np.arange(3) == axis, -1.0, 1.0))
    offset = np.where(np.arange(3) == axis, file.mesh.bounds.sum(axis=0), 0.0)
    mirror = Pose(1.0, rotation, offset)
    return edits.mirror_source(session, AXES[axis]), reading.after(mirror)
