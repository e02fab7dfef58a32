from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.core.strategies import landmark_pairs

from pinwarp.core import kernel
from pinwarp.core.factor import factorise
from pinwarp.core.live import Influence, PenaltySweep, PreviewPoints, can_follow, preview
from pinwarp.core.spline import PenaltyConvention, solve


def box(points):
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def around(source, count=700):
    low, high = source.min(axis=0), source.max(axis=0)
    return np.random.default_rng(5).uniform(low, high, (count, 3))


@given(landmark_pairs(least=4, most=60), st.floats(-5, 3))
def test_a_sweep_stays_within_a_twenty_thousandth_of_the_box_at_every_penalty(pairs, exponent):
    source, destination = pairs
    vertices = around(source)
    factor = factorise(source)
    sweep = PenaltySweep(factor, destination, PreviewPoints.of(vertices))
    for penalty in (0.0, 10.0**exponent * box(source), np.inf):
        exact = solve(factor, destination, penalty).evaluate(vertices)
        assert np.abs(sweep.at(penalty) - exact).max() <= 5e-5 * box(exact)


def test_the_rank_of_a_sweep_hardly_grows_with_the_number_of_landmarks():
    rng = np.random.default_rng(0)
    source = rng.normal(size=(300, 3))
    destination = source + 0.1 * rng.normal(size=(300, 3))
    sweep = PenaltySweep(factorise(source), destination, PreviewPoints.of(source))
    assert sweep.rank <= 20


@given(landmark_pairs(least=4), st.integers(0, 100), st.floats(0, 1), st.booleans())
def test_a_dragged_destination_moves_the_warp_as_a_new_solve_would(pairs, row, share, published):
    source, destination = pairs
    row %= len(source)
    vertices = around(source)
    factor = factorise(source)
    penalty, convention = share * box(source), PenaltyConvention.REGULARISING
    if published and len(factor.poles):
        # Below the first pole, where the published convention is as tame.
        penalty, convention = 0.05 * float(factor.poles[0]), PenaltyConvention.OPYNSIM
    spline = solve(factor, destination, penalty, convention)
    drag = Influence(factor, spline, row, destination[row], PreviewPoints.of(vertices))
    moved = destination.copy()
    moved[row] += 0.2 * box(destination) * np.array([0.3, -0.5, 0.8])
    exact = solve(factor, moved, penalty, convention).evaluate(vertices)
    assert np.abs(drag.at(moved[row]) - exact).max() <= 5e-5 * max(box(exact), box(moved))


def test_a_drag_that_comes_back_leaves_no_trace():
    rng = np.random.default_rng(0)
    source, destination = rng.normal(size=(9, 3)), rng.normal(size=(9, 3))
    points = PreviewPoints.of(rng.normal(size=(50, 3)))
    factor = factorise(source)
    spline = solve(factor, destination)
    drag = Influence(factor, spline, 2, destination[2], points)
    drag.at(destination[2] + 10)
    assert np.array_equal(drag.at(destination[2]), preview(spline, points))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_warp_filled_in_by_a_similarity_does_not_follow_linearly(count):
    assert not can_follow(factorise(np.eye(3)[:count]))


def test_the_compiled_and_the_numpy_shortcuts_agree(monkeypatch):
    rng = np.random.default_rng(2)
    source, destination = rng.normal(size=(120, 3)) * 100, rng.normal(size=(120, 3)) * 100
    points = PreviewPoints.of(rng.normal(size=(5000, 3)) * 100 + 20)
    factor = factorise(source)
    spline = solve(factor, destination, 3.0)

    def shortcuts():
        sweep = PenaltySweep(factor, destination, points)
        drag = Influence(factor, spline, 4, destination[4], points)
        return [preview(spline, points), sweep.at(3.0), drag.at(destination[4] + [5, 0, 1])]

    assert kernel.compiled() is not None
    monkeypatch.setattr(kernel, "WORTH_COMPILING", 0)
    compiled = shortcuts()
    monkeypatch.setattr(kernel, "compiled", lambda: None)
    for fast, plain in zip(compiled, shortcuts(), strict=True):
        assert fast.dtype == plain.dtype == np.float32
        assert np.abs(fast - plain).max() < 5e-5 * box(plain)


def test_a_mesh_far_from_the_origin_keeps_its_digits():
    rng = np.random.default_rng(3)
    source, destination = rng.normal(size=(9, 3)), rng.normal(size=(9, 3))
    far = 1e5
    points = PreviewPoints.of(rng.normal(size=(50, 3)) + far)
    spline = solve(factorise(source + far), destination)
    exact = spline.evaluate(points.local.astype(float) + points.centre)
    assert np.abs(preview(spline, points) - exact).max() < 1e-5 * box(exact)
