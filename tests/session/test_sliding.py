"""Semilandmarks in the warp of a session: at rest, while one drags, in its figures and its file."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pinwarp.core.components import Components
from pinwarp.core.conditions import factorise_conditions
from pinwarp.core.curves import PathFinder
from pinwarp.core.groups import Handle
from pinwarp.core.landmarks import Role, Side, as_position
from pinwarp.core.spline import PenaltyConvention
from pinwarp.core.surface import Surface
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.io.samples import sample_session
from pinwarp.session import edits
from pinwarp.session.judging.quality import quality_of
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.warp.expected import destination_path, expected_handles
from pinwarp.session.warp.refining import RefinementOptions, refined_session
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


@pytest.fixture(scope="module")
def plain():
    return read_session(sample_session())


@pytest.fixture(scope="module")
def finders(plain):
    return {side: PathFinder(Surface(plain.mesh(side))) for side in Side}


@pytest.fixture(scope="module")
def grouped(plain, finders):
    """The sample with a patch, and a curve between two of its landmarks."""
    session, _ = edits.add_patch(plain, finders[SOURCE], count=80)
    ends = [plain.landmark(name) for name in ("greater_trochanter_tip", "lesser_trochanter_tip")]
    handles = [Handle(end.source, landmark=end.name) for end in ends]
    return edits.add_curve(session, handles, finders[SOURCE], count=7)[0]


def rest_of(session):
    return WarpSolver().solve(WarpInputs.of(session))


@pytest.fixture(scope="module")
def at_rest(grouped):
    return rest_of(grouped)


def pushed(session, name, by, side=DESTINATION):
    place = np.array(session.landmark(name).position(side)) + by
    return edits.move(session, name, side, as_position(place))


def misses(session, result):
    index = SurfaceIndex(session.mesh(DESTINATION))
    return index.distances(result.vertices.astype(float)).mean()


def test_semilandmarks_bring_the_surface_closer_and_landmarks_stay_met(plain, grouped, at_rest):
    assert at_rest.problem is None
    assert at_rest.not_sliding is None
    assert misses(plain, at_rest) < 0.75 * misses(plain, rest_of(plain))
    assert at_rest.residuals.max() == 0
    assert at_rest.semilandmarks.count + at_rest.semilandmarks.freed == 87
    patch, curve = at_rest.semilandmarks.groups
    assert [len(group.positions) for group in (patch, curve)] == [80, 7]
    index = SurfaceIndex(grouped.mesh(DESTINATION))
    for group in (patch, curve):
        assert index.distances(group.positions[~group.is_freed]).max() < 1e-9
        assert group.largest_slide > 0


def test_the_same_session_rests_at_the_same_places(grouped, at_rest):
    again = rest_of(replace(grouped))
    np.testing.assert_array_equal(again.vertices, at_rest.vertices)


def test_a_penalty_moves_no_semilandmark_and_slides_none_anew(grouped):
    solver = WarpSolver()
    first = solver.solve(WarpInputs.of(grouped))
    softer = edits.set_penalty(grouped, 20.0)
    moving = solver.preview(WarpInputs.of(softer))
    second = solver.solve(WarpInputs.of(softer))
    assert second.semilandmarks is first.semilandmarks
    assert solver.slider.slides == 1
    np.testing.assert_allclose(moving.vertices, second.vertices, atol=1e-2)
    assert second.residuals.max() > 0.1


def test_a_landmark_that_is_dragged_takes_the_others_along_without_a_slide(grouped):
    solver = WarpSolver()
    solver.solve(WarpInputs.of(grouped))
    moved = pushed(grouped, "midshaft_anterior", [2.0, 0.0, 3.0])
    moving = solver.preview(WarpInputs.of(moved))
    assert solver.slider.slides == 1
    assert moving.residuals.max() == 0
    rest = solver.solve(WarpInputs.of(moved))
    assert solver.slider.slides == 2
    # What was held to its planes is near to where it comes to rest.
    assert np.abs(moving.vertices - rest.vertices).max() < 1.0
    np.testing.assert_array_equal(rest.vertices, rest_of(moved).vertices)


def test_a_source_landmark_that_is_dragged_is_followed_too(grouped):
    solver = WarpSolver()
    solver.solve(WarpInputs.of(grouped))
    moved = pushed(grouped, "midshaft_anterior", [0.0, 0.0, 4.0], SOURCE)
    moving = solver.preview(WarpInputs.of(moved))
    assert moving.residuals.max() == 0
    assert np.abs(moving.vertices - rest_of(moved).vertices).max() < 1.0


def test_held_and_not_moved_the_warp_is_the_one_at_rest(at_rest, grouped):
    groups = at_rest.semilandmarks
    pairs = grouped.pairs
    source = np.array([pair.source for pair in pairs])
    destination = np.array([pair.destination for pair in pairs])
    _, targets = groups.following(source, destination)
    np.testing.assert_allclose(targets, groups.targets, atol=1e-8)
    n = len(pairs)
    np.testing.assert_allclose(targets[:n], destination, atol=1e-9)


def test_leave_one_out_keeps_the_planes_and_equals_leaving_out(grouped, at_rest):
    left_out = quality_of(at_rest).left_out
    groups = at_rest.semilandmarks
    factor = groups.slid.spline.source
    conditions = groups.slid.conditions
    for row in (0, 7):
        kept = conditions.rows != row
        without = replace(conditions, rows=conditions.rows[kept])
        without = replace(without, directions=conditions.directions[kept])
        rows = np.delete(np.arange(len(factor)), row)
        new = np.full(len(factor), -1)
        new[rows] = np.arange(len(rows))
        without = replace(without, rows=new[without.rows])
        spline = factorise_conditions(factor[rows], without).solve(groups.targets[rows])
        error = groups.targets[row] - spline.evaluate(factor[row : row + 1])[0]
        np.testing.assert_allclose(left_out.errors[row], error, atol=1e-6)


def test_semilandmarks_are_no_pairs_in_any_figure(plain, grouped, at_rest):
    judged, alone = quality_of(at_rest), quality_of(rest_of(plain))
    assert len(judged.left_out.distances) == len(plain.pairs)
    assert judged.findings == alone.findings
    assert judged.curve is None
    assert judged.left_out.rms < alone.left_out.rms
    assert judged.rms_by_components[Components.FULL] == pytest.approx(0, abs=1e-6)


def with_opynsim(session):
    return edits.set_penalty(edits.set_convention(session, PenaltyConvention.OPYNSIM), 3.0)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda s: replace(s, landmarks=s.landmarks[:3]), "There are 3 pairs"),
        (lambda s: replace(s, destination=None), "there is no destination mesh"),
        (lambda s: replace(s, source=None), "there is no source mesh"),
        (with_opynsim, "regularising"),
        (
            lambda s: replace(
                s,
                landmarks=tuple(
                    x.placed(SOURCE, (x.source[0], x.source[1], 0.0)) for x in s.landmarks
                ),
            ),
            "lie in one plane",
        ),
    ],
    ids=["three pairs", "no destination", "no source", "convention", "plane"],
)
def test_what_cannot_slide_says_why_and_leaves_the_warp_of_the_landmarks(grouped, change, words):
    session = change(grouped)
    result = WarpSolver().solve_landmarks(WarpInputs.of(session))
    assert words in result.not_sliding
    assert result.semilandmarks is None
    alone = WarpSolver().solve_landmarks(WarpInputs.of(replace(session, groups=())))
    np.testing.assert_array_equal(result.spline.weights, alone.spline.weights)


def test_a_mirrored_bone_says_so(grouped):
    mirrored = tuple(x.placed(SOURCE, (-x.source[0], *x.source[1:])) for x in grouped.landmarks)
    result = WarpSolver().solve_landmarks(WarpInputs.of(replace(grouped, landmarks=mirrored)))
    assert "mirror" in result.not_sliding


def test_a_curve_that_was_accepted_keeps_its_points_on_the_way_drawn(grouped, at_rest, finders):
    curve = grouped.group("curve_1")
    course = at_rest.semilandmarks.groups[1].course
    finder = finders[DESTINATION]
    handles = expected_handles(curve, at_rest.shown, finder.surface)
    ghost = destination_path(curve, course, at_rest.shown, finder)
    assert len(ghost) == len(course.path.places)
    accepted = edits.accept_curve(grouped, "curve_1", [as_position(x) for x in handles])
    assert accepted.group("curve_1").is_drawn
    result = rest_of(accepted)
    drawn = destination_path(accepted.group("curve_1"), course, result.shown, finder)
    points = result.semilandmarks.groups[1].positions
    gaps = np.linalg.norm(points[:, None] - drawn[None], axis=2).min(axis=1)
    assert gaps.max() < 2.0
    # In order: each further along than the one before.
    nearest = np.linalg.norm(points[:, None] - drawn[None], axis=2).argmin(axis=1)
    assert (np.diff(nearest) > 0).all()


def test_a_pair_that_is_switched_off_is_no_anchor_meanwhile(grouped):
    off = edits.set_enabled(grouped, ["greater_trochanter_tip"], False)
    result = rest_of(off)
    assert result.not_sliding is None
    assert len(result.semilandmarks.groups[1].positions) == 7
    passenger = edits.set_role(grouped, ["greater_trochanter_tip"], Role.PASSENGER)
    assert rest_of(passenger).not_sliding is None


def test_the_file_gives_back_groups_and_rest_and_needs_no_mesh_for_it(grouped, at_rest, tmp_path):
    path = tmp_path / "femur.pinwarp.csv"
    write_session(path, grouped)
    assert path.read_text().startswith("# pinwarp-session: 2\n")
    again = read_session(path)
    assert again.groups == grouped.groups
    assert len(again.slid.source) == 87
    without = read_session(path, meshes=[SOURCE])
    result = rest_of(without)
    assert result.not_sliding is None
    np.testing.assert_allclose(result.vertices, at_rest.vertices, atol=1e-4)
    # Names are no part of it.
    renamed = edits.rename(without, "greater_trochanter_tip", "apex")
    renamed = edits.rename_group(renamed, "curve_1", "crest")
    assert rest_of(renamed).not_sliding is None
    # Once a landmark was moved the old rest means nothing any more.
    moved = rest_of(pushed(without, "midshaft_anterior", [1.0, 0.0, 0.0]))
    assert "there is no destination mesh" in moved.not_sliding
    write_session(path, replace(grouped, groups=()))
    assert path.read_text().startswith("# pinwarp-session: 1\n")


@pytest.mark.parametrize("there", [[SOURCE], [DESTINATION], []])
def test_without_a_mesh_a_session_of_excluded_points_is_saved_with_its_rest(
    grouped, there, tmp_path
):
    path, copy = tmp_path / "femur.pinwarp.csv", tmp_path / "copy.pinwarp.csv"
    write_session(path, edits.exclude_points(grouped, "curve_1", [0, 3]))
    without = read_session(path, meshes=there)
    write_session(copy, without)
    again = read_session(copy)
    assert again.groups == without.groups
    assert again.slid == without.slid


def test_a_refined_session_warps_as_it_was_refined(grouped):
    refined, _ = refined_session(grouped, RefinementOptions(smallest_feature=60.0))
    assert rest_of(refined).semilandmarks is None
    assert "nothing slides meanwhile" in rest_of(refined).not_sliding
    alone = rest_of(replace(refined, groups=()))
    np.testing.assert_array_equal(rest_of(refined).vertices, alone.vertices)


def test_points_at_one_place_take_part_once(grouped, finders, tmp_path):
    """Two curves that cross, and a curve through a landmark that it is not anchored to."""
    curve = grouped.group("curve_1")
    twice, _ = edits.add_curve(grouped, curve.handles, finders[SOURCE], count=7)
    through = [Handle(handle.source) for handle in curve.handles]
    twice, _ = edits.add_curve(twice, through, finders[SOURCE], count=3)
    result = rest_of(twice)
    assert result.not_sliding is None
    assert [len(group.positions) for group in result.semilandmarks.groups] == [80, 7, 0, 0]
    path = tmp_path / "twice.pinwarp.csv"
    write_session(path, twice)
    assert read_session(path).groups == twice.groups


def test_a_point_that_is_excluded_makes_room_for_one_at_its_place(grouped, finders):
    curve = grouped.group("curve_1")
    twice, _ = edits.add_curve(grouped, curve.handles, finders[SOURCE], count=7)
    without = edits.exclude_points(twice, "curve_1", [3])
    numbers = [group.numbers.tolist() for group in rest_of(without).semilandmarks.groups]
    assert numbers[1:] == [[0, 1, 2, 4, 5, 6], [3]]


def test_a_drag_that_puts_a_refinement_out_of_date_slides_from_its_first_frame(grouped):
    refined, _ = refined_session(grouped, RefinementOptions(smallest_feature=60.0))
    solver = WarpSolver()
    solver.solve(WarpInputs.of(refined))
    for step in (1.0, 2.0):
        moved = pushed(refined, "midshaft_anterior", [step, 0.0, 0.0])
        moving = solver.preview(WarpInputs.of(moved))
        assert moving.not_sliding is None
        assert moving.semilandmarks is not None
    assert solver.slider.slides == 1
    assert np.abs(moving.vertices - rest_of(moved).vertices).max() < 1.0
