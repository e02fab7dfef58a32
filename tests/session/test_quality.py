"""What the pairs of a session say about one another."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.core.femur import femur_landmarks

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.components import Components
from pinwarp.core.factor import factorise
from pinwarp.core.findings import FindingKind
from pinwarp.core.landmarks import Landmark, as_position
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import PenaltyConvention, solve
from pinwarp.session import edits
from pinwarp.session.judging.quality import penalty_advice, quality_of
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver


def session_of(source, destination, names=None, **changes):
    names = names or [f"p{i}" for i in range(len(source))]
    return Session(
        landmarks=tuple(
            Landmark(name, as_position(a), as_position(b))
            for name, a, b in zip(names, source, destination, strict=True)
        ),
        **changes,
    )


def quality(session):
    return quality_of(WarpSolver().solve(WarpInputs.of(session)))


def made_up(count, seed=0):
    rng = np.random.default_rng(seed)
    source = 50 * rng.normal(size=(count, 3))
    return source, source * [1.1, 0.9, 1.0] + 4 * np.sin(source / 30) + rng.normal(size=(count, 3))


def rms(a, b):
    return float(np.sqrt(np.mean(np.sum((a - b) ** 2, axis=1))))


@pytest.fixture
def femur(shared_data):
    return femur_landmarks(shared_data)


def test_the_real_femur_has_two_pairs_worth_a_look_and_isolated_ones_but_none_wrong(femur):
    names, source, destination = femur
    judged = quality(session_of(source, destination, names))
    kinds = [finding.kind for finding in judged.findings]
    first_isolated = kinds.index(FindingKind.ISOLATED)
    looks = judged.findings[:first_isolated]
    assert {x.kind for x in looks} == {FindingKind.WORTH_A_LOOK}
    assert {names[x.rows[0]] for x in looks} == {"landmark_9", "landmark_12"}
    assert set(kinds[first_isolated:]) == {FindingKind.ISOLATED}, "last: they are not wrong"
    isolated = [names[finding.rows[0]] for finding in judged.findings[first_isolated:]]
    assert "landmark_18" in isolated
    largest = int(np.argmax(judged.left_out.distances))
    assert names[largest] == "landmark_18"
    assert judged.left_out.rms == pytest.approx(11.1, abs=0.05)


def test_while_something_moves_the_figures_come_and_the_judgement_stays():
    source, destination = made_up(14)
    before = quality(session_of(source, destination))
    destination[5] += [0, 90, 0]
    moving = WarpSolver().solve(WarpInputs.of(session_of(source, destination)))
    figures = quality_of(moving, judge=False)
    assert figures.judgement is None
    assert figures.left_out.distances[5] > 60
    assert figures.judged_as(before).findings == before.findings
    assert figures.judged_as(quality(session_of(*made_up(13)))).judgement is None
    assert [x.rows for x in quality_of(moving).findings[:1]] == [(5,)]


def test_two_exchanged_destinations_of_the_real_femur_are_named_as_swapped(femur):
    names, source, destination = femur
    a, b = names.index("landmark_5"), names.index("landmark_12")
    destination[[a, b]] = destination[[b, a]]
    found = quality(session_of(source, destination, names)).findings[0]
    assert found.kind is FindingKind.SWAPPED
    assert {names[row] for row in found.rows} == {"landmark_5", "landmark_12"}


def test_a_mirrored_set_is_the_only_thing_said():
    source, destination = made_up(14)
    judged = quality(session_of(source, destination * [-1, 1, 1]))
    assert [finding.kind for finding in judged.findings] == [FindingKind.MIRRORED]


def test_a_landmark_of_a_swap_is_not_suspected_once_more():
    source, destination = made_up(20)
    destination[[3, 11]] = destination[[11, 3]]
    findings = quality(session_of(source, destination)).findings
    assert findings[0].kind is FindingKind.SWAPPED
    assert not any({3, 11} & set(finding.rows) for finding in findings[1:])


def test_close_landmarks_are_mentioned_with_the_others():
    source, destination = made_up(14)
    source[1] = source[0] + 1e-4
    kinds = [finding.kind for finding in quality(session_of(source, destination)).findings]
    assert FindingKind.CLOSE in kinds


@pytest.mark.parametrize(
    ("as_good", "words"),
    [
        ((3.14159, 41.0), "Anything from 3.1 mm to 41 mm does as well as the suggested penalty."),
        ((0.0, 41.0), "Anything up to 41 mm does as well, even no penalty."),
        ((3.0, np.inf), "Anything from 3 mm on does as well, even the affine fit."),
        ((0.0, np.inf), "The pairs do not tell one penalty from another: anything does as well."),
    ],
)
def test_a_suggested_penalty_says_how_flat_its_curve_is(as_good, words):
    source, destination = made_up(30)
    noisy = destination + 4 * np.random.default_rng(1).normal(size=destination.shape)
    curve = quality(session_of(source, noisy)).curve
    assert curve.suggested is not None
    assert penalty_advice(replace(curve, as_good=as_good), "mm") == words


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_few_pairs_have_no_leave_one_out_error(count):
    source, destination = made_up(count)
    judged = quality(session_of(source, destination))
    assert judged.left_out is None
    assert judged.curve is None


def test_no_pairs_no_quality():
    assert quality(Session()) is None


def test_the_published_convention_has_no_leave_one_out_error_above_penalty_0():
    source, destination = made_up(14)
    session = session_of(
        source, destination, settings=WarpSettings(convention=PenaltyConvention.OPYNSIM)
    )
    assert quality(session).left_out is not None
    assert quality(edits.set_penalty(session, 0.1)).left_out is None


def test_the_affine_part_and_the_energy_are_those_of_the_warp():
    source, _ = made_up(14)
    judged = quality(session_of(source, source * [2, 1, 1] + 3))
    assert judged.affine.scales == pytest.approx([2, 1, 1])
    assert judged.energy == pytest.approx(np.zeros(3), abs=1e-6)
    assert quality(session_of(*made_up(14))).energy.min() > 0.1


def test_each_part_of_the_warp_leaves_what_its_own_fit_leaves():
    source, destination = made_up(14)
    penalty = 5.0
    session = session_of(source, destination, settings=WarpSettings(penalty))
    left = quality(session).rms_by_components
    factor = factorise(source)
    for part, mapped in (
        (Components.FULL, solve(factor, destination, penalty).evaluate(source)),
        (Components.WITHOUT_POSE, solve(factor, destination, penalty).evaluate(source)),
        (Components.AFFINE, solve(factor, destination, math.inf).evaluate(source)),
        (Components.SIMILARITY, fit_similarity(source, destination).apply(source)),
        (Components.RIGID, fit_similarity(source, destination, scaling=False).apply(source)),
    ):
        assert left[part] == pytest.approx(rms(mapped, destination)), part


def test_what_is_left_grows_from_the_full_warp_to_the_rigid_fit(femur):
    names, source, destination = femur
    left = quality(session_of(source, destination, names)).rms_by_components
    order = (Components.FULL, Components.AFFINE, Components.SIMILARITY, Components.RIGID)
    assert [round(left[part], 1) for part in order] == [0.0, 11.0, 11.1, 29.6]


@pytest.mark.parametrize(
    ("places", "words"),
    [
        ([(0, 0, 0), (10, 0, 0), (0, 10, 0), (10, 10, 0)], "in one plane"),
        ([(0, 0, 5), (10, 0, 5), (0, 10, 5), (10, 10, 5), (3, 4, 5)], "in one plane"),
        ([(0, 0, 0), (10, 0, 0), (20, 0, 0), (30, 0, 0)], "on one line"),
        ([(0, 0, 0), (10, 0, 0), (20, 0, 0)], "on one line"),
        ([(0, 0, 0), (10, 0, 0)], ""),
        ([(0, 0, 0), (10, 0, 0), (0, 10, 0)], ""),
        ([(0, 0, 0), (10, 0, 0), (0, 10, 0), (0, 0, 10)], ""),
    ],
)
def test_pairs_that_leave_a_direction_open_that_so_many_could_settle_are_told(places, words):
    marks = tuple(
        Landmark(f"p{i}", place, tuple(1.1 * x for x in place)) for i, place in enumerate(places)
    )
    session = Session(landmarks=marks)
    result = WarpSolver().solve(WarpInputs.of(session))
    told = [x.sentence for x in quality_of(result).findings_in(session)]
    assert len(told) == bool(words)
    away = "Place one off the plane." if "plane" in words else "Place two away from the line."
    assert all(words in sentence and sentence.endswith(away) for sentence in told)
    if len(places) == 4:
        assert result.flexibility is None, "nothing can bend, so nothing is 100 % flexible"
