"""Names of files whose letters the locale does not know."""

from __future__ import annotations

import os
from types import SimpleNamespace

import pytest

from pinwarp.io import file_names
from pinwarp.io.mesh_reference import MeshReference, mesh_reference, mesh_text


@pytest.fixture
def few_letters(monkeypatch):
    """The system's names are ASCII; other bytes have stand-ins, as Python does it."""
    system = SimpleNamespace(
        fsencode=lambda name: name.encode("ascii", "surrogateescape"),
        fsdecode=lambda name: name.decode("ascii", "surrogateescape"),
        path=os.path,
        sep=os.sep,
    )
    monkeypatch.setattr(file_names, "os", system)


@pytest.mark.parametrize("line", ["fémur α.stl", '"f\\u00e9mur \u03b1.stl"'])
def test_a_name_is_looked_for_by_its_bytes(few_letters, tmp_path, line):
    name = "fémur α.stl".encode().decode("ascii", "surrogateescape")
    assert mesh_reference(line, tmp_path).path.name == name


def test_a_name_that_came_by_its_bytes_is_written_in_letters(few_letters, tmp_path):
    name = "fémur α.stl".encode().decode("ascii", "surrogateescape")
    assert mesh_text(MeshReference(tmp_path / name), tmp_path) == "fémur α.stl"


def test_bytes_that_are_no_letters_come_back(tmp_path):
    mesh = MeshReference(tmp_path / "fem\udcff.stl")
    line = mesh_text(mesh, tmp_path)
    assert line.isascii()
    assert mesh_reference(line, tmp_path) == mesh


def test_a_name_that_no_system_can_hold_is_refused_or_not_found(tmp_path):
    with pytest.raises(ValueError, match="zero"):
        mesh_reference('"fem\\u0000.stl"', tmp_path)
    assert not mesh_reference('"fem\\ud800.stl"', tmp_path).path.exists()
