"""How precisely landmarks were digitised, for people and for programs."""

from __future__ import annotations

import json

import numpy as np
import pytest

from pinwarp.core.landmarks import Side
from pinwarp.io.landmark_files import write_landmarks
from pinwarp.io.samples import sample_session
from pinwarp.session.keeping.files import read_session, write_session


@pytest.fixture
def files(tmp_path):
    """Three repeats of the sample's destination, in three formats, and its session."""
    session = read_session(sample_session())
    rng = np.random.default_rng(0)
    paths = [tmp_path / name for name in ("a.csv", "b.fcsv", "c.pp")]
    for path in paths:
        marks = [
            x.placed(Side.DESTINATION, np.add(x.destination, 0.4 * rng.normal(size=3)))
            for x in session.pairs
        ]
        write_landmarks(path, marks, Side.DESTINATION, unit="mm")
    write_session(tmp_path / "femur.pinwarp.csv", session)
    return tmp_path


def test_the_worst_come_first_and_the_pooled_spread_below(pinwarp_command, files):
    outcome = pinwarp_command("repeat", files / "a.csv", files / "b.fcsv", files / "c.pp")
    assert "16 landmarks in 3 repeats: the 10 worst" in outcome.stdout
    assert "Pooled spread" in outcome.stdout
    assert "Penalty" not in outcome.stdout
    spreads = [
        float(line.split("│")[3]) for line in outcome.stdout.splitlines() if line.startswith("│")
    ]
    assert len(spreads) == 10
    assert spreads == sorted(spreads, reverse=True)
    whole = pinwarp_command("repeat", files / "a.csv", files / "b.fcsv", "--all").stdout
    assert sum(line.startswith("│") for line in whole.splitlines()) == 16


def test_figures_for_a_program_hold_the_penalty_of_the_session(pinwarp_command, files):
    words = ("repeat", files / "a.csv", files / "b.fcsv", files / "c.pp", "--json")
    asked = ("--session", files / "femur.pinwarp.csv", "--side", "destination")
    found = json.loads(pinwarp_command(*words, *asked).stdout)
    low, high = found["spread_interval"]
    assert low < 0.4 * 3**0.5 < high
    assert found["degrees_of_freedom"] == 96
    assert sum(found["axis_shares"]) == pytest.approx(1)
    assert found["penalty"]["interval"][0] < found["penalty"]["penalty"]
    assert len(found["landmarks"]) == 16
    assert json.loads(pinwarp_command(*words).stdout)["penalty"] is None


def test_a_session_is_a_repeat_too_and_says_the_penalty(pinwarp_command, files):
    session = files / "femur.pinwarp.csv"
    refused = pinwarp_command("repeat", session, files / "a.csv", exit_code=2)
    assert "holds both sides" in refused.stderr
    outcome = pinwarp_command("repeat", session, files / "a.csv", "--side", "destination")
    assert "Penalty for this noise" in outcome.stdout


def test_spreads_are_kept_with_a_session_when_asked_and_told_by_check(pinwarp_command, files):
    session = files / "femur.pinwarp.csv"
    before = session.read_bytes()
    words = ("repeat", files / "a.csv", files / "b.fcsv", "--session", session)
    assert "Which side" in pinwarp_command(*words, exit_code=2).stderr
    pinwarp_command(*words, "--side", "destination")
    assert session.read_bytes() == before
    assert "Left out / spread" not in pinwarp_command("check", session).stdout
    pinwarp_command(*words, "--side", "destination", "--keep")
    assert all(x.destination_spread is not None for x in read_session(session).pairs)
    figures = json.loads(pinwarp_command("check", session, "--json").stdout)
    assert figures["pairs"][0]["spread"] > 0
    refused = pinwarp_command("repeat", files / "a.csv", files / "b.fcsv", "--keep", exit_code=2)
    assert "say which by --session" in refused.stderr


def test_what_is_wrong_with_the_files_is_told_on_one_line(pinwarp_command, files):
    metres = files / "metres.csv"
    marks = read_session(sample_session(), meshes=()).pairs
    scaled = [x.placed(Side.DESTINATION, np.multiply(x.destination, 0.001)) for x in marks]
    write_landmarks(metres, scaled, Side.DESTINATION)
    refused = pinwarp_command("repeat", files / "a.csv", metres, exit_code=2)
    assert "--adapt does that" in refused.stderr
    adapted = pinwarp_command("repeat", files / "a.csv", metres, "--adapt")
    assert "multiplied by 1,000 (m to mm)" in adapted.stderr
    for wrong, reason in (
        (("a.csv",), "nothing to compare with"),
        (("a.csv", "a.csv"), "given twice"),
        (("a.csv", "nowhere.csv"), "nowhere.csv"),
    ):
        told = pinwarp_command("repeat", *(files / x for x in wrong), exit_code=2).stderr
        assert reason in told
        assert len(told.splitlines()) == 1
