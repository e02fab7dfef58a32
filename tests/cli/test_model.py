"""``pinwarp model``: listing, warping, looking first, studies."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from tests.osim_kinematics import Kinematics
from tests.osim_models import copied_model, edited_model, session_file

from pinwarp.core.landmarks import Side
from pinwarp.io.landmark_files import write_landmarks
from pinwarp.io.meshes import read_mesh
from pinwarp.session.keeping.files import read_session
from pinwarp.session.warp.solved import solved


@pytest.fixture
def leg(tmp_path):
    return copied_model("leg", tmp_path / "leg")


@pytest.fixture
def thigh(leg):
    return session_file(leg, "thigh")


def test_without_a_body_the_bodies_are_listed_with_what_can_be_warped(pinwarp_command, leg):
    (leg.parent / "Geometry" / "hip.obj").unlink()
    edited_model(
        leg,
        (
            '<WrapEllipsoid name="head_wrap">',
            '<WrapTorus name="ring"/><WrapEllipsoid name="head_wrap">',
        ),
    )
    told = pinwarp_command("model", leg)
    assert "leg_plain: 3 bodies, version 40500" in told.stdout
    assert "hip: hip.obj (1 not found)" in told.stdout
    assert "2 path points, 1 conditional path point" in told.stdout
    assert "cannot be: /bodyset/thigh/wrapobjectset/ring (wrap torus" in told.stdout
    listed = json.loads(pinwarp_command("model", leg, "--json").stdout)
    assert [body["body"] for body in listed["bodies"]] == ["hip", "thigh", "shank"]
    assert listed["bodies"][0]["missing_meshes"] == ["hip.obj"]
    assert listed["bodies"][1]["not_warped"][0]["kind"] == "wrap torus"


def test_a_body_is_warped_and_everything_on_it_is_told(pinwarp_command, leg, thigh, tmp_path):
    new = tmp_path / "new.osim"
    told = pinwarp_command("model", leg, "--body", f"thigh={thigh}", "-o", new)
    assert "2 path points warped, moved by" in told.stdout
    assert f"{new}: 1 mesh beside it, new_report.csv says all of it" in told.stdout
    before, after = Kinematics(leg), Kinematics(new)
    knee = "/markerset/KNEE"
    assert abs(before.point_in_body(knee) - after.point_in_body(knee)).max() > 0.005


def test_a_dry_run_tells_the_same_and_writes_nothing(pinwarp_command, leg, thigh, tmp_path):
    options = ("model", leg, "--body", f"thigh={thigh}")
    dry = pinwarp_command(*options, "--dry-run", "--json")
    assert sorted(os.listdir(tmp_path)) == ["leg"]
    told = json.loads(dry.stdout)
    wet = json.loads(pinwarp_command(*options, "--json", "-o", tmp_path / "new.osim").stdout)
    assert (told.pop("written"), wet.pop("written")) == (None, str(tmp_path / "new.osim"))
    assert told == wet
    assert told["bodies"][0]["pairs"] == 24
    assert {element["outcome"] for element in told["elements"]} <= {"warped", "kept", "flagged"}


def test_rules_are_given_by_path(pinwarp_command, leg, thigh, tmp_path):
    knee, frame = "/markerset/KNEE", "/jointset/knee/knee_parent"
    new = tmp_path / "new.osim"
    told = pinwarp_command(
        *("model", leg, "--body", f"thigh={thigh}", "-o", new, "--json"),
        *("--keep", knee, "--turn", frame),
    )
    rows = {(x["path"], x["kind"]): x for x in json.loads(told.stdout)["elements"]}
    assert rows[knee, "marker"]["outcome"] == "kept"
    assert "turned with the bone" in rows[frame, "offset frame"]["rule"]
    before, after = Kinematics(leg), Kinematics(new)
    assert abs(before.in_body(frame)[:3, :3] - after.in_body(frame)[:3, :3]).max() > 1e-3
    assert (before.point_in_body(knee) == after.point_in_body(knee)).all()


def test_strict_exits_with_one_where_something_is_flagged(pinwarp_command, leg, thigh, tmp_path):
    options = ("model", leg, "--body", f"thigh={thigh}", "--strict")
    told = pinwarp_command(*options, "-o", tmp_path / "new.osim", exit_code=1)
    assert "! " in told.stdout
    assert (tmp_path / "new.osim").is_file(), "it is written all the same"
    hip = session_file(leg, "hip", warp=lambda x: x * [1.05, 1.05, 1.05])
    pinwarp_command("model", leg, "--body", f"hip={hip}", "--strict", "--dry-run")


def test_a_study_says_what_the_options_would(pinwarp_command, leg, thigh, tmp_path):
    study = leg.parent / "anna.pinwarp-model.csv"
    study.write_text(
        "# pinwarp-model: 1\n# model: leg.osim\nbody,session,orientation_rule\n"
        "thigh,thigh.pinwarp.csv,turn\n/markerset/KNEE,keep\n"
    )
    one, other = tmp_path / "one.osim", tmp_path / "other.osim"
    pinwarp_command("model", study, "-o", one)
    pinwarp_command(
        *("model", leg, "--body", f"thigh={thigh}", "-o", other),
        *("--turn-all", "--keep", "/markerset/KNEE"),
    )
    assert one.read_bytes() == other.read_bytes().replace(b"other_Geometry", b"one_Geometry")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--body", "thigh=THIGH"], "Name the new model: -o NEW.osim"),
        (["--body", "thigh", "--dry-run"], "name a body and its session"),
        (["--body", "femur=THIGH", "--dry-run"], "no body 'femur' in it. It has hip, thigh"),
        (["--body", "thigh=THIGH", "--body", "thigh=THIGH", "--dry-run"], "thigh has two sessions"),
        (["--body", "hip=THIGH", "--dry-run"], "was made on /bodyset/thigh"),
        (["--body", "thigh=THIGH", "--keep", "/x", "--dry-run"], "/x cannot be kept"),
        (["--body", "thigh=THIGH", "-o", "leg.osim", "--force"], "would be replaced"),
        (["--body", "thigh=THIGH", "-o", "leg.pinwarp.csv"], "ends in .osim"),
        (["--body", "thigh=none.csv", "--dry-run"], "no such file"),
    ],
)
def test_what_cannot_be_done_is_told_on_one_line_and_nothing_is_written(
    pinwarp_command, leg, thigh, tmp_path, monkeypatch, options, words
):
    monkeypatch.chdir(leg.parent)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    given = [option.replace("THIGH", str(thigh)) for option in options]
    told = pinwarp_command("model", leg, *given, exit_code=2)
    assert words in told.stderr
    assert len(told.stderr.splitlines()) == 1
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_an_output_that_is_there_is_replaced_only_by_force(pinwarp_command, leg, thigh, tmp_path):
    new = tmp_path / "new.osim"
    new.write_text("mine")
    options = ("model", leg, "--body", f"thigh={thigh}", "-o", new)
    assert "use --force" in pinwarp_command(*options, exit_code=2).stderr
    assert sorted(os.listdir(tmp_path)) == ["leg", "new.osim"]
    assert new.read_text() == "mine"
    pinwarp_command(*options, "--force")
    assert new.stat().st_size > 1000


def test_a_study_takes_no_bodies_beside_its_own(pinwarp_command, leg, thigh):
    study = leg.parent / "anna.pinwarp-model.csv"
    study.write_text(
        "# pinwarp-model: 1\n# model: leg.osim\nbody,session\nthigh,thigh.pinwarp.csv\n"
    )
    told = pinwarp_command("model", study, "--keep", "/x", "--dry-run", exit_code=2)
    assert "change it there" in told.stderr


def test_what_else_warps_a_session_warps_one_on_a_bone(leg, tmp_path, pinwarp_command):
    path = session_file(leg, "thigh")
    pinwarp_command("warp", path, "-o", tmp_path / "out")
    warped = read_mesh(tmp_path / "out" / "thigh_warped.vtp").mesh
    expected = solved(read_session(path)).mesh
    np.testing.assert_allclose(warped.vertices, expected.vertices, atol=1e-12)
    assert "24 pairs" in pinwarp_command("check", path).stdout
    write_landmarks(tmp_path / "anna.csv", read_session(path).landmarks, Side.DESTINATION)
    (tmp_path / "study.csv").write_text("name,destination_landmarks\nanna,anna.csv\n")
    out = tmp_path / "many"
    pinwarp_command("batch", tmp_path / "study.csv", "--session", path, "-o", out, "--jobs", 1)
    many = read_mesh(out / "anna_warped.vtp").mesh
    np.testing.assert_allclose(many.vertices, expected.vertices, atol=1e-12)


def test_opensim_adds_its_figures_to_what_a_program_reads(leg, thigh, tmp_path):
    pytest.importorskip("opensim")
    command = (sys.executable, "-m", "pinwarp", "model", leg, "--body", f"thigh={thigh}")
    told = subprocess.run(
        (*map(str, command), "--dry-run", "--json", "--check", "--scale-lengths"),
        capture_output=True,
        text=True,
        check=True,
        cwd=tmp_path,
    )
    found = json.loads(told.stdout)
    assert {muscle["path"] for muscle in found["opensim"]["muscles"]} == {
        *("/forceset/rf", "/forceset/ham", "/forceset/add"),
    }
    rows = {row["path"]: row for row in found["elements"]}
    assert rows["/forceset/rf"]["outcome"] == "warped"
    assert os.listdir(tmp_path) == ["leg"]
