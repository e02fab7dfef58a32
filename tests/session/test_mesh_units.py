"""Meshes in different units."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pinwarp.core.errors import FileFormatError, LandmarkError
from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.settings import WarpSettings
from pinwarp.io.meshes import MeshFile
from pinwarp.io.session_file import read_session, write_session
from pinwarp.session import edits
from pinwarp.session.mesh_units import scale_side, size_ratio, unit_factor, unit_on
from pinwarp.session.outputs.exports import warped_mesh
from pinwarp.session.session import Session, from_record, to_record

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
CORNERS = np.array([[1, 0, 0], [0.4, 0.3, 0], [0.1, 0.2, 0.1], [0.1, 0, 0.3], [0.5, 0.6, 0.7]])
FACES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [2, 3, 4]]


def file_of(size, name="bone.ply"):
    return MeshFile(Path("/bones", name), Mesh(size * CORNERS, FACES), "ab", ())


def session_of(source, destination, unit="m", penalty=0.0):
    landmarks = [
        Landmark(str(i), tuple(source * row), tuple(1.1 * destination * row[::-1] ** 2))
        for i, row in enumerate(CORNERS)
    ]
    landmarks.append(Landmark("p", tuple(source * CORNERS[0]), role=Role.PASSENGER))
    return Session(
        file_of(source),
        file_of(destination),
        tuple(landmarks),
        unit=unit,
        settings=WarpSettings(penalty),
    )


@pytest.mark.parametrize(
    ("source", "destination", "factor"),
    [
        (0.4, 0.5, None),
        (0.4, 380, 1000),
        (380, 0.4, 1 / 1000),
        (0.4, 42, 100),
        # A mouse and a man.
        (15, 400, None),
        # No unit that anybody uses.
        (0.4, 4000 * 1000, None),
    ],
)
def test_a_usual_change_of_unit_is_recognised(source, destination, factor):
    assert unit_factor(session_of(source, destination)) == factor


def test_without_both_meshes_there_is_nothing_to_compare():
    assert size_ratio(Session(source=file_of(1))) is None
    assert unit_factor(Session()) is None


@pytest.mark.parametrize("side", Side)
def test_scaling_a_side_takes_along_what_lies_on_it_and_keeps_the_warp(side):
    before = session_of(0.4, 380, penalty=0.02)
    factor = {SOURCE: 1000.0, DESTINATION: 0.001}[side]
    after = scale_side(before, side, factor)
    assert np.allclose(after.mesh(side).vertices, factor * before.mesh(side).vertices, rtol=1e-15)
    assert after.mesh(side.other) is before.mesh(side.other)
    for old, new in zip(before.landmarks, after.landmarks, strict=True):
        assert new.position(side.other) == old.position(side.other)
    assert unit_factor(after) is None
    assert after.unit == ("mm" if side is SOURCE else "m")
    moved = warped_mesh(after).vertices
    expected = warped_mesh(before).vertices * (1 if side is SOURCE else factor)
    assert np.allclose(moved, expected, rtol=1e-9)


def test_an_infinite_penalty_stays_infinite():
    after = scale_side(session_of(1, 1, penalty=math.inf), SOURCE, 10)
    assert after.settings.penalty == math.inf


def test_scaling_there_and_back_leaves_no_factor(tmp_path):
    session = session_of(0.4, 380)
    back = scale_side(scale_side(session, SOURCE, 1000), SOURCE, 1 / 1000)
    assert back.source.scaled == 1
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, to_record(back))
    assert "scaled" not in path.read_text()


@pytest.mark.parametrize("mirrored", ["", "x", "yz"])
def test_a_scaled_mesh_is_saved_and_comes_back_the_same(tmp_path, mirrored):
    here = scale_side(session_of(0.4, 380), SOURCE, 1000)
    for axis in mirrored:
        here = edits.mirror_source(here, axis)
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, to_record(here))
    assert "# source_scaled: 1000.0\n" in path.read_text()
    record = read_session(path)
    assert record == to_record(here)
    back = from_record(record, file_of(0.4), file_of(380))
    assert np.allclose(back.mesh(SOURCE).vertices, here.mesh(SOURCE).vertices, rtol=1e-14)
    assert np.array_equal(back.mesh(SOURCE).faces, here.mesh(SOURCE).faces)
    assert back.landmarks == here.landmarks
    # A session whose mesh is not found keeps the factor.
    lost = from_record(record, None, None)
    assert to_record(lost) == record
    assert edits.swap_sides(back).destination.scaled == 1000


@pytest.mark.parametrize("text", ["0", "-1", "much", "inf", "nan", ""])
def test_a_factor_that_is_none_is_refused_with_its_line(tmp_path, text):
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, to_record(scale_side(session_of(0.4, 380), SOURCE, 1000)))
    path.write_text(path.read_text().replace("source_scaled: 1000.0", f"source_scaled: {text}"))
    with pytest.raises(FileFormatError, match="line 3"):
        read_session(path)


def test_a_factor_without_a_mesh_is_refused(tmp_path):
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, to_record(Session()))
    path.write_text(path.read_text().replace("# unit", "# source_scaled: 1000\n# unit"))
    with pytest.raises(FileFormatError, match="source mesh is scaled, but there is none"):
        read_session(path)


def test_a_missing_mesh_cannot_be_scaled():
    with pytest.raises(LandmarkError, match="open one first"):
        scale_side(Session(), SOURCE, 1000)


def test_a_unit_that_cannot_be_right_is_not_said():
    apart = session_of(0.4, 380, unit="m")
    assert [unit_on(apart, side) for side in Side] == ["m", ""]
    assert [unit_on(replace(apart, unit="mm"), side) for side in Side] == ["", "mm"]
    alike = session_of(0.4, 0.5, unit="mm")
    # The user said so, and nothing contradicts it.
    assert [unit_on(alike, side) for side in Side] == ["mm", "mm"]
