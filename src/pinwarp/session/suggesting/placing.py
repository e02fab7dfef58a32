"""Suggestions put into a session, each marked as such until somebody has looked at it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pinwarp.core.guessed import Reading
from pinwarp.core.mirror import AXES
from pinwarp.io.meshes import MeshFile
from pinwarp.session import edits
from pinwarp.session.session import Session
from pinwarp.session.suggesting.ghosts import ghosts_of


def with_suggestions(session: Session, reading: Reading) -> Session:
    """Place every landmark that is missing where a reading expects it, marked as suggested.

    Where the destination is the other hand the source is mirrored, as somebody would do in the
    window: the warp must not turn it inside out.

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
    places = {ghost.name: ghost.position for ghost in ghosts_of(reading, session)}
    placed = tuple(
        landmark.suggested(places[landmark.name]) if landmark.name in places else landmark
        for landmark in session.landmarks
    )
    session = replace(session, landmarks=placed)
    if not reading.mirrored or not isinstance(session.source, MeshFile):
        return session
    return edits.mirror_source(session, _axis_of(reading))


def _axis_of(reading: Reading) -> str:
    """Return the axis across which to mirror so that least is left to turn."""
    # The larger the trace of a rotation, the smaller its angle; a mirror takes one entry from it.
    return AXES[int(np.argmin(np.diag(reading.pose.rotation)))]
