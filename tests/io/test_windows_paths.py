"""Paths that somebody wrote on Windows name the same files everywhere."""

from __future__ import annotations

import os

import pytest

from pinwarp.io.file_names import with_slashes
from pinwarp.io.manifest import read_manifest
from pinwarp.io.mesh_reference import MeshReference, mesh_reference, mesh_text
from pinwarp.io.model_manifest import read_model_manifest
from pinwarp.io.model_study import read_model_study


def test_every_file_that_names_others_takes_backslashes(tmp_path):
    here = tmp_path / "bones" / "anna" / "thigh.csv"
    manifest = tmp_path / "study.csv"
    manifest.write_text("name,destination_landmarks\nanna,bones\\anna\\thigh.csv\n")
    (anna,) = read_manifest(manifest).subjects
    assert anna.destination_landmarks == here
    manifest.write_text("name,thigh,thigh_mesh\nanna,bones\\anna\\thigh.csv,..\\thigh.stl\n")
    ((thigh,),) = (x.bodies for x in read_model_manifest(manifest, ["thigh"]).subjects)
    assert (thigh.landmarks, thigh.mesh) == (here, tmp_path.parent / "thigh.stl")
    manifest.write_text(
        "# pinwarp-model: 1\n# model: bones\\leg.osim\nbody,session\nthigh,bones\\anna\\thigh.csv\n"
    )
    study = read_model_study(manifest)
    assert study.model == tmp_path / "bones" / "leg.osim"
    assert study.bodies[0].session == here
    mesh = mesh_reference("bones\\anna\\thigh.stl sha256=ab vertices=3", tmp_path)
    assert mesh == MeshReference(here.with_suffix(".stl"), "ab", 3)
    assert mesh_text(mesh, tmp_path) == "bones/anna/thigh.stl sha256=ab vertices=3"


def test_what_is_on_another_drive_of_windows_is_kept_for_the_way_back(tmp_path):
    line = "D:/bones/femur.stl sha256=ab vertices=3"
    mesh = mesh_reference(line, tmp_path)
    assert mesh.path.name == "femur.stl", "it is looked for by its name"
    assert mesh_text(mesh, tmp_path) == line


@pytest.mark.skipif(os.sep == "\\", reason="a name cannot hold a backslash there")
def test_a_name_that_truly_holds_a_backslash_stays_one(tmp_path):
    odd = tmp_path / "left\\femur.stl"
    mesh = MeshReference(odd, "ab", 3)
    assert mesh_reference(mesh_text(mesh, tmp_path), tmp_path) == mesh
    assert with_slashes(odd.name, tmp_path) == "left/femur.stl"
    odd.touch()
    assert with_slashes(odd.name, tmp_path) == odd.name
