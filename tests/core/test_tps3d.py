from __future__ import annotations

import csv
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import tps
from hypothesis import assume, example, given
from hypothesis import strategies as st
from scipy.interpolate import RBFInterpolator
from tests.core.strategies import landmark_pairs, rotations

from pinwarp.core.errors import (
    ConflictingLandmarksWarning,
    LandmarkError,
    NearlyPlanarWarning,
    PenaltyError,
    PoleWarning,
    SingularSystemError,
)
from pinwarp.core.factor import factorise
from pinwarp.tps3d import PenaltyConvention, TPSCoefficients3D, solve_coefficients

OPYNSIM = PenaltyConvention.OPYNSIM
pytestmark = pytest.mark.filterwarnings("ignore::pinwarp.core.errors.NearlyPlanarWarning")


def diagonal(points):
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def rms(residual):
    return float(np.sqrt(np.mean(np.sum(residual**2, axis=1))))


def probes(source, count=40):
    low, high = source.min(axis=0), source.max(axis=0)
    return np.random.default_rng(1).uniform(
        low - 0.3 * (high - low), high + 0.3 * (high - low), (count, 3)
    )


def affine_fit(source, destination):
    P = np.column_stack([np.ones(len(source)), source - source.mean(axis=0)])
    return P @ np.linalg.lstsq(P, destination, rcond=None)[0]


@given(landmark_pairs(least=4))
def test_penalty_zero_meets_every_landmark(pairs):
    source, destination = pairs
    warp = solve_coefficients(source, destination)
    assert np.abs(warp.warp_points(source) - destination).max() <= 1e-9 * diagonal(destination)


@given(landmark_pairs(), st.integers(0, 1000), st.sampled_from([0.0, 0.01, 3.0, np.inf]))
def test_an_affine_map_is_reproduced_at_every_penalty(pairs, seed, share):
    source, _ = pairs
    A = np.eye(3) + 0.4 * np.random.default_rng(seed).normal(size=(3, 3))
    destination = source @ A + 3.0
    warp = solve_coefficients(source, destination, warping_penalty=share * diagonal(source))
    v = probes(source)
    assert np.abs(warp.warp_points(v) - (v @ A + 3.0)).max() <= 1e-8 * (diagonal(destination) + 3)


@given(landmark_pairs(), st.integers(0, 1000), st.floats(0, 1))
def test_the_warp_moves_and_turns_with_both_bones(pairs, seed, share):
    source, destination = pairs
    s = share * diagonal(source)
    R, S = rotations(seed), rotations(seed + 1)
    v = probes(source)
    plain = solve_coefficients(source, destination, warping_penalty=s).warp_points(v)
    shift = diagonal(source)
    turned = solve_coefficients(source @ R + shift, destination @ S - shift, warping_penalty=s)
    again = (turned.warp_points(v @ R + shift) + shift) @ S.T
    assert np.abs(again - plain).max() <= 1e-8 * diagonal(destination)


@given(landmark_pairs(), st.randoms(use_true_random=False), st.floats(0, 1))
def test_the_order_of_the_pairs_does_not_matter(pairs, random, share):
    source, destination = pairs
    order = list(range(len(source)))
    random.shuffle(order)
    s = share * diagonal(source)
    v = probes(source)
    plain = solve_coefficients(source, destination, warping_penalty=s).warp_points(v)
    other = solve_coefficients(source[order], destination[order], warping_penalty=s).warp_points(v)
    assert np.abs(other - plain).max() <= 1e-9 * diagonal(destination)


@given(landmark_pairs(), st.sampled_from([1e-3, 1e3, 25.4]), st.floats(0, 1))
def test_a_change_of_unit_changes_only_the_unit(pairs, factor, share):
    source, destination = pairs
    s = share * diagonal(source)
    v = probes(source)
    plain = solve_coefficients(source, destination, warping_penalty=s).warp_points(v)
    scaled = solve_coefficients(source * factor, destination * factor, warping_penalty=s * factor)
    assert np.abs(scaled.warp_points(v * factor) / factor - plain).max() <= 1e-9 * diagonal(
        destination
    )


@given(landmark_pairs(), st.lists(st.floats(-6, 4), min_size=2, max_size=5))
def test_the_residual_grows_with_the_penalty_up_to_the_affine_fit(pairs, exponents):
    source, destination = pairs
    limit = rms(affine_fit(source, destination) - destination)
    last = 0.0
    for exponent in sorted(exponents):
        warp = solve_coefficients(
            source, destination, warping_penalty=10.0**exponent * diagonal(source)
        )
        residual = rms(warp.warp_points(source) - destination)
        assert residual >= last - 1e-9 * diagonal(destination)
        assert residual <= limit + 1e-9 * diagonal(destination)
        last = residual


@given(landmark_pairs())
def test_an_infinite_penalty_is_the_affine_fit(pairs):
    source, destination = pairs
    warp = solve_coefficients(source, destination, warping_penalty=np.inf)
    expected = affine_fit(source, destination)
    assert np.abs(warp.warp_points(source) - expected).max() <= 1e-9 * diagonal(destination)
    assert not warp.weights.any()


@given(landmark_pairs(), st.floats(0, 2))
def test_scipy_agrees_with_the_regularising_penalty(pairs, share):
    source, destination = pairs
    s = share * diagonal(source)
    v = probes(source)
    ours = solve_coefficients(source, destination, warping_penalty=s).warp_points(v)
    theirs = RBFInterpolator(source, destination, kernel="linear", degree=1, smoothing=s)(v)
    assert np.abs(ours - theirs).max() <= 1e-9 * diagonal(np.vstack([destination, theirs]))


@given(landmark_pairs(), st.floats(0, 2), st.sampled_from([1, -1]))
def test_the_thin_plate_spline_package_agrees_with_both_conventions(pairs, share, sign):
    source, destination = pairs
    # Its bordered system loses digits far from the origin and the unit scale: give it an easy one.
    size = diagonal(source)
    source, destination = (source - source.mean(axis=0)) / size, destination / size
    convention = OPYNSIM if sign > 0 else PenaltyConvention.REGULARISING
    poles = factorise(source).poles
    assume(sign < 0 or np.min(np.abs(poles - share)) > 1e-3 * poles[-1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PoleWarning)
        ours = solve_coefficients(source, destination, warping_penalty=share, convention=convention)
    theirs = tps.ThinPlateSpline(alpha=sign * share).fit(source, destination)
    v = probes(source)
    expected = theirs.transform(v)
    scale = max(diagonal(destination), float(np.abs(expected).max()))
    assert np.abs(ours.warp_points(v) - expected).max() <= 1e-9 * scale


def test_weights_belong_to_the_plus_sign_of_the_documented_equation():
    rng = np.random.default_rng(4)
    source, destination = rng.normal(size=(9, 3)), rng.normal(size=(9, 3))
    warp = solve_coefficients(source, destination, warping_penalty=0.3)
    v = np.array([0.2, -0.4, 1.0])
    distances = np.linalg.norm(source - v, axis=1)
    by_hand = warp.a1 + warp.a2 * v[0] + warp.a3 * v[1] + warp.a4 * v[2] + distances @ warp.weights
    assert np.allclose(warp.warp_point(v), by_hand, atol=1e-12)
    assert np.allclose(warp.weights.sum(axis=0), 0, atol=1e-12)


# Degenerate input


def test_one_pair_translates():
    warp = solve_coefficients([[1, 2, 3]], [[2, 2, 5]])
    assert np.allclose(warp.warp_points([[0, 0, 0], [9, 9, 9]]), [[1, 0, 2], [10, 9, 11]])


@pytest.mark.parametrize("count", [2, 3])
def test_two_or_three_pairs_make_a_similarity(count):
    rng = np.random.default_rng(count)
    source = rng.normal(size=(count, 3))
    R = rotations(3)
    warp = solve_coefficients(source, 2.5 * source @ R + 7.0)
    linear = np.array([warp.a2, warp.a3, warp.a4])
    assert np.allclose(linear @ linear.T, 2.5**2 * np.eye(3), atol=1e-9)
    assert np.linalg.det(linear) > 0
    assert np.allclose(warp.warp_points(source), 2.5 * source @ R + 7.0)


@pytest.mark.parametrize("dimensions", [1, 2])
@pytest.mark.parametrize("penalty", [0.0, 0.5, np.inf])
def test_collinear_and_coplanar_pairs_do_not_flatten_a_mesh(dimensions, penalty):
    rng = np.random.default_rng(dimensions)
    source = np.zeros((9, 3))
    source[:, :dimensions] = rng.uniform(-1, 1, (9, dimensions))
    R = rotations(5)
    destination = (source + 0.01 * rng.normal(size=source.shape)) @ R + 100.0
    warp = solve_coefficients(source @ rotations(6) + 50.0, destination, warping_penalty=penalty)
    stretches = np.linalg.svd([warp.a2, warp.a3, warp.a4])[1]
    assert stretches.min() > 0.9
    assert stretches.max() < 1.1


def test_coplanar_pairs_are_met_at_penalty_zero():
    rng = np.random.default_rng(2)
    source = np.column_stack([rng.normal(size=(8, 2)), np.zeros(8)])
    destination = rng.normal(size=(8, 3))
    warp = solve_coefficients(source, destination)
    assert np.allclose(warp.warp_points(source), destination, atol=1e-9)


def test_nearly_planar_landmarks_are_warned_about():
    rng = np.random.default_rng(2)
    source = rng.normal(size=(8, 3)) * [1, 1, 0.01]
    with pytest.warns(NearlyPlanarWarning, match="nearly in one plane"):
        solve_coefficients(source, source)


def test_treating_nearly_planar_landmarks_as_planar_keeps_the_warp_tame_far_away():
    rng = np.random.default_rng(2)
    source = rng.normal(size=(8, 3)) * [1, 1, 0.01]
    destination = source + 0.1 * rng.normal(size=(8, 3))
    from pinwarp.core.spline import solve

    far = np.array([[0, 0, 1.0]])
    wild = solve(factorise(source), destination).evaluate(far)
    tame = solve(factorise(source, planar=True), destination).evaluate(far)
    assert np.linalg.norm(wild - far) > 2.0
    assert np.linalg.norm(tame - far) < 0.5


def test_duplicates_that_agree_are_as_good_as_one():
    rng = np.random.default_rng(8)
    source, destination = rng.normal(size=(7, 3)), rng.normal(size=(7, 3))
    twice = solve_coefficients(
        np.vstack([source, source[2]]), np.vstack([destination, destination[2]])
    )
    once = solve_coefficients(source, destination)
    v = probes(source)
    assert np.allclose(twice.warp_points(v), once.warp_points(v), atol=1e-9)


def test_duplicates_in_conflict_are_named_and_met_half_way():
    rng = np.random.default_rng(8)
    source, destination = rng.normal(size=(7, 3)), rng.normal(size=(7, 3))
    other = destination[2] + [0.5, 0, 0]
    with pytest.warns(
        ConflictingLandmarksWarning, match=r"landmark 2 and landmark 7 .* 0\.5 apart"
    ):
        warp = solve_coefficients(np.vstack([source, source[2]]), np.vstack([destination, other]))
    assert np.allclose(warp.warp_point(source[2]), destination[2] + [0.25, 0, 0], atol=1e-9)
    assert np.allclose(
        warp.warp_points(source)[[0, 1, 3, 4, 5, 6]], destination[[0, 1, 3, 4, 5, 6]]
    )


def test_duplicates_are_no_conflict_where_a_penalty_meets_no_landmark_anyway():
    rng = np.random.default_rng(8)
    source, destination = rng.normal(size=(7, 3)), rng.normal(size=(7, 3))
    source = np.vstack([source, source[2]])
    destination = np.vstack([destination, destination[2] + [0.5, 0, 0]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solve_coefficients(source, destination, warping_penalty=0.1)


def test_landmarks_almost_on_top_of_each_other_are_named():
    rng = np.random.default_rng(8)
    source = rng.normal(size=(7, 3))
    near = source[2] + [1e-7, 0, 0]
    with pytest.warns(
        ConflictingLandmarksWarning, match="landmark 2 and landmark 7 are only 1e-07"
    ):
        solve_coefficients(np.vstack([source, near]), np.vstack([source, near]))


def test_all_pairs_at_one_place_translate():
    with pytest.warns(ConflictingLandmarksWarning):
        warp = solve_coefficients([[1, 1, 1]] * 3, [[2, 2, 2], [4, 4, 4], [3, 3, 3]])
    assert np.allclose(warp.warp_point([0, 0, 0]), [2, 2, 2])


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e200])
@pytest.mark.parametrize("side", [0, 1])
def test_a_landmark_that_cannot_be_used_is_named_by_its_row(bad, side):
    rng = np.random.default_rng(0)
    pairs = [rng.normal(size=(5, 3)), rng.normal(size=(5, 3))]
    pairs[side][3, 1] = bad
    with pytest.raises(LandmarkError, match="in row 3"):
        solve_coefficients(*pairs)


def test_bad_shapes_and_counts_are_refused_in_words():
    with pytest.raises(LandmarkError, match="at least one"):
        solve_coefficients(np.zeros((0, 3)), np.zeros((0, 3)))
    with pytest.raises(LandmarkError, match="2 source landmarks but 1 destination"):
        solve_coefficients([[0, 0, 0], [1, 1, 1]], [[0, 0, 0]])
    with pytest.raises(LandmarkError, match="shape"):
        solve_coefficients([[0, 0], [1, 1]], [[0, 0], [1, 1]])
    with pytest.raises(LandmarkError, match="not a table of numbers"):
        solve_coefficients([["a", 0, 0]], [[0, 0, 0]])


@pytest.mark.parametrize("penalty", [-1.0, np.nan])
def test_a_negative_penalty_is_refused(penalty):
    with pytest.raises(PenaltyError, match="0 or more"):
        solve_coefficients([[0, 0, 0]], [[0, 0, 0]], warping_penalty=penalty)


def test_points_that_are_not_finite_do_not_get_in_or_out():
    warp = solve_coefficients([[0, 0, 0]], [[1, 1, 1]])
    with pytest.raises(LandmarkError, match="row 1"):
        warp.warp_points([[0, 0, 0], [np.nan, 0, 0]])
    with pytest.raises(LandmarkError, match="shape"):
        warp.warp_point([0, 0])


@example(count=5, seed=234, spread=1, penalty=0.0)
@example(count=2, seed=0, spread=0, penalty=2.2e-313)
@given(
    count=st.integers(1, 12),
    seed=st.integers(0, 10**6),
    spread=st.integers(0, 2),
    penalty=st.floats(0, 10),
)
def test_whatever_the_integers_nothing_non_finite_gets_out(count, seed, spread, penalty):
    rng = np.random.default_rng(seed)
    source = rng.integers(-spread, spread + 1, (count, 3))
    destination = rng.integers(-3, 4, (count, 3))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warp = solve_coefficients(source, destination, warping_penalty=penalty)
    assert np.isfinite(warp.warp_points(rng.normal(size=(20, 3)) * 5)).all()
    assert np.abs(warp.warp_points(source)).max() < 1e3


def test_a_worker_solves_the_same_as_the_main_thread(monkeypatch):
    monkeypatch.setattr("pinwarp.core.spline.HOLDS_UP_LITTLE", 0)
    rng = np.random.default_rng(3)
    source, destination = rng.normal(size=(30, 3)), rng.normal(size=(30, 3))
    with ThreadPoolExecutor(1) as pool:
        worked = pool.submit(solve_coefficients, source, destination, warping_penalty=0.1).result()
    here = solve_coefficients(source, destination, warping_penalty=0.1)
    assert np.allclose(worked.weights, here.weights, atol=1e-12)


# The OPYNSIM convention


def test_opynsim_warns_near_its_poles_and_names_the_nearest():
    rng = np.random.default_rng(1)
    source = rng.normal(size=(10, 3))
    pole = factorise(source).poles[0]
    with pytest.warns(PoleWarning, match=f"{pole:.4g}"):
        solve_coefficients(source, source, warping_penalty=0.5 * pole, convention=OPYNSIM)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solve_coefficients(source, source, warping_penalty=0.05 * pole, convention=OPYNSIM)


def test_opynsim_on_a_pole_is_refused():
    rng = np.random.default_rng(1)
    source = rng.normal(size=(10, 3))
    pole = float(factorise(source).poles[2])
    with pytest.raises(SingularSystemError, match="pole"):
        solve_coefficients(source, source, warping_penalty=pole, convention=OPYNSIM)


# The coefficients as an object


def test_coefficients_compare_by_value_and_cannot_be_changed():
    source = np.random.default_rng(0).normal(size=(6, 3))
    warp = solve_coefficients(source, source + 1)
    assert warp == solve_coefficients(source.tolist(), (source + 1).tolist())
    assert warp != solve_coefficients(source, source + 2)
    assert warp != 3
    with pytest.raises(AttributeError):
        warp.a1 = np.zeros(3)
    with pytest.raises(ValueError, match="read-only"):
        warp.weights[0] = 0


def test_the_repr_shows_the_affine_coefficients():
    text = repr(solve_coefficients([[0, 0, 0]], [[1, 2, 3]]))
    assert all(f"{name} = [" in text for name in ("a1", "a2", "a3", "a4"))


def test_integer_arrays_and_lists_are_accepted():
    source = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    warp = solve_coefficients(source, (2 * source).tolist())
    assert isinstance(warp, TPSCoefficients3D)
    assert warp.warp_point((1, 1, 1)).tolist() == pytest.approx([2, 2, 2])


# The real femur


def read_side(path):
    with path.open() as file:
        return {row[0]: [float(x) for x in row[1:4]] for row in list(csv.reader(file))[1:] if row}


@pytest.fixture
def femur(shared_data):
    folder = shared_data / "opensim-creator-femur"
    source = read_side(folder / "femur_r_warp.landmarks.csv")
    destination = read_side(folder / "subject_femur_r.landmarks.csv")
    names = sorted(source)
    return np.array([source[n] for n in names]), np.array([destination[n] for n in names])


@pytest.mark.parametrize(
    ("convention", "penalty", "expected"),
    [
        ("regularising", 0.001, 0.390),
        ("regularising", 0.01, 2.40),
        ("regularising", 0.1, 6.74),
        ("regularising", 1, 10.07),
        ("regularising", np.inf, 10.96),
        ("opynsim", 0.001, 0.469),
        ("opynsim", 0.01, 17.45),
        ("opynsim", 0.1, 37.26),
        ("opynsim", 1, 12.24),
        ("opynsim", 100, 10.97),
    ],
)
@pytest.mark.filterwarnings("ignore::pinwarp.core.errors.PoleWarning")
def test_the_femur_table_of_the_documentation_is_true(femur, convention, penalty, expected):
    source, destination = femur
    warp = solve_coefficients(
        source, destination, warping_penalty=penalty, convention=PenaltyConvention(convention)
    )
    residual = rms(warp.warp_points(source) - destination) * 1000
    assert residual == pytest.approx(expected, rel=2e-3, abs=5e-4)


def test_the_poles_of_the_femur_are_the_documented_ones(femur):
    poles = factorise(femur[0]).poles
    assert poles[0] == pytest.approx(0.0083, abs=5e-5)
    assert poles[-1] == pytest.approx(0.213, abs=5e-4)
