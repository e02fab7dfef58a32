from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.core.femur import femur_landmarks
from tests.core.strategies import landmark_pairs, rotations

from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.quality import leave_one_out
from pinwarp.core.spline import factorise, solve
from pinwarp.core.suspects import SHARPLY, is_mirrored, suspects, swapped_pairs

INCONSISTENT, SUSPECT, ISOLATED = (
    FindingKind.INCONSISTENT,
    FindingKind.SUSPECT,
    FindingKind.ISOLATED,
)


def bone(count=20, noise=1.0, seed=0):
    """A made-up bone 400 long, and another subject's."""
    rng = np.random.default_rng(seed)
    source = rng.uniform(-1, 1, (count, 3)) * [60, 60, 200]
    bent = source * [1.1, 1.0, 0.9] + 8 * np.sin(source[:, [1, 2, 0]] / 60)
    return source, bent @ rotations(seed) + noise * rng.normal(size=source.shape)


def test_a_landmark_in_the_wrong_place_is_named_first():
    source, destination = bone()
    destination[7] += [0, 40, 0]
    first = suspects(factorise(source), destination)[0]
    result = leave_one_out(factorise(source), destination)
    assert (first.kind, first.rows) == (SUSPECT, (7,))
    assert first.value == result.standardised[7]
    assert first.others == (result.distances[7],)


def test_a_clean_bone_has_no_wrong_landmark():
    source, destination = bone()
    kinds = {finding.kind for finding in suspects(factorise(source), destination)}
    assert kinds <= {ISOLATED}
    assert swapped_pairs(factorise(source), destination) == ()


def test_a_lonely_landmark_is_isolated_and_not_wrong():
    source, destination = bone(noise=3.0)
    source[3] = [0, 0, 400]
    rest = np.arange(20) != 3
    others = solve(factorise(source[rest]), destination[rest])
    destination[3] = others.evaluate(source[3:4])[0] + [15, 15, 0]
    result = leave_one_out(factorise(source), destination)
    assert result.distances.argmax() == 3
    found = {f.rows[0]: f for f in suspects(factorise(source), destination)}
    assert found[3].kind is ISOLATED
    assert found[3].value == pytest.approx(
        min(np.linalg.norm(source[3] - other) for other in np.delete(source, 3, axis=0))
    )


def test_neighbours_torn_apart_accuse_each_other():
    source, destination = bone()
    source[5] = source[9] + [4, 0, 0]
    destination[5] = destination[9] + [0, 0, 30]
    first = suspects(factorise(source), destination)[0]
    assert first.kind is INCONSISTENT
    assert set(first.rows) == {5, 9}
    assert (first.value, first.others) == (pytest.approx(4), (pytest.approx(30),))


def test_of_three_neighbours_torn_apart_nobody_is_blamed_twice():
    source, destination = bone(seed=1)
    source[5], source[13] = source[9] + [4, 0, 0], source[9] + [0, 4, 0]
    apart = 30 * np.random.default_rng(0).normal(size=(2, 3))
    destination[[5, 13]] = destination[9] + apart
    found = suspects(factorise(source), destination)
    rows = [row for finding in found for row in finding.rows]
    assert {5, 9, 13} <= set(rows)
    assert len(rows) == len(set(rows))


def test_one_place_picked_twice_on_the_destination_is_noticed():
    source, destination = bone()
    near = np.linalg.norm(source - source[4], axis=1).argsort()[1]
    destination[4] = destination[near]
    first = suspects(factorise(source), destination)[0]
    assert first.kind in (INCONSISTENT, SUSPECT)
    assert set(first.rows) & {4, near}


@given(landmark_pairs(least=1), st.sampled_from([0.0, 1.0, np.inf]))
def test_whatever_the_pairs_each_is_judged_at_most_once_and_in_words(pairs, share):
    source, destination = pairs
    factor = factorise(source)
    penalty = share * float(np.ptp(source)) if np.isfinite(share) else share
    for found in (
        suspects(factor, destination, penalty),
        swapped_pairs(factor, destination, penalty),
    ):
        rows = [row for finding in found for row in finding.rows]
        assert len(rows) == len(set(rows))
        assert all(finding.describe().endswith(".") for finding in found)


@pytest.mark.parametrize(
    "source",
    [
        np.zeros((1, 3)),
        np.ones((4, 3)),
        np.eye(3),
        np.arange(8)[:, None] * np.ones(3),
        np.vstack([np.eye(3), np.eye(3), np.zeros((2, 3))]),
    ],
)
def test_degenerate_sets_are_judged_without_a_fuss(source):
    destination = np.random.default_rng(0).normal(size=source.shape)
    for target in (destination, source):
        suspects(factorise(source), target)
        swapped_pairs(factorise(source), target)
        assert not is_mirrored(source, source)


def test_leave_one_out_figures_at_hand_are_used():
    source, destination = bone()
    destination[7] += [0, 40, 0]
    factor = factorise(source)
    known = leave_one_out(factor, destination, 5.0)
    found = suspects(factor, destination, 5.0)
    assert suspects(factor, destination, 5.0, left_out=known) == found


# Swaps


@pytest.mark.parametrize("penalty", [0.0, 10.0])
def test_any_two_swapped_destinations_are_found_out(penalty):
    source, destination = bone(12)
    factor = factorise(source)
    for i, j in itertools.combinations(range(12), 2):
        swapped = destination.copy()
        swapped[[i, j]] = swapped[[j, i]]
        found = swapped_pairs(factor, swapped, penalty)
        assert [set(finding.rows) for finding in found] == [{i, j}]


def test_two_swaps_are_found_one_after_the_other():
    source, destination = bone()
    destination[[2, 11, 5, 17]] = destination[[11, 2, 17, 5]]
    found = swapped_pairs(factorise(source), destination)
    assert {frozenset(finding.rows) for finding in found} == {
        frozenset((2, 11)),
        frozenset((5, 17)),
    }


def test_the_share_that_is_left_is_what_solving_anew_says():
    source, destination = bone()
    factor = factorise(source)
    swapped = destination.copy()
    swapped[[2, 11]] = swapped[[11, 2]]
    (found,) = swapped_pairs(factor, swapped, 3.0)
    before, after = (leave_one_out(factor, y, 3.0).rms for y in (swapped, destination))
    assert found.value == pytest.approx(after / before, rel=1e-9)
    assert found.value < SHARPLY**0.5


def test_five_pairs_are_too_few_to_find_a_swap_in():
    source, destination = bone(5)
    assert swapped_pairs(factorise(source), destination[[1, 0, 2, 3, 4]]) == ()


# Mirrors


@given(landmark_pairs(least=6), st.integers(0, 1000))
def test_a_mirror_image_is_told_from_a_turned_bone(pairs, seed):
    source, _ = pairs
    turned = 1.3 * source @ rotations(seed) + 5
    assert not is_mirrored(source, turned)
    flattest = np.linalg.svd(source - source.mean(axis=0), compute_uv=False)
    assert is_mirrored(source, turned * [1, -1, 1]) or flattest[2] < 1e-3 * flattest[0]


def test_planes_and_three_landmarks_have_no_mirror_image():
    source = np.random.default_rng(0).normal(size=(8, 3)) * [1, 1, 0]
    assert not is_mirrored(source, source * [-1, 1, 1])
    assert not is_mirrored(np.eye(3), -np.eye(3))
    noisy = source * [-1, 1, 1] + 0.05 * np.random.default_rng(1).normal(size=(8, 3))
    assert not is_mirrored(source, noisy)


def test_findings_speak_with_names_and_units():
    names = ["landmark_9", "landmark_3"]
    assert Finding(INCONSISTENT, (0, 1), 8.8, (25.5,)).describe(names, "mm") == (
        "landmark_9 and landmark_3 are 8.8 mm apart on the source, 25.5 mm on the destination."
    )
    assert (
        Finding(ISOLATED, (1,), 70.0, (26.1,))
        .describe(names, "mm")
        .startswith("landmark_3 is isolated: no landmark within 70 mm.")
    )
    assert "within 110 mm" in Finding(ISOLATED, (1,), 119.7, (26.1,)).describe(names, "mm")
    assert "within 0.069." in Finding(ISOLATED, (1,), 0.0699, (0.1,)).describe(names)
    assert "3.5 times" in Finding(SUSPECT, (0,), 3.53, (18.1,)).describe(names, "mm")
    assert "to 12%" in Finding(FindingKind.SWAPPED, (0, 1), 0.12).describe(names)
    assert "mirror image" in Finding(FindingKind.MIRRORED, (), 0.1).describe(names)


# The real femur


def test_the_femur_is_judged_as_documented(shared_data):
    names, source, destination = femur_landmarks(shared_data)
    found = suspects(factorise(source), destination)
    assert found[0].kind is INCONSISTENT
    assert found[0].describe(names, "mm") == (
        "landmark_9 and landmark_3 are 8.77 mm apart on the source, 25.5 mm on the destination."
    )
    kinds = {names[row]: finding.kind for finding in found for row in finding.rows}
    assert kinds["landmark_18"] is ISOLATED
    assert not is_mirrored(source, destination)
    assert is_mirrored(source, destination * [1, 1, -1])


def test_any_swap_on_the_femur_is_found_out(shared_data):
    _, source, destination = femur_landmarks(shared_data)
    factor = factorise(source)
    assert swapped_pairs(factor, destination) == ()
    for i, j in itertools.combinations(range(20), 2):
        swapped = destination.copy()
        swapped[[i, j]] = swapped[[j, i]]
        found = swapped_pairs(factor, swapped)
        assert [set(finding.rows) for finding in found] == [{i, j}]
