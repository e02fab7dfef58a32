"""A session is solved once for all that leaves it."""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest
from tests.session.study import make_study

from pinwarp.core import factor as factors
from pinwarp.core import jacobian, kernel, spline, surface_distance
from pinwarp.core.components import Components
from pinwarp.core.errors import PinwarpError
from pinwarp.core.findings import Finding, FindingKind, Severity, gravest_first
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.manifest import read_manifest
from pinwarp.io.meshes import read_mesh
from pinwarp.session import edits
from pinwarp.session.judging import quality as judging
from pinwarp.session.judging.check import check
from pinwarp.session.judging.mesh_data import warped_mesh_data
from pinwarp.session.judging.report import report_of
from pinwarp.session.keeping.files import read_session
from pinwarp.session.outputs.exports import (
    session_coefficients,
    warped_landmarks,
    warped_mesh,
    warped_passengers,
)
from pinwarp.session.session import Session
from pinwarp.session.study.batch import plan
from pinwarp.session.study.subject import warp_subject
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solved import NO_PAIR, solved
from pinwarp.session.warp.solver import WarpSolver

MADE = datetime(2026, 11, 22, 14, 3)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return make_study(tmp_path_factory.mktemp("study"), 2).parent


@pytest.fixture
def session(study) -> Session:
    session = read_session(study / "study.pinwarp.csv")
    return edits.set_mesh(session, Side.DESTINATION, read_mesh(study / "s0.stl"))


@pytest.fixture
def counted(monkeypatch) -> Counter[str]:
    """How often something dear is done, wherever it is called from."""
    counts: Counter[str] = Counter()

    def count(module, name: str, what: str, when=lambda *_arguments: True) -> None:
        original = getattr(module, name)

        def counting(*arguments, **options):
            counts[what] += bool(when(*arguments))
            return original(*arguments, **options)

        for other in [x for key, x in sys.modules.items() if key.startswith("pinwarp")]:
            if getattr(other, name, None) is original:
                monkeypatch.setattr(other, name, counting)

    def is_mesh(*arguments) -> bool:
        return any(isinstance(one, np.ndarray) and len(one) > 50 for one in arguments)

    count(factors, "factorise", "factorisations")
    count(spline, "solve_values", "solves")
    count(kernel, "evaluate", "warps of the mesh", is_mesh)
    count(jacobian, "jacobians", "derivatives of the mesh", is_mesh)
    count(surface_distance, "SurfaceIndex", "indexes")
    count(judging, "quality_of", "judgements")
    return counts


def test_one_subject_of_a_batch_is_factorised_solved_and_warped_once(study, tmp_path, counted):
    manifest = read_manifest(study / "study.csv")
    source = read_session(study / "study.pinwarp.csv", meshes=[Side.SOURCE])
    task = plan(manifest, source, tmp_path)[1]
    counted.clear()
    outcome = warp_subject(task)
    assert outcome.error == ""
    assert outcome.check.distance is not None
    assert task.passengers.is_file()
    # The second solve is that of the affine fit, which the pairs are judged by.
    assert counted == {
        "factorisations": 1,
        "solves": 2,
        "warps of the mesh": 1,
        "derivatives of the mesh": 1,
        # Of the destination, and of the source once for all subjects of a process.
        "indexes": 2,
        "judgements": 1,
    }


def test_all_that_leaves_a_session_leaves_one_solved_warp(session, counted):
    warp = solved(session)
    warped_mesh(warp), warped_landmarks(warp), warped_passengers(warp), session_coefficients(warp)
    warped_mesh_data(warp)
    assert (counted["factorisations"], counted["solves"], counted["warps of the mesh"]) == (1, 1, 1)
    check(warp)
    report_of("bone", warp, MADE)
    assert counted["factorisations"] == counted["warps of the mesh"] == 1


def test_what_the_window_has_solved_is_not_solved_again(session, counted):
    result = WarpSolver().solve(WarpInputs.of(session))
    quality = judging.quality_of(result)
    before = counted.copy()
    warp = solved(session, result)
    assert warp.result is result
    report_of("bone", warp, MADE, quality=quality)
    for what in ("factorisations", "solves", "judgements"):
        assert counted[what] == before[what], what


@pytest.mark.parametrize("stale", ["result", "quality"])
def test_what_the_window_has_of_another_session_is_not_taken(session, stale):
    expected = report_of("bone", solved(session), MADE)
    other = WarpSolver().solve(WarpInputs.of(edits.set_penalty(session, 5.0)))
    if stale == "result":
        taken = report_of("bone", solved(session, other), MADE)
    else:
        taken = report_of("bone", solved(session), MADE, quality=judging.quality_of(other))
    assert taken == expected


def test_a_preview_under_way_is_not_exported(session):
    """The worker's last result may be of a drag, which the committed session knows nothing of."""
    dragged = edits.move(session, "p0", Side.DESTINATION, (0.0, 0.0, 0.0))
    result = WarpSolver().preview(WarpInputs.of(dragged))
    assert np.array_equal(
        warped_mesh(solved(session, result)).vertices, warped_mesh(session).vertices
    )


@pytest.mark.parametrize("components", Components)
@pytest.mark.parametrize("blend", [1.0, 0.5])
def test_a_solved_warp_is_the_same_in_every_figure(session, components, blend):
    session = edits.set_blend(edits.set_components(session, components), blend)
    warp = solved(session)
    data, checked = warped_mesh_data(warp), check(warp)
    report = {(x.section, x.item, x.quantity): x.value for x in report_of("b", warp, MADE).figures}
    distance = data.scalars["distance_mm"][session.mesh(Side.SOURCE).on_surface]
    assert checked.distance.maximum == distance.max()
    assert report["Distances", "source to destination", "maximum"] == distance.max()
    assert report["Folds", "vertices", "folded"] == checked.folded_vertices
    assert checked.folded_vertices == np.count_nonzero(data.scalars["det_j"] <= 0)
    residuals = [pair.residual for pair in checked.pairs]
    assert residuals == [report["Pairs", pair.name, "residual"] for pair in checked.pairs]
    assert checked.rms_residual == warp.result.rms_residual
    assert np.array_equal(
        session_coefficients(warp).spline.evaluate(warp.source.vertices), warp.mesh.vertices
    )


def test_without_pairs_or_meshes_it_says_what_is_missing(session):
    with pytest.raises(PinwarpError, match=NO_PAIR):
        solved(replace(session, landmarks=()))
    with pytest.raises(PinwarpError, match="no source mesh"):
        warped_mesh(replace(session, source=None))
    with pytest.raises(PinwarpError, match="no passenger"):
        warped_passengers(replace(session, landmarks=session.pairs))
    alone = solved(replace(session, source=None, destination=None))
    assert (alone.folds, alone.distances(), alone.comparison) == (None, None, None)


def test_a_solve_that_fails_says_why():
    far = tuple(Landmark(f"p{i}", (i * 1e307, 0, i % 2), (0, 0, 0)) for i in range(3))
    with pytest.raises(PinwarpError) as caught:
        solved(Session(landmarks=far))
    assert NO_PAIR not in str(caught.value)


def test_a_part_is_not_exported_with_the_pose_that_is_drawn(session):
    warp = solved(edits.set_components(session, Components.WITHOUT_POSE))
    assert not np.allclose(warp.mesh.vertices, warp.drawn_mesh.vertices, atol=1)
    assert solved(session).mesh is not warp.mesh
    whole = solved(session)
    assert whole.drawn_mesh is whole.mesh


# One severity


def test_every_kind_of_finding_has_one_severity():
    wrong = {kind for kind in FindingKind if kind.severity is Severity.WRONG}
    assert wrong == {
        FindingKind.MIRRORED,
        FindingKind.SWAPPED,
        FindingKind.DISPLACED,
        FindingKind.EITHER,
        FindingKind.ELSEWHERE,
        FindingKind.CONFLICT,
        FindingKind.FOLD,
    }
    assert {kind for kind in FindingKind if kind.severity is Severity.REMARK} == {
        FindingKind.WORTH_A_LOOK,
        FindingKind.ISOLATED,
        FindingKind.ACCEPTED,
        FindingKind.UNITS,
    }


def test_the_same_severity_orders_findings_flags_them_and_makes_them_grave(session):
    swapped = edits.swap_destinations(session, "p1", "p5")
    checked = check(swapped)
    severities = [named.severity for named in checked.findings]
    assert severities == sorted(severities, reverse=True)
    assert checked.is_flagged == (Severity.WRONG in severities)
    flags = [found["flagged"] for found in checked.as_json()["findings"]]
    assert flags == [severity is Severity.WRONG for severity in severities]
    kinds = [Finding(kind, (), 1.0) for kind in FindingKind]
    assert [one.is_grave for one in kinds] == [one.severity > Severity.REMARK for one in kinds]
    assert sorted(kinds, key=lambda one: -one.severity) == [*gravest_first(kinds)]
