"""Swapping the sides and mirroring the source."""

from __future__ import annotations

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
from pinwarp.session.session import Session, from_record, to_record


def bone(name: str) -> MeshFile:
    mesh = Mesh([[1, 0, 0], [5, 0, 0], [1, 2, 0], [1, 0, 3]], [[0, 2, 1], [0, 1, 3], [0, 3, 2]])
    return MeshFile(Path("/bones", name), mesh, "ab", ())


def session() -> Session:
    landmarks = (
        Landmark("a", (1, 0, 0), (9, 9, 9)),
        Landmark("b", (2, 0, 0), None),
        Landmark("p", (5, 1, 0), None, role=Role.PASSENGER),
    )
    return Session(bone("source.ply"), bone("destination.ply"), landmarks, WarpSettings(2.0))


def test_swapping_twice_is_nothing_and_once_keeps_positions_on_their_bones():
    before = session()
    after = edits.swap_sides(before)
    assert after.source is before.destination
    assert after.landmarks[1].source is None
    assert after.landmarks[1].destination == (2, 0, 0)
    assert after.landmarks[2].role is Role.PASSENGER
    assert after.landmarks[2].destination == (5, 1, 0)
    assert edits.swap_sides(after) == before


def test_mirroring_keeps_the_bone_where_it_is_and_its_outside_outside():
    before = session()
    after = edits.mirror_source(before, "x")
    mesh = after.mesh(Side.SOURCE)
    assert np.array_equal(mesh.bounds, before.mesh(Side.SOURCE).bounds)
    assert [x.source for x in after.landmarks] == [(5, 0, 0), (4, 0, 0), (1, 1, 0)]
    assert after.landmarks[0].destination == (9, 9, 9)

    def normal(m):
        a, b, c = m.vertices[m.faces[0]]
        return np.cross(b - a, c - a)

    # The plane z = 0 looks down before and after.
    assert normal(before.mesh(Side.SOURCE))[2] < 0
    assert normal(mesh)[2] < 0


@pytest.mark.parametrize("axes", ["x", "xz", "xx"])
def test_a_mirror_is_saved_also_after_a_swap(tmp_path, axes):
    here = session()
    for axis in axes:
        here = edits.mirror_source(here, axis)
    here = edits.swap_sides(here)
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, to_record(here))
    record = read_session(path)
    assert record == to_record(here)
    back = from_record(record, bone("destination.ply"), bone("source.ply"))
    assert np.allclose(
        back.mesh(Side.DESTINATION).vertices, here.mesh(Side.DESTINATION).vertices, atol=1e-12
    )
    assert back.source.mirrored == ""
    assert ("mirrored" in path.read_text()) == (axes != "xx")


def test_without_a_source_there_is_no_middle_to_mirror_across():
    with pytest.raises(LandmarkError, match="open one first"):
        edits.mirror_source(Session(), "x")


@pytest.mark.parametrize("text", ["w", "", "xx", "yes"])
def test_an_axis_that_is_none_is_refused_with_its_line(tmp_path, text):
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, to_record(edits.mirror_source(session(), "x")))
    content = path.read_text().replace("source_mirrored: x", f"source_mirrored: {text}")
    path.write_text(content)
    with pytest.raises(FileFormatError, match="axes") as caught:
        read_session(path)
    assert caught.value.line == 3


def test_a_mirror_without_a_mesh_is_refused(tmp_path):
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, to_record(Session()))
    path.write_text(path.read_text().replace("# unit", "# source_mirrored: x\n# unit"))
    with pytest.raises(FileFormatError, match="there is none"):
        read_session(path)
