"""Colours of maps whose range is huge, empty or next to nothing."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from pinwarp.core.maps import MapKind
from pinwarp.gui.drawn.colour_table import colour_table
from pinwarp.gui.style.colour_scale import ColourScale

VALUES = [0.0, 5e-324, 1e-310, 1e-45, 1e-38, 1e-6, 0.5, 1.0, 1 + 1e-15, 3.4e38, 1e39, 1e300]
RANGES = [(low, high) for low, high in itertools.product(VALUES, VALUES) if low <= high]


@pytest.mark.parametrize("kind", list(MapKind))
def test_any_range_has_colours_ticks_and_a_table(kind):
    for range_ in RANGES:
        scale = ColourScale(kind, range_)
        low, high = scale.ends
        assert low < high
        assert high > 3e38 or np.float32(low) < np.float32(high)
        ticks = scale.ticks()
        assert all(-1e-3 <= tick.share <= 1 + 1e-3 for tick in ticks), range_
        assert len(ticks) < 20
        assert scale.colours(np.linspace(low, high, 5)).shape == (5, 3)
        assert colour_table(scale).GetNumberOfTableValues() == 256
