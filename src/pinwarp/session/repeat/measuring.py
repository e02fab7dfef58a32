"""From files to figures in one go: all that a window shows of repeats."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import PinwarpError, words_of
from pinwarp.core.landmarks import Side
from pinwarp.session.repeat.comparing import OtherFrameError, Repeats, compared
from pinwarp.session.repeat.level import PenaltyOfNoise, about_session, penalty_of_noise
from pinwarp.session.repeat.reading import Repeat, read_repeat
from pinwarp.session.session import Session

THIS_SESSION = "this session"


@dataclass(frozen=True)
class Asked:
    """What is to be compared, and how.

    Attributes
    ----------
    paths
        Landmark files and sessions.
    side
        The side that was digitised again.
    with_session
        Whether the landmarks of the open session are one of the repeats, the first.
    by_order, adapt
        As in :func:`~pinwarp.session.repeat.comparing.compared`.
    """

    paths: tuple[Path, ...] = ()
    side: Side = Side.DESTINATION
    with_session: bool = False
    by_order: bool = False
    adapt: bool = False


@dataclass(frozen=True, eq=False)
class Measured:
    """What came of it.

    Attributes
    ----------
    asked
        What was asked for.
    repeats
        None where they could not be compared.
    penalty
        What their noise asks for in the session; None where that cannot be told.
    notes
        What the user should know, as sentences.
    problem
        Why there are no repeats, or no penalty; else empty.
    other_frame
        Whether adapting a file to the first would help.
    """

    asked: Asked
    repeats: Repeats | None = None
    penalty: PenaltyOfNoise | None = None
    notes: tuple[str, ...] = ()
    problem: str = ""
    other_frame: bool = False


def measured(session: Session, asked: Asked) -> Measured:
    """Read files, compare them, and find the penalty of a session for their noise.

    Parameters
    ----------
    session
        Its pairs say how much the warp itself varies.
    asked
        What is compared. What is wrong with it is told in the result, not raised.

    Examples
    --------
    >>> measured(Session(), Asked((Path("nowhere.csv"), Path("b.csv")))).problem[:11]
    'nowhere.csv'
    """
    side = asked.side
    try:
        own = [_own(session, side)] if asked.with_session else []
        repeats = compared(
            [*own, *_read(asked.paths, side)], by_order=asked.by_order, adapt=asked.adapt
        )
    except (PinwarpError, OSError) as error:
        other = isinstance(error, OtherFrameError)
        return Measured(asked, problem=words_of(error), other_frame=other)
    notes = (*repeats.notes, *about_session(session, side, repeats))
    try:
        return Measured(asked, repeats, penalty_of_noise(session, side, repeats), notes)
    except PinwarpError as error:
        return Measured(asked, repeats, notes=notes, problem=words_of(error))


def _read(paths: Sequence[Path], side: Side) -> list[Repeat]:
    return [read_repeat(path, side) for path in paths]


def _own(session: Session, side: Side) -> Repeat:
    places = {x.name: at for x in session.landmarks if (at := x.position(side)) is not None}
    if not places:
        raise PinwarpError(f"The session has no landmarks on the {side.value}.")
    return Repeat(Path(THIS_SESSION), places)
