"""A cut through a bone, to see inside: a plane that moves along the view it was made in."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from vtkmodules.vtkCommonDataModel import vtkPlane

Matrix = NDArray[np.float64]


class Section:
    """Clips what lies towards the eye; the camera may turn away from it afterwards.

    Parameters
    ----------
    direction
        Unit vector towards the eye.
    points
        (n, 3) positions of what is cut.

    Attributes
    ----------
    plane : vtkPlane
        For mappers, which drop what is on its negative side.
    """

    def __init__(self, direction: ArrayLike, points: ArrayLike) -> None:
        self.direction = np.asarray(direction, dtype=np.float64)
        depths = np.asarray(points, dtype=np.float64) @ self.direction
        self._near, self._far = float(depths.max()), float(depths.min())
        self.plane = vtkPlane()
        self.plane.SetNormal(*(-self.direction).tolist())
        self.share = 0.0
        self.move(0.0)

    def move(self, share: float) -> None:
        """Clip a share of the depth: 0 nothing, 1 everything."""
        self.share = share
        self.plane.SetOrigin(*(self.direction * self._level).tolist())

    @property
    def _level(self) -> float:
        return self._near + self.share * (self._far - self._near)

    def clips(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return which positions are clipped away."""
        # A position on the cut itself stays, whatever rounding did to it.
        slack = 1e-9 * (self._near - self._far)
        return np.asarray(points) @ self.direction > self._level + slack

    def entry(self, start: Matrix, end: Matrix) -> Matrix | None:
        """Return where a line of sight begins to see what is left; None where it never does."""
        before, after = (float(p @ self.direction) - self._level for p in (start, end))
        if before <= 0:
            return start
        if after > 0:
            return None
        return start + (end - start) * (before / (before - after))
