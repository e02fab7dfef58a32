"""The warp of a session in the frame and unit of a model's body."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.components import Components
from pinwarp.core.errors import PinwarpError
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.landmarks import Side
from pinwarp.core.lengths import rms
from pinwarp.core.prediction import Prediction, prediction_of
from pinwarp.core.spline import Spline
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.core.words import counted
from pinwarp.io.osim.bone import Bone
from pinwarp.session.model.body_view import BodyView, in_body_frame, view_of
from pinwarp.session.session import Session
from pinwarp.session.warp.ghost import FEWEST_PAIRS
from pinwarp.session.warp.refined import OUT_OF_DATE, is_out_of_date, refinement_in_use
from pinwarp.session.warp.slid_words import not_sliding_note
from pinwarp.session.warp.solved import SolvedWarp, solved

Matrix = NDArray[np.float64]

# Another size than this is not another subject but another unit.
SMALLEST_RATIO, LARGEST_RATIO = 0.3, 3.0
# So many of the pairs lie this close to the bone, as a share of its diagonal; others may be
# centres of joints.
CLOSE = 0.01
SHARE_CLOSE = 0.75
# With fewer pairs not even the size along every axis is known.
FEW = 4


@dataclass(frozen=True, eq=False)
class BodyWarp:
    """A warp that a body's parts can be carried through.

    Attributes
    ----------
    warp
        Takes (m, 3) places of the body to where the subject has them, pose left out, in the
        body's frame and unit.
    deviation
        Standard deviation of one coordinate of it, (m,); None where it is not known.
    pairs
        How many pairs it comes from.
    ratio
        How many times as large as the body the subject is.
    notes
        What is to be known about it, as sentences.
    """

    warp: Callable[[Matrix], Matrix]
    deviation: Callable[[Matrix], Matrix] | None
    pairs: int
    ratio: float
    notes: tuple[str, ...] = ()


def body_warp(session: Session, bone: Bone) -> BodyWarp:
    """Solve a session and bring its warp into the frame of a body.

    Parameters
    ----------
    session
        Its source is the bone, one of the bone's mesh files, or not known; in the last case its
        landmarks are taken to be in the body's frame. Meshes need not have been read but for
        semilandmarks and mirrors.
    bone
        The body.

    Returns
    -------
    BodyWarp
        Of the components without pose, whatever the session applies.

    Raises
    ------
    PinwarpError
        When there is no pair, the solve fails, the session is of another body, its landmarks do
        not lie on the bone, or the subject is in another unit.
    """
    if not session.pairs:
        raise PinwarpError(f"{bone.name}: its session has no pair. Place landmarks on both meshes.")
    view, notes = view_of(session, bone)
    about_refinement = (OUT_OF_DATE,) if is_out_of_date(session) else ()
    is_of_pairs = not session.groups and refinement_in_use(session) is None
    if not view.is_similar and not is_of_pairs:
        raise PinwarpError(
            f"{bone.name}: the model draws its mesh with scale factors, through which curves, "
            "patches and a refinement cannot go. Open the body itself as the source: "
            f"{bone.file.path.name} of {bone.model.path.name}."
        )
    if is_of_pairs and (view.is_mirrored or not view.is_similar):
        session, view = in_body_frame(session, view), BodyView()
    solution = solved(session)
    source = solution.factor.source
    _check_lie(bone, view.out(source))
    ratio = _size(solution.destination) / _size(source) if _size(source) > 0 else 1.0
    _check_size(bone, ratio)
    few = f"With {counted(len(source), 'pair')} the subject's size is a guess: place at least 8."
    spline = solution.part(Components.WITHOUT_POSE)
    notes = (
        *notes,
        *about_refinement,
        *_about_suggested(session),
        *not_sliding_note(solution.result),
        *((few,) if len(source) < FEW else ()),
        *_about_folds(spline, bone, view),
    )
    prediction = _prediction(solution)

    def carried(places: Matrix) -> Matrix:
        return view.out(spline.evaluate(view.into(places)))

    def deviation(places: Matrix) -> Matrix:
        assert prediction is not None, "asked for only where it is known"
        return prediction.standard_deviation(view.into(places)) * view.unit

    return BodyWarp(
        carried,
        None if prediction is None else deviation,
        len(source),
        ratio,
        tuple(f"{bone.name}: {note}" for note in notes),
    )


def _prediction(solution: SolvedWarp) -> Prediction | None:
    settings, result = solution.session.settings, solution.result
    if not settings.is_regular or result.is_fitted or len(solution.destination) < FEWEST_PAIRS:
        return None
    mesh = solution.session.mesh(Side.SOURCE)
    size = None if mesh is None else mesh.diagonal
    return prediction_of(solution.factor, solution.destination, settings.penalty, size)


def _about_suggested(session: Session) -> tuple[str, ...]:
    count = sum(pair.is_suggested for pair in session.pairs)
    are = counted(count, "landmark was", "landmarks were")
    return (f"{are} only suggested: nobody has looked there yet.",) if count else ()


def _about_folds(spline: Spline, bone: Bone, view: BodyView) -> tuple[str, ...]:
    if bone.mesh is None:
        return ()
    determinant = determinants(jacobians(spline, view.into(bone.mesh.vertices)))
    folded = int((determinant <= 0).sum())
    where = counted(folded, "vertex", "vertices")
    words = f"The warp folds at {where} of its mesh: look for a wrong pair in the session."
    return (words,) if folded else ()


def _size(places: Matrix) -> float:
    return rms(np.linalg.norm(places - places.mean(axis=0), axis=1))


def _check_size(bone: Bone, ratio: float) -> None:
    if SMALLEST_RATIO <= ratio <= LARGEST_RATIO:
        return
    way_out = "Check that both are the same bone, and their units."
    if SMALLEST_RATIO < ratio / 1000 < LARGEST_RATIO:
        way_out = (
            "It is in millimetres and the model in metres: scale the source by 1000 in the "
            "session (the line '# source_scaled: 1000')."
        )
    times = f"{ratio:,.0f}" if ratio > 10 else f"{ratio:.2g}"
    raise PinwarpError(
        f"{bone.name}: the subject is {times} times as large as the model's bone. {way_out}"
    )


def _check_lie(bone: Bone, places: Matrix) -> None:
    if bone.mesh is None:
        return
    far = SurfaceIndex(bone.mesh).distances(places)
    limit = CLOSE * bone.mesh.diagonal
    close = int((far <= limit).sum())
    if close < SHARE_CLOSE * len(places):
        raise PinwarpError(
            f"{bone.name}: {close} of {len(places)} landmarks of its session lie on that body's "
            f"mesh; the farthest is {1e3 * far.max():.1f} mm away. Is the session of another "
            "bone, or was the mesh moved?"
        )
