"""Curves and patches of a session: what edits do to them, and what they do to its warp."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.core.bones import bone, landmarks, off_truth, shape, truth

from pinwarp.core.basis import Basis
from pinwarp.core.curves import PathFinder
from pinwarp.core.errors import LandmarkError
from pinwarp.core.groups import Handle
from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.core.spline import PenaltyConvention
from pinwarp.core.surface import Surface
from pinwarp.io.meshes import MeshFile
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.mesh_units import scale_side
from pinwarp.session.session import Session
from pinwarp.session.warp.solver import WarpInputs, WarpSolver

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
MESH = bone()
ON_SOURCE, ON_TRUTH = Surface(MESH), Surface(MESH.with_vertices(truth(MESH.vertices)))
FINDER = PathFinder(ON_SOURCE)


def file_of(mesh, name):
    return MeshFile(Path("/bones", name), mesh, "ab", ())


def on_source(angle, height):
    place = ON_SOURCE.closest(shape(np.array([angle]), np.array([height]))).positions[0]
    return as_position(place)


@pytest.fixture(scope="module")
def plain():
    """Twelve pairs on two bones."""
    sources = ON_SOURCE.closest(landmarks(12)).positions
    ends = ON_TRUTH.closest(truth(sources)).positions
    pairs = tuple(
        Landmark(f"p{n}", as_position(a), as_position(b))
        for n, (a, b) in enumerate(zip(sources, ends, strict=True))
    )
    return Session(file_of(MESH, "source.ply"), file_of(ON_TRUTH.mesh, "destination.ply"), pairs)


@pytest.fixture(scope="module")
def session(plain):
    """The same with a curve between two landmarks, a ring, and a patch inside that."""
    a, b = plain.landmarks[2], plain.landmarks[7]
    ends = Handle(a.source, landmark="p2"), Handle(b.source, landmark="p7")
    here, _ = edits.add_curve(plain, ends, FINDER, count=5, name="crest")
    ring = [Handle(on_source(angle, 0.6)) for angle in np.arange(6) * np.pi / 3]
    here, _ = edits.add_curve(here, ring, FINDER, is_closed=True, count=12, name="ring")
    top = on_source(0, 0.05)
    here, _ = edits.add_patch(here, FINDER, count=15, around="ring", inside=top, name="cap")
    return here


def anchors(session, name="crest"):
    return [handle.landmark for handle in session.group(name).anchors]


# Anchors


def test_a_curve_keeps_its_landmarks_when_they_are_renamed(session):
    renamed = edits.rename_many(session, {"p2": "p7", "p7": "apex"})
    assert anchors(renamed) == ["p7", "apex"]
    assert renamed.group("crest").places(SOURCE) == session.group("crest").places(SOURCE)


def test_a_handle_goes_with_its_landmark_and_lets_go_when_that_is_removed(session):
    there = on_source(1.0, 1.0)
    moved = edits.move(session, "p2", SOURCE, there)
    assert moved.group("crest").handles[0].source == there
    gone = edits.remove(moved, ["p2"])
    assert anchors(gone) == ["p7"]
    assert gone.group("crest").handles[0].source == there
    # A landmark of that name that comes later is another one.
    assert anchors(replace(gone, landmarks=(*gone.landmarks, session.landmarks[2]))) == ["p7"]


def test_a_landmark_that_is_switched_off_is_still_where_the_curve_ends(session):
    off = edits.set_enabled(session, ["p2"], False)
    assert anchors(off) == ["p2", "p7"]
    result = WarpSolver().solve(WarpInputs.of(off))
    assert result.not_sliding is None
    assert result.semilandmarks.count == 32 - result.semilandmarks.freed


def test_accepting_a_ghost_places_the_landmarks_that_wait(plain):
    here = edits.remove_side(plain, "p2", DESTINATION)
    ends = [Handle(plain.landmarks[n].source, landmark=f"p{n}") for n in (2, 7)]
    here, _ = edits.add_curve(here, ends, FINDER, name="crest")
    assert not here.group("crest").is_drawn
    there = plain.landmarks[2].destination
    drawn = edits.accept_curve(here, "crest", [there, (0.0, 0.0, 0.0)])
    assert drawn.group("crest").is_drawn
    assert drawn.landmark("p2").destination == there
    assert drawn.landmark("p7") == plain.landmark("p7")


def test_taking_back_what_was_drawn_leaves_landmarks_alone(session):
    places = truth(np.array(session.group("ring").places(SOURCE)))
    drawn = edits.accept_curve(session, "ring", [as_position(x) for x in places])
    assert drawn.group("ring").is_drawn
    assert edits.undraw_curve(drawn, "ring") == session
    assert edits.undraw_curve(session, "crest").landmarks == session.landmarks


# The bones


def test_mirroring_twice_is_nothing_and_once_moves_the_source_alone(session):
    once = edits.mirror_source(session, "x")
    before, after = session.group("crest"), once.group("crest")
    low, high = (x[0] for x in MESH.bounds.reshape(2, 3))
    assert after.handles[0].source[0] == pytest.approx(low + high - before.handles[0].source[0])
    assert after.places(DESTINATION) == before.places(DESTINATION)
    assert anchors(once) == ["p2", "p7"]
    points = np.array(once.group("cap").points)
    assert Surface(once.mesh(SOURCE)).index.distances(points).max() < 1e-9
    twice = edits.mirror_source(once, "x")
    np.testing.assert_allclose(twice.group("cap").points, session.group("cap").points, atol=1e-9)


@pytest.mark.parametrize("side", list(Side))
def test_another_unit_scales_groups_with_their_bone(session, side):
    scaled = scale_side(session, side, 1000.0)
    for before, after in zip(session.groups, scaled.groups, strict=True):
        places = [x.places(side) if hasattr(x, "places") else () for x in (before, after)]
        np.testing.assert_allclose(np.array(places[1]), 1000 * np.array(places[0]))
    factor = 1000 if side is SOURCE else 1
    cap = scaled.group("cap")
    np.testing.assert_allclose(cap.points, factor * np.array(session.group("cap").points))
    np.testing.assert_allclose(cap.inside, factor * np.array(session.group("cap").inside))
    assert anchors(scaled) == ["p2", "p7"]


def test_what_nobody_placed_on_the_destination_cannot_change_sides(session):
    with pytest.raises(LandmarkError, match=r"crest.*cap cannot change sides.*remove patches"):
        edits.swap_sides(session)
    only_crest = edits.remove_groups(session, ["ring", "cap"])
    # It ends at landmarks on both sides, but nobody accepted its way there.
    assert not only_crest.group("crest").is_drawn
    only_crest = edits.accept_curve(only_crest, "crest", [(0, 0, 0), (0, 0, 0)])
    swapped = edits.swap_sides(only_crest)
    assert anchors(swapped) == ["p2", "p7"]
    assert swapped.group("crest").places(SOURCE) == only_crest.group("crest").places(DESTINATION)
    assert edits.swap_sides(swapped) == only_crest


# Points


def test_a_pinned_point_is_a_landmark_and_no_point_any_more(session):
    pinned, name = edits.pin_point(session, "cap", 4, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    assert name == "cap_5"
    assert pinned.landmarks[-1] == Landmark("cap_5", (1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    assert pinned.group("cap").excluded == {4}
    again, name = edits.pin_point(pinned, "cap", 4, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    assert name == "cap_5_"
    assert edits.exclude_points(again, "cap", [4], excluded=False).group("cap").excluded == set()


def test_a_point_that_is_not_there_cannot_be_excluded(session):
    with pytest.raises(LandmarkError, match="cap has no point 16"):
        edits.exclude_points(session, "cap", [15])


def test_fewer_points_forget_what_was_excluded_beyond(session):
    here = edits.exclude_points(session, "crest", [1, 4])
    assert edits.set_count(here, "crest", 3, FINDER).group("crest").excluded == {1}


def test_a_patch_stays_where_it_is_when_its_curve_goes(session):
    assert edits.remove_groups(session, ["ring"]).group("cap").around == ""
    assert edits.remove_groups(session, ["ring"]).group("cap").points == session.group("cap").points
    assert edits.rename_group(session, "ring", " rim ").group("cap").around == "rim"


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda s: edits.rename_group(s, "ring", "cap"), "already a group called cap"),
        (lambda s: edits.rename_group(s, "ring", "  "), "needs a name"),
        (lambda s: edits.rename_group(s, "none", "x"), "no curve or patch called none"),
        (lambda s: edits.set_count(s, "none", 3, FINDER), "no curve or patch called none"),
        (lambda s: edits.set_count(s, "ring", 5001, FINDER), "5,001 points"),
        (lambda s: edits.set_count(s, "cap", 5001, FINDER), "5,001 points"),
        (lambda s: edits.undraw_curve(s, "cap"), "cap is a patch"),
        (lambda s: edits.add_patch(s, FINDER, name="cap"), "already a group called cap"),
        (lambda s: edits.add_patch(s, FINDER, around="x"), "no curve called x"),
    ],
)
def test_what_cannot_be_done_is_said_in_words(session, edit, words):
    with pytest.raises(LandmarkError, match=words):
        edit(session)


def test_undoing_everything_is_the_start(session, plain):
    editor = Editor(plain)
    steps = [
        lambda s: edits.add_curve(s, session.group("crest").handles, FINDER, name="crest")[0],
        lambda s: edits.set_count(s, "crest", 9, FINDER),
        lambda s: edits.rename(s, "p2", "apex"),
        lambda s: edits.remove(s, ["p7"]),
        lambda s: edits.move_handle(s, "crest", 1, SOURCE, on_source(2, 2)),
        lambda s: edits.exclude_points(s, "crest", [3]),
        lambda s: edits.add_patch(s, FINDER, count=9)[0],
        lambda s: edits.mirror_source(s, "y"),
        lambda s: edits.remove_groups(s, ["crest"]),
    ]
    states = [plain]
    for step in steps:
        editor.commit(step(editor.session), "step")
        states.append(editor.session)
    for state in states[-2::-1]:
        editor.undo()
        assert editor.session == state
    while editor.redo_label is not None:
        editor.redo()
    assert editor.session == states[-1]


# Their warp


def test_the_warp_passes_through_landmarks_and_all_that_came_to_rest(session, plain):
    result = WarpSolver().solve(WarpInputs.of(session))
    assert result.not_sliding is None
    assert not result.residuals.any()
    for group in result.semilandmarks.groups:
        used = ~group.is_freed
        carried = result.spline.evaluate(group.source[used])
        np.testing.assert_allclose(carried, group.positions[used], atol=1e-6)
    # Drawn curves aside, the points lie on the destination's surface.
    cap = result.semilandmarks.groups[2]
    assert ON_TRUTH.index.distances(cap.positions[~cap.is_freed]).max() < 1e-9
    alone = WarpSolver().solve(WarpInputs.of(plain))
    assert off_truth(result.spline) < off_truth(alone.spline)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda s: s.with_mesh(DESTINATION, None), "no destination mesh"),
        (lambda s: s.with_mesh(SOURCE, None), "no source mesh"),
        (lambda s: replace(s, landmarks=s.landmarks[:3]), "from 4 on"),
        (
            lambda s: edits.set_convention(edits.set_penalty(s, 1.0), PenaltyConvention.OPYNSIM),
            "regularising convention only",
        ),
        (lambda s: edits.set_basis(s, Basis.R2_LOG_R), "with the basis r only"),
    ],
)
def test_where_they_cannot_slide_the_warp_is_that_of_the_pairs_and_says_why(session, change, words):
    changed = change(session)
    result = WarpSolver().solve(WarpInputs.of(changed))
    assert words in result.not_sliding
    assert result.semilandmarks is None
    alone = WarpSolver().solve(WarpInputs.of(replace(changed, groups=())))
    np.testing.assert_array_equal(result.spline.weights, alone.spline.weights)


def test_a_point_at_the_place_of_a_landmark_takes_no_part(session):
    """A landmark is placed where a curve that is not anchored begins."""
    place = session.group("ring").handles[0].source
    there = as_position(truth(np.array([place]))[0])
    crowded = replace(session, landmarks=(*session.landmarks, Landmark("new", place, there)))
    result = WarpSolver().solve(WarpInputs.of(crowded))
    assert result.not_sliding is None
    assert result.semilandmarks.groups[1].numbers.tolist() == list(range(1, 12))


def test_the_same_session_slides_to_the_same_places(session):
    first, second = (WarpSolver().solve(WarpInputs.of(session)) for _ in range(2))
    for a, b in zip(first.semilandmarks.groups, second.semilandmarks.groups, strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)
