from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import RBFInterpolator
from scipy.spatial.distance import cdist
from tests.core.strategies import landmark_pairs

from pinwarp.core import spline
from pinwarp.core.conditions import (
    Conditions,
    across,
    factorise_conditions,
    held,
    held_across,
    held_along,
)
from pinwarp.core.errors import LandmarkError, PenaltyError
from pinwarp.core.quality import bending_energy, leave_one_out
from pinwarp.core.spline import factorise, solve


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


@st.composite
def sliding_pairs(draw):
    """Source, destination, rows of landmarks, of points on lines and their tangents, on planes."""
    source, destination = draw(landmark_pairs(least=14, most=40))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    lines = draw(st.integers(0, 5))
    rows = rng.permutation(len(source))
    landmarks, curve, surface = np.split(rows, [6, 6 + lines])
    return (
        source,
        destination,
        landmarks,
        (curve, unit(rng.normal(size=(len(curve), 3)))),
        (surface, unit(rng.normal(size=(len(surface), 3)))),
    )


def conditions_of(landmarks, curve, surface):
    return Conditions.joined([held(landmarks), held_across(*curve), held_along(*surface)])


def gunz(source, destination, curve, surface):
    """Generalised least squares over the tangent coordinates, dense and to the letter.

    Gunz, Mitteroecker and Bookstein 2005: L^-1 of the bordered matrix, one block for each axis.
    In long doubles by two turns of refinement, since it is the oracle.
    """
    n = len(source)
    x = (source - source.mean(axis=0)) / np.ptp(source)
    P = np.column_stack([np.ones(n), x])
    L = np.block([[-cdist(x, x), P], [P.T, np.zeros((4, 4))]])
    B = np.linalg.inv(L)[:n, :n]
    t1, t2 = across(surface[1])
    rows = np.concatenate([curve[0], surface[0], surface[0]])
    tangents = np.vstack([curve[1], t1, t2])
    U = np.zeros((3 * n, len(rows)))
    for k in range(3):
        U[rows + k * n, np.arange(len(rows))] = tangents[:, k]
    B3 = np.kron(np.eye(3), B)
    y = (destination - destination.mean(axis=0)).T.ravel()
    for _ in range(2):
        y = y - U @ np.linalg.solve(U.T @ B3 @ U, U.T @ (B3 @ y))
    return y.reshape(3, n).T + destination.mean(axis=0)


@given(sliding_pairs())
def test_one_slide_is_that_of_dense_generalised_least_squares(case):
    source, destination, landmarks, curve, surface = case
    spline = factorise_conditions(source, conditions_of(landmarks, curve, surface)).solve(
        destination
    )
    expected = gunz(source, destination, curve, surface)
    # Points held by random planes can be all but free to slide: far-away places are less exact.
    size = max(np.ptp(destination), np.ptp(expected))
    error = np.abs(spline.evaluate(source) - expected).max() / size
    assert error < 1e-12 * condition_of(case)


@pytest.mark.parametrize("seed", range(6))
def test_one_slide_of_a_bone_sized_set_is_that_of_gunz_to_the_last_digits(seed):
    rng = np.random.default_rng(seed)
    source = rng.normal(size=(87, 3)) * [40, 30, 80] + [500, -200, 900]
    bent = source + 0.001 * (source - source.mean(axis=0)) ** 2 @ rng.normal(size=(3, 3))
    bent += 2 * rng.normal(size=source.shape)
    landmarks, curve, surface = np.split(np.arange(87), [12, 27])
    curve, surface = ((rows, unit(rng.normal(size=(len(rows), 3)))) for rows in (curve, surface))
    spline = factorise_conditions(source, conditions_of(landmarks, curve, surface)).solve(bent)
    expected = gunz(source, bent, curve, surface)
    assert np.abs(spline.evaluate(source) - expected).max() <= 1e-12 * np.ptp(bent)


def condition_of(case):
    """How much the slid places magnify rounding, from 1 on."""
    source, _, landmarks, curve, surface = case
    factor = factorise_conditions(source, conditions_of(landmarks, curve, surface))
    upper = np.linalg.svd(factor.reflections.upper, compute_uv=False)
    values = np.linalg.eigvalsh(factor.projected[12:, 12:])
    return max(1.0, 0.01 * upper[0] / upper[-1]) * max(1.0, 1e-2 * values[-1] / values[0])


@given(landmark_pairs(), st.sampled_from([0.0, 1e-3, 0.3, 50.0]))
def test_landmarks_alone_are_the_ordinary_spline(pairs, share):
    source, destination = pairs
    penalty = share * float(np.ptp(source))
    expected = solve(factorise(source), destination, penalty)
    found = factorise_conditions(source, held(np.arange(len(source)))).solve(destination, penalty)
    places = np.vstack([source, source + np.ptp(source, axis=0)])
    error = np.abs(found.evaluate(places) - expected.evaluate(places)).max()
    assert error < 1e-12 * 30 * np.abs(expected.evaluate(places)).max()


@given(landmark_pairs(), st.sampled_from([0.0, 0.01, 1.0]))
def test_equal_penalties_are_those_of_scipy(pairs, share):
    source, destination = pairs
    size = float(np.ptp(source))
    centre = source.mean(axis=0)
    expected = RBFInterpolator(
        (source - centre) / size, destination, kernel="linear", degree=1, smoothing=share
    )
    found = factorise_conditions(source, held(np.arange(len(source)))).solve(
        destination, np.full(3 * len(source), share * size)
    )
    extent = np.abs(destination).max()
    assert (
        np.abs(found.evaluate(source) - expected((source - centre) / size)).max() < 1e-11 * extent
    )


@given(sliding_pairs())
def test_the_result_is_an_ordinary_spline_of_its_own_pairs(case):
    source, destination, *held_how = case
    spline = factorise_conditions(source, conditions_of(*held_how)).solve(destination, 0.0)
    again = solve(factorise(source), spline.evaluate(source))
    # Side conditions: the bending part knows nothing of affine maps.
    size = np.abs(spline.weights).sum()
    assert np.abs(spline.weights.sum(axis=0)).max() <= 1e-11 * size
    places = source + 0.1 * np.ptp(source, axis=0)
    extent = np.abs(spline.evaluate(np.vstack([source, places]))).max()
    assert np.abs(again.evaluate(places) - spline.evaluate(places)).max() < 1e-9 * extent


@given(sliding_pairs())
def test_no_tangent_lowers_the_energy_any_further(case):
    source, destination, landmarks, curve, surface = case
    spline = factorise_conditions(source, conditions_of(landmarks, curve, surface)).solve(
        destination
    )
    unslid = solve(factorise(source), destination)
    # The gradient of the energy with respect to the places is -2 w.
    t1, t2 = across(surface[1])
    for rows, tangents in ((curve[0], curve[1]), (surface[0], t1), (surface[0], t2)):
        start = np.abs(unslid.weights).max()
        along = np.sum(spline.weights[rows] * tangents, axis=1)
        assert np.abs(along).max(initial=0) <= 1e-10 * max(start, np.abs(spline.weights).max())


@given(sliding_pairs(), st.floats(0.01, 10.0))
def test_the_answer_does_not_depend_on_frame_or_unit(case, scale):
    source, destination, landmarks, curve, surface = case
    turn, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    shift = np.array([5.0, -7.0, 2.0]) * np.ptp(destination)
    expected = factorise_conditions(source, conditions_of(landmarks, curve, surface)).solve(
        destination, 0.05 * np.ptp(source)
    )
    turned = conditions_of(landmarks, (curve[0], curve[1] @ turn), (surface[0], surface[1] @ turn))
    moved = factorise_conditions(scale * source, turned).solve(
        scale * destination @ turn + shift, 0.05 * np.ptp(scale * source)
    )
    found = (moved.evaluate(scale * source) - shift) @ turn.T / scale
    extent = np.abs(moved.evaluate(scale * source)).max() / scale
    assert np.abs(found - expected.evaluate(source)).max() < 1e-9 * extent


@given(sliding_pairs())
def test_a_condition_with_a_large_penalty_is_as_good_as_left_out(case):
    source, destination, landmarks, curve, surface = case
    conditions = conditions_of(landmarks, curve, surface)
    soft = np.isin(conditions.rows, surface[0])
    spline = factorise_conditions(source, conditions).solve(
        destination, np.where(soft, 1e7 * np.ptp(source), 0.0)
    )
    without = Conditions.joined([held(landmarks), held_across(*curve)])
    expected = factorise_conditions(source, without).solve(destination)
    extent = np.abs(expected.evaluate(source)).max()
    assert np.abs(spline.evaluate(source) - expected.evaluate(source)).max() < 1e-4 * extent


@settings(max_examples=20)
@given(sliding_pairs(), st.sampled_from([0.0, 0.02]))
def test_left_out_landmarks_miss_by_what_leaving_them_out_says(case, share):
    source, destination, landmarks, curve, surface = case
    conditions = conditions_of(landmarks, curve, surface)
    penalty = share * np.ptp(source)
    errors = factorise_conditions(source, conditions).leave_one_out(destination, landmarks, penalty)
    for row, error in zip(landmarks, errors, strict=True):
        kept = conditions.rows != row
        rest = Conditions(conditions.rows[kept], conditions.directions[kept])
        warp = factorise_conditions(source, rest).solve(destination, penalty)
        missed = destination[row] - warp.evaluate(source[row : row + 1])[0]
        assert np.abs(error - missed).max() < 1e-7 * np.ptp(destination)


@given(landmark_pairs(least=6), st.sampled_from([0.0, 0.1]))
def test_landmarks_alone_are_left_out_as_ever(pairs, share):
    source, destination = pairs
    penalty = share * np.ptp(source)
    expected = leave_one_out(factorise(source), destination, penalty)
    rows = np.arange(len(source))
    errors = factorise_conditions(source, held(rows)).leave_one_out(destination, rows, penalty)
    extent = max(np.abs(expected.errors).max(), np.abs(destination).max())
    assert np.abs(errors - expected.errors).max() < 1e-9 * extent


def test_a_point_that_slides_has_no_leave_one_out_error():
    source = np.random.default_rng(0).normal(size=(8, 3))
    conditions = Conditions.joined([held(np.arange(7)), held_along([7], [[0, 0, 1]])])
    with pytest.raises(LandmarkError, match="held wholly"):
        factorise_conditions(source, conditions).leave_one_out(source, [7])


def test_two_landmarks_at_one_place_are_met_on_average_as_by_the_ordinary_solver():
    rng = np.random.default_rng(0)
    source, destination = rng.normal(size=(2, 9, 3))
    source[8] = source[3]
    expected = solve(factorise(source), destination)
    found = factorise_conditions(source, held(np.arange(9))).solve(destination)
    np.testing.assert_allclose(found.evaluate(source), expected.evaluate(source), atol=1e-9)


@pytest.mark.parametrize(
    ("source", "conditions", "words"),
    [
        (np.eye(3), held([0, 1, 2]), "fewer than the 12"),
        (np.random.default_rng(0).normal(size=(9, 3)) * [1, 1, 0], held(range(9)), "in one plane"),
        (np.zeros((5, 3)), held(range(5)), "in one plane"),
        (np.eye(4)[:, :3], Conditions.joined([held(range(4)), held([4])]), "does not exist"),
        (
            np.eye(5)[:, :3],
            Conditions.joined([held(range(4)), held_along([4], [[0, 0, 2]])]),
            "unit",
        ),
        (np.full((5, 3), np.nan), held(range(5)), "not usable"),
    ],
)
def test_what_determines_no_warp_is_refused_in_words(source, conditions, words):
    with pytest.raises(LandmarkError, match=words):
        factorise_conditions(source, conditions)


@pytest.mark.parametrize("penalty", [-1.0, np.nan, np.inf])
def test_a_penalty_that_is_no_length_is_refused(penalty):
    source = np.random.default_rng(0).normal(size=(5, 3))
    factor = factorise_conditions(source, held(range(5)))
    with pytest.raises(PenaltyError, match="0 or more"):
        factor.solve(source, penalty)


def test_the_energy_of_a_soft_solve_is_no_larger_than_that_of_a_strict_one():
    rng = np.random.default_rng(1)
    source, destination = rng.normal(size=(2, 20, 3))
    factor = factorise_conditions(source, held(range(20)))
    energies = [bending_energy(factor.solve(destination, s)).sum() for s in (0.0, 0.1, 1.0, 10.0)]
    assert energies == sorted(energies, reverse=True)


def test_a_worker_solves_the_same_once_and_again(monkeypatch):
    rng = np.random.default_rng(1)
    source, destination = rng.normal(size=(2, 20, 3))
    expected = factorise_conditions(source, held(range(20))).solve(destination)
    # As with some thousand conditions, where LAPACK may not keep the interpreter's lock.
    monkeypatch.setattr(spline, "HOLDS_UP_LITTLE", 0)
    factor = factorise_conditions(source, held(range(20)))
    with ThreadPoolExecutor(1) as worker:
        once = worker.submit(factor.solve, destination).result()
        assert not factor.is_prepared
        assert worker.submit(lambda: factor.lower).result() is not None
        again = worker.submit(factor.solve, destination).result()
    for warp in (once, again):
        np.testing.assert_allclose(warp.weights, expected.weights, atol=1e-11)
