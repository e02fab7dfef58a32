"""Functions of a coordinate, as OpenSim evaluates them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.osim_kinematics import simm_spline

from pinwarp.core.coordinate_function import CoordinateFunction, FunctionKind

KNOTS = st.lists(st.integers(-40, 40), min_size=4, max_size=9, unique=True).map(sorted)


@pytest.mark.parametrize(
    ("count", "where", "expected"),
    [
        # What OpenSim 4.6 makes of the first knots of one spline.
        (
            5,
            [-3, -2, -1.5, -0.3, 0.1, 0.3, 0.5, 0.9],
            [
                *(-0.023961057382333978, -0.004, 0.002247840103159252, -0.0008698274661508693),
                *(-0.005039432624113476, -0.0028309176875134325, 0.01, 0.048718839458413925),
            ],
        ),
        (3, [-3, -2, -1.5, -0.3, 0, 0.9], [-0.018, -0.004, 0.00125, -0.00043, -0.004, -0.0166]),
        (2, [-3, -1.5, 0.9], [-0.011, -0.0005, 0.0163]),
    ],
)
def test_a_spline_runs_as_opensim_runs_it(count, where, expected):
    knots, values = [-2, -1, 0, 0.2, 0.5], [-0.004, 0.003, -0.004, -0.005, 0.01]
    spline = CoordinateFunction(FunctionKind.SPLINE, knots[:count], values[:count])
    np.testing.assert_allclose(spline(where), expected, atol=1e-15)


@given(KNOTS, st.data())
def test_a_spline_is_that_of_scipy_with_the_same_ends(knots, data):
    knots = np.array(knots) / 10
    values = np.array(
        data.draw(st.lists(st.integers(-9, 9), min_size=len(knots), max_size=len(knots)))
    )
    spline = CoordinateFunction(FunctionKind.SPLINE, knots, values)
    where = np.linspace(knots[0], knots[-1], 23)
    scale = max(1, np.abs(np.diff(values) / np.diff(knots)).max())
    np.testing.assert_allclose(
        spline(where), simm_spline(knots, values.astype(float), where), atol=1e-6 * scale
    )
    np.testing.assert_allclose(spline(knots), values, atol=1e-12)


def test_what_is_linear_in_pieces_goes_on_straight_at_its_ends():
    bent = CoordinateFunction(FunctionKind.LINEAR, [0, 1, 3], [0, 2, 0])
    np.testing.assert_allclose(bent([-1, 0.5, 2, 5]), [-2, 1, 1, -2])


@pytest.mark.parametrize(
    ("knots", "values", "words"),
    [
        ([0, 1], [1], "1 values instead of 2"),
        ([0, 0], [1, 2], "do not increase"),
        ([], [], "no knots"),
        ([0, np.inf], [1, 2], "not finite"),
    ],
)
def test_knots_that_make_no_function_are_refused(knots, values, words):
    with pytest.raises(ValueError, match=words):
        CoordinateFunction(FunctionKind.SPLINE, knots, values)
