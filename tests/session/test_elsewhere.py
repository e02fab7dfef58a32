"""Landmarks in another frame or unit than their mesh are told wherever a warp is judged."""

from __future__ import annotations

import re
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from pinwarp.core.findings import FindingKind, Severity
from pinwarp.core.groups import Curve, Handle
from pinwarp.core.landmarks import Side
from pinwarp.io.samples import sample_session
from pinwarp.session.importing.fit import Fit, fitted
from pinwarp.session.judging.check import check
from pinwarp.session.judging.different_units import different_units
from pinwarp.session.judging.elsewhere import MeshGuard, elsewhere
from pinwarp.session.judging.report import report_of
from pinwarp.session.keeping.files import read_session
from pinwarp.session.mesh_units import scale_side
from pinwarp.session.rulers import rulers_of
from pinwarp.session.session import Session
from pinwarp.session.view import LengthUnit
from pinwarp.session.warp.solved import solved

WAYS = [Fit(flips=True), Fit(factor=1000.0), Fit(factor=0.001), Fit(True, 1000.0)]


@pytest.fixture(scope="module")
def sample() -> Session:
    return read_session(sample_session())


@pytest.mark.parametrize("side", list(Side))
@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.action)
def test_the_way_back_is_found_and_flagged(sample: Session, side: Side, way: Fit) -> None:
    (found,) = check(fitted(sample, side, way)).elsewhere
    assert (found.side, found.fit.flips, found.fit.factor) == (side, way.flips, 1 / way.factor)
    assert found.severity is Severity.WRONG
    assert found.sentence.startswith(f"The {side.value} landmarks lie")


@pytest.mark.parametrize(
    ("way", "words"),
    [
        (
            WAYS[0],
            "With x and y negated (LPS to RAS or back) they lie on it: they are in another frame.",
        ),
        (WAYS[1], "Divided by 1,000 (mm to m) they lie on it: they are in another unit."),
        (WAYS[3], "they lie on it: they are in another frame and unit."),
    ],
)
def test_it_is_said_what_would_bring_them_onto_their_mesh(sample: Session, way, words) -> None:
    (found,) = elsewhere(fitted(sample, Side.SOURCE, way))
    assert found.sentence.endswith(words)


def test_what_lies_farther_than_any_bone_is_told_in_metres(sample: Session) -> None:
    (found,) = elsewhere(fitted(sample, Side.DESTINATION, Fit(factor=1000.0)))
    told = found.by(rulers_of(sample, LengthUnit.MM)).sentence
    assert re.search(r"lie \d+ m from their mesh", told), told


def test_a_mesh_that_no_reading_brings_near_is_told_but_not_wrong(sample: Session) -> None:
    away = tuple(
        x.placed(Side.DESTINATION, tuple(np.add(x.destination, 400).tolist())) for x in sample.pairs
    )
    checked = check(replace(sample, landmarks=away))
    (found,) = checked.elsewhere
    assert found.fit is None
    assert found.severity is Severity.WARNING
    assert not checked.is_flagged
    assert found.sentence.endswith("is it the one that they were placed on?")
    assert elsewhere(sample) == ()


def test_landmarks_crowded_beside_their_mesh_are_told(sample: Session) -> None:
    crowded = scale_side(sample, Side.SOURCE, 0.001)
    (found,) = elsewhere(replace(crowded, source=sample.source))
    assert found.side is Side.SOURCE


def test_meshes_in_different_units_are_a_remark_of_check_and_report(sample: Session) -> None:
    declined = scale_side(sample, Side.SOURCE, 0.001)
    checked = check(declined)
    (found,) = [x for x in checked.findings if x.finding.kind is FindingKind.UNITS]
    assert found.severity is Severity.REMARK
    assert "One seems to be in metres and the other in millimetres." in found.sentence
    report = report_of("femur", solved(declined), datetime(2024, 1, 1, tzinfo=UTC))
    assert found.sentence in report.findings
    assert different_units(scale_side(declined, Side.SOURCE, 1000.0)) == ()


def test_sizes_that_no_unit_explains_have_no_way_to_be_scaled(sample: Session) -> None:
    (found,) = different_units(scale_side(sample, Side.SOURCE, 1e-6))
    assert found.ways == ()
    assert found.sentence.endswith("across, in their own numbers.")


def test_a_check_is_flagged_and_says_so_first(sample: Session) -> None:
    checked = check(fitted(sample, Side.DESTINATION, Fit(flips=True)))
    assert checked.is_flagged
    assert checked.elsewhere[0] in checked.findings
    assert "elsewhere" in {x["kind"] for x in checked.as_json()["findings"]}
    assert not check(sample).is_flagged


def test_a_report_says_it_before_anything_else(sample: Session) -> None:
    turned = solved(fitted(sample, Side.SOURCE, Fit(flips=True)))
    report = report_of("femur", turned, datetime(2024, 1, 1, tzinfo=UTC))
    assert report.findings[0].startswith("The source landmarks lie")


def test_a_guard_measures_each_mesh_once(sample: Session) -> None:
    guard = MeshGuard()
    assert guard.look(sample) == ()
    turned = fitted(sample, Side.SOURCE, Fit(flips=True))
    assert guard.look(turned) == elsewhere(turned)
    assert guard.look(Session(landmarks=sample.landmarks)) == ()


def test_curves_without_a_landmark_are_looked_at_as_well(sample: Session) -> None:
    curve = Curve("rim", tuple(Handle(x.source) for x in sample.pairs))
    alone = replace(sample, landmarks=(), groups=(curve,))
    assert elsewhere(alone) == ()
    (found,) = elsewhere(fitted(alone, Side.SOURCE, Fit(flips=True)))
    assert found.sentence.startswith("The source curves and patches lie")
    assert found.fit.flips
