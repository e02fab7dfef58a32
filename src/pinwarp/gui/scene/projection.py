"""How places in a bone's frame come to the screen, as far as what is painted there needs it."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


class Projection(Protocol):
    """A camera before a bone; lengths on the screen are logical pixels."""

    @property
    def unit_per_pixel(self) -> float:
        """The length that a pixel shows where the camera looks, in mesh units."""

    @property
    def is_bone_lost(self) -> bool:
        """Whether there is a bone but nothing of it in the view."""

    def view_key(self) -> Hashable:
        """Return what decides which places are hidden; another one after any change of it."""

    def project(self, points: NDArray) -> NDArray:
        """Return where (n, 3) positions are on the screen: (n, 2)."""

    def pixels_per_unit(self, position: NDArray) -> float:
        """Return how many pixels a mesh unit takes at a position."""

    def behind_surface(self, positions: NDArray) -> NDArray[np.bool_]:
        """Return which of (n, 3) positions the bone hides from the camera."""
