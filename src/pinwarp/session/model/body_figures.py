"""What becomes of a body's elements by the session as it is: rows, and where they are drawn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.errors import PinwarpError
from pinwarp.core.frame_warp import BodyRules
from pinwarp.core.landmarks import Side, positions
from pinwarp.core.model_rows import ElementRow
from pinwarp.core.model_warp import warp_body
from pinwarp.io.osim.bone import Bone
from pinwarp.session.model.body_view import BodyView, view_of
from pinwarp.session.model.body_warp import BodyWarp, body_warp
from pinwarp.session.model.elements import Elements, MusclePaths, elements_after, elements_before
from pinwarp.session.session import Session
from pinwarp.session.warp.solved import solved

Matrix = NDArray[np.float64]
Way = Callable[[Matrix], Matrix]

# So many places of the bone tell where a model in the body's frame lies on the destination.
_ENOUGH = 60


@dataclass(frozen=True, eq=False)
class BodyFigures:
    """What becomes of a body.

    Attributes
    ----------
    bone, session, rules
        What it is of.
    view
        How the session sees the bone.
    before
        Its elements on the source.
    after
        Its elements on the destination, as the new model will have them; None without a warp.
    rows
        A row for every element; without a warp their figures are not known.
    notes
        What is to be known of the warp.
    problem
        Why there is none, in words; empty where there is nothing to say.
    """

    bone: Bone
    session: Session
    rules: BodyRules
    view: BodyView
    before: Elements
    after: Elements | None
    rows: tuple[ElementRow, ...]
    notes: tuple[str, ...] = ()
    problem: str = ""

    @property
    def is_warped(self) -> bool:
        """Whether the rows say where the warp takes things."""
        return self.after is not None


def body_figures(
    session: Session, bone: Bone, rules: BodyRules, muscles: MusclePaths
) -> BodyFigures:
    """Find out what becomes of a body.

    Parameters
    ----------
    session
        As it is, with or without pairs.
    bone
        The body; the session was made on it or on one of its meshes.
    rules
        What is chosen.
    muscles
        The paths of the model's muscles.
    """
    problem, warp = "", None
    try:
        view, _ = view_of(session, bone)
        if session.pairs:
            warp = body_warp(session, bone)
            warped = warp_body(bone.parts, warp.warp, rules, warp.deviation)
    except PinwarpError as error:
        view, problem, warp = BodyView(), str(error), None
    except ValueError as error:
        problem, warp = f"{bone.name}: of a frame {error} after the warp.", None
    before = elements_before(bone.parts, muscles).mapped(view.into)
    if warp is None:
        rows = warp_body(bone.parts, lambda places: places, rules).rows
        return BodyFigures(
            bone, session, rules, view, before, None, _without_figures(rows), problem=problem
        )
    after = elements_after(warped, muscles).mapped(_way_there(session, view, warp, bone))
    return BodyFigures(bone, session, rules, view, before, after, warped.rows, warp.notes)


def _way_there(session: Session, view: BodyView, warp: BodyWarp, bone: Bone) -> Way:
    """Return the way from the warped body, without its pose, to the destination."""
    if bone.mesh is None:
        places = view.out(positions(session.pairs, Side.SOURCE))
    else:
        places = bone.mesh.vertices[:: max(1, len(bone.mesh.vertices) // _ENOUGH)]

    def seen(there: Matrix) -> Matrix:
        return view.into(there) if view.is_mirrored else there

    whole = solved(session).spline.evaluate(view.into(places))
    pose = fit_similarity(seen(warp.warp(places)), whole)
    return lambda there: pose.apply(seen(there))


def _without_figures(rows: tuple[ElementRow, ...]) -> tuple[ElementRow, ...]:
    return tuple(
        replace(row, moved=np.nan, plus_minus=np.nan, turned=np.nan, words="", flag="")
        for row in rows
    )
