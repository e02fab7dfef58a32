from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.core.strategies import landmark_pairs

from pinwarp.core import kernel
from pinwarp.core.errors import RangeError
from pinwarp.core.jacobian import determinants, jacobians, stretches
from pinwarp.core.spline import factorise, identity, solve


def by_differences(spline, points, step):
    moved = np.eye(3) * step
    slopes = [spline.evaluate(points + e) - spline.evaluate(points - e) for e in moved]
    return np.stack(slopes, axis=2) / (2 * step)


@given(landmark_pairs(least=4), st.floats(0, 1))
def test_the_derivative_is_what_finite_differences_say(pairs, share):
    source, destination = pairs
    size = np.linalg.norm(np.ptp(source, axis=0))
    spline = solve(factorise(source), destination, share * size)
    points = source.mean(axis=0) + size * np.random.default_rng(1).uniform(-1, 1, (50, 3))
    apart = np.linalg.norm(points[:, None] - source, axis=2).min(axis=1)
    points = points[apart > 0.02 * size]
    exact = jacobians(spline, points)
    rough = by_differences(spline, points, 1e-5 * size)
    assert np.abs(exact - rough).max() <= 1e-5 * np.abs(exact).max()


def test_the_compiled_and_the_numpy_derivative_agree_also_at_a_landmark(monkeypatch):
    rng = np.random.default_rng(2)
    source = rng.normal(size=(120, 3)) * 100 + 4000
    spline = solve(factorise(source), source + rng.normal(size=source.shape), 3.0)
    points = np.vstack([source, rng.normal(size=(2000, 3)) * 100 + 4000])
    monkeypatch.setattr(kernel, "WORTH_COMPILING", 0)
    assert kernel.compiled() is not None
    fast = jacobians(spline, points)
    monkeypatch.setattr(kernel, "compiled", lambda: None)
    plain = jacobians(spline, points)
    assert np.isfinite(plain).all()
    assert np.abs(fast - plain).max() < 1e-11


def test_at_a_landmark_it_is_the_mean_over_directions():
    rng = np.random.default_rng(2)
    source = rng.normal(size=(8, 3))
    spline = solve(factorise(source), source + 0.2 * rng.normal(size=source.shape))
    way = 1e-7 * rng.normal(size=3)
    around = jacobians(spline, source[:1] + np.array([way, -way])).mean(axis=0)
    assert np.allclose(jacobians(spline, source[:1])[0], around, atol=1e-6)


def test_no_landmarks_and_no_points_are_fine():
    assert np.array_equal(jacobians(identity(), [[1, 2, 3]])[0], np.eye(3))
    assert jacobians(identity(), np.zeros((0, 3))).shape == (0, 3, 3)
    assert determinants(np.zeros((0, 3, 3))).shape == (0,)


def test_determinants_and_stretches_are_those_of_numpy():
    J = np.random.default_rng(4).normal(size=(200, 3, 3))
    largest, smallest = stretches(J)
    assert np.allclose(determinants(J), np.linalg.det(J))
    assert np.allclose(largest, np.linalg.norm(J, 2, axis=(1, 2)))
    assert np.allclose(smallest, np.linalg.norm(J, -2, axis=(1, 2)))


def test_a_fold_has_a_determinant_below_zero():
    source = np.vstack([np.eye(3), -np.eye(3), [[0.1, 0, 0], [-0.1, 0, 0]]])
    destination = source.copy()
    destination[[6, 7]] = source[[7, 6]]
    spline = solve(factorise(source), destination)
    assert determinants(jacobians(spline, [[0, 0, 0]]))[0] < 0
    assert determinants(jacobians(spline, [[3, 0, 0]]))[0] == pytest.approx(1, abs=0.2)


@pytest.mark.parametrize("scale", [1e-120, 1e120])
def test_a_derivative_whose_determinant_is_no_number_is_refused(scale):
    warp = replace(identity(), affine=scale * identity().affine)
    with pytest.raises(RangeError, match="range of numbers"):
        jacobians(warp, [[0.0, 0.0, 0.0]])
