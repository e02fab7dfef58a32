"""One model made that of many subjects by ``pinwarp model --subjects``."""

from __future__ import annotations

import csv

import numpy as np
import pytest
from tests.osim_kinematics import Kinematics
from tests.osim_models import copied_model, session_on, subject

from pinwarp.core.landmarks import Side
from pinwarp.io.landmark_files import write_landmarks
from pinwarp.session.keeping.files import write_session


def shaped(number):
    """Return the warp to a subject of a cohort."""
    return lambda places: subject(places) * (1 + 0.03 * number)


@pytest.fixture(scope="module")
def cohort(tmp_path_factory):
    """A model, a study of two bodies, and two subjects; ben has no landmarks of the shank."""
    folder = tmp_path_factory.mktemp("cohort")
    leg = copied_model("leg", folder)
    study = ["# pinwarp-model: 1", "# model: leg.osim", "body,session"]
    for body in ("thigh", "shank"):
        write_session(folder / f"{body}.pinwarp.csv", session_on(leg, body))
        study.append(f"{body},{body}.pinwarp.csv")
        for number, name in enumerate(("anna", "ben")):
            placed = session_on(leg, body, warp=shaped(number)).landmarks
            write_landmarks(folder / f"{name}_{body}.csv", placed, Side.DESTINATION)
    (folder / "leg.pinwarp-model.csv").write_text("\n".join(study) + "\n")
    (folder / "cohort.csv").write_text(
        "name,thigh,shank\nanna,anna_thigh.csv,anna_shank.csv\nben,ben_thigh.csv,\n"
    )
    return folder


def options(cohort, out, *more):
    return (
        *("model", cohort / "leg.pinwarp-model.csv", "--subjects", cohort / "cohort.csv"),
        *("-o", out, *more),
    )


def rows_of(out):
    with (out / "summary.csv").open(newline="") as file:
        return {row["name"]: row for row in csv.DictReader(file)}


def test_every_subject_gets_its_model_and_a_row(pinwarp_command, cohort, tmp_path):
    told = pinwarp_command(*options(cohort, tmp_path, "--jobs", 1))
    assert "2 done, 0 unchanged, 0 failed of 2" in told.stdout
    rows = rows_of(tmp_path)
    assert {name: row["pairs"] for name, row in rows.items()} == {"anna": "48", "ben": "24"}
    assert "shank stays generic" in rows["ben"]["notes"]
    before = Kinematics(cohort / "leg.osim")
    anna, ben = (Kinematics(tmp_path / f"{name}.osim") for name in ("anna", "ben"))
    knee, hip, ankle = "/markerset/KNEE", "/markerset/HIP", "/forceset/ham/path/ham-P3"
    lengths = [
        np.linalg.norm(model.point_in_body(knee) - model.point_in_body(hip))
        for model in (before, anna, ben)
    ]
    np.testing.assert_allclose(lengths[2] / lengths[1], 1.03, rtol=0.01)
    assert lengths[1] > 1.05 * lengths[0]
    assert (ben.point_in_body(ankle) == before.point_in_body(ankle)).all()
    assert (anna.point_in_body(ankle) != before.point_in_body(ankle)).any()


def test_a_second_run_does_only_what_is_missing_or_has_changed(pinwarp_command, cohort, tmp_path):
    run = options(cohort, tmp_path, "--jobs", 1)
    pinwarp_command(*run)
    assert "0 done, 2 unchanged" in pinwarp_command(*run).stdout
    (tmp_path / "ben.osim").unlink()
    assert "1 done, 1 unchanged" in pinwarp_command(*run).stdout
    assert "2 done, 0 unchanged" in pinwarp_command(*run, "--force").stdout


def test_one_that_fails_does_not_touch_the_others(pinwarp_command, cohort, tmp_path):
    manifest = cohort / "with_a_gap.csv"
    manifest.write_text("name,thigh\nanna,anna_thigh.csv\ncarl,gone.csv\ndora,\n")
    told = pinwarp_command(
        *("model", cohort / "leg.pinwarp-model.csv", "--subjects", manifest),
        *("-o", tmp_path, "--jobs", 1),
        exit_code=1,
    )
    assert "1 done, 0 unchanged, 2 failed of 3" in told.stdout
    assert "carl: with_a_gap.csv, line 3: The file" in told.stderr
    assert "dora: with_a_gap.csv, line 4: There are no landmarks of any body." in told.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        *("anna.osim", "anna_Geometry", "anna_report.csv", "summary.csv"),
    ]


def test_subjects_are_done_in_processes_of_their_own_as_in_this_one(
    pinwarp_command, cohort, tmp_path
):
    one, other = tmp_path / "one", tmp_path / "other"
    pinwarp_command(*options(cohort, one, "--jobs", 1))
    pinwarp_command(*options(cohort, other, "--jobs", 2))
    for name in ("anna", "ben"):
        assert (one / f"{name}.osim").read_bytes() == (other / f"{name}.osim").read_bytes()


@pytest.mark.parametrize("more", [["--dry-run"], ["--json"], ["--strict"]])
def test_what_is_of_one_model_is_refused_for_many(pinwarp_command, cohort, tmp_path, more):
    told = pinwarp_command(*options(cohort, tmp_path / "out", *more), exit_code=2)
    assert "of one model" in told.stderr
    assert not (tmp_path / "out").exists()


def test_a_malformed_address_is_refused_before_anything_is_read(pinwarp_command, cohort, tmp_path):
    out = tmp_path / "out"
    told = pinwarp_command(*options(cohort, out, "--scheduler", "tcp://node7"), exit_code=2)
    assert "'tcp://node7' is no address of a scheduler" in told.stderr
    assert not out.exists()
