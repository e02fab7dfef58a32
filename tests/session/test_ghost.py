"""Where the counterpart of a half-placed landmark is expected, and how surely."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.mesh import Mesh
from pinwarp.io.meshes import MeshFile
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


@pytest.mark.parametrize("count", [3, 4])
def test_pairs_too_few_to_tell_have_the_doubt_of_the_bones_size(count):
    """It grows away from the pairs, with the bone, and in the destination's unit."""
    corners = np.array([[0, 0, 0], [100, 0, 0], [0, 80, 0], [0, 0, 60]], dtype=float)[:count]

    def deviation(place, *, unit=1.0, size=400.0):
        mesh = Mesh(np.array([[0, 0, 0], [size, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
        pairs = [
            Landmark(name, tuple(start), tuple(unit * 1.1 * start))
            for name, start in zip("abcd", corners, strict=False)
        ]
        session = Session(source=MeshFile(Path("bone.ply"), mesh, "", ()), landmarks=tuple(pairs))
        result = WarpSolver().solve(WarpInputs.of(session))
        return ghost_of(Landmark("x", place), Side.DESTINATION, result).deviation

    near, far = deviation((40, 30, 5)), deviation((40, 30, 200))
    assert 0.01 * 400 < near < far < 0.4 * 400
    assert deviation((0, 80, 0.001)) < 0.05 * near
    assert deviation((40, 30, 5), unit=1e-3) == pytest.approx(1e-3 * near)
    assert deviation((40, 30, 5), size=1600.0) == pytest.approx(2 * near, rel=1e-3)
