"""How precise landmarks are, and the penalty that asks for: against simulations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.errors import LandmarkError, PinwarpError
from pinwarp.core.factor import factorise
from pinwarp.core.noise import carried_variance, linear_size, noise_level
from pinwarp.core.quality import penalty_curve
from pinwarp.core.repeatability import repeatability
from pinwarp.core.spline import solve


def test_spreads_are_those_of_each_landmark_by_hand():
    rng = np.random.default_rng(0)
    places = rng.normal(size=(3, 5, 3))
    places[2, 4] = np.nan
    found = repeatability(places)
    for row in range(5):
        there = places[np.isfinite(places[:, row, 0]), row]
        variances = there.var(axis=0, ddof=1)
        assert found.spreads[row] == pytest.approx(math.sqrt(variances.sum()))
        assert found.shares[row] == pytest.approx(variances / variances.sum())
    assert found.counts.tolist() == [3, 3, 3, 3, 2]
    assert found.freedom == 3 * (2 + 2 + 2 + 2 + 1)
    assert found.spread**2 == pytest.approx(
        np.sum(found.spreads**2 * (found.counts - 1)) / np.sum(found.counts - 1)
    )


def test_the_interval_holds_the_true_spread_as_often_as_it_says():
    rng = np.random.default_rng(1)
    truth = math.sqrt(3) * 0.4
    intervals = [repeatability(0.4 * rng.normal(size=(2, 8, 3))).interval for _ in range(600)]
    held = np.mean([low < truth < high for low, high in intervals])
    assert 0.925 < held < 0.975


def test_a_landmark_stands_out_in_one_set_of_a_hundred_by_chance_and_always_when_it_is_off():
    rng = np.random.default_rng(2)
    sets = 400
    by_chance = sum(
        repeatability(rng.normal(size=(3, 20, 3))).outstanding.any() for _ in range(sets)
    )
    assert by_chance < 0.05 * sets
    places = rng.normal(size=(3, 20, 3))
    places[1, 7] += 12
    places[2, 3] -= 12
    found = repeatability(places)
    assert np.flatnonzero(found.outstanding).tolist() == [3, 7]
    assert found.variance_without < found.variance / 2


@given(st.floats(-1e3, 1e3), st.floats(1e-3, 1e3), st.integers(0, 2**31))
def test_spreads_know_neither_origin_nor_order_and_go_along_with_the_unit(shift, factor, seed):
    places = np.random.default_rng(seed).normal(size=(3, 4, 3))
    found = repeatability(places)
    assert repeatability(places[::-1] + shift).spreads == pytest.approx(found.spreads, rel=1e-6)
    other = repeatability(factor * places)
    assert other.spreads == pytest.approx(factor * found.spreads, rel=1e-6)
    assert other.interval == pytest.approx([factor * x for x in found.interval], rel=1e-6)


def test_what_was_placed_once_has_no_spread_and_nothing_twice_is_refused():
    places = np.zeros((2, 2, 3))
    places[1, 0] = np.nan
    assert np.isnan(repeatability(places).spreads).tolist() == [True, False]
    places[1] = np.nan
    with pytest.raises(LandmarkError, match="nothing to compare"):
        repeatability(places)
    with pytest.raises(LandmarkError, match=r"\(k, n, 3\)"):
        repeatability(np.zeros((2, 3)))


def drawn(rng, count, penalty, field=0.2):
    """Return landmarks of a field of the spline's own kind with noise, and places without."""
    places = rng.normal(size=(count + 25, 3)) * [20, 20, 80]
    factor = factorise(places)
    values = np.maximum(factor.modes[0], 0)
    bent = factor.modes_at_landmarks @ (
        np.sqrt(values)[:, None] * rng.normal(size=(len(values), 3))
    )
    truth = places @ np.diag([1.1, 0.9, 1.0]) + math.sqrt(field) * bent
    noisy = truth[:count] + math.sqrt(field * penalty) * rng.normal(size=(count, 3))
    return places[:count], noisy, places[count:], truth[count:]


@pytest.mark.parametrize(("count", "penalty"), [(12, 10.0), (30, 3.0), (30, 30.0)])
def test_the_penalty_of_a_known_noise_is_the_true_one_and_beats_the_suggested(count, penalty):
    rng = np.random.default_rng(3)
    found, missed, missed_suggested = [], [], []
    for _ in range(60):
        source, noisy, elsewhere, truth = drawn(rng, count, penalty)
        factor = factorise(source)
        level = noise_level(factor, noisy, 0.2 * penalty)
        curve = penalty_curve(factor, noisy)
        suggested = curve.penalties[curve.leave_one_out.argmin()]
        found.append(level.penalty)
        for missing, one in ((missed, level.penalty), (missed_suggested, suggested)):
            warped = solve(factor, noisy, one).evaluate(elsewhere)
            missing.append(np.mean((warped - truth) ** 2))
    assert 0.85 * penalty < np.median(found) < 1.18 * penalty
    assert np.mean(missed) <= np.mean(missed_suggested)


def test_the_level_goes_along_with_the_units_of_either_side():
    source, noisy, _, _ = drawn(np.random.default_rng(4), 15, 5.0)
    level = noise_level(factorise(source), noisy, 1.0)
    metres = noise_level(factorise(source / 1000), noisy / 1000, 1e-6)
    assert metres.penalty == pytest.approx(level.penalty / 1000, rel=1e-4)
    larger = noise_level(factorise(source), 10 * noisy, 100.0)
    assert larger.penalty == pytest.approx(level.penalty, rel=1e-4)


def test_noise_that_explains_everything_asks_for_the_affine_fit_and_none_for_no_penalty():
    rng = np.random.default_rng(5)
    source = rng.normal(size=(12, 3))
    noisy = source + 0.1 * rng.normal(size=source.shape)
    factor = factorise(source)
    assert noise_level(factor, noisy, 1.0).penalty == math.inf
    assert noise_level(factor, noisy, 0.0).penalty == 0.0
    assert noise_level(factor, source, 0.01).penalty == math.inf
    assert noise_level(factorise(source[:4]), source[:4], 0.01) is None
    with pytest.raises(PinwarpError, match="must be 0 or more"):
        noise_level(factor, noisy, -1.0)


def test_noise_of_the_source_is_carried_over_by_the_linear_part():
    rng = np.random.default_rng(6)
    source = rng.normal(size=(20, 3))
    linear = rng.normal(size=(3, 3))
    destination = source @ linear + 5
    offs = 0.1 * rng.normal(size=(20_000, 3))
    carried = np.mean(np.sum((offs @ linear) ** 2, axis=1)) / 3
    assert carried_variance(source, destination, 0.01) == pytest.approx(carried, rel=0.03)
    flat = source * [1, 1, 0]
    assert linear_size(flat, 3 * flat) == pytest.approx(3)
    assert linear_size(np.zeros((0, 3)), np.zeros((0, 3))) == 1
