"""The steps of the tour: what is asked for, how it is prepared, and when it is done."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pinwarp.core.landmarks import Side
from pinwarp.io.samples import sample_session
from pinwarp.session import edits
from pinwarp.session.session import Session

# The pair that the first step places, and those that the fourth exchanges.
PLACED = "lesser_trochanter_tip"
EXCHANGED = ("medial_epicondyle", "lateral_epicondyle")


@dataclass(frozen=True)
class TourStep:
    """One step.

    Parameters
    ----------
    words
        What is asked for, as HTML; ``{name}`` stands for a key as it is on this system.
    done
        What was learned, in few words.
    prepare
        Returns the session in which it can be done.
    is_done
        Told the session as it was before it was prepared, as the step began, and as it is now.
    """

    words: str
    done: str
    prepare: Callable[[Session], Session]
    is_done: Callable[[Session, Session, Session], bool]


def is_of_tour(session: Session) -> bool:
    """Whether a session is that of the tour: the sample bones, with the landmarks it needs."""
    source = session.source
    at_home = source is not None and source.path.parent == sample_session().parent
    return at_home and all(session.landmark(name) for name in (PLACED, *EXCHANGED))


def _unplaced(session: Session) -> Session:
    return edits.remove_side(session, PLACED, Side.DESTINATION)


def _as_it_is(session: Session) -> Session:
    return session


def _exchanged(session: Session) -> Session:
    return edits.swap_destinations(session, *EXCHANGED)


def _is_placed(_before: Session, _begun: Session, now: Session) -> bool:
    landmark = now.landmark(PLACED)
    return landmark is not None and landmark.is_complete


def _is_moved(_before: Session, begun: Session, now: Session) -> bool:
    return any(
        (new := now.landmark(old.name)) is not None
        and new.is_complete
        and (new.source, new.destination) != (old.source, old.destination)
        for old in begun.pairs
    )


def _is_penalised(_before: Session, begun: Session, now: Session) -> bool:
    return now.settings.penalty not in (0, begun.settings.penalty)


def _is_put_right(before: Session, _begun: Session, now: Session) -> bool:
    return all(
        (old := before.landmark(name)) is not None
        and (new := now.landmark(name)) is not None
        and old.destination == new.destination
        for name in EXCHANGED
    )


def _is_exported(_before: Session, _begun: Session, _now: Session) -> bool:
    # No session tells.
    return False


STEPS = (
    TourStep(
        f"The destination lacks <b>{PLACED}</b>. Its <b>ghost</b>, a ring in a disc of doubt, "
        "shows where it should be: press <b>{accept_ghost}</b>, and once more if the view has to "
        "turn first.",
        "a counterpart by its ghost",
        _unplaced,
        _is_placed,
    ),
    TourStep(
        "<b>Drag</b> any landmark over one of the bones: the warped source, in blue, follows while "
        "you drag. <b>{undo}</b> would take it back.",
        "a landmark dragged, live",
        _as_it_is,
        _is_moved,
    ),
    TourStep(
        "Move the slider of the <b>warping penalty</b> to the right: the warp becomes stiffer and "
        "meets the landmarks less closely. The curve above it tells where the pairs predict one "
        "another best.",
        "the warping penalty",
        _as_it_is,
        _is_penalised,
    ),
    TourStep(
        "Two landmarks were just <b>exchanged</b> behind your back, and the surface folds. The "
        "list below the table says which: press its <b>Swap</b> button.",
        "a swapped pair found and put right",
        _exchanged,
        _is_put_right,
    ),
    TourStep(
        "Take the result home: <b>File &gt; Export Warped Mesh</b> ({export_mesh}) writes the "
        "warped bone, STL or any other kind.",
        "the warped mesh exported",
        _as_it_is,
        _is_exported,
    ),
)
