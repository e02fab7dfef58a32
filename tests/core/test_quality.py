from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.core.femur import femur_landmarks
from tests.core.strategies import landmark_pairs

from pinwarp.core.quality import bending_energy, leave_one_out, penalty_curve
from pinwarp.core.spline import factorise, identity, solve


def extent(points):
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def rms(vectors):
    return float(np.sqrt(np.mean(np.sum(vectors**2, axis=1))))


def by_solving_anew(source, destination, penalty):
    errors = []
    for row in range(len(source)):
        others = np.arange(len(source)) != row
        spline = solve(factorise(source[others]), destination[others], penalty)
        errors.append(destination[row] - spline.evaluate(source[[row]])[0])
    return np.array(errors)


@given(landmark_pairs(least=6), st.sampled_from([0.0, 0.02, 1.0, 50.0, np.inf]))
def test_leaving_out_in_closed_form_is_solving_without_the_pair(pairs, share):
    source, destination = pairs
    penalty = share * extent(source)
    result = leave_one_out(factorise(source), destination, penalty)
    expected = by_solving_anew(source, destination, penalty)
    # Without a pair the rest may lie nearly in a plane: then the errors are large, and so are ours.
    assert np.abs(result.errors - expected).max() <= 1e-9 * max(
        np.abs(expected).max(), extent(destination)
    )
    assert result.rms == pytest.approx(rms(expected), rel=1e-8, abs=1e-12 * extent(destination))


@pytest.mark.parametrize("penalty", [0.0, 0.4])
def test_coplanar_pairs_are_left_out_as_well(penalty):
    rng = np.random.default_rng(1)
    source = np.column_stack([rng.normal(size=(9, 2)), np.zeros(9)])
    destination = source + 0.1 * rng.normal(size=(9, 3))
    result = leave_one_out(factorise(source), destination, penalty)
    assert np.allclose(result.errors, by_solving_anew(source, destination, penalty), rtol=1e-9)


def test_duplicates_are_left_out_one_by_one():
    rng = np.random.default_rng(1)
    source, destination = rng.normal(size=(9, 3)), rng.normal(size=(9, 3))
    source[4] = source[2]
    result = leave_one_out(factorise(source), destination)
    assert np.allclose(result.errors, by_solving_anew(source, destination, 0.0), rtol=1e-7)
    assert np.allclose(result.errors[4], destination[4] - destination[2])
    assert set(np.argsort(result.standardised)[-2:]) == {2, 4}
    curve = penalty_curve(factorise(source), destination, [0.0, 1.0])
    halfway = rms(solve(factorise(source), destination).evaluate(source) - destination)
    assert curve.residual[0] == pytest.approx(halfway)
    agreeing = destination.copy()
    agreeing[4] = agreeing[2]
    result = leave_one_out(factorise(source), agreeing)
    assert result.distances[[2, 4]].max() < 1e-9
    assert result.standardised[[2, 4]].max() < 1e-6


def test_a_pair_that_alone_fixes_a_direction_is_not_judged():
    rng = np.random.default_rng(1)
    source = np.column_stack([rng.normal(size=(9, 2)), np.zeros(9)])
    source[3, 2] = 1.0
    destination = source + 0.1 * rng.normal(size=(9, 3))
    result = leave_one_out(factorise(source), destination)
    others = np.arange(9) != 3
    assert np.isnan(result.distances[3])
    assert np.isnan(result.standardised[3])
    assert np.isfinite(result.distances[others]).all()
    assert result.rms == pytest.approx(rms(result.errors[others]))
    assert np.isfinite(penalty_curve(factorise(source), destination).leave_one_out).all()


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_with_four_pairs_or_fewer_none_can_be_left_out(count):
    source = np.random.default_rng(0).normal(size=(count, 3))
    result = leave_one_out(factorise(source), source + 1)
    assert np.isnan(result.rms)
    assert result.errors.shape == (count, 3)
    assert np.isnan(result.standardised).all()
    curve = penalty_curve(factorise(source), source + 1)
    assert curve.suggested is None
    assert np.isnan(curve.leave_one_out).all()
    assert curve.residual.tolist() == [0.0]


def test_an_affine_map_leaves_nothing_suspicious():
    source = np.random.default_rng(0).normal(size=(12, 3))
    result = leave_one_out(factorise(source), 3 * source + 50)
    assert result.rms < 1e-9
    assert not result.standardised.any()
    curve = penalty_curve(factorise(source), 3 * source + 50)
    assert curve.is_affine
    assert not curve.leave_one_out.any()
    assert not curve.residual.any()
    assert curve.suggested is None
    assert not penalty_curve(factorise(source), 3 * source**2 + 50).is_affine


@given(landmark_pairs(least=6), st.sampled_from([1e-3, 25.4]), st.floats(0, 2))
def test_standardised_errors_have_no_unit(pairs, factor, share):
    source, destination = pairs
    penalty = share * extent(source)
    plain = leave_one_out(factorise(source), destination, penalty)
    scaled = leave_one_out(factorise(source * factor), destination * factor, penalty * factor)
    assert np.allclose(scaled.standardised, plain.standardised, rtol=1e-6)
    assert np.allclose(scaled.expected, plain.expected, rtol=1e-6)
    assert np.median(plain.standardised) == pytest.approx(1)


@given(landmark_pairs(least=6))
def test_a_curve_has_the_figures_of_each_single_solve(pairs):
    source, destination = pairs
    factor = factorise(source)
    shares = np.array([0.0, 0.3, 0.01, np.inf])
    curve = penalty_curve(factor, destination, shares * extent(source))
    assert (np.diff(curve.penalties) > 0).all()
    size = extent(destination)
    for k, penalty in enumerate(curve.penalties):
        residual = solve(factor, destination, penalty).evaluate(source) - destination
        alone = leave_one_out(factor, destination, penalty)
        assert curve.residual[k] == pytest.approx(rms(residual), rel=1e-8, abs=1e-11 * size)
        assert curve.leave_one_out[k] == pytest.approx(alone.rms, rel=1e-8, abs=1e-11 * size)
        assert curve.flexibility[k] == pytest.approx(factor.flexibility(penalty))


@given(landmark_pairs(least=6), st.floats(0, 1))
def test_between_its_penalties_a_curve_runs_close_to_the_figures(pairs, flexibility):
    source, destination = pairs
    factor = factorise(source)
    curve = penalty_curve(factor, destination)
    there = penalty_curve(factor, destination, [factor.penalty_at(flexibility)])
    left_out, residual = curve.at(flexibility)
    # As far as a line of a pixel's width can show it.
    assert abs(left_out - there.leave_one_out[0]) < 0.03 * curve.leave_one_out.max() + 1e-12
    assert abs(residual - there.residual[0]) < 0.03 * curve.residual.max() + 1e-12


def test_noise_asks_for_a_penalty_and_smoothness_for_none():
    rng = np.random.default_rng(2)
    source = rng.uniform(-1, 1, (150, 3))
    smooth = source + 0.3 * np.sin(3 * source[:, [1, 2, 0]])
    noisy = smooth + 0.1 * rng.normal(size=source.shape)
    factor = factorise(source)
    curve = penalty_curve(factor, noisy)
    best = int(curve.leave_one_out.argmin())
    assert len(curve.penalties) == 62
    assert curve.penalties[[0, -1]].tolist() == [0, np.inf]
    assert 0 < best < 61
    assert curve.suggested == curve.penalties[best]
    assert penalty_curve(factor, smooth).suggested is None
    probes = rng.uniform(-1, 1, (500, 3))
    truth = probes + 0.3 * np.sin(3 * probes[:, [1, 2, 0]])
    errors = [
        rms(solve(factor, noisy, penalty).evaluate(probes) - truth)
        for penalty in (0.0, curve.suggested)
    ]
    assert errors[1] < errors[0]


def noisy_pairs(count):
    rng = np.random.default_rng(2)
    source = rng.uniform(-1, 1, (count, 3))
    bent = source + 0.3 * np.sin(3 * source[:, [1, 2, 0]])
    return source, bent + 0.15 * rng.normal(size=source.shape)


@pytest.mark.parametrize("count", [80, 300])
def test_penalties_that_chance_cannot_tell_from_the_suggested_one_lie_around_it(count):
    source, noisy = noisy_pairs(count)
    factor = factorise(source)
    curve = penalty_curve(factor, noisy)
    low, high = curve.as_good
    assert low < curve.suggested < high
    best = np.sum(leave_one_out(factor, noisy, curve.suggested).errors ** 2, axis=1)
    for penalty in curve.penalties:
        more = np.sum(leave_one_out(factor, noisy, penalty).errors ** 2, axis=1) - best
        by_chance = more.mean() <= more.std(ddof=1) / np.sqrt(count)
        assert by_chance == (low <= penalty <= high)


def test_more_pairs_tell_penalties_apart_better():
    few, many = (penalty_curve(factorise(a), b).as_good for a, b in map(noisy_pairs, (80, 300)))
    assert many[1] / many[0] < few[1] / max(few[0], 1e-9)


def test_bending_energy_is_the_quadratic_form_of_the_data():
    rng = np.random.default_rng(3)
    source, destination = rng.normal(size=(10, 3)), rng.normal(size=(10, 3))
    spline = solve(factorise(source), destination)
    # At penalty 0 the energy equals y^T G y, the data's own.
    assert np.allclose(bending_energy(spline), -np.sum(spline.weights * destination, axis=0))
    flatter = bending_energy(solve(factorise(source), destination, 0.5))
    assert (flatter < bending_energy(spline)).all()
    assert bending_energy(solve(factorise(source), destination, np.inf)).tolist() == [0, 0, 0]
    assert bending_energy(identity()).tolist() == [0, 0, 0]


# The real femur


def test_the_femur_has_the_documented_figures(shared_data):
    names, source, destination = femur_landmarks(shared_data)
    result = leave_one_out(factorise(source), destination)
    assert result.rms == pytest.approx(11.1, abs=0.05)
    assert names[int(result.distances.argmax())] == "landmark_18"
    assert result.distances.max() == pytest.approx(26, abs=0.2)
    figures = dict(zip(names, result.standardised, strict=True))
    assert figures["landmark_9"] == pytest.approx(3.5, abs=0.05)
    assert figures["landmark_3"] == pytest.approx(2.8, abs=0.05)
    assert figures["landmark_18"] == pytest.approx(1.8, abs=0.05)
    assert result.expected[names.index("landmark_18")] == pytest.approx(1.9, abs=0.05)
    curve = penalty_curve(factorise(source), destination, [0.0, np.inf])
    assert curve.residual == pytest.approx([0, 10.96], abs=0.005)
