"""Refining on the command line."""

from __future__ import annotations

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from tests.cli.test_check import figures

from pinwarp.io.meshes import read_mesh
from pinwarp.session import edits
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.outputs.exports import warped_mesh
from pinwarp.session.warp.refined import refinement_in_use
from pinwarp.session.warp.refining import RefinementOptions, refined_session


@pytest.fixture
def session(study):
    path = study / "study.pinwarp.csv"
    destination = read_mesh(study / "s0.stl")
    write_session(path, replace(read_session(path), destination=destination))
    return path


def test_a_session_is_refined_in_place_and_its_last_version_kept(pinwarp_command, session):
    before = session.read_bytes()
    outcome = pinwarp_command("refine", session, "--feature", 30)
    assert "places fitted" in outcome.stdout
    assert "proves nothing" in outcome.stdout
    assert refinement_in_use(read_session(session)) is not None
    assert session.with_name(session.name + ".bak").read_bytes() == before


def test_the_command_gives_what_the_window_gives_bit_for_bit(pinwarp_command, session):
    expected, _ = refined_session(read_session(session), RefinementOptions(30.0))
    pinwarp_command("refine", session, "--feature", 30)
    found = read_session(session)
    assert found.refinement == expected.refinement
    np.testing.assert_array_equal(warped_mesh(found).vertices, warped_mesh(expected).vertices)


def test_the_figures_before_and_after_are_told_to_programs(pinwarp_command, session, study):
    out = study / "refined.pinwarp.csv"
    outcome = pinwarp_command(
        "refine", session, "--feature", 40, "--verify", "--json", "--out", out
    )
    found = json.loads(outcome.stdout)
    assert found["after"]["distance"]["mean"] < found["before"]["distance"]["mean"]
    assert found["fitted"] == found["after"]["fitted"] > 0
    assert len(found["left_out"]["pairs"]) == 8
    assert read_session(session).refinement is None
    again = pinwarp_command("refine", session, "--out", out, exit_code=2)
    assert "is there already" in again.stderr


def test_checking_says_what_was_fitted(pinwarp_command, session):
    pinwarp_command("refine", session, "--feature", 40)
    assert figures(pinwarp_command, session)["fitted"] > 0
    assert "proves nothing" in pinwarp_command("check", session).stdout.replace("\n", " ")


def test_leaving_landmarks_out_prints_a_row_for_each(pinwarp_command, session):
    outcome = pinwarp_command("refine", session, "--feature", 60, "--verify")
    assert "of 8 pairs are missed by less" in outcome.stdout
    assert all(f"p{i}" in outcome.stdout for i in range(8))


def test_warping_applies_the_refined_warp_and_says_when_it_is_out_of_date(
    pinwarp_command, session, study
):
    pinwarp_command("refine", session, "--feature", 40)
    out = study / "warped"
    outcome = pinwarp_command("warp", session, "--out", out)
    assert "the full refined warp" in outcome.stdout
    written = read_mesh(out / "source_warped.ply").mesh.vertices
    np.testing.assert_allclose(written, warped_mesh(read_session(session)).vertices, atol=1e-4)
    write_session(session, edits.set_penalty(read_session(session), 2.0))
    late = pinwarp_command("warp", session, "--out", out, "--force")
    assert "out of date" in late.stderr
    assert "refined" not in late.stdout


def test_what_cannot_be_refined_leaves_the_session_alone(pinwarp_command, study):
    path = study / "study.pinwarp.csv"
    before = path.read_bytes()
    outcome = pinwarp_command("refine", path, exit_code=2)
    assert "no destination mesh" in outcome.stderr
    assert path.read_bytes() == before


def rows(study):
    with (study / "out" / "summary.csv").open() as file:
        return {row["name"]: row for row in csv.DictReader(file)}


def test_a_batch_refines_each_subject(pinwarp_command, study):
    given = ("batch", study / "study.csv", "--session", study / "study.pinwarp.csv")
    given = (*given, "--out", study / "out", "--jobs", 1)
    pinwarp_command(*given)
    plain = rows(study)
    refined = (*given, "--refine", "--feature", 40)
    assert "3 done, 0 unchanged" in pinwarp_command(*refined).stdout
    found = rows(study)
    for name, row in found.items():
        assert int(row["fitted"]) > 0
        assert float(row["distance_mean"]) < float(plain[name]["distance_mean"])
        assert row["folded_vertices"] == "0"
    assert "0 done, 3 unchanged" in pinwarp_command(*refined).stdout
    assert "3 done" in pinwarp_command(*given, "--refine", "--feature", 50).stdout


def test_options_of_the_refinement_need_it(pinwarp_command, study):
    given = ("batch", study / "study.csv", "--session", study / "study.pinwarp.csv")
    given = (*given, "--out", study / "out")
    assert "add --refine" in pinwarp_command(*given, "--feature", 40, exit_code=2).stderr


def test_a_subject_without_a_mesh_cannot_be_refined_to(pinwarp_command, study):
    manifest = study / "study.csv"
    manifest.write_text(manifest.read_text().replace("s1.stl", ""))
    given = ("batch", manifest, "--session", study / "study.pinwarp.csv")
    outcome = pinwarp_command(*given, "--out", study / "out", "--refine", exit_code=2)
    assert "s1 has no destination_mesh" in outcome.stderr
