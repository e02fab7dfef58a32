"""Suggesting on the command line."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import pyvista as pv
from tests.core import bones
from tests.core.hooked import carried, hooked, places, subject

from pinwarp.core import first_guess
from pinwarp.core.landmarks import Landmark, Side, as_position, positions
from pinwarp.core.mesh import Mesh
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.session.judging.check import check
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.session import Session


@pytest.fixture(autouse=True)
def _coarse(monkeypatch):
    monkeypatch.setattr(first_guess, "FINE", first_guess.COARSE)


@pytest.fixture
def session_of(tmp_path):
    """Write a session of two meshes; its source has landmarks."""

    def write(source: Mesh, destination: Mesh):
        for name, mesh in (("source", source), ("subject", destination)):
            write_mesh(tmp_path / f"{name}.ply", mesh)
        marks = [Landmark(f"p{k}", as_position(place)) for k, place in enumerate(places(12))]
        marks[4] = replace(marks[4], note="deep")
        path = tmp_path / "bone.pinwarp.csv"
        write_session(
            path,
            Session(
                read_mesh(tmp_path / "source.ply"),
                read_mesh(tmp_path / "subject.ply"),
                tuple(marks),
            ),
        )
        return path

    return write


def test_missing_landmarks_are_placed_in_place_and_marked(pinwarp_command, session_of):
    path = session_of(hooked(), subject(hooked()))
    before = path.read_bytes()
    outcome = pinwarp_command("suggest", path, "--mirror", "no")
    assert "12 landmarks" in outcome.stdout
    found = read_session(path)
    assert [x.note for x in found.landmarks][3:5] == ["suggested", "deep; suggested"]
    assert check(found).suggested == 12
    off = positions(found.pairs, Side.DESTINATION) - carried(places(12))
    assert np.linalg.norm(off, axis=1).max() < 10
    assert path.with_name(path.name + ".bak").read_bytes() == before
    again = pinwarp_command("suggest", path, exit_code=2)
    assert "on the destination already" in again.stderr


def test_the_other_side_of_the_body_is_found_and_the_source_mirrored(
    pinwarp_command, session_of, tmp_path
):
    path = session_of(hooked(), subject(hooked(), mirrored=True))
    before, out = path.read_bytes(), tmp_path / "out.pinwarp.csv"
    outcome = pinwarp_command("suggest", path, "--json", "-o", out)
    told = json.loads(outcome.stdout)
    assert (told["verdict"], told["mirrored"], len(told["suggested"])) == ("sure", True, 12)
    assert told["other_hand"] > 1.4
    assert "the source was mirrored" in outcome.stderr
    found = read_session(out)
    assert found.source.mirrored
    off = positions(found.pairs, Side.DESTINATION) - carried(places(12), mirrored=True)
    assert np.linalg.norm(off, axis=1).max() < 10
    assert not check(found).is_flagged
    assert path.read_bytes() == before


def test_what_the_shapes_leave_open_is_not_decided(pinwarp_command, session_of, tmp_path):
    bone = bones.bone(16, 24)
    path = session_of(bone, bone.with_vertices(bones.truth(bone.vertices)))
    before, out = path.read_bytes(), tmp_path / "out.pinwarp.csv"
    outcome = pinwarp_command("suggest", path, "--json", "-o", out, exit_code=3)
    assert json.loads(outcome.stdout)["verdict"] == "ask"
    assert "--mirror no" in outcome.stderr
    assert "Nothing was written" in outcome.stderr
    assert path.read_bytes() == before
    assert not out.exists()


def test_where_the_shapes_tell_nothing_it_says_why(pinwarp_command, session_of):
    ball = pv.Icosphere(radius=50.0, nsub=2)
    path = session_of(hooked(), Mesh(ball.points, ball.regular_faces))
    before = path.read_bytes()
    outcome = pinwarp_command("suggest", path, "--mirror", "no", exit_code=1)
    assert "Nothing was written" in outcome.stderr
    assert "three pairs" in outcome.stderr
    assert path.read_bytes() == before


def test_what_cannot_begin_is_refused_at_once(pinwarp_command, session_of, tmp_path):
    path = session_of(hooked(), subject(hooked()))
    assert "is there already" in pinwarp_command("suggest", path, "-o", path, exit_code=2).stderr
    bare = tmp_path / "bare.pinwarp.csv"
    write_session(bare, replace(read_session(path), landmarks=()))
    assert "no landmark on the source" in pinwarp_command("suggest", bare, exit_code=2).stderr
    (tmp_path / "subject.ply").unlink()
    assert "is not there" in pinwarp_command("suggest", path, exit_code=2).stderr
