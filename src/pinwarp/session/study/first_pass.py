"""A cohort's first pass: what the shapes alone say of a subject that nobody has landmarked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import PinwarpError
from pinwarp.core.first_guess import FirstGuess, Verdict
from pinwarp.core.pose import PoseSettings
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
        Where the session with the suggestions goes, to be looked at.
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
