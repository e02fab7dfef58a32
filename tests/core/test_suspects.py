from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from tests.core.femur import femur_landmarks
from tests.core.mistaken import made_up, smooth, stationary
from tests.core.strategies import landmark_pairs, rotations

from pinwarp.core.chance import chances_of
from pinwarp.core.evidence import evidence
from pinwarp.core.exchanges import best_exchange
from pinwarp.core.findings import Finding, FindingKind, Severity
from pinwarp.core.isolation import isolated
from pinwarp.core.mirror import is_mirrored
from pinwarp.core.pair_field import PairField, Roughness
from pinwarp.core.quality import leave_one_out
from pinwarp.core.spline import factorise, solve
from pinwarp.core.suspects import suspects

DISPLACED, EITHER, SWAPPED = FindingKind.DISPLACED, FindingKind.EITHER, FindingKind.SWAPPED
LOOK, ISOLATED = FindingKind.WORTH_A_LOOK, FindingKind.ISOLATED
FIELDS = [stationary, smooth]


def bone(count=20, noise=1.0, seed=0):
    """A made-up bone 400 long, and another subject's."""
    rng = np.random.default_rng(seed)
    source = rng.uniform(-1, 1, (count, 3)) * [60, 60, 200]
    bent = source * [1.1, 1.0, 0.9] + 8 * np.sin(source[:, [1, 2, 0]] / 60)
    return source, bent @ rotations(seed) + noise * rng.normal(size=source.shape)


def judged(source, destination):
    return suspects(factorise(source), destination)


def strict(found):
    return [finding for finding in found if finding.severity is Severity.WRONG]


def named(found):
    return {row for finding in strict(found) for row in finding.rows}


# One displaced


def test_a_landmark_in_the_wrong_place_is_named_with_how_far_it_is_off():
    source, destination = bone()
    destination[7] += [0, 40, 0]
    (found,) = strict(judged(source, destination))
    assert (found.kind, found.rows) == (DISPLACED, (7,))
    shift, usual = found.others
    assert shift == pytest.approx(leave_one_out(factorise(source), destination).distances[7], 0.3)
    assert usual < shift / 3
    assert found.value < 0.01


def test_a_clean_bone_has_no_wrong_landmark():
    assert strict(judged(*bone())) == []


def test_what_is_small_beside_the_bone_is_only_worth_a_look_unless_it_is_all_the_clearer():
    def found(noise, off):
        source, destination = bone(25, noise, seed=4)
        destination[7] += [0, off, 0]
        return [(x.kind, x.rows) for x in judged(source, destination)]

    assert found(noise=1.0, off=12) == [(LOOK, (7,))]
    assert found(noise=1.0, off=20) == found(noise=0.3, off=12) == [(DISPLACED, (7,))]


def test_nobody_is_blamed_twice_for_several_mistakes():
    source, destination = bone(30, seed=1)
    destination[[5, 13, 21]] += [[0, 60, 0], [50, 0, 0], [0, 0, 70]]
    found = judged(source, destination)
    rows = [row for finding in found for row in finding.rows]
    assert len(rows) == len(set(rows))
    assert named(found) == {5, 13, 21}


def test_two_neighbours_that_hide_one_another_are_both_named():
    source, destination = bone(16, noise=0.5, seed=3)
    source[5] = source[9] + [6, 0, 0]
    destination[5] = destination[9] + [6, 0, 0]
    destination[[5, 9]] += [0, 50, 0]
    assert named(judged(source, destination)) == {5, 9}


def test_of_two_neighbours_torn_apart_either_may_be_the_wrong_one():
    source, destination = bone(20, noise=0.5, seed=1)
    lone = np.array([0.0, 0.0, 420.0])
    source[[3, 8]] = [lone, lone + np.array([0.5, 0, 0])]
    warp = solve(factorise(np.delete(source, [3, 8], 0)), np.delete(destination, [3, 8], 0))
    destination[[3, 8]] = warp.evaluate(source[[3, 8]]) + np.array([[0, 10, 0], [0, -10, 0]])
    found = strict(judged(source, destination))
    assert [(x.kind, set(x.rows)) for x in found] == [(EITHER, {3, 8})]


def test_one_of_two_that_is_wrong_itself_leaves_no_doubt_about_the_other():
    source, destination = bone(20, noise=0.5, seed=3)
    source[8] = source[3] + [0.5, 0, 0]
    warp = solve(factorise(np.delete(source, [3, 8], 0)), np.delete(destination, [3, 8], 0))
    destination[[3, 8]] = warp.evaluate(source[[3, 8]]) + np.array([[0, 10, 0], [0, -10, 0]])
    found = strict(judged(source, destination))
    assert sorted((x.kind, x.rows) for x in found) == [(DISPLACED, (3,)), (DISPLACED, (8,))]


def test_a_lonely_landmark_is_isolated_and_not_wrong():
    source, destination = bone(noise=3.0)
    source[3] = [0, 0, 400]
    rest = np.arange(20) != 3
    others = solve(factorise(source[rest]), destination[rest])
    destination[3] = others.evaluate(source[3:4])[0] + [15, 15, 0]
    factor = factorise(source)
    left_out = leave_one_out(factor, destination)
    assert left_out.distances.argmax() == 3
    assert 3 not in named(suspects(factor, destination))
    first = isolated(factor, left_out)[0]
    assert (first.kind, first.rows) == (ISOLATED, (3,))
    assert first.value == pytest.approx(
        min(np.linalg.norm(source[3] - other) for other in np.delete(source, 3, axis=0))
    )


# How often it is right: the small version of ``python -m tests.benchmarks --only suspects``


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize(("count", "sets"), [(7, 40), (10, 30), (16, 20), (60, 10), (300, 2)])
def test_sets_without_a_mistake_are_hardly_ever_accused(field, count, sets):
    cases = [made_up(count, seed, field) for seed in range(sets)]
    accused = sum(bool(strict(suspects(x.factor, x.destination))) for x in cases)
    assert accused <= max(1, sets // 10)


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize(("count", "least"), [(16, 7), (25, 9), (60, 8)])
def test_one_displaced_by_a_tenth_of_the_bone_is_named_and_others_are_not(field, count, least):
    hits = innocents = 0
    for seed in range(10):
        case = made_up(count, seed, field, displaced=1)
        found = strict(suspects(case.factor, case.destination))
        hits += case.wrong <= named(found)
        innocents += any(not case.wrong & set(finding.rows) for finding in found)
    assert hits >= least
    assert innocents <= 1


@pytest.mark.parametrize(
    ("count", "displaced", "sets"), [(60, 3, 4), (60, 6, 2), (150, 15, 1), (300, 30, 1)]
)
def test_several_of_many_do_not_hide_one_another(count, displaced, sets):
    for seed in range(sets):
        case = made_up(count, seed, FIELDS[seed % 2], displaced=displaced, off=0.15)
        assert named(suspects(case.factor, case.destination)) == case.wrong


def test_a_swap_with_one_displaced_is_told_from_it():
    right = 0
    for seed in range(10):
        case = made_up(25, seed, smooth, swap=True, displaced=1)
        found = strict(suspects(case.factor, case.destination))
        swaps = [set(x.rows) for x in found if x.kind is SWAPPED]
        right += swaps == [set(case.swapped)] and case.wrong <= named(found)
    assert right >= 9


# Swaps


def test_any_two_swapped_destinations_are_found_out():
    source, destination = bone(8)
    factor = factorise(source)
    for i, j in itertools.combinations(range(8), 2):
        swapped = destination.copy()
        swapped[[i, j]] = swapped[[j, i]]
        found = strict(suspects(factor, swapped))
        assert [(x.kind, set(x.rows)) for x in found] == [(SWAPPED, {i, j})]


def test_two_displaced_are_not_called_swapped_where_that_explains_only_most():
    case = made_up(41, 1004, smooth, displaced=2, off=0.15)
    found = strict(suspects(case.factor, case.destination))
    assert {(x.kind, x.rows) for x in found} == {(DISPLACED, (row,)) for row in case.wrong}


def test_two_that_lie_together_look_swapped_only_where_that_is_clearly_likelier():
    def found(apart):
        source, destination = bone(noise=2.0)
        source[8] = source[3] + [0, 0, apart]
        warp = solve(factorise(np.delete(source, 8, 0)), np.delete(destination, 8, 0))
        destination[8] = warp.evaluate(source[8:9])[0] + 2 * np.random.default_rng(0).normal(size=3)
        destination[[3, 8]] = destination[[8, 3]]
        return [(x.kind, set(x.rows)) for x in strict(judged(source, destination))]

    assert found(apart=4) == []
    assert found(apart=8) == [(SWAPPED, {3, 8})]


def test_two_swaps_are_found_one_after_the_other():
    source, destination = bone()
    destination[[2, 11, 5, 17]] = destination[[11, 2, 17, 5]]
    found = judged(source, destination)[:2]
    assert {frozenset(finding.rows) for finding in found} == {
        frozenset((2, 11)),
        frozenset((5, 17)),
    }


def test_an_exchange_is_as_likely_as_the_exchanged_set_is():
    source, destination = bone()
    field = PairField.of(factorise(source))
    y = destination - destination.mean(axis=0)
    y[[4, 9]] = y[[9, 4]]
    likely, i, j = best_exchange(evidence(field, y, (2,)), np.array([1, 4, 6, 9]))
    assert {i, j} == {4, 9}
    y[[4, 9]] = y[[9, 4]]
    assert likely == pytest.approx(evidence(field, y, (2,)).nothing_wrong[::2].max(), rel=1e-9)


# Leaving out without solving anew


@pytest.mark.parametrize("roughness", Roughness)
def test_leaving_pairs_out_is_as_if_they_had_never_been_there(roughness):
    source, destination = bone()
    out, rest = [3, 8, 15], np.delete(np.arange(20), [3, 8, 15])
    factor, fewer = factorise(source), factorise(source[rest])
    y = destination - destination.mean(axis=0)
    field, alone = PairField.of(factor, roughness), PairField.of(fewer, roughness)
    seen = evidence(field, y, out)
    # In units of the mesh, a smooth field in those of the landmarks' size.
    size = 1.0 if roughness is Roughness.SPLINE else (fewer.scale / factor.scale) ** 3
    for level, noise in enumerate(field.noise):
        values = 1 / alone.certainty[0] - alone.noise[0]
        G = (alone.modes / (size * values + noise)) @ alone.modes.T
        assert np.allclose(seen.precision[level, rest], np.diag(G), rtol=1e-7)
        assert np.allclose(seen.pulls[level, rest], G @ y[rest], rtol=1e-6, atol=1e-9)
        assert seen.misfit[level] == pytest.approx(float(np.sum(y[rest] * (G @ y[rest]))), rel=1e-7)
        (block,) = seen.block(slice(level, level + 1), rest.tolist())
        assert np.allclose(block, G, rtol=1e-6, atol=1e-12)
        assert np.allclose(seen.column(level, 5)[rest], G[:, list(rest).index(5)], atol=1e-9)
        near = seen.near_entries(level)[rest[0]]
        nearest = field.near[rest[0], : field.neighbours + 1]
        kept = [k for k, row in enumerate(nearest) if row in rest]
        assert len(near) == len(nearest)
        places = [list(rest).index(field.near[rest[0]][k]) for k in kept]
        assert np.allclose(near[kept], G[0, places], atol=1e-9)


@pytest.mark.parametrize("duplicate", [False, True])
def test_pairs_left_out_one_by_one_are_left_out_as_if_at_once(duplicate):
    source, destination = bone()
    if duplicate:
        source[8], destination[8] = source[3], destination[3]
    field, y = PairField.of(factorise(source)), destination - destination.mean(axis=0)
    rest = np.delete(np.arange(20), [3, 8, 15])
    whole = evidence(field, y)
    at_once, one_by_one = whole.without((3, 8, 15)), whole.without((15,)).without((8, 3))
    assert at_once.left_out == one_by_one.left_out == (3, 8, 15)
    for what in ("pulls", "precision", "one_wrong"):
        first, second = (getattr(seen, what)[:, rest] for seen in (at_once, one_by_one))
        assert np.allclose(first, second, rtol=1e-7, atol=1e-9 * np.abs(first).max()), what
    assert np.allclose(at_once.near_entries(2)[rest], one_by_one.near_entries(2)[rest], atol=1e-9)
    assert at_once.misfit == pytest.approx(one_by_one.misfit, rel=1e-7)
    assert at_once.level_without(5) == one_by_one.level_without(5)


def test_the_chance_depends_neither_on_the_unit_nor_on_the_pose():
    source, destination = bone()
    y = destination - destination.mean(axis=0)
    (first,) = chances_of([(evidence(PairField.of(factorise(source)), y), 6)])
    turned = 1e-3 * source @ rotations(4) + 7
    moved = evidence(PairField.of(factorise(turned)), 50 * y @ rotations(9))
    (second,) = chances_of([(moved, 6)])
    assert second.value == pytest.approx(first.value, rel=1e-6)
    assert (second.shift, second.usual) == pytest.approx((50 * first.shift, 50 * first.usual))


def test_pairs_that_are_judged_at_once_are_judged_as_one_by_one():
    source, destination = bone(30)
    y = destination - destination.mean(axis=0)
    field = PairField.of(factorise(source))
    seen = [evidence(field, y, out) for out in ((), (4,), (2, 11))]
    asked = [(seen[0], 6), (seen[1], 6), (seen[2], 4), (seen[2], 19)]
    alone = [chances_of([pair])[0] for pair in asked]
    for chance, other in zip(chances_of(asked), alone, strict=True):
        assert chance.value == pytest.approx(other.value, rel=1e-9)
        assert (chance.shift, chance.usual) == pytest.approx((other.shift, other.usual))
    assert len({chance.value for chance in alone}) == 4


# Anything


@given(landmark_pairs(least=1))
def test_whatever_the_pairs_each_is_judged_at_most_once_and_in_words(pairs):
    source, destination = pairs
    found = suspects(factorise(source), destination)
    rows = [row for finding in found for row in finding.rows]
    assert len(rows) == len(set(rows))
    assert all(finding.describe().endswith(".") for finding in found)
    assert len(strict(found)) <= max(1, 0.3 * len(source) + 1)


@pytest.mark.parametrize(
    "source",
    [
        np.zeros((1, 3)),
        np.ones((4, 3)),
        np.eye(3),
        np.arange(8)[:, None] * np.ones(3),
        np.vstack([np.eye(3), np.eye(3), np.zeros((2, 3))]),
        np.vstack([np.zeros((12, 3)), np.eye(3)]),
    ],
)
def test_degenerate_sets_are_judged_without_a_fuss(source):
    destination = np.random.default_rng(0).normal(size=source.shape)
    for target in (destination, source):
        suspects(factorise(source), target)
        assert not is_mirrored(source, source)


def test_what_an_affine_map_meets_is_not_judged():
    source, _ = bone()
    assert judged(source, source @ rotations(3) * [1, 2, 3] + 1e4) == ()


def test_one_wrong_pair_of_an_exact_map_is_named():
    source, _ = bone()
    destination = 1.2 * source @ rotations(3)
    destination[11] += [0, 0, 1]
    assert named(judged(source, destination)) == {11}


def test_of_a_plane_six_pairs_are_judged():
    source, destination = bone(14, noise=0.3)
    flat = source * [0, 1, 1]
    destination = flat * [1, 1.1, 0.9] + 4 * np.sin(flat[:, [1, 2, 0]] / 60)
    assert strict(judged(flat, destination)) == []
    destination[4] += [40, 0, 0]
    assert named(judged(flat, destination)) == {4}


def test_duplicates_that_agree_accuse_nobody():
    source, destination = bone()
    source, destination = np.vstack([source, source[:4]]), np.vstack([destination, destination[:4]])
    assert strict(judged(source, destination)) == []


# Mirrors


@settings(max_examples=25)
@given(landmark_pairs(least=6))
def test_a_mirror_image_is_told_from_a_turned_bone(pairs):
    source, _ = pairs
    turned = 1.3 * source @ rotations(5) + 5
    assert not is_mirrored(source, turned)
    flattest = np.linalg.svd(source - source.mean(axis=0), compute_uv=False)
    assert is_mirrored(source, turned * [1, -1, 1]) or flattest[2] < 0.1 * flattest[0]


def test_a_mirrored_set_is_known_with_one_displaced_and_no_other_is():
    for seed in range(20):
        case = made_up(10, seed, displaced=1)
        assert is_mirrored(case.factor.source, case.destination * [1, 1, -1])
        assert not is_mirrored(case.factor.source, case.destination)


def test_planes_and_four_landmarks_have_no_mirror_image():
    source = np.random.default_rng(0).normal(size=(8, 3)) * [1, 1, 0]
    assert not is_mirrored(source, source * [-1, 1, 1])
    corners = np.vstack([np.eye(3), np.zeros(3)])
    assert not is_mirrored(corners, -corners)
    rng = np.random.default_rng(2)
    line = np.arange(8)[:, None] * [10, 20, 30]
    for _ in range(30):
        one, other = (line + 0.1 * rng.normal(size=(8, 3)) for _ in range(2))
        assert not is_mirrored(one, other)
    noisy = source * [-1, 1, 1] + 0.05 * np.random.default_rng(1).normal(size=(8, 3))
    assert not is_mirrored(source, noisy)


# Words


def test_findings_speak_with_names_units_and_how_often_that_happens():
    names = ["landmark_9", "tip and base"]
    off = Finding(DISPLACED, (0,), 1e-9, (18.2, 7.81)).describe(names, "mm")
    assert off == (
        "landmark_9 lies 18.2 mm from where the other pairs expect it; 7.81 mm is usual there. A "
        "set without a mistake shows as much about once in 1,000. The other pairs were judged "
        "without it."
    )
    measured = Finding(DISPLACED, (0,), 1e-9, (18.2, 7.81)).describe(names, "mm", {names[0]: 2.0})
    assert measured == off.replace(" expect it;", " expect it, 9.1 times its own spread;")
    for finding in (
        Finding(EITHER, (1, 0), 0.01, (18.2, 7.8)),
        Finding(LOOK, (1,), 0.2, (18.2, 7)),
    ):
        told = finding.describe(names, "mm", dict(zip(names, (2.0, 0.1), strict=True)))
        assert "tip and base lies 18.2 mm from where the other pairs expect it, 182 times" in told
        assert "spread" not in finding.describe(names, "mm", {names[0]: 2.0, names[1]: 0.0})
    assert "once in 30." in Finding(DISPLACED, (0,), 0.031, (18.2, 7.8)).describe(names)
    assert (
        Finding(EITHER, (0, 1), 0.01, (18.2, 7.8))
        .describe(names)
        .startswith("landmark_9 or tip and base is wrong: leaving out either explains the set")
    )
    look = Finding(LOOK, (0,), 0.23, (18.2, 7.8)).describe(names, "mm")
    assert look.endswith("About one set without a mistake in 4 has such a pair.")
    alone = Finding(ISOLATED, (1,), 70.0, (26.1,)).describe(names, "mm")
    assert alone.startswith("tip and base is isolated: no landmark within 70 mm.")
    assert "within 110 mm" in Finding(ISOLATED, (1,), 119.7, (26.1,)).describe(names, "mm")
    assert "within 0.069." in Finding(ISOLATED, (1,), 0.0699, (0.1,)).describe(names)
    assert "look swapped" in Finding(SWAPPED, (0, 1), 1e-5).describe(names)
    assert "mirror image" in Finding(FindingKind.MIRRORED, (), 0.1).describe(names)


# The real femur


def test_the_femur_is_judged_as_documented(shared_data):
    names, source, destination = femur_landmarks(shared_data)
    found = judged(source, destination)
    assert strict(found) == []
    assert {names[x.rows[0]] for x in found} == {"landmark_9", "landmark_12"}
    assert {x.kind for x in found} == {LOOK}
    assert not is_mirrored(source, destination)
    assert is_mirrored(source, destination * [1, 1, -1])


def test_any_swap_on_the_femur_is_found_out(shared_data):
    _, source, destination = femur_landmarks(shared_data)
    factor = factorise(source)
    for i, j in ((i, (i + 7) % 20) for i in range(0, 20, 2)):
        swapped = destination.copy()
        swapped[[i, j]] = swapped[[j, i]]
        found = strict(suspects(factor, swapped))
        assert [(x.kind, set(x.rows)) for x in found] == [(SWAPPED, {i, j})]
