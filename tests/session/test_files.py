"""Sessions beside which something strange lies, or which name what cannot be."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark
from pinwarp.io.mesh_reference import MeshReference
from pinwarp.io.session_file import SessionRecord, write_session
from pinwarp.session.judging.check import check
from pinwarp.session.keeping.files import read_session
from pinwarp.session.session import Session

MARKS = tuple(
    Landmark(name, (x, x * x, 0), (x, 1, x)) for name, x in (("a", 1.0), ("a\u200b", 2.0))
)


def session_with(folder: Path, mesh: Path) -> Session:
    path = folder / "a.pinwarp.csv"
    write_session(path, SessionRecord(MARKS, source_mesh=MeshReference(mesh, "ab", 3)))
    return read_session(path)


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_a_link_that_loops_beside_a_session_without_its_mesh_is_no_hindrance(tmp_path):
    (tmp_path / "x").symlink_to("y")
    (tmp_path / "y").symlink_to("x")
    (tmp_path / "bone.stl").symlink_to("bone.stl")
    os.mkfifo(tmp_path / "z.stl")
    for mesh in (tmp_path / "gone" / "bone.stl", tmp_path / "bone.stl", tmp_path / "z.stl"):
        session = session_with(tmp_path, mesh)
        assert isinstance(session.source, MeshReference)


def test_a_mesh_whose_name_no_system_takes_is_not_there(tmp_path):
    assert isinstance(session_with(tmp_path, tmp_path / ("a" * 5000)).source, MeshReference)
    with pytest.raises(FileFormatError, match=r"line 2: No file's name holds a zero"):
        session_with(tmp_path, tmp_path / "b\0")


def test_names_of_a_session_that_look_alike_are_told(tmp_path):
    notes = check(session_with(tmp_path, tmp_path / "gone.stl")).notes
    assert any(r"'a' and 'a\u200b' look alike" in note for note in notes)
