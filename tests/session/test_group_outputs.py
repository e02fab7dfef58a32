"""What leaves a session with curves and patches is its warp, and says what slid."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest
from tests.session.study import add_groups, make_study

from pinwarp.core.components import Components
from pinwarp.core.errors import PinwarpError
from pinwarp.core.groups import Curve
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.maps import MapKind
from pinwarp.io.manifest import read_manifest
from pinwarp.io.meshes import read_mesh
from pinwarp.session import edits
from pinwarp.session.judging.check import check
from pinwarp.session.judging.mesh_data import warped_mesh_data
from pinwarp.session.judging.report import report_of
from pinwarp.session.judging.survey import Surveyor
from pinwarp.session.keeping.files import read_session
from pinwarp.session.outputs.exports import (
    session_coefficients,
    warped_landmarks,
    warped_mesh,
    warped_passengers,
)
from pinwarp.session.outputs.script import script_of
from pinwarp.session.outputs.semilandmarks import semilandmarks_on
from pinwarp.session.study.batch import plan
from pinwarp.session.study.subject import made_from, warp_subject
from pinwarp.session.warp.ghost import ghost_of
from pinwarp.session.warp.refining import RefinementOptions
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solved import solved
from pinwarp.session.warp.solver import WarpSolver


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("grouped") / "study"
    make_study(folder, 3)
    add_groups(folder)
    return folder


@pytest.fixture(scope="module")
def session(study):
    return read_session(study / "study.pinwarp.csv")


@pytest.fixture(scope="module")
def plain(session):
    return replace(session, groups=(), slid=None)


@pytest.fixture(scope="module")
def warp(session):
    return solved(session)


CHANGES = [
    lambda s: s,
    lambda s: edits.set_penalty(s, 3.0),
    lambda s: edits.set_components(s, Components.AFFINE),
    lambda s: edits.set_components(s, Components.RIGID),
    lambda s: edits.set_blend(edits.set_components(s, Components.WITHOUT_POSE), 0.5),
]


@pytest.mark.parametrize("change", CHANGES)
def test_what_is_exported_is_what_the_window_shows(session, change):
    changed = change(session)
    shown = WarpSolver().solve(WarpInputs.of(changed))
    found = solved(changed)
    np.testing.assert_allclose(found.drawn_mesh.vertices, shown.vertices, atol=1e-3)
    coefficients = session_coefficients(changed)
    carried = coefficients.spline.evaluate(changed.mesh(Side.SOURCE).vertices)
    np.testing.assert_array_equal(carried, warped_mesh(changed).vertices)
    assert len(coefficients.names) == len(coefficients.spline.source)


def test_the_warp_that_leaves_is_solved_from_landmarks_and_semilandmarks(session, plain, warp):
    alone = solved(plain)
    assert np.abs(warp.mesh.vertices - alone.mesh.vertices).max() > 0.1
    distances = [np.mean(x.distances()) for x in (warp, alone)]
    assert distances[0] < 0.8 * distances[1]
    met = [x.destination for x in warped_landmarks(warp)]
    np.testing.assert_allclose(met, [x.destination for x in session.pairs], atol=1e-6)
    rider = session.passengers[0].source
    (carried,) = warped_passengers(warp)
    np.testing.assert_allclose(carried.destination, warp.spline.evaluate([rider])[0])


def test_coefficients_name_every_point(session, warp):
    names = session_coefficients(warp).names
    assert names[:8] == tuple(pair.name for pair in session.pairs)
    assert {"ring_1", "ball_25"} <= set(names)
    assert len(set(names)) == len(names) == 8 + warp.result.semilandmarks.count
    taken = session_coefficients(edits.rename(session, "p0", "ball_1")).names
    assert len(set(taken)) == len(names)
    assert "ball_1_" in taken


@pytest.mark.parametrize("change", CHANGES)
def test_the_script_writes_the_same_mesh(session, study, change):
    changed = change(session)
    script = study / "warp.py"
    script.write_text(script_of(changed, study))
    exec(compile(script.read_text(), script, "exec"), {"__file__": str(script)})
    written = read_mesh(study / "source_warped.ply").mesh.vertices
    np.testing.assert_allclose(written, warped_mesh(changed).vertices, atol=1e-4)
    count = solved(changed).result.semilandmarks.count
    assert f"{8 + count} pairs, {count} of them semilandmarks" in script.read_text()


def test_the_report_and_the_check_count_what_slid(session, warp):
    made = report_of("ball", warp, datetime(2026, 1, 2))
    figures = {(x.section, x.item, x.quantity): x.value for x in made.figures}
    checked = check(warp)
    ring, ball = checked.groups
    assert (ring.kind, ring.drawn, ring.points) == ("closed curve", True, 9)
    assert (ball.kind, ball.drawn, ball.points) == ("patch", False, 25)
    assert ball.used + ball.freed == 25
    assert figures["Semilandmarks", "ring", "points"] == 9
    assert figures["Semilandmarks", "ball", "largest slide"] == ball.largest_slide > 0
    assert checked.fitted == ring.used + ball.used
    assert "proves little" in str(made.remarks)
    assert f"{checked.fitted} semilandmarks" in str(made.facts)
    assert checked.as_json()["groups"][0]["name"] == "ring"
    assert len(checked.pairs) == 8
    excluded = check(edits.exclude_points(session, "ball", [0, 3])).groups[1]
    assert (excluded.excluded, excluded.used + excluded.freed) == (2, 23)


def test_where_nothing_slides_it_is_said(session, plain):
    changed = replace(session, destination=None)
    checked = check(changed)
    assert checked.groups == ()
    assert checked.fitted is None
    assert any("no part in this warp" in note for note in checked.notes)
    made = report_of("ball", solved(changed), datetime(2026, 1, 2))
    assert "no part in this warp" in str(made.facts)
    np.testing.assert_array_equal(warped_mesh(changed).vertices, warped_mesh(plain).vertices)
    assert "semilandmarks" not in script_of(changed, changed.source.path.parent)


def test_read_at_rest_without_the_destination_it_is_the_same_warp(study, session):
    alone = read_session(study / "study.pinwarp.csv", meshes=[Side.SOURCE])
    np.testing.assert_allclose(
        warped_mesh(alone).vertices, warped_mesh(session).vertices, atol=1e-9
    )
    figures = check(alone).groups
    assert [x.used for x in figures] == [x.used for x in check(session).groups]
    assert check(alone).as_json()["groups"][1]["largest_slide"] is None


def test_the_doubt_of_a_warp_with_semilandmarks_is_that_of_its_pairs_and_not_exported(
    session, plain
):
    assert "deviation_mm" in warped_mesh_data(plain).scalars
    assert "deviation_mm" not in warped_mesh_data(session).scalars
    result = WarpSolver().solve(WarpInputs.of(session))
    target = session.mesh(Side.DESTINATION)
    # Map and disc are those of the landmarks alone; the map's title says so.
    seen, alone = (
        Surveyor().survey(warp, target, MapKind.UNCERTAINTY)
        for warp in (result, WarpSolver().solve(WarpInputs.of(plain)))
    )
    assert seen.is_fitted
    np.testing.assert_array_equal(seen.map.values, alone.map.values)
    halves = [edits.remove_side(each, "p3", Side.DESTINATION) for each in (session, plain)]
    slid, straight = (
        ghost_of(half.landmark("p3"), Side.DESTINATION, WarpSolver().solve(WarpInputs.of(half)))
        for half in halves
    )
    assert slid.position != straight.position
    assert 0 < slid.deviation == straight.deviation


# Many subjects


@pytest.fixture
def tasks(study, tmp_path):
    manifest = read_manifest(study / "study.csv")
    source = read_session(study / "study.pinwarp.csv", meshes=[Side.SOURCE])
    return plan(manifest, source, tmp_path)


def test_semilandmarks_slide_on_each_subject(tasks):
    for task in tasks:
        assert not any(x.is_drawn for x in task.session.groups if isinstance(x, Curve))
        outcome = warp_subject(task)
        assert outcome.error == ""
        assert [x.points for x in outcome.check.groups] == [9, 25]
        assert outcome.check.fitted > 25
        alone = warp_subject(replace(task, session=replace(task.session, groups=())))
        assert outcome.check.distance.mean < 0.8 * alone.check.distance.mean


def test_a_refined_batch_needs_no_slide(tasks):
    options = RefinementOptions()
    outcome = warp_subject(replace(tasks[1], refinement=options))
    assert outcome.error == ""
    assert outcome.check.groups == ()
    assert outcome.check.fitted > 100
    # Why nothing slid is told in words of its own.
    (told,) = [note for note in outcome.check.notes if "refined" in note.lower()]
    assert "landmarks alone" not in told


def test_a_changed_group_makes_subjects_again(tasks):
    task = tasks[1]
    changed = edits.exclude_points(task.session, "ball", [2])
    without = replace(task.session, groups=())
    hashes = {made_from(replace(task, session=x)) for x in (task.session, changed, without)}
    assert len(hashes) == 3
    assert made_from(task) == made_from(replace(task))


def test_a_subject_without_a_mesh_is_refused_before_the_night(study, tmp_path):
    manifest = study / "meshless.csv"
    manifest.write_text("name,destination_landmarks\ns1,s1.csv\n")
    source = read_session(study / "study.pinwarp.csv", meshes=[Side.SOURCE])
    with pytest.raises(PinwarpError, match=r"s1 has no destination_mesh.*slide on"):
        plan(read_manifest(manifest), source, tmp_path)


def test_a_subject_on_which_nothing_can_slide_fails_and_says_why(tasks):
    # Three landmarks determine no affine map.
    few = replace(
        tasks[1].session, landmarks=tasks[1].session.landmarks[:3], groups=tasks[1].session.groups
    )
    outcome = warp_subject(replace(tasks[1], session=few))
    assert "3 pairs" in outcome.error
    assert not tasks[1].mesh.exists()


# For other programs


def test_both_sides_have_the_same_rows(session, warp):
    there, left = semilandmarks_on(warp, Side.DESTINATION)
    here, _ = semilandmarks_on(warp, Side.SOURCE)
    assert [name for name, _ in here.places] == [name for name, _ in there.places]
    assert (here.curves, here.patches) == (there.curves, there.patches)
    assert here.landmarks == 8
    assert left[0] == "1 landmark that is a passenger or switched off: left out (muscle)."
    assert here.missing == 0
    assert there.missing == warp.result.semilandmarks.freed
    ring, ball = here.curves[0], here.patches[0]
    assert ring.points == tuple(range(8, 17))
    assert ball.points == tuple(range(17, 17 + len(ball.points)))
    carried = warp.spline.evaluate([place for _, place in here.places])
    for (_, place), expected in zip(there.places, carried, strict=True):
        assert place is None or np.allclose(place, expected, atol=1e-6)


def test_anchors_stand_among_the_points_of_their_curve(session):
    anchor = session.group("ring").handles[0]
    mark = Landmark("anchor", anchor.source, anchor.destination)
    handles = (replace(anchor, landmark="anchor"), *session.group("ring").handles[1:])
    groups = (replace(session.group("ring"), handles=handles),)
    changed = replace(session, landmarks=(*session.landmarks, mark), groups=groups)
    points, _ = semilandmarks_on(changed, Side.SOURCE)
    (ring,) = points.curves
    assert ring.rows[0] == 8
    assert points.places[8][0] == "anchor"
    assert set(ring.rows) - set(ring.points) == {8}
    assert len(ring.sliders) == 9


def test_without_semilandmarks_at_rest_there_is_nothing_to_write(session, plain):
    with pytest.raises(PinwarpError, match="no curves or patches"):
        semilandmarks_on(plain, Side.SOURCE)
    with pytest.raises(PinwarpError, match="no destination mesh"):
        semilandmarks_on(replace(session, destination=None), Side.SOURCE)
