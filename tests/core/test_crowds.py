"""Many landmarks at one place are one thing to say, and no more work than others."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from pinwarp.core import factor as factor_module
from pinwarp.core.errors import ConflictingLandmarksWarning
from pinwarp.core.factor import factorise
from pinwarp.core.findings import FindingKind
from pinwarp.core.spline import solve
from pinwarp.core.suspects import suspects
from pinwarp.tps3d import solve_coefficients


def crowd(count, apart=1.0, seed=0):
    """General places, the last one taken by many landmarks that disagree on the destination."""
    rng = np.random.default_rng(seed)
    source = np.vstack([rng.normal(size=(6, 3)), np.tile(rng.normal(size=3), (count, 1))])
    return source, source + apart * rng.normal(size=source.shape)


def warnings_of(source, destination):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        solve_coefficients(source, destination)
    return [str(warning.message) for warning in caught]


@pytest.mark.parametrize("count", [2, 3, 20, 1000])
def test_landmarks_at_one_place_are_one_finding_and_one_warning(count):
    source, destination = crowd(count)
    findings = solve(factorise(source), destination).findings
    assert [(x.kind, x.rows) for x in findings] == [
        (FindingKind.CONFLICT, tuple(range(6, 6 + count)))
    ]
    (words,) = warnings_of(source, destination)
    assert words == findings[0].describe()


def test_a_sentence_names_the_first_few_and_says_how_many_more():
    (finding,) = solve(factorise(crowd(200)[0]), crowd(200)[1]).findings
    words = finding.describe([f"p{row}" for row in range(206)], "mm")
    assert words.startswith("p6, p7, p8 and 197 more lie at the same place on the source but up to")
    (finding,) = solve(factorise(crowd(4)[0]), crowd(4)[1]).findings
    assert finding.describe().startswith("landmark 6, landmark 7, landmark 8 and landmark 9 lie")


def test_the_figure_of_a_crowd_is_how_far_the_furthest_two_are_apart():
    source, destination = crowd(30)
    (finding,) = solve(factorise(source), destination).findings
    apart = np.linalg.norm(destination[6:, None] - destination[None, 6:], axis=2)
    assert finding.value == pytest.approx(apart.max())


def test_each_place_is_a_finding_of_its_own():
    rng = np.random.default_rng(1)
    places = rng.normal(size=(40, 3))
    source = np.repeat(places, 3, axis=0)
    findings = solve(factorise(source), rng.normal(size=source.shape)).findings
    assert [x.rows for x in findings] == [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(40)]


def test_a_chain_of_close_landmarks_is_one_finding():
    rng = np.random.default_rng(2)
    spread = rng.normal(size=(30, 3))
    chain = np.array([[5.0 + 1e-6 * i, 0, 0] for i in range(8)])
    source = np.vstack([spread, chain])
    (finding,) = factorise(source).findings
    assert finding.kind is FindingKind.CLOSE
    assert finding.rows == tuple(range(30, 38))
    assert finding.value == pytest.approx(1e-6)
    assert "landmark 30, landmark 31, landmark 32 and 5 more are only 1e-06" in finding.describe()


def test_of_a_crowd_beside_a_close_landmark_the_first_speaks():
    source, _ = crowd(4)
    factor = factorise(np.vstack([source, source[-1] + [1e-9, 0, 0]]))
    assert [x.rows for x in factor.findings] == [(6, 10)]
    assert factor.duplicates == (tuple(range(6, 10)),)


def test_a_thousand_at_one_place_look_at_each_row_once(monkeypatch):
    looked = []

    class Counted(np.ndarray):
        def __getitem__(self, key):
            looked.append(np.size(key))
            return np.asarray(self)[key]

    clusters = factor_module._clusters
    near = ~np.eye(1000, dtype=bool)
    assert clusters(near.view(Counted)) == (tuple(range(1000)),)
    assert sum(looked) == 1000


def test_all_at_one_place_are_solved_and_judged():
    source = np.zeros((300, 3))
    destination = np.random.default_rng(0).normal(size=(300, 3))
    factor = factorise(source)
    assert len(solve(factor, destination).findings) == 1
    assert suspects(factor, destination) == ()


def test_a_crowd_that_agrees_is_nothing_to_say():
    source, _ = crowd(100)
    with warnings.catch_warnings():
        warnings.simplefilter("error", ConflictingLandmarksWarning)
        solve_coefficients(source, 2 * source)


@pytest.mark.parametrize("apart", [0.0, 1.0])
def test_places_solved_once_each_are_what_the_eigenvalues_say(apart):
    rng = np.random.default_rng(5)
    places = rng.normal(size=(20, 3)) + 7
    source = places[np.concatenate([np.arange(20), rng.integers(0, 20, 30)])]
    destination = source @ rng.normal(size=(3, 3)) + np.sin(source)
    destination += apart * rng.normal(size=source.shape)
    quick, thorough = factorise(source), factorise(source)
    _ = thorough.modes
    a, b = solve(quick, destination), solve(thorough, destination)
    assert not quick.has_modes
    assert np.allclose(a.weights, b.weights, atol=1e-9)
    assert np.allclose(a.affine, b.affine, atol=1e-8)
    assert a.findings == b.findings


def test_a_thousand_at_one_place_need_no_eigenvalues():
    for source in (crowd(1000)[0], np.ones((1000, 3)), np.repeat(crowd(1)[0], 200, axis=0)):
        factor = factorise(source)
        solve(factor, np.random.default_rng(0).normal(size=source.shape))
        assert not factor.has_modes
