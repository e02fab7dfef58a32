"""The figures of a session, for people and for programs."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.io.meshes import read_mesh
from pinwarp.io.samples import sample_session
from pinwarp.session import edits
from pinwarp.session.importing.fit import Fit, fitted
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.session import Session

KEYS = {
    "pinwarp": str,
    "session": str,
    "unit": str,
    "warping_penalty": float,
    "penalty_convention": str,
    "components": str,
    "blend": float,
    "planar": bool,
    "basis": str,
    "flagged": bool,
    "rms_residual": float,
    "rms_leave_one_out": float,
    "flexibility": float,
    "suggested_penalty": (float, type(None)),
    "as_good": (list, type(None)),
    "folded_vertices": int,
    "distance": dict,
    "fitted": (int, type(None)),
    "suggested": int,
    "findings": list,
    "notes": list,
    "groups": list,
    "pairs": list,
}


@pytest.fixture
def session(study):
    return study / "study.pinwarp.csv"


def with_swapped_destinations(path):
    """Exchange two destinations in the file of a session."""
    session = read_session(path)
    marks = list(session.landmarks)
    a, b = marks[0].destination, marks[1].destination
    marks[:2] = [replace(marks[0], destination=b), replace(marks[1], destination=a)]
    write_session(path, replace(session, landmarks=tuple(marks)))


def figures(command, *arguments, exit_code=0):
    return json.loads(command("check", *arguments, "--json", exit_code=exit_code).stdout)


def test_the_figures_for_programs_have_names_and_types(pinwarp_command, session, study):
    destination = read_mesh(study / "s0.stl")
    write_session(session, replace(read_session(session), destination=destination))
    found = figures(pinwarp_command, session)
    assert list(found) == list(KEYS)
    for key, kind in KEYS.items():
        assert isinstance(found[key], kind), key
    assert list(found["distance"]) == ["mean", "rms", "percentile_95", "maximum"]
    assert 0 < found["distance"]["mean"] < 2
    assert [list(pair) for pair in found["pairs"]] == 8 * [
        ["name", "residual", "leave_one_out", "standardised", "spread"]
    ]
    assert found["rms_leave_one_out"] == pytest.approx(
        np.sqrt(np.mean([pair["leave_one_out"] ** 2 for pair in found["pairs"]]))
    )


def test_the_figures_for_people_are_a_table_and_sentences(pinwarp_command, session):
    words = pinwarp_command("check", session).stdout
    for expected in ("8 pairs, lengths in mm", "Left out", "p7", "RMS residual", "Flexibility"):
        assert expected in words
    assert "To the destination" not in words


def test_brackets_in_names_are_no_markup(pinwarp_command, session):
    opened = read_session(session)
    marks = (replace(opened.landmarks[0], name="[red]apex[/red]"), *opened.landmarks[1:])
    write_session(session, replace(opened, landmarks=marks))
    assert "[red]apex[/red]" in pinwarp_command("check", session).stdout


def test_swapped_pairs_are_flagged_and_fail_only_a_strict_check(pinwarp_command, session):
    assert not figures(pinwarp_command, session, "--strict")["flagged"]
    with_swapped_destinations(session)
    found = figures(pinwarp_command, session)
    assert found["flagged"]
    assert found["findings"][0]["flagged"]
    assert {"p0", "p1"} & {name for finding in found["findings"] for name in finding["landmarks"]}
    pinwarp_command("check", session)
    assert "! " in pinwarp_command("check", session, "--strict", exit_code=1).stdout


def test_the_affine_fit_has_an_infinite_penalty_that_json_can_say(pinwarp_command, session):
    write_session(session, edits.set_penalty(read_session(session), np.inf))
    assert figures(pinwarp_command, session)["warping_penalty"] == "inf"


def test_few_pairs_have_figures_that_are_not_known(pinwarp_command, session):
    opened = read_session(session)
    write_session(session, replace(opened, landmarks=opened.landmarks[:3]))
    found = figures(pinwarp_command, session)
    assert found["rms_leave_one_out"] is None
    assert [pair["leave_one_out"] for pair in found["pairs"]] == [None] * 3
    assert "not known" in pinwarp_command("check", session).stdout


def test_what_is_isolated_is_told_but_not_flagged(pinwarp_command, tmp_path):
    near = 50 * np.random.default_rng(0).normal(size=(24, 3))
    source = np.vstack([near, [[0, 0, 400]]])
    destination = source * [1.1, 0.9, 1] + 4 * np.sin(source / 30)
    marks = (
        Landmark(f"p{row}", as_position(a), as_position(b))
        for row, (a, b) in enumerate(zip(source, destination, strict=True))
    )
    session = tmp_path / "isolated.pinwarp.csv"
    write_session(session, Session(landmarks=tuple(marks)))
    found = figures(pinwarp_command, session, "--strict")
    assert {finding["kind"] for finding in found["findings"]} == {"isolated"}
    assert ["p24"] in [finding["landmarks"] for finding in found["findings"]]
    assert not found["flagged"]


def test_a_mesh_that_changed_or_went_away_is_mentioned(pinwarp_command, session, study):
    (study / "source.ply").write_bytes((study / "source.ply").read_bytes() + b"\n")
    assert "source.ply: It has changed since" in pinwarp_command("check", session).stdout
    (study / "source.ply").unlink()
    found = figures(pinwarp_command, session)
    assert found["folded_vertices"] is None
    assert "source.ply: It is not there" in found["notes"][0]


@pytest.mark.parametrize(
    ("text", "words"),
    [(None, "There is no such file"), ("nonsense\n", "not a pinwarp session")],
)
def test_what_is_no_session_is_told_on_one_line(pinwarp_command, tmp_path, text, words):
    path = tmp_path / "a.pinwarp.csv"
    if text is not None:
        path.write_text(text)
    outcome = pinwarp_command("check", path, exit_code=2)
    assert outcome.stderr.startswith("pinwarp: a.pinwarp.csv: ")
    assert words in outcome.stderr
    assert outcome.stderr.count("\n") == 1


def test_landmarks_in_another_frame_or_unit_are_flagged(pinwarp_command, tmp_path):
    path = tmp_path / "femur.pinwarp.csv"
    sample = read_session(sample_session())
    write_session(path, fitted(sample, Side.DESTINATION, Fit(flips=True)))
    outcome = pinwarp_command("check", path, "--strict", exit_code=1)
    assert "! The destination landmarks lie" in outcome.stdout
    assert "With x and y negated" in " ".join(outcome.stdout.split())
    write_session(path, sample)
    assert "another frame" not in pinwarp_command("check", path, "--strict").stdout


def test_a_warp_can_be_checked_with_another_basis(pinwarp_command, session):
    own, other = (
        json.loads(pinwarp_command("check", session, "--json", *options).stdout)
        for options in ((), ("--basis", "r2logr"))
    )
    assert (own["basis"], other["basis"]) == ("r", "r2logr")
    assert own["rms_leave_one_out"] != other["rms_leave_one_out"]
    assert "Basis" in pinwarp_command("check", session, "--basis", "r2logr").stdout
