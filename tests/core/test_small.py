"""Small work in one compiled pass: the same as the long way, said and refused alike."""

from __future__ import annotations

import subprocess
import sys
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.core.strategies import landmark_pairs

from pinwarp.core import small
from pinwarp.core.errors import LandmarkError, NearlyPlanarWarning, RangeError
from pinwarp.core.factor import factorise
from pinwarp.core.spline import PenaltyConvention, solve
from pinwarp.tps3d import solve_coefficients

REGULARISING = PenaltyConvention.REGULARISING
SOURCE = np.random.default_rng(0).normal(size=(12, 3))
DESTINATION = SOURCE + 0.2 * np.sin(3 * SOURCE)


@pytest.fixture(autouse=True, scope="module")
def compiled():
    small.warm_up()
    assert small.loops() is not None


@pytest.fixture
def not_compiled(monkeypatch):
    monkeypatch.setattr(small, "_loaded", [None])


def size_of(points):
    return float(np.linalg.norm(np.ptp(points, axis=0)))


@given(landmark_pairs(most=60), st.sampled_from([0.0, 1e-6, 0.1, 3.0]))
def test_one_pass_solves_what_the_long_way_solves(pairs, share):
    source, destination = pairs
    penalty = share * size_of(source)
    quick = small.solve_ordinary(source, destination, penalty, REGULARISING)
    thorough = solve(factorise(source), destination, penalty)
    if quick is None:
        return
    points = source.mean(axis=0) + 1.3 * (source - source.mean(axis=0))
    apart = np.abs(quick.evaluate(points) - thorough.evaluate(points)).max()
    assert apart <= 1e-10 * size_of(destination)
    assert np.abs(quick.weights - thorough.weights).max() <= 1e-8 * np.abs(thorough.weights).max()
    assert [x.kind for x in quick.findings] == [x.kind for x in thorough.findings]


@pytest.mark.parametrize("count", [5, 6, 10, 50, 200, small.MOST_PAIRS])
def test_ordinary_pairs_take_the_short_way(count):
    source = np.random.default_rng(count).normal(size=(count, 3))
    assert small.solve_ordinary(source, 2 * source, 0.0, REGULARISING) is not None


def test_nearly_planar_pairs_take_it_too_and_are_told():
    source = np.random.default_rng(3).normal(size=(20, 3)) * [1, 1, 0.02]
    quick = small.solve_ordinary(source, 2 * source, 0.0, REGULARISING)
    (finding,) = factorise(source).findings
    assert quick.findings[0].kind is finding.kind
    assert quick.findings[0].value == pytest.approx(finding.value)
    with pytest.warns(NearlyPlanarWarning):
        solve_coefficients(source, 2 * source)


def extraordinary():
    flat, line = SOURCE * [1, 1, 0], SOURCE * [1, 0, 0]
    near = np.vstack([SOURCE, SOURCE[:1] + 1e-7])
    missing, huge = SOURCE.copy(), SOURCE.copy()
    missing[3, 1], huge[3, 1] = np.nan, 1e200
    return {
        "planar": flat,
        "hardly space": SOURCE * [1, 1, 1e-4],
        "collinear": line,
        "one place": np.ones((12, 3)),
        "twice": np.vstack([SOURCE, SOURCE[:2]]),
        "close": near,
        "few": SOURCE[:4],
        "none": SOURCE[:0],
        "not finite": missing,
        "too large": huge,
        "next to nothing": 1e-300 * SOURCE,
        "many": np.random.default_rng(0).normal(size=(small.MOST_PAIRS + 1, 3)),
    }


@pytest.mark.parametrize("name", extraordinary())
def test_anything_else_goes_the_long_way(name):
    source = extraordinary()[name]
    destination = np.ones((len(source), 3))
    assert small.solve_ordinary(source, destination, 0.0, REGULARISING) is None


def test_arrays_of_any_order_and_lists_are_solved_alike():
    expected = solve_coefficients(SOURCE, DESTINATION)
    for source in (np.asfortranarray(SOURCE), SOURCE.tolist(), np.repeat(SOURCE, 2, axis=0)[::2]):
        assert solve_coefficients(source, DESTINATION) == expected


def test_conventions_and_penalties_of_their_own_go_the_long_way():
    opynsim = PenaltyConvention.OPYNSIM
    assert small.solve_ordinary(SOURCE, DESTINATION, 0.001, opynsim) is None
    assert small.solve_ordinary(SOURCE, DESTINATION, np.inf, REGULARISING) is None
    assert small.solve_ordinary(SOURCE, DESTINATION[:-1], 0.0, REGULARISING) is None
    bad = DESTINATION.copy()
    bad[5, 0] = np.inf
    assert small.solve_ordinary(SOURCE, bad, 0.0, REGULARISING) is None
    with pytest.raises(LandmarkError, match="destination landmark in row 5"):
        solve_coefficients(SOURCE, bad)


def test_what_was_given_stays_as_it_was_and_is_not_shared():
    source, destination = SOURCE.copy(), DESTINATION.copy()
    warp = solve_coefficients(source, destination)
    assert np.array_equal(source, SOURCE)
    source[:] = 0
    assert np.array_equal(warp.source_landmarks, SOURCE)
    assert not warp.source_landmarks.flags.writeable


def test_without_a_compiler_everything_is_the_same(not_compiled):
    thorough = solve_coefficients(SOURCE, DESTINATION, warping_penalty=0.1)
    point = thorough.warp_point(SOURCE[0])
    small._loaded[:] = []
    small.warm_up()
    quick = solve_coefficients(SOURCE, DESTINATION, warping_penalty=0.1)
    assert np.abs(quick.weights - thorough.weights).max() < 1e-13
    assert np.abs(quick.warp_point(SOURCE[0]) - point).max() < 1e-13


# One point


@given(landmark_pairs(least=1))
def test_a_point_is_warped_as_many_are(pairs):
    source, destination = pairs
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warp = solve_coefficients(source, destination)
    points = source.mean(axis=0) + 1.5 * (source - source.mean(axis=0))
    one_by_one = np.array([warp.warp_point(point) for point in points])
    assert np.abs(one_by_one - warp.warp_points(points)).max() <= 1e-12 * np.abs(destination).max()


def test_points_of_any_kind_are_warped_alike():
    warp = solve_coefficients(SOURCE, DESTINATION)
    expected = warp.warp_point(np.array([1.0, 2.0, 3.0])).tolist()
    every = np.array([[1.0, 9, 2, 9, 3, 9]])
    for point in ([1, 2, 3], (1.0, 2, 3), np.array([1, 2, 3]), every[0, ::2]):
        assert warp.warp_point(point).tolist() == expected
    first, second = (warp.warp_point(np.array([1.0, 2.0, 3.0])) for _ in range(2))
    first += 1
    assert second.tolist() == expected


@pytest.mark.parametrize("way", ["compiled", "not compiled"])
def test_a_point_that_cannot_be_used_is_refused_in_words(way, monkeypatch):
    if way == "not compiled":
        monkeypatch.setattr(small, "_loaded", [None])
    warp = solve_coefficients(SOURCE, DESTINATION)
    for bad in (np.nan, np.inf, 1e200):
        with pytest.raises(LandmarkError, match="point in row 0"):
            warp.warp_point(np.array([0.0, bad, 0.0]))
    stretched = solve_coefficients(1e-100 * SOURCE, 1e100 * DESTINATION)
    with pytest.raises(RangeError, match="range of numbers"):
        stretched.warp_point(np.array([1.0, 0.0, 0.0]))


def test_a_few_calls_do_not_wait_for_the_compiler():
    code = (
        "import sys, numpy as np\n"
        "from pinwarp.core import small\n"
        "from pinwarp.tps3d import solve_coefficients\n"
        "source = np.random.default_rng(0).normal(size=(9, 3))\n"
        "warp = solve_coefficients(source, source)\n"
        "for _ in range(small.PATIENCE - 1): warp.warp_point(source[0])\n"
        "assert 'numba' not in sys.modules\n"
        "warp.warp_point(source[0])\n"
        "assert 'numba' in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=300)
