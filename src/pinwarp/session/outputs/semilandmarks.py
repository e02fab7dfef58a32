"""The semilandmarks of a session as other programs number them: one order for every specimen."""

from __future__ import annotations

import numpy as np

from pinwarp.core.errors import PinwarpError
from pinwarp.core.gathering import rows_along
from pinwarp.core.groups import Curve
from pinwarp.core.landmarks import Position, Role, Side, as_position
from pinwarp.core.words import counted, some_of
from pinwarp.io.semilandmark_formats.points import CurveRows, NamedPlace, PatchRows, PointSet
from pinwarp.session.session import Session
from pinwarp.session.warp.slid_words import point_names
from pinwarp.session.warp.sliding import SlidGroup
from pinwarp.session.warp.solved import SolvedWarp, solved


def semilandmarks_on(session: Session | SolvedWarp, side: Side) -> tuple[PointSet, tuple[str, ...]]:
    """Return landmarks and semilandmarks of one side, and what was left out, as sentences.

    Rows are the same on both sides: a landmark that is not placed here, and on the destination
    a point that is freed, is missing. Passengers, and what is switched off or excluded, have no
    row.

    Parameters
    ----------
    session
        Or its warp, solved.
    side
        On the destination points are where they came to rest.

    Raises
    ------
    PinwarpError
        When there are no curves or patches, or they cannot slide; the message says what to do.
    """
    warp = solved(session)
    session = warp.session
    if not session.groups:
        raise PinwarpError("There are no curves or patches, so there are no semilandmarks yet.")
    at_rest = warp.result.semilandmarks
    if at_rest is None:
        assert warp.result.not_sliding is not None, "what does not slide says why"
        raise PinwarpError(warp.result.not_sliding)
    marks = [x for x in session.landmarks if x.role is Role.PAIR and x.enabled]
    left = [x.name for x in session.landmarks if x.role is not Role.PAIR or not x.enabled]
    rows = {mark.name: row for row, mark in enumerate(marks)}
    names = point_names(at_rest, rows, freed=True)
    places: list[NamedPlace] = [(mark.name, mark.position(side)) for mark in marks]
    curves, patches = [], []
    for slid in at_rest.groups:
        group, first = slid.group, len(places)
        places += zip(names[first - len(marks) :], _places(slid, side), strict=False)
        own = tuple(range(first, len(places)))
        if not isinstance(group, Curve):
            patches.append(PatchRows(group.name, own))
            continue
        if slid.course is None:
            raise PinwarpError("Curves are exported with both meshes at hand: open them first.")
        of_point = dict(zip(slid.numbers.tolist(), own, strict=True))
        along = rows_along(group, slid.course, rows, of_point)
        curves.append(CurveRows(group.name, group.is_closed, tuple(along.tolist()), own))
    notes = []
    if left:
        are = "is a passenger or" if len(left) == 1 else "are passengers or"
        notes.append(
            f"{counted(len(left), 'landmark')} that {are} switched off: left out ({some_of(left)})."
        )
    freed = at_rest.freed if side is Side.DESTINATION else 0
    if freed:
        notes.append(f"{counted(freed, 'point')} without a counterpart: written as missing.")
    points = PointSet(tuple(places), len(marks), tuple(curves), tuple(patches), session.unit)
    return points, tuple(notes)


def _places(slid: SlidGroup, side: Side) -> list[Position | None]:
    here = slid.source if side is Side.SOURCE else slid.positions
    absent = slid.is_freed if side is Side.DESTINATION else np.zeros_like(slid.is_freed)
    return [
        None if is_absent else as_position(place)
        for place, is_absent in zip(here, absent, strict=True)
    ]
