"""Where the counterpart of a half-placed landmark is expected, and how surely."""

from __future__ import annotations

import numpy as np
import pytest

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.session.session import Session
from pinwarp.session.warp.ghost import ghost_of
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver


def test_both_sides_of_a_landmark_are_expected_where_they_belong_and_equally_surely():
    places = np.random.default_rng(0).normal(size=(9, 3))
    # Far away: what is said of one side must not be looked up on the other.
    ends = 1.1 * places + 0.1 * np.sin(3 * places) + [50, 0, 0]
    pairs = map(Landmark, "abcdefghi", map(tuple, places), map(tuple, ends))
    result = WarpSolver().solve(WarpInputs.of(Session(landmarks=tuple(pairs))))
    source = (0.3, -0.2, 0.5)
    there = ghost_of(Landmark("x", source), Side.DESTINATION, result)
    assert there.position == pytest.approx(result.spline.evaluate([source])[0])
    back = ghost_of(Landmark("x", None, there.position), Side.SOURCE, result)
    assert back.position == pytest.approx(source)
    assert 0 < back.deviation == pytest.approx(there.deviation)
