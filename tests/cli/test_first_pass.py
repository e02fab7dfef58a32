"""A cohort's first pass: subjects that nobody has landmarked."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from tests.core.hooked import carried, hooked, places, subject
from tests.core.strategies import rotations

from pinwarp.core import first_guess
from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.io.landmark_files import LandmarkReading, write_landmarks
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.session import edits
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.session import Session
from pinwarp.session.study.subject import with_destinations

TURN = rotations(5)


@pytest.fixture
def cohort(tmp_path, monkeypatch):
    """A folder with a source, its landmarks, and four subjects' meshes."""
    monkeypatch.setattr(first_guess, "FINE", first_guess.COARSE)
    write_mesh(tmp_path / "source.ply", hooked())
    marks = [Landmark(f"p{k}", as_position(place)) for k, place in enumerate(places(12))]
    write_landmarks(tmp_path / "source.csv", marks, Side.SOURCE)
    write_mesh(tmp_path / "bare.ply", subject(hooked(), TURN))
    true = carried(places(12))
    known = [x.placed(Side.DESTINATION, y) for x, y in zip(marks, true, strict=True)]
    write_landmarks(tmp_path / "known.csv", known, Side.DESTINATION)
    write_landmarks(tmp_path / "some.csv", known[:5], Side.DESTINATION)
    write_mesh(tmp_path / "other.ply", subject(hooked()))
    ball = pv.Icosphere(radius=50.0, nsub=2)
    write_mesh(tmp_path / "ball.ply", Mesh(ball.points, ball.regular_faces))
    (tmp_path / "study.csv").write_text(
        "name,destination_landmarks,destination_mesh\n"
        "known,known.csv,other.ply\nbare,,bare.ply\nsome,some.csv,other.ply\nball,,ball.ply\n"
        "nothing,,\n"
    )
    return tmp_path


def run(pinwarp_command, folder, *options, exit_code=0):
    outcome = pinwarp_command(
        *("batch", folder / "study.csv", "-o", folder / "out", "--jobs", 1),
        *("--source", folder / "source.ply", "--source-landmarks", folder / "source.csv"),
        *options,
        exit_code=exit_code,
    )
    table = folder / "out" / "summary.csv"
    text = table.read_text(encoding="utf-8") if table.exists() else ""
    rows = list(csv.DictReader(text.splitlines()))
    return outcome, rows


def test_bare_subjects_are_warped_by_suggestions_and_doubtful_ones_come_first(
    pinwarp_command, cohort
):
    outcome, rows = run(pinwarp_command, cohort, "--suggest", "--mirror", "no", exit_code=1)
    assert "3 done, 0 unchanged, 2 failed of 5" in outcome.stdout
    assert [row["name"] for row in rows] == ["ball", "known", "bare", "some", "nothing"]
    by_name = {row["name"]: row for row in rows}
    ball, known, bare, some = (by_name[name] for name in ("ball", "known", "bare", "some"))
    assert (ball["status"], ball["verdict"]) == ("failed", "none")
    assert float(ball["misfit"]) > 0.03
    assert "three pairs" in ball["error"]
    assert "destination_mesh" in by_name["nothing"]["error"]
    assert (known["verdict"], known["suggested"]) == ("", "")
    assert (bare["verdict"], bare["suggested"], bare["pairs"]) == ("sure", "12", "12")
    assert "only suggested" in bare["findings"]
    assert float(bare["other_pose"]) > 1.3
    assert (some["verdict"], some["suggested"], some["pairs"]) == ("sure", "7", "12")
    warped = read_mesh(cohort / "out" / "bare_warped.ply").mesh
    off = np.linalg.norm(warped.vertices - carried(hooked().vertices, TURN), axis=1)
    assert np.median(off) < 5
    suggested = read_session(cohort / "out" / "bare.pinwarp.csv")
    assert all(pair.is_suggested for pair in suggested.pairs)
    # What is done is not done again; what is in doubt is tried again.
    again, _ = run(pinwarp_command, cohort, "--suggest", "--mirror", "no", exit_code=1)
    assert "0 done, 3 unchanged, 2 failed of 5" in again.stdout
    # What somebody made of the session is what counts from then on, and it stays.
    path = cohort / "out" / "bare.pinwarp.csv"
    seen = edits.confirm(suggested, "p0")
    write_session(path, edits.move(seen, "p1", Side.DESTINATION, (0.0, 0.0, 0.0)))
    worked_on = path.read_bytes()
    third, rows = run(pinwarp_command, cohort, "--suggest", "--mirror", "no", exit_code=1)
    assert "1 done, 2 unchanged, 2 failed of 5" in third.stdout
    assert {row["name"]: row["suggested"] for row in rows}["bare"] == "10"
    assert path.read_bytes() == worked_on
    write_session(path, edits.remove(seen, ["p1"]))
    fourth, _ = run(pinwarp_command, cohort, "--suggest", "--mirror", "no", exit_code=1)
    assert "bare.pinwarp.csv: The source has other landmarks by now" in fourth.stderr


def test_landmarks_that_come_from_a_file_as_suggested_stay_so():
    source = Session(landmarks=(Landmark("p0", (0.0, 0.0, 0.0)),))
    reading = LandmarkReading((Landmark("p0").suggested((1.0, 0.0, 0.0)),), False, ())
    session, _ = with_destinations(source, reading, Path("anna.csv"))
    assert session.landmark("p0").is_suggested


def test_without_being_asked_for_nothing_is_suggested(pinwarp_command, cohort):
    _, rows = run(pinwarp_command, cohort, exit_code=1)
    by_name = {row["name"]: row for row in rows}
    assert "--suggest" in by_name["bare"]["error"]
    assert by_name["some"]["pairs"] == "5"
    outcome, _ = run(pinwarp_command, cohort, "--mirror", "no", exit_code=2)
    assert "add --suggest" in outcome.stderr
