"""The ghost: where the counterpart of a half-placed landmark should be, by the warp so far."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pinwarp.core.factor import SourceFactor
from pinwarp.core.landmarks import Position, Side, as_position
from pinwarp.core.prediction import inverse_warp, prediction_of
from pinwarp.core.spline import PenaltyConvention, Spline
from pinwarp.session.session import Session

# With fewer pairs a prediction says more about the pairs than about the bone.
LEAST_PAIRS = 3


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
        are too few pairs to tell.
    """

    name: str
    side: Side
    position: Position
    deviation: float | None


def ghost_of(
    session: Session, name: str | None, side: Side, factor: SourceFactor, spline: Spline
) -> Ghost | None:
    """Predict one side of a landmark from its other one.

    Parameters
    ----------
    session
        Holds the landmark and at least three pairs.
    name, side
        Which landmark lacks which side; None for no landmark.
    factor, spline
        The warp of the session's pairs.

    Returns
    -------
    Ghost or None
        None where there is nothing to predict from, or the warp cannot be inverted there.
    """
    landmark = session.landmark(name) if name is not None else None
    if landmark is None or landmark.position(side) is not None:
        return None
    known = landmark.position(side.other)
    if known is None or len(session.pairs) < LEAST_PAIRS:
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
    if spline.convention is PenaltyConvention.REGULARISING:
        pairs = session.pairs
        destination = np.array([pair.destination for pair in pairs])
        prediction = prediction_of(factor, destination, spline.penalty)
        if prediction is not None:
            deviation = float(prediction.standard_deviation(source)[0])
    return Ghost(landmark.name, side, as_position(expected[0]), deviation)
