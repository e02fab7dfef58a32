"""Frames in frames."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.placement import Placement, frame_of_stations, turn_in_degrees

ANGLES = st.tuples(*[st.floats(-np.pi, np.pi)] * 3)
PLACES = st.tuples(*[st.floats(-2, 2)] * 3)


@given(ANGLES | st.sampled_from([(0.3, np.pi / 2, -0.4), (1.0, -np.pi / 2, 0.2)]))
def test_angles_come_back_as_the_same_rotation_also_where_they_lock(angles):
    rotation = Placement.from_angles(angles, [0, 0, 0]).rotation
    again = Placement.from_angles(Placement(rotation, np.zeros(3)).angles, [0, 0, 0])
    np.testing.assert_allclose(again.rotation, rotation, atol=2e-9)


def test_angles_turn_about_x_then_the_turned_y_then_the_turned_z():
    turned = Placement.from_angles([np.pi / 2, np.pi / 2, 0], [0, 0, 0])
    # The turned y is the old z, about which x goes to y.
    np.testing.assert_allclose(turned.out([[1, 0, 0]]), [[0, 1, 0]], atol=1e-15)


@given(ANGLES, PLACES, ANGLES, PLACES, PLACES)
def test_a_frame_in_a_frame_is_seen_from_it_as_it_stands_in_it(a, p, b, q, place):
    outer, inner = Placement.from_angles(a, p), Placement.from_angles(b, q)
    both = outer.holding(inner)
    np.testing.assert_allclose(both.out([place]), outer.out(inner.out([place])), atol=1e-12)
    np.testing.assert_allclose(both.seen_from(outer).rotation, inner.rotation, atol=1e-12)
    np.testing.assert_allclose(both.seen_from(outer).origin, inner.origin, atol=1e-12)


def test_a_turn_is_told_in_degrees():
    assert turn_in_degrees(Placement.from_angles([0, 0, 0.1], [0, 0, 0]).rotation) == (
        pytest.approx(np.degrees(0.1))
    )


@pytest.mark.parametrize("axes", [("+x", "-x"), ("x", "+y"), ("+x", "+w")])
def test_axes_that_make_no_frame_are_refused(axes):
    with pytest.raises(ValueError, match="axes"):
        frame_of_stations([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]], *axes)


def test_stations_in_a_line_are_refused():
    with pytest.raises(ValueError, match="line"):
        frame_of_stations([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, 0]], "+x", "+y")
