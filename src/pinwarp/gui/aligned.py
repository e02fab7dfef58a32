"""The source as it is shown over the destination: warped, or only moved by a fit of the pairs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.alignment import Similarity, fit_similarity
from pinwarp.core.mesh import Mesh
from pinwarp.session.editor import OverlayKind
from pinwarp.session.results import WarpInputs, WarpResult


def overlay_fit(inputs: WarpInputs, kind: OverlayKind) -> Similarity | None:
    """Return the fit that moves the source; None where it is warped or there is no pair."""
    if kind is OverlayKind.WARP or not inputs.source:
        return None
    scaling = kind is OverlayKind.SIMILARITY
    return fit_similarity(inputs.source, inputs.destination, scaling=scaling)


def as_shown(result: WarpResult, kind: OverlayKind) -> WarpResult:
    """Return a result whose shapes are those on the screen; its numbers stay the warp's.

    A fit needs no solve: it is there too where the warp has a problem.
    """
    fit = overlay_fit(result.inputs, kind)
    if fit is None:
        return result
    inputs = result.inputs
    # A preview has only the stand-in, where there is one.
    full_is_due = result.vertices is not None or inputs.stand_in is None
    passengers = np.array(inputs.passengers, dtype=np.float64).reshape(-1, 3)
    return replace(
        result,
        vertices=_moved(fit, inputs.mesh) if full_is_due else None,
        stand_in=_moved(fit, inputs.stand_in),
        passengers=fit.apply(passengers),
    )


def misfit(inputs: WarpInputs, kind: OverlayKind) -> float | None:
    """Return the root mean square distance that a fit leaves between the pairs."""
    fit = overlay_fit(inputs, kind)
    if fit is None:
        return None
    misses = fit.apply(np.array(inputs.source)) - np.array(inputs.destination)
    return float(np.sqrt(np.mean(np.sum(misses**2, axis=1))))


def _moved(fit: Similarity, mesh: Mesh | None) -> NDArray[np.float32] | None:
    return None if mesh is None else fit.apply(mesh.vertices).astype(np.float32)
