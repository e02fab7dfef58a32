"""Refined warps: kept with the session, in use while they belong to it, honest in figures."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest
from tests.core.bones import bone, landmarks, shape, truth

from pinwarp.core.components import Components
from pinwarp.core.curves import PathFinder
from pinwarp.core.errors import PinwarpError
from pinwarp.core.gathering import course_of, path_of
from pinwarp.core.groups import Curve, Handle
from pinwarp.core.landmarks import Landmark, Role, Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.core.readiness import InsideOutError
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import PenaltyConvention
from pinwarp.core.surface import Surface
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.session import edits
from pinwarp.session.judging.check import check
from pinwarp.session.judging.report import report_of
from pinwarp.session.judging.survey import Surveyor
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.outputs.exports import (
    session_coefficients,
    warped_mesh,
    warped_passengers,
)
from pinwarp.session.outputs.script import script_of
from pinwarp.session.session import Session
from pinwarp.session.warp.refined import (
    inputs_of,
    is_out_of_date,
    refinement_in_use,
    warp_in_words,
)
from pinwarp.session.warp.refining import RefinementOptions, refined_session, verified
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solved import solved
from pinwarp.session.warp.solver import WarpSolver

COARSE = RefinementOptions(smallest_feature=30.0)


@pytest.fixture(scope="module")
def begun(tmp_path_factory):
    """A session on two bones, not refined."""
    folder = tmp_path_factory.mktemp("bones")
    source = bone(16, 24)
    write_mesh(folder / "source.ply", source)
    write_mesh(folder / "destination.ply", source.with_vertices(truth(source.vertices)))
    u = landmarks(8)
    pairs = tuple(
        Landmark(f"p{i}", as_position(a), as_position(b))
        for i, (a, b) in enumerate(zip(u, truth(u), strict=True))
    )
    muscle = Landmark("muscle", as_position(landmarks(30)[-1]), role=Role.PASSENGER)
    return Session(
        read_mesh(folder / "source.ply"),
        read_mesh(folder / "destination.ply"),
        (*pairs, muscle),
    )


@pytest.fixture(scope="module")
def refined(begun):
    session, _ = refined_session(begun, COARSE)
    return session


def distance(session):
    found = check(session).distance
    assert found is not None
    return found.mean


def test_a_refined_session_warps_closer_and_meets_every_landmark(begun, refined):
    assert replace(refined, refinement=None) == begun
    assert distance(refined) < 0.6 * distance(begun)
    checked = check(refined)
    assert checked.fitted == len(refined.refinement.source) - 8
    assert checked.rms_residual == 0
    assert checked.folded_vertices == 0
    assert "refined" in warp_in_words(refined)


def test_its_figures_of_pairs_are_those_of_the_landmarks(begun, refined):
    before, after = check(begun), check(refined)
    assert [x.leave_one_out for x in before.pairs] == [x.leave_one_out for x in after.pairs]
    assert before.suggested_penalty == after.suggested_penalty


def test_the_window_and_the_exports_show_the_same_refined_warp(refined):
    result = WarpSolver().solve(WarpInputs.of(refined))
    assert result.spline is not None
    assert result.vertices is not None
    exported = warped_mesh(refined).vertices
    np.testing.assert_array_equal(result.spline.weights, solved(refined).applied.weights)
    assert np.abs(result.vertices - exported + _centre(result, exported)).max() < 1e-2
    assert len(warped_passengers(refined)) == 1


def _centre(result, exported):
    """Previews may be about another centre; what matters is the shape."""
    return np.mean(exported - result.vertices, axis=0)


def test_a_saved_session_opens_with_the_same_warp_to_the_last_bit(refined, tmp_path):
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, refined)
    opened = read_session(path)
    assert opened.refinement == refined.refinement
    assert refinement_in_use(opened) is not None
    np.testing.assert_array_equal(warped_mesh(opened).vertices, warped_mesh(refined).vertices)


def test_refining_again_gives_the_same_to_the_last_bit(begun, refined):
    again, _ = refined_session(begun, COARSE)
    assert again.refinement == refined.refinement


@pytest.mark.parametrize(
    "change",
    [
        lambda s: edits.move(s, "p3", Side.DESTINATION, (1.0, 2.0, 3.0)),
        lambda s: edits.set_penalty(s, 0.5),
        lambda s: s.with_mesh(Side.SOURCE, replace(s.source, sha256="other")),
        lambda s: replace(s, landmarks=s.landmarks[1:]),
    ],
)
def test_a_change_puts_it_out_of_date_and_the_landmarks_warp_again(refined, change):
    changed = change(refined)
    assert is_out_of_date(changed)
    plain = replace(changed, refinement=None)
    np.testing.assert_array_equal(warped_mesh(changed).vertices, warped_mesh(plain).vertices)
    checked = check(changed)
    assert checked.fitted is None
    assert any("out of date" in note for note in checked.notes)
    assert changed.refinement == refined.refinement


def test_what_it_does_not_depend_on_leaves_it_in_use(refined):
    renamed = edits.rename(refined, "p3", "apex")
    parts = edits.set_components(renamed, Components.WITHOUT_POSE)
    assert refinement_in_use(parts) is not None
    # And back again: whoever undoes a move has the refined warp.
    moved = edits.move(refined, "p3", Side.DESTINATION, (1.0, 2.0, 3.0))
    back = edits.move(moved, "p3", Side.DESTINATION, refined.landmark("p3").destination)
    assert refinement_in_use(back) is not None


def test_dragging_a_landmark_of_a_refined_session_shows_the_landmarks_own_warp(refined):
    solver = WarpSolver()
    solver.solve(WarpInputs.of(refined))
    place = tuple(np.add(refined.landmark("p3").destination, 2.0).tolist())
    moved = edits.move(refined, "p3", Side.DESTINATION, place)
    dragged = solver.preview(WarpInputs.of(moved)).vertices
    expected = WarpSolver().solve(WarpInputs.of(replace(moved, refinement=None))).vertices
    np.testing.assert_allclose(dragged, expected, atol=1e-3)


def test_a_penalty_dragged_back_shows_the_refined_warp_again(refined):
    solver = WarpSolver()
    solver.solve(WarpInputs.of(refined))
    solver.preview(WarpInputs.of(edits.set_penalty(refined, 5.0)))
    back = solver.preview(WarpInputs.of(edits.set_penalty(refined, 0.0))).vertices
    expected = WarpSolver().solve(WarpInputs.of(refined)).vertices
    np.testing.assert_allclose(back, expected, atol=1e-3)


def test_parts_of_a_refined_warp_are_the_fits_of_the_landmarks(begun, refined):
    for part in (Components.RIGID, Components.AFFINE):
        fits = [
            solved(edits.set_components(session, part)).applied.affine
            for session in (begun, refined)
        ]
        np.testing.assert_array_equal(*fits)


def test_coefficients_name_what_was_fitted(refined):
    found = session_coefficients(refined)
    assert len(found.names) == len(found.spline.source)
    assert found.names[7:9] == ("p7", "fitted_1")
    taken = session_coefficients(edits.rename(refined, "p0", "fitted_1"))
    assert len(set(taken.names)) == len(found.names)


def test_a_script_of_a_refined_session_writes_the_same_mesh(refined, tmp_path, monkeypatch):
    script = tmp_path / "warp.py"
    script.write_text(script_of(refined, tmp_path))
    exec(compile(script.read_text(), script, "exec"), {"__file__": str(script)})
    written = read_mesh(tmp_path / "source_warped.ply").mesh.vertices
    np.testing.assert_allclose(written, warped_mesh(refined).vertices, atol=1e-4)
    with pytest.raises(PinwarpError, match="in full"):
        script_of(edits.set_components(refined, Components.RIGID), tmp_path)


def test_the_report_says_what_was_fitted_and_that_a_distance_proves_nothing(begun, refined):
    def words(session):
        made = report_of("bone", solved(session), datetime(2026, 1, 2))
        return f"{made.facts} {made.remarks}"

    assert "proves nothing" not in words(begun)
    assert "proves nothing" in words(refined)
    assert "places fitted to the destination" in words(refined)
    assert "out of date" in words(edits.set_penalty(refined, 1.0))


def test_folds_of_a_refined_warp_name_landmarks_only(refined):
    mesh = bone(16, 24)
    crossed = list(refined.refinement.destination)
    crossed[20:60] = crossed[20:60][::-1]
    worse = replace(refined.refinement, destination=tuple(crossed))
    session = replace(refined, refinement=worse)
    checked = check(session)
    assert checked.folded_vertices
    survey = Surveyor().survey(WarpSolver().solve(WarpInputs.of(session)), mesh, None)
    rows = [row for finding in survey.findings for row in finding.rows]
    assert all(row < 8 for row in rows)


def test_checking_leaves_each_landmark_out_and_refines_anew(refined):
    seen = []
    found = verified(refined, progress=lambda share, words: seen.append((share, words)))
    assert found.names == tuple(f"p{i}" for i in range(8))
    assert found.judged == 8
    assert found.rms()[1] < found.rms()[0]
    assert found.improved >= 4
    assert [share for share, _ in seen] == sorted(share for share, _ in seen)
    assert "landmark 8 of 8" in seen[-1][1]
    # One of them by hand.
    rest = replace(refined, landmarks=refined.landmarks[1:], refinement=None)
    alone, _ = refined_session(rest, COARSE)
    missed = solved(alone).applied.evaluate([refined.landmarks[0].source])[0]
    expected = np.linalg.norm(missed - refined.landmarks[0].destination)
    assert abs(found.after[0] - expected) < 1e-9


def turned(file):
    return replace(file, mesh=Mesh(file.mesh.vertices, file.mesh.faces[:, ::-1]))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda s: replace(s, destination=None), "no destination mesh: open the bone"),
        (lambda s: replace(s, source=None), "no source mesh"),
        (lambda s: replace(s, landmarks=s.landmarks[:3]), "from 4 on: place more"),
        (lambda s: replace(s, landmarks=()), "no pairs"),
        (lambda s: edits.set_penalty(s, np.inf), "infinite penalty"),
        (
            lambda s: replace(s, settings=WarpSettings(1.0, PenaltyConvention.OPYNSIM)),
            "OPYNSIM",
        ),
        (
            lambda s: replace(s, landmarks=(*s.landmarks, replace(s.landmarks[2], name="again"))),
            "p2 and again lie at one place",
        ),
        (
            lambda s: replace(
                s,
                landmarks=tuple(
                    x.placed(Side.SOURCE, np.multiply(x.source, [-1, 1, 1])) for x in s.landmarks
                ),
            ),
            "mirror one of the meshes",
        ),
        (lambda s: s.with_mesh(Side.DESTINATION, turned(s.destination)), "inside out"),
    ],
)
def test_what_cannot_be_refined_is_refused_in_words(begun, change, words):
    with pytest.raises(PinwarpError, match=words):
        refined_session(change(begun), COARSE)


def test_an_inside_out_mesh_is_taken_the_other_way_round_by_choice(begun, refined):
    session = begun.with_mesh(Side.SOURCE, turned(begun.source))
    with pytest.raises(InsideOutError, match="most likely the source"):
        refined_session(session, COARSE)
    chosen, _ = refined_session(session, replace(COARSE, turn_destination=True))
    assert distance(chosen) < 0.6 * distance(begun)
    assert chosen.refinement.turn_destination


def test_four_pairs_can_be_refined_but_none_left_out(begun):
    four = replace(begun, landmarks=begun.landmarks[:4])
    refined_session(four, COARSE)
    with pytest.raises(PinwarpError, match="none can be left out"):
        verified(four, COARSE)


def test_the_sessions_penalty_is_the_landmarks_tolerance_unless_told_otherwise(begun):
    soft = edits.set_penalty(begun, 5.0)
    assert refined_session(soft, COARSE)[0].refinement.landmark_tolerance == 5.0
    strict = refined_session(soft, replace(COARSE, landmark_tolerance=0.0))[0]
    assert strict.refinement.landmark_tolerance == 0.0
    assert check(strict).rms_residual < 1e-9


def test_a_curve_drawn_on_both_bones_is_kept_to_and_its_change_puts_out_of_date(begun):
    finders = {side: PathFinder(Surface(begun.mesh(side))) for side in Side}
    angles, heights = np.full(3, 0.4), np.array([0.8, 1.2, 1.6])
    handles = [Handle(as_position(place)) for place in shape(angles, heights)]
    ghost, _ = edits.add_curve(begun, handles, finders[Side.SOURCE], count=9)
    # Somebody saw the crest a little further round than the surface alone would take it.
    there = truth(shape(angles + 0.15, heights))
    drawn = edits.accept_curve(ghost, "curve_1", [as_position(place) for place in there])
    kept, found = refined_session(drawn, COARSE)
    free, _ = refined_session(ghost, COARSE)
    assert found.fitted == len(kept.refinement.source) - len(begun.pairs)
    course = course_of(drawn.group("curve_1"), finders[Side.SOURCE])
    path = path_of(drawn.group("curve_1"), finders[Side.DESTINATION], Side.DESTINATION)
    misses = []
    for session in (kept, free):
        carried = solved(session).applied.evaluate(course.points)
        misses.append(np.linalg.norm(carried - path.closest(carried)[0], axis=1).max())
    assert misses[0] < 0.1 * misses[1]
    assert solved(kept).residuals.max() < 1e-9
    assert refinement_in_use(kept) is not None
    assert is_out_of_date(edits.set_count(kept, "curve_1", 4, finders[Side.SOURCE]))
    assert is_out_of_date(edits.exclude_points(kept, "curve_1", [4]))
    assert refinement_in_use(edits.rename_group(kept, "curve_1", "crest")) is not None
    # A curve that is only a ghost does not act on it.
    assert refinement_in_use(edits.remove_groups(free, ["curve_1"])) is not None


def test_what_the_landmark_at_a_drawn_curve_is_called_does_not_matter(begun):
    ends = begun.pairs[:2]
    handles = tuple(Handle(end.source, end.destination, end.name) for end in ends)
    curve = Curve("crest", handles, drawn=True)
    drawn = replace(begun, groups=(curve,))
    assert inputs_of(edits.rename(drawn, ends[0].name, "apex")) == inputs_of(drawn)
    # Its other end is another landmark, though at the same place.
    loose = replace(curve, handles=(handles[0], replace(handles[1], landmark="")))
    assert inputs_of(replace(begun, groups=(loose,))) != inputs_of(drawn)


def test_leaving_out_an_anchor_leaves_out_its_curve(begun):
    """The curve ends in the landmark's destination: it would tell what is to be predicted."""
    finders = {side: PathFinder(Surface(begun.mesh(side))) for side in Side}
    ends = begun.pairs[:2]
    handles = [Handle(end.source, landmark=end.name) for end in ends]
    ghost, _ = edits.add_curve(begun, handles, finders[Side.SOURCE], count=3)
    drawn = edits.accept_curve(ghost, "curve_1", [end.destination for end in ends])
    rough = RefinementOptions(smallest_feature=60.0)
    plain, with_curve = verified(begun, rough), verified(drawn, rough)
    np.testing.assert_array_equal(with_curve.after[:2], plain.after[:2])
    assert (with_curve.after[2:] != plain.after[2:]).all()
