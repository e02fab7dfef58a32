"""The basis r^2 log r: everything that knows the kernel, against systems solved densely."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import cdist
from tests.core.amplitudes import sigma_of
from tests.core.strategies import landmark_pairs
from tests.core.test_tps3d import affine_fit, diagonal, probes, rms

from pinwarp.core import kernel
from pinwarp.core.basis import Basis
from pinwarp.core.components import Components, applied
from pinwarp.core.errors import ConflictingLandmarksWarning, PenaltyError, PinwarpError
from pinwarp.core.factor import factorise
from pinwarp.core.folds import folds_of
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.live import Influence, PenaltySweep, PreviewPoints, preview
from pinwarp.core.mesh import Mesh
from pinwarp.core.prediction import inverse_warp, prediction_of
from pinwarp.core.quality import bending_energy, leave_one_out, penalty_curve
from pinwarp.core.spline import PenaltyConvention, solve
from pinwarp.core.suspects import suspects
from pinwarp.tps3d import solve_coefficients

LOG = Basis.R2_LOG_R
pytestmark = pytest.mark.filterwarnings("ignore::pinwarp.core.errors.NearlyPlanarWarning")


def bordered(source, penalty):
    """The published system K + alpha I with U = r^2 log r, as it is printed."""
    r = cdist(source, source)
    K = np.where(r > 0, r**2 * np.log(np.where(r > 0, r, 1.0)), 0.0)
    P = np.column_stack([np.ones(len(source)), source])
    return np.block([[K + penalty * np.eye(len(source)), P], [P.T, np.zeros((4, 4))]])


def some_pairs(count=14, seed=0):
    rng = np.random.default_rng(seed)
    source = rng.normal(size=(count, 3)) * [40, 30, 200] + 100
    return source, source + 5 * np.sin(source / 40) + rng.normal(size=(count, 3))


def solved(source, destination, penalty=0.0):
    factor = factorise(source, basis=LOG)
    return factor, solve(factor, destination, penalty)


@pytest.mark.parametrize("penalty", [0.0, 30.0])
def test_the_published_system_is_what_is_solved(penalty):
    source, destination = some_pairs()
    warp = solve_coefficients(source, destination, warping_penalty=penalty, basis="r^2 log r")
    right = np.vstack([destination, np.zeros((4, 3))])
    expected = np.linalg.solve(bordered(source, penalty), right)
    assert np.allclose(warp.weights, expected[:-4], rtol=0, atol=1e-9 * np.abs(expected).max())
    assert np.allclose([warp.a1, warp.a2, warp.a3, warp.a4], expected[-4:], atol=1e-8)
    assert np.allclose(warp.warp_point(source[3] + 1), warp.warp_points(source[3:4] + 1)[0])


@given(landmark_pairs(), st.lists(st.floats(-6, 4), min_size=2, max_size=5))
def test_the_published_penalty_regularises(pairs, exponents):
    source, destination = pairs
    limit = rms(affine_fit(source, destination) - destination)
    last = 0.0
    for exponent in sorted(exponents):
        penalty = 10.0**exponent * diagonal(source) ** 2
        warp = solve_coefficients(
            source,
            destination,
            warping_penalty=penalty,
            basis=LOG,
            convention=PenaltyConvention.OPYNSIM,
        )
        residual = rms(warp.warp_points(source) - destination)
        assert residual >= last - 1e-9 * diagonal(destination)
        assert residual <= limit + 1e-9 * diagonal(destination)
        last = residual
    assert warp.convention is PenaltyConvention.REGULARISING


@given(landmark_pairs())
def test_its_kernel_is_positive_where_that_of_r_is_negative(pairs):
    source, _ = pairs
    for basis in Basis:
        factor = factorise(source, basis=basis)
        assert factor.modes[0].min() > 0
        of_weights = factor.modes_at_landmarks
        K = basis.of(cdist(source, source))
        found = np.diag(of_weights.T @ K @ of_weights)
        assert np.allclose(basis.sign * found, factor.modes[0], atol=1e-7 * factor.stiffest_mode)


@given(landmark_pairs(), st.sampled_from([1e-3, 1e3, 25.4]), st.floats(0, 1))
def test_a_change_of_unit_changes_only_the_unit_if_the_penalty_is_an_area(pairs, factor, share):
    source, destination = pairs
    s = share * diagonal(source) ** 2
    v = probes(source)
    plain = solve_coefficients(source, destination, warping_penalty=s, basis=LOG)
    scaled = solve_coefficients(
        source * factor, destination * factor, warping_penalty=s * factor**2, basis=LOG
    )
    apart = scaled.warp_points(v * factor) / factor - plain.warp_points(v)
    assert np.abs(apart).max() <= 1e-8 * diagonal(destination)


@given(landmark_pairs(), st.floats(0, 1))
def test_an_affine_map_is_reproduced_and_the_affine_fit_is_the_same_in_both(pairs, share):
    source, destination = pairs
    A = np.eye(3) + 0.4 * np.random.default_rng(1).normal(size=(3, 3))
    warp = solve_coefficients(source, source @ A + 3, warping_penalty=share, basis=LOG)
    size = diagonal(source) + 3
    assert np.abs(warp.warp_points(probes(source)) - probes(source) @ A - 3).max() <= 1e-7 * size
    fits = [solve_coefficients(source, destination, warping_penalty=np.inf, basis=b) for b in Basis]
    assert np.array_equal(fits[0].warp_points(source), fits[1].warp_points(source))


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7])
def test_few_and_flat_landmarks_are_met_and_flatten_nothing(count):
    source, destination = some_pairs(count)
    if count == 7:
        source[:, 2] = 5
    for penalty in (0.0, 7.0):
        warp = solve_coefficients(source, destination, warping_penalty=penalty, basis=LOG)
        assert np.linalg.svd([warp.a2, warp.a3, warp.a4])[1].min() > 0.1
    met = solve_coefficients(source, destination, basis=LOG).warp_points(source)
    assert np.allclose(met, destination)


def test_landmarks_at_one_place_are_met_half_way():
    source, destination = some_pairs()
    source[5] = source[6]
    with pytest.warns(ConflictingLandmarksWarning):
        warp = solve_coefficients(source, destination, basis=LOG)
    assert np.allclose(warp.warp_point(source[5]), (destination[5] + destination[6]) / 2)
    others = np.delete(np.arange(14), [5, 6])
    assert np.allclose(warp.warp_points(source[others]), destination[others])


def test_compiled_and_plain_loops_agree(monkeypatch):
    source, destination = some_pairs()
    _, spline = solved(source, destination)
    v = np.vstack([probes(source, 300), source])
    plain = spline.evaluate(v), jacobians(spline, v)
    monkeypatch.setattr(kernel, "WORTH_COMPILING", 0)
    assert np.allclose(spline.evaluate(v), plain[0], rtol=0, atol=1e-9)
    assert np.allclose(jacobians(spline, v), plain[1], rtol=0, atol=1e-11)


def test_the_derivative_is_that_of_the_warp_even_at_a_landmark():
    source, destination = some_pairs()
    _, spline = solved(source, destination)
    v = np.vstack([probes(source, 20), source[:2]])
    step = 1e-4
    for axis in range(3):
        shift = step * np.eye(3)[axis]
        slope = (spline.evaluate(v + shift) - spline.evaluate(v - shift)) / (2 * step)
        assert np.allclose(jacobians(spline, v)[:, :, axis], slope, atol=1e-6)


@pytest.mark.parametrize("penalty", [0.0, 50.0])
def test_left_out_errors_are_those_of_solving_again(penalty):
    source, destination = some_pairs()
    found = leave_one_out(factorise(source, basis=LOG), destination, penalty).errors
    for row in (0, 4, 13):
        others = np.delete(np.arange(14), row)
        _, without = solved(source[others], destination[others], penalty)
        assert np.allclose(found[row], destination[row] - without.evaluate(source[[row]])[0])


@pytest.mark.parametrize("penalty", [0.0, 50.0])
def test_the_uncertainty_is_that_of_kriging_with_its_covariance(penalty):
    source, destination = some_pairs()
    factor = factorise(source, basis=LOG)
    M = bordered(source, penalty)
    inverse = np.linalg.inv(M)
    v = probes(source, 10)
    borders = np.hstack([LOG.of(cdist(v, source)), np.ones((10, 1)), v])
    variance = -np.einsum("mi,ij,mj->m", borders, inverse, borders)
    G = inverse[:14, :14]
    sigma = sigma_of(G, source, destination)
    found = prediction_of(factor, destination, penalty).standard_deviation(v)
    assert np.allclose(found, sigma * np.sqrt(variance), rtol=1e-6)


def test_bending_energy_and_flexibility_are_of_its_modes():
    source, destination = some_pairs()
    factor, spline = solved(source, destination)
    bent = factor.modes_at_landmarks.T @ destination
    assert np.allclose(bending_energy(spline), np.sum(bent**2 / factor.modes[0][:, None], axis=0))
    hat = np.array([solve(factor, np.tile(unit, (3, 1)).T, 80.0).evaluate(source)[:, 0]
                    for unit in np.eye(14)])  # fmt: skip
    assert np.trace(hat) == pytest.approx(4 + 10 * factor.flexibility(80.0))
    assert factor.flexibility(factor.penalty_at(0.4)) == pytest.approx(0.4)
    curve = penalty_curve(factor, destination)
    left_out = leave_one_out(factor, destination, curve.penalties[20])
    assert curve.leave_one_out[20] == pytest.approx(left_out.rms)


def test_the_screen_follows_penalty_and_hand():
    source, destination = some_pairs()
    factor, spline = solved(source, destination, 20.0)
    points = PreviewPoints.of(probes(source, 500))
    exact = spline.evaluate(points.local.astype(float) + points.centre)
    size = diagonal(destination)
    assert np.abs(preview(spline, points) - exact).max() < 1e-6 * size
    sweep = PenaltySweep(factor, destination, points)
    assert np.abs(sweep.at(20.0) - exact).max() < 1e-4 * size
    there = destination[3] + [4, -2, 1]
    moved = destination.copy()
    moved[3] = there
    followed = Influence(factor, spline, 3, destination[3], points).at(there)
    assert np.abs(followed - preview(solve(factor, moved, 20.0), points)).max() < 1e-5 * size


def test_the_way_back_and_parts_of_the_warp_keep_the_basis():
    source, destination = some_pairs()
    factor, spline = solved(source, destination)
    v = probes(source, 5)
    places, found = inverse_warp(spline, spline.evaluate(v))
    assert found.all()
    assert np.allclose(spline.evaluate(places), spline.evaluate(v), atol=1e-6)
    half = applied(spline, factor, destination, Components.FULL, 0.5)
    pose = applied(spline, factor, destination, Components.FULL, 0.0)
    mean = (spline.evaluate(v) + pose.evaluate(v)) / 2
    assert np.allclose(half.evaluate(v), mean)


def test_a_fold_names_the_landmarks_that_make_it():
    grid = np.stack(np.meshgrid(*[np.linspace(0, 4, 9)] * 3, indexing="ij"), -1).reshape(-1, 3)
    source = np.stack(np.meshgrid(*[[0.0, 2.0, 4.0]] * 3, indexing="ij"), -1).reshape(-1, 3)
    destination = source.copy()
    destination[13] += [3.5, 0, 0]
    _, spline = solved(source, destination)
    faces = [[i, i + 1, i + 9] for i in range(len(grid) - 9)]
    volumes = determinants(jacobians(spline, grid))
    folds = folds_of(volumes, Mesh(grid, faces), spline)
    assert folds.is_folded.any()
    assert 13 in folds.patches[0].landmarks


def test_mistakes_are_the_same_whatever_warps():
    source, destination = some_pairs(20)
    destination[[3, 9]] = destination[[9, 3]]
    by_r = suspects(factorise(source), destination)
    assert by_r
    assert suspects(factorise(source, basis=LOG), destination) == by_r


def test_planar_landmarks_and_another_basis_are_refused_in_words():
    with pytest.raises(PinwarpError, match="basis r only"):
        factorise(some_pairs()[0], planar=True, basis=LOG)
    with pytest.raises(PenaltyError, match="'cubic'; it must be 'r' or 'r2logr'"):
        solve_coefficients([[0, 0, 0]], [[0, 0, 0]], basis="cubic")
    with pytest.raises(PenaltyError, match="it must be"):
        solve_coefficients([[0, 0, 0]], [[0, 0, 0]], basis=None)
