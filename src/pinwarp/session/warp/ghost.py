"""The ghost: where the counterpart of a half-placed landmark should be, by the warp so far."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pinwarp.core.errors import RangeError
from pinwarp.core.landmarks import Landmark, Position, Side, as_position
from pinwarp.core.prediction import inverse_warp, prediction_of
from pinwarp.core.spline import PenaltyConvention
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
        The prediction's standard deviation there, in destination mesh units; None where there
        are too few pairs to tell, and with semilandmarks.
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
    deviation = None
    # Not while the eigenvalues are put off: they would hold the hand up. Semilandmarks bring the
    # expected place nearer than the pairs alone could tell.
    foretold = result.semilandmarks is None and factor.has_modes
    if foretold and spline.convention is PenaltyConvention.REGULARISING:
        prediction = prediction_of(factor, np.array(result.inputs.destination), spline.penalty)
        if prediction is not None:
            deviation = float(prediction.standard_deviation(source)[0])
    return Ghost(landmark.name, side, as_position(expected[0]), deviation)
