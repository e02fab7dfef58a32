"""A cohort's first pass: what the shapes alone say of a subject that nobody has landmarked."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError, PinwarpError
from pinwarp.core.first_guess import FirstGuess, Verdict
from pinwarp.core.landmarks import Side
from pinwarp.core.pose import PoseSettings
from pinwarp.session.keeping.files import read_session
from pinwarp.session.session import Session
from pinwarp.session.suggesting import SuggestInputs, suggest, with_suggestions


@dataclass(frozen=True)
class Suggestion:
    """How landmarks that a subject lacks are suggested.

    Parameters
    ----------
    settings
        What is known of the bones.
    session
        Where the session with the suggestions goes, to be looked at. Once it is there the
        subject is warped by it, whatever somebody has made of it since.
    """

    settings: PoseSettings
    session: Path


@dataclass(frozen=True)
class FirstPass:
    """What the shapes told, small enough to be sent from a worker; see ``FirstGuess``."""

    verdict: Verdict
    fit: float
    other_hand: float
    other_pose: float

    @classmethod
    def of(cls, guess: FirstGuess) -> FirstPass:
        """Return the figures of a first guess."""
        return cls(guess.verdict, guess.fit, guess.other_hand, guess.other_pose)


class DoubtfulError(PinwarpError):
    """A subject whose landmarks could not be suggested without a doubt."""

    def __init__(self, words: str, first_pass: FirstPass) -> None:
        super().__init__(words)
        self.first_pass = first_pass


def earlier_pass(path: Path, source: Session) -> Session:
    """Read the session of an earlier pass, in which somebody may have looked at landmarks.

    Parameters
    ----------
    path
        Where it is.
    source
        What is warped, and how.

    Raises
    ------
    FileFormatError
        When it cannot be read, or was made from another source: it is not replaced.
    """
    found = read_session(path)
    way_out = "Remove or rename it to have the landmarks suggested anew."
    for side in Side:
        if found.mesh(side) is None:
            raise FileFormatError(path, f"Its {side.value} mesh is not there. {way_out}")
    assert found.source is not None, "its mesh was asked for"
    if source.source is not None and found.source.sha256 != source.source.sha256:
        raise FileFormatError(path, f"It was made from another source mesh. {way_out}")
    if {x.name for x in found.landmarks} != {x.name for x in source.landmarks}:
        raise FileFormatError(path, f"The source has other landmarks by now. {way_out}")
    return replace(found, settings=source.settings, refinement=None)


def first_passed(session: Session, settings: PoseSettings) -> tuple[Session, FirstPass]:
    """Suggest the landmarks that a subject lacks.

    Parameters
    ----------
    session
        With both meshes.
    settings
        What is known of them.

    Returns
    -------
    session, first_pass
        Where the subject is the other side of the body, with the source mirrored.

    Raises
    ------
    DoubtfulError
        When the shapes leave open what is meant; the message says why and what to do.
    PinwarpError
        When a mesh is missing or the two cannot be compared.
    """
    guess = suggest(SuggestInputs.of(session), settings)
    found = FirstPass.of(guess)
    match guess.verdict:
        case Verdict.SURE:
            return with_suggestions(session, guess.readings[0]), found
        case Verdict.ASK:
            words = f"{guess.words} Place three pairs by hand, or give --mirror no or yes."
        case Verdict.NONE:
            words = guess.words
    raise DoubtfulError(f"No landmark was suggested. {words}", found)
