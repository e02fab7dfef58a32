"""Which part of a warp is applied: all of it, a simpler fit, or something on the way there.

Every part is again of the spline's form, so that it is evaluated, exported and mapped like the
whole: a fit has no weights, and a blend mixes weights and affine parts linearly.
"""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.alignment import Similarity, fit_similarity
from pinwarp.core.factor import SourceFactor
from pinwarp.core.positions import quiet
from pinwarp.core.spline import Spline, solve

Matrix = NDArray[np.float64]


class Components(StrEnum):
    """What of the warp is applied.

    ``WITHOUT_POSE`` aligns the destination rigidly to the source first, so that the result keeps
    the source's frame and takes only the destination's size and shape. ``AFFINE``,
    ``SIMILARITY`` and ``RIGID`` are the least-squares fits of the pairs (the affine one is the
    warp at infinite penalty), not what is left of the spline without its weights: that would be
    the warp far away from the bone.

    Examples
    --------
    >>> [part.value for part in Components]
    ['full', 'without pose', 'affine', 'similarity', 'rigid']
    """

    FULL = "full"
    WITHOUT_POSE = "without pose"
    AFFINE = "affine"
    SIMILARITY = "similarity"
    RIGID = "rigid"


@quiet
def applied(
    spline: Spline,
    factor: SourceFactor,
    destination: ArrayLike,
    components: Components = Components.FULL,
    blend: float = 1.0,
) -> Spline:
    """Return the part of a warp that is to be applied.

    Parameters
    ----------
    spline
        The solved warp.
    factor, destination
        The pairs it was solved from: factorised source and (n, 3) destination landmarks.
    components
        What of it is applied.
    blend
        From 0, the source aligned rigidly to the destination (for ``WITHOUT_POSE`` the source
        where it is), to 1, the components in full.

    Returns
    -------
    Spline
        In the destination's frame and unit, but for ``WITHOUT_POSE``, which keeps the source's
        frame.

    Raises
    ------
    ValueError
        When the blend is not from 0 to 1.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> source = np.random.default_rng(0).normal(size=(8, 3))
    >>> moved = source @ [[0, 1, 0], [-1, 0, 0], [0, 0, 1]] + 5
    >>> factor = factorise(source)
    >>> kept = applied(solve(factor, moved), factor, moved, Components.WITHOUT_POSE)
    >>> np.allclose(kept.evaluate(source), source)
    True
    """
    if not 0 <= blend <= 1:
        raise ValueError(f"The blend is {blend}; it must be from 0 to 1.")
    if components is Components.FULL and blend == 1:
        return spline
    target = np.asarray(destination, dtype=np.float64)
    pose = fit_similarity(factor.source, target, scaling=False)
    match components:
        case Components.AFFINE:
            whole = solve(factor, target, np.inf)
        case Components.SIMILARITY:
            whole = _without_weights(spline, fit_similarity(factor.source, target))
        case Components.RIGID:
            whole = _without_weights(spline, pose)
        case _:
            whole = spline
    rigid = _affine_of(pose)
    mixed = replace(
        spline,
        # A refined warp has places beside the landmarks; the fits are of the landmarks.
        source=whole.source,
        weights=blend * whole.weights,
        affine=blend * whole.affine + (1 - blend) * rigid,
    )
    return _pose_removed(mixed, pose) if components is Components.WITHOUT_POSE else mixed


def as_drawn(components: Components) -> Components:
    """Return what is shown over the destination: the pose is put back for the eye.

    Examples
    --------
    >>> as_drawn(Components.WITHOUT_POSE).value, as_drawn(Components.RIGID).value
    ('full', 'rigid')
    """
    return Components.FULL if components is Components.WITHOUT_POSE else components


def _affine_of(similarity: Similarity) -> Matrix:
    return np.vstack([similarity.translation, similarity.scale * similarity.rotation.T])


def _without_weights(spline: Spline, similarity: Similarity) -> Spline:
    return replace(
        spline, weights=np.zeros_like(spline.weights), affine=_affine_of(similarity), findings=()
    )


def _pose_removed(spline: Spline, pose: Similarity) -> Spline:
    """Return the spline followed by the way back from the destination's frame."""
    affine = spline.affine.copy()
    affine[0] -= pose.translation
    # Rows are positions: x R takes the rotation R back.
    return replace(spline, weights=spline.weights @ pose.rotation, affine=affine @ pose.rotation)
