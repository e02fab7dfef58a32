"""The refined warp of a session: whether it still belongs to it, and the spline that it is."""

from __future__ import annotations

import functools
from collections.abc import Sequence

from pinwarp.core.factor import factorise
from pinwarp.core.groups import Curve
from pinwarp.core.spline import Spline, solve
from pinwarp.core.words import counted
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.io.setting_keys import setting_lines
from pinwarp.session.session import Session
from pinwarp.session.warp.component_words import applied_in_words
from pinwarp.session.warp.fingerprint import fingerprint, group_parts, mesh_parts

OUT_OF_DATE = (
    "The refinement is out of date, since landmarks, drawn curves, a mesh or the penalty have "
    "changed: the warp goes without it. Refine again."
)


def refinement_in_use(session: Session) -> RefinementRecord | None:
    """Return the refinement of a session where it belongs to what the session is now.

    Examples
    --------
    >>> refinement_in_use(Session()) is None
    True
    """
    refined = session.refinement
    return refined if refined is not None and refined.inputs == inputs_of(session) else None


def is_out_of_date(session: Session) -> bool:
    """Whether the session was refined, and has changed since."""
    return session.refinement is not None and refinement_in_use(session) is None


def warp_in_words(session: Session) -> str:
    """Say what of the warp of a session is applied, and whether it is refined.

    Examples
    --------
    >>> warp_in_words(Session())
    'the full warp'
    """
    words = applied_in_words(session.settings)
    return words if refinement_in_use(session) is None else words.replace("warp", "refined warp")


def refinement_in_words(session: Session) -> str:
    """Say in short what became of the refinement of a session; nothing where it has none.

    Examples
    --------
    >>> refinement_in_words(Session())
    ''
    """
    if session.refinement is None:
        return ""
    refined = refinement_in_use(session)
    if refined is None:
        return "The refinement is out of date"
    fitted = len(refined.source) - len(session.pairs)
    return f"Refined to the surface by {counted(fitted, 'fitted pair')}"


def fitted_names(count: int, landmarks: Sequence[str]) -> list[str]:
    """Return what the places that a refinement fitted are called, none as a landmark is.

    Examples
    --------
    >>> fitted_names(2, ["apex"]), fitted_names(1, ["fitted_1"])
    (['fitted_1', 'fitted_2'], ['fitted__1'])
    """
    start = "fitted_"
    while any(name.startswith(start) for name in landmarks):
        start += "_"
    return [f"{start}{number}" for number in range(1, count + 1)]


def drawn_curves(session: Session) -> tuple[Curve, ...]:
    """Return the curves that somebody drew on both bones.

    Examples
    --------
    >>> drawn_curves(Session())
    ()
    """
    return tuple(x for x in session.groups if isinstance(x, Curve) and x.is_drawn)


def inputs_of(session: Session) -> str:
    """Return a hash of all in a session that a refinement depends on.

    Names, notes, passengers and what of the warp is applied do not matter.
    """
    settings = session.settings.whole
    parts = (
        tuple((pair.source, pair.destination) for pair in session.pairs),
        mesh_parts(session),
        # As files say it: a setting that is yet to come and as usual puts nothing out of date.
        tuple(line for always in (True, False) for line in setting_lines(settings, always=always)),
        # Other curves and patches do not act on it.
        *group_parts(session, drawn_curves(session)),
    )
    return fingerprint(parts)


# Every frame and every export of a session asks for the same one.
@functools.lru_cache(maxsize=2)
def refined_spline(refined: RefinementRecord) -> Spline:
    """Return the spline of a refinement: the ordinary one of its pairs, at penalty 0.

    Raises
    ------
    PinwarpError
        When they cannot be solved for, as in a file that was changed by hand.
    """
    return solve(factorise(refined.source), refined.destination)
