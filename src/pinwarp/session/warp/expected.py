"""Where a curve is on the destination: as it was drawn there, or as the warp takes it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.curves import PathFinder
from pinwarp.core.gathering import Course, path_of
from pinwarp.core.groups import Curve
from pinwarp.core.landmarks import Side
from pinwarp.core.spline import Spline
from pinwarp.core.surface import Surface

Matrix = NDArray[np.float64]


def expected_handles(curve: Curve, spline: Spline, surface: Surface) -> Matrix:
    """Return (h, 3) where the handles of a curve are on the destination, or are expected there.

    Parameters
    ----------
    curve
        The curve.
    spline
        The warp.
    surface
        The destination's.
    """
    places = surface.closest(spline.evaluate([handle.source for handle in curve.handles]))
    return np.array(
        [
            place if handle.destination is None else handle.destination
            for handle, place in zip(curve.handles, places.positions, strict=True)
        ]
    )


def destination_path(curve: Curve, course: Course, spline: Spline, finder: PathFinder) -> Matrix:
    """Return the (p, 3) way of a curve over the destination: drawn there, or as it is carried.

    Parameters
    ----------
    curve, course
        The curve, and where it runs on the source.
    spline
        The warp.
    finder
        Of the destination's surface.
    """
    if curve.is_drawn:
        return path_of(curve, finder, Side.DESTINATION).places
    return finder.surface.closest(spline.evaluate(course.path.places)).positions
