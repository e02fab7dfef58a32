"""The ghost: where the counterpart of a half-placed landmark should be, by the warp so far."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.errors import RangeError
from pinwarp.core.factor import SourceFactor
from pinwarp.core.landmarks import Landmark, Position, Side, as_position
from pinwarp.core.prediction import inverse_warp, prediction_of
from pinwarp.session.warp.result import WarpResult

# With fewer pairs a prediction says more about the pairs than about the bone.
FEWEST_PAIRS = 3


@dataclass(frozen=True)
class Ghost:
    """A predicted place.

    Parameters
    ----------
    name
        The landmark that lacks this side.
    side
        The side it lacks.
    position
        Where it is expected, in that side's mesh unit.
    deviation
        The prediction's standard deviation there, in destination mesh units. It is that of the
        landmarks alone: semilandmarks, which were fitted and not observed, may bring the place
        nearer, so with them it is rather too wide. None while something moves, and of a penalty
        that does not regularise.
    """

    name: str
    side: Side
    position: Position
    deviation: float | None


def ghost_of(landmark: Landmark | None, side: Side, result: WarpResult) -> Ghost | None:
    """Predict one side of a landmark from its other one.

    Parameters
    ----------
    landmark, side
        Which landmark lacks which side; None for no landmark.
    result
        The warp of at least three pairs.

    Returns
    -------
    Ghost or None
        None where there is nothing to predict from, or the warp cannot be inverted there.
    """
    try:
        return _predicted(landmark, side, result)
    except RangeError:
        return None


def _predicted(landmark: Landmark | None, side: Side, result: WarpResult) -> Ghost | None:
    factor, spline = result.factor, result.spline
    if landmark is None or landmark.position(side) is not None or factor is None or spline is None:
        return None
    known = landmark.position(side.other)
    if known is None or len(factor.source) < FEWEST_PAIRS:
        return None
    if side is Side.DESTINATION:
        source = np.array([known])
        expected = spline.evaluate(source)
    else:
        source, converged = inverse_warp(spline, np.array([known]))
        if not converged[0]:
            return None
        expected = source
    deviation = _deviation(result, factor, source)
    return Ghost(landmark.name, side, as_position(expected[0]), deviation)


def _deviation(
    result: WarpResult, factor: SourceFactor, source: NDArray[np.float64]
) -> float | None:
    """Return how far the warp may be off at a place of the source, None where nobody can tell."""
    inputs = result.inputs
    # Not while the eigenvalues are put off: they would hold the hand up.
    if not factor.has_modes:
        return None
    if factor.usable_modes.any() and not inputs.settings.is_regular:
        return None
    size = None if inputs.mesh is None else inputs.mesh.diagonal
    destination = np.array(inputs.destination)
    prediction = prediction_of(factor, destination, inputs.settings.penalty, size)
    return float(prediction.standard_deviation(source)[0])
