"""Sessions with curves and patches on the command line."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from tests.session.study import add_groups

from pinwarp.io.meshes import read_mesh
from pinwarp.session.keeping.files import read_session
from pinwarp.session.outputs.exports import warped_mesh


@pytest.fixture
def session(study):
    add_groups(study)
    return study / "study.pinwarp.csv"


def test_check_counts_what_slid(pinwarp_command, session):
    words = pinwarp_command("check", session).stdout
    assert all(word in words for word in ("ring", "ball", "patch", "Largest"))
    assert "a small distance then proves little" in words
    found = json.loads(pinwarp_command("check", session, "--json").stdout)
    assert [(x["name"], x["points"]) for x in found["groups"]] == [("ring", 9), ("ball", 25)]
    assert found["fitted"] == sum(x["used"] for x in found["groups"])


def test_warp_needs_no_destination_while_the_rest_is_known(pinwarp_command, session, study):
    expected = warped_mesh(read_session(session)).vertices
    # Beside the session it would be found by its content.
    (study / "s0.stl").rename(study.parent / "elsewhere.stl")
    out = study / "out"
    told = pinwarp_command("warp", session, "-o", out)
    assert "semilandmarks" in told.stdout
    np.testing.assert_allclose(
        read_mesh(out / "source_warped.ply").mesh.vertices, expected, atol=1e-4
    )
    # Changed by hand, nobody knows where they rest.
    text = session.read_text()
    session.write_text(text.replace("# slid: method=1 inputs=sha256:", "# slid: method=1 inputs=x"))
    told = pinwarp_command("warp", session, "-o", study / "alone")
    assert "no part in this warp" in told.stderr
    (study.parent / "elsewhere.stl").rename(study / "s0.stl")
    told = pinwarp_command("warp", session, "-o", study / "again")
    assert "no part" not in told.stderr
    again = read_mesh(study / "again" / "source_warped.ply").mesh.vertices
    np.testing.assert_allclose(again, expected, atol=1e-4)


def test_batch_slides_on_each_subject_and_says_what_was_drawn_elsewhere(
    pinwarp_command, session, study
):
    out = study / "out"
    told = pinwarp_command(
        *("batch", study / "study.csv", "-o", out, "--session", session, "--jobs", 1)
    )
    assert "ring: drawn on the session's own destination" in told.stderr
    with (out / "summary.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["done"] * 3
    for row in rows:
        assert int(row["fitted"]) + int(row["freed"]) == 34


@pytest.mark.parametrize(
    ("name", "others"),
    [
        ("a.tps", ["a.sliders.csv", "a.surfslide.csv"]),
        ("a.R", ["a.points.csv"]),
        ("a.mrk.json", ["a.ring.mrk.json", "a.ball.mrk.json"]),
    ],
)
def test_convert_writes_semilandmarks(pinwarp_command, session, study, name, others):
    options = ("--side", "destination", "--semilandmarks")
    told = pinwarp_command("convert", session, study / name, *options)
    assert all((study / x).is_file() for x in (name, *others))
    assert "8 landmarks, 34 semilandmarks" in told.stdout
    (study / name).unlink()
    told = pinwarp_command("convert", session, study / name, *options, exit_code=2)
    assert "use --force" in told.stderr
    assert not (study / name).exists()


def test_convert_says_what_it_needs(pinwarp_command, session, study):
    command = ("convert", session, study / "a.tps")
    assert "choose by --side" in pinwarp_command(*command, "--semilandmarks", exit_code=2).stderr
    told = pinwarp_command(*command, "--side", "source")
    assert "2 curves and patches left out (ring, ball): --semilandmarks writes them" in told.stderr
    no_session = pinwarp_command(
        *("convert", study / "s0.csv", study / "b.tps", "--side", "source", "--semilandmarks"),
        exit_code=2,
    )
    assert "only sessions have curves" in no_session.stderr
