"""Landmarks in another frame or unit than their mesh are told wherever a warp is judged."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest

from pinwarp.core.findings import Severity
from pinwarp.core.landmarks import Side
from pinwarp.io.samples import sample_session
from pinwarp.session.importing.fit import Fit, fitted
from pinwarp.session.judging.check import check
from pinwarp.session.judging.elsewhere import MeshGuard, elsewhere
from pinwarp.session.judging.report import report_of
from pinwarp.session.keeping.files import read_session
from pinwarp.session.session import Session
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
