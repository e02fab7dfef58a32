"""What a refinement is given beside surfaces and landmarks: how, drawn curves, where to begin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.curves import CurvePath
from pinwarp.core.errors import LandmarkError
from pinwarp.core.spline import Spline, check_penalty

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class RefinementSettings:
    """How a warp is refined.

    Parameters
    ----------
    smallest_feature
        Only what is larger is bent, in source mesh units; None takes what 1200 places resolve.
    landmark_tolerance
        A penalty of the landmarks, a length in source mesh units: 0 meets each of them.
    turn_destination
        Whether the destination is taken to face the other way: it, or the source, is inside out.

    Raises
    ------
    LandmarkError
        When the smallest feature is no length.
    PenaltyError
        When the tolerance is none.
    """

    smallest_feature: float | None = None
    landmark_tolerance: float = 0.0
    turn_destination: bool = False

    def __post_init__(self) -> None:
        feature = self.smallest_feature
        if feature is not None and not (feature > 0 and np.isfinite(feature)):
            raise LandmarkError(f"The smallest feature is {feature}; it must be longer than 0.")
        check_penalty(self.landmark_tolerance)


@dataclass(frozen=True, eq=False)
class DrawnPoints:
    """Points of a curve that somebody drew on both surfaces.

    Attributes
    ----------
    source : (k, 3) float64
        In their order on the source, landmarks not among them.
    path
        The curve on the destination.
    """

    source: Matrix
    path: CurvePath


@dataclass(frozen=True, eq=False)
class Start:
    """Where a refinement begins that landmarks are too few for: with another warp, as of a pose.

    Attributes
    ----------
    spline : Spline
        The warp; it must not mirror.
    loose : (k, 3) float64
        Places of the source, four or more and not in one plane, that stay where it takes them as
        long as nothing else moves them: what the surface leaves open is determined by them.
    penalty : float
        Theirs, a length in source mesh units; many times the size of the source.
    """

    spline: Spline
    loose: Matrix
    penalty: float
