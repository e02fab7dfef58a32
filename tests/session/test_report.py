"""What a report says about a session."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import numpy as np

from pinwarp.core.landmarks import Side, as_position
from pinwarp.io.report import write_report
from pinwarp.io.samples import sample_session
from pinwarp.session import edits
from pinwarp.session.judging.check import check
from pinwarp.session.judging.quality import judged_at
from pinwarp.session.judging.report import report_of
from pinwarp.session.keeping.files import read_session
from pinwarp.session.rulers import rulers_of
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solved import solved
from pinwarp.session.warp.solver import WarpSolver

MADE = datetime(2026, 11, 22, 14, 3)


def reported(session):
    return report_of("femur", solved(session), MADE)


def values(report, quantity):
    return {x.item: x.value for x in report.figures if x.quantity == quantity}


def test_a_report_names_meshes_hashes_penalty_and_date():
    session = read_session(sample_session())
    report = reported(edits.set_penalty(session, 2.5))
    facts = dict(report.facts)
    assert session.source.sha256 in facts["Source mesh"]
    assert session.destination.sha256 in facts["Destination mesh"]
    assert facts["Warping penalty"] == "2.5 mm"
    assert "22 November 2026 at 14:03" in report.made


def test_the_figures_are_those_of_the_warp():
    session = edits.set_penalty(read_session(sample_session()), 2.5)
    result = WarpSolver().solve(WarpInputs.of(session))
    report = reported(session)
    assert list(values(report, "residual").values()) == result.residuals.tolist()
    assert values(report, "folded") == {"vertices": 0}
    assert len(values(report, "maximum")) == 2


def test_a_swap_is_the_first_thing_to_check():
    session = read_session(sample_session())
    names = [pair.name for pair in session.pairs]
    swapped = edits.swap_destinations(session, names[2], names[9])
    first = reported(swapped).findings[0]
    assert names[2] in first
    assert names[9] in first
    assert "swapped" in first


def test_without_meshes_there_are_no_distances_but_all_else():
    session = read_session(sample_session(), meshes=())
    report = reported(session)
    assert values(report, "maximum") == {}
    assert np.isfinite(list(values(report, "left out").values())).all()
    assert "not found" in dict(report.facts)["Source mesh"]


def noisy(scale):
    """Return the sample with destinations that are some millimetres off."""
    session, random = read_session(sample_session()), np.random.default_rng(3)
    for pair in session.pairs:
        place = as_position(np.add(pair.destination, random.normal(scale=scale, size=3)))
        session = edits.move(session, pair.name, Side.DESTINATION, place)
    return session


def test_the_chart_shades_the_penalties_that_do_as_well_and_says_so():
    report = reported(noisy(1.5))
    assert "does as well" in dict(report.remarks)["Warping penalty"]
    assert "shaded" in dict(report.remarks)["Warping penalty"]
    assert 'fill-opacity="0.12"' in report.chart
    plain = reported(read_session(sample_session()))
    assert 'fill-opacity="0.12"' not in plain.chart


def test_where_pairs_are_judged_at_another_penalty_report_check_and_list_say_at_which(tmp_path):
    session = edits.set_penalty(noisy(1.5), 2.5)
    words = judged_at(session, rulers_of(session).session)
    assert "judged at penalty 0, not at 2.5 mm" in words
    report = reported(session)
    assert dict(report.remarks)["To check"] == words
    assert words in check(session).notes
    path = tmp_path / "a.html"
    write_report(path, report)
    assert words in path.read_text("utf-8")
    # What is found does not depend on the penalty of the warp.
    assert report.findings == reported(noisy(1.5)).findings
    assert dict(reported(noisy(1.5)).remarks)["To check"] == ""
    # Too few are not judged at all.
    few = replace(session, landmarks=session.pairs[:4])
    assert dict(reported(few).remarks)["To check"] == ""
    assert "judged at" not in " ".join(check(few).notes)
