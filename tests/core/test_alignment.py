from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.core.strategies import rotations

from pinwarp.core.alignment import decompose


def around(axis, angle):
    x, y, z = axis
    W = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * W + (1 - np.cos(angle)) * W @ W


@given(
    st.integers(0, 1000), st.floats(0.01, np.pi - 0.01), st.floats(0.2, 3), st.sampled_from([1, -1])
)
def test_an_affine_map_is_its_parts_put_together(seed, angle, largest, sign):
    axis = rotations(seed)[0]
    Q = rotations(seed + 1)
    stretch = Q @ np.diag([largest, 0.8 * largest, 0.1 * sign]) @ Q.T
    turn = around(axis, angle)
    shift, centre = np.array([3.0, -4.0, 5.0]), np.array([100.0, 0.0, -20.0])
    linear = turn @ stretch
    affine = np.vstack([shift + centre - linear @ centre, linear.T])
    parts = decompose(affine, centre)
    assert parts.mirrored == (sign < 0)
    assert parts.angle == pytest.approx(np.degrees(angle))
    assert np.allclose(parts.axis, axis, atol=1e-6)
    assert np.allclose(parts.translation, shift)
    assert np.allclose(parts.scales, np.diag(stretch))
    assert np.allclose(parts.shears, [stretch[0, 1], stretch[0, 2], stretch[1, 2]])
    assert np.allclose(parts.principal, [largest, 0.8 * largest, 0.1 * sign])
    assert np.allclose(parts.directions.T @ np.diag(parts.principal) @ parts.directions, stretch)


def test_nothing_at_all_and_half_a_turn():
    parts = decompose(np.vstack([np.zeros(3), np.eye(3)]))
    assert (parts.angle, parts.mirrored) == (0, False)
    assert parts.axis.tolist() == [1, 0, 0]
    assert decompose(np.vstack([np.zeros(3), np.diag([-1, -1, 1])])).angle == pytest.approx(180)


def test_a_flattened_bone_is_taken_apart_too():
    parts = decompose(np.vstack([np.zeros(3), np.diag([1.0, 1.0, 0.0])]))
    assert parts.scales.tolist() == [1, 1, 0]
    assert not parts.mirrored
    parts = decompose(np.zeros((4, 3)))
    assert not parts.principal.any()
    assert np.isfinite(parts.axis).all()
