"""What a first guess needs of a session, and making it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from pinwarp.core.errors import PinwarpError
from pinwarp.core.first_guess import FirstGuess, first_guess
from pinwarp.core.landmarks import Landmark, Role, Side, positions
from pinwarp.core.mesh import Mesh
from pinwarp.core.pose import PoseSettings
from pinwarp.session.session import Session
from pinwarp.session.warp.fingerprint import fingerprint, mesh_parts

Matrix = NDArray[np.float64]
Progress = Callable[[float, str], None]

# Which way of guessing; another number once it gives other places.
METHOD = 1


def _silent(_share: float, _words: str) -> None:
    pass


def why_not(session: Session) -> str | None:
    """Say why nothing can be suggested, and what to do about it; None where it can.

    Examples
    --------
    >>> why_not(Session())
    'There is no source mesh: open the bone that has the landmarks.'
    """
    for side, what in (
        (Side.SOURCE, "that has the landmarks"),
        (Side.DESTINATION, "that they are suggested on"),
    ):
        file = session.mesh_file(side)
        if file is None:
            return f"There is no {side.value} mesh: open the bone {what}."
        if session.mesh(side) is None:
            return f"The {side.value} mesh {file.path} is not there. Was it moved or renamed?"
    if not any(is_landmark(landmark) for landmark in session.landmarks):
        return "There is no landmark on the source: place some there first."
    if not missing_of(session):
        return "Every landmark of the source is on the destination already."
    return None


def is_landmark(landmark: Landmark) -> bool:
    """Whether it is a landmark of the source that may be paired; passengers are carried only."""
    return landmark.role is Role.PAIR and landmark.enabled and landmark.source is not None


def missing_of(session: Session) -> tuple[Landmark, ...]:
    """Return the landmarks of the source that are not on the destination, in order."""
    return tuple(x for x in session.landmarks if is_landmark(x) and x.destination is None)


def known_pairs(session: Session) -> tuple[Landmark, ...]:
    """Return the pairs that somebody has placed, in the order of the table.

    What was left where a guess had put it tells the next one nothing.
    """
    return tuple(pair for pair in session.pairs if pair.is_by_hand)


@dataclass(frozen=True, eq=False)
class SuggestInputs:
    """All of a session that a first guess follows from.

    Attributes
    ----------
    source, destination
        The meshes.
    pairs : (n, 3), (n, 3) float64
        The pairs that are known, in the meshes' units.
    fingerprint
        Another one tells that the guess is out of date.
    meshes
        The same of the meshes alone: where only this is the same, the guess can still be used
        with the pairs that have come since.
    """

    source: Mesh
    destination: Mesh
    pairs: tuple[Matrix, Matrix]
    fingerprint: str
    meshes: str

    @classmethod
    def of(cls, session: Session) -> SuggestInputs:
        """Return what a session gives.

        Raises
        ------
        PinwarpError
            When nothing can be suggested; the message says why and what to do.
        """
        if (words := why_not(session)) is not None:
            raise PinwarpError(words)
        source, destination = (session.mesh(side) for side in Side)
        assert source is not None, "asked for above"
        assert destination is not None, "asked for above"
        known = known_pairs(session)
        places = tuple((pair.source, pair.destination) for pair in known)
        meshes = mesh_parts(session)
        return cls(
            source,
            destination,
            (positions(known, Side.SOURCE), positions(known, Side.DESTINATION)),
            fingerprint((*places, *meshes)),
            fingerprint(meshes),
        )


def suggest(
    inputs: SuggestInputs, settings: PoseSettings | None = None, *, progress: Progress = _silent
) -> FirstGuess:
    """Guess where all places of the source lie on the destination.

    Parameters
    ----------
    inputs
        From a session.
    settings
        What is known of the two bones.
    progress
        Called with the share done and words; what it raises ends it.

    Raises
    ------
    PinwarpError
        When the meshes cannot be compared; the message says what to do.

    Examples
    --------
    >>> from pinwarp.core.pose import Mirror
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.edits import remove_side
    >>> from pinwarp.session.keeping.files import read_session
    >>> session = read_session(sample_session())
    >>> one = remove_side(session, session.pairs[0].name, Side.DESTINATION)
    >>> guess = suggest(SuggestInputs.of(one), PoseSettings(Mirror.NO))
    >>> guess.verdict.value, guess.readings[0].mirrored
    ('sure', False)
    """
    # One thread: it is faster for matrices of this size, and the same everywhere bit for bit.
    with threadpool_limits(limits=1, user_api="blas"):
        return first_guess(
            inputs.source, inputs.destination, settings, given=inputs.pairs, progress=progress
        )
