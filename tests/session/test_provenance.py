"""What an output says about how it came about."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.animation import write_gif
from pinwarp.io.landmark_files import read_landmarks, write_landmarks
from pinwarp.io.mesh_formats.vertex_data import VertexData
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.io.samples import sample_session
from pinwarp.session import edits
from pinwarp.session.judging.methods import methods_of
from pinwarp.session.judging.quality import quality_of
from pinwarp.session.keeping.files import read_session
from pinwarp.session.outputs.exports import session_coefficients, warped_mesh
from pinwarp.session.outputs.script import script_of
from pinwarp.session.outputs.warp_files import FileWarper
from pinwarp.session.warp.provenance import provenance, session_hash
from pinwarp.session.warp.solved import solved

REMARKS = ("Made by pinwarp, session sha256:12", "12 pairs -- penalty: 2.5 mm", "fémur\nleft")


@pytest.fixture(scope="module")
def sample():
    return read_session(sample_session())


def test_the_hash_follows_every_edit_and_comes_back_with_undo(sample):
    before = session_hash(sample)
    for changed in (
        edits.set_penalty(sample, 2.5),
        edits.set_note(sample, sample.landmarks[0].name, "worn"),
        edits.remove(sample, [sample.landmarks[3].name]),
        replace(sample, unit="m"),
        replace(sample, destination=None),
    ):
        assert session_hash(changed) != before
    assert session_hash(edits.set_penalty(edits.set_penalty(sample, 2.5), 0.0)) == before


def test_the_hash_is_the_same_wherever_the_files_are(sample, tmp_path):
    elsewhere = replace(sample.source, path=tmp_path / "another_name.ply")
    assert session_hash(replace(sample, source=elsewhere)) == session_hash(sample)


def test_the_hash_is_the_same_without_the_meshes_read(sample):
    assert session_hash(read_session(sample_session(), meshes=())) == session_hash(sample)


@pytest.mark.parametrize(
    "suffix", [".ply", ".obj", ".off", ".stl", ".vtp", ".vtu", ".vtk", ".glb", ".gltf", ".3mf"]
)
def test_a_mesh_says_how_it_came_about_and_reads_back(sample, tmp_path, suffix):
    path = tmp_path / f"warped{suffix}"
    mesh = warped_mesh(sample)
    write_mesh(path, mesh, VertexData(remarks=REMARKS))
    plain = tmp_path / f"plain{suffix}"
    write_mesh(plain, mesh)
    assert np.array_equal(read_mesh(path).mesh.vertices, read_mesh(plain).mesh.vertices)
    assert np.array_equal(read_mesh(path).mesh.faces, read_mesh(plain).mesh.faces)
    assert read_mesh(path).notes == read_mesh(plain).notes
    if suffix != ".3mf":
        assert b"session sha256:12" in path.read_bytes()


def test_a_stl_that_says_solid_is_still_binary(tmp_path, sample):
    path = tmp_path / "warped.stl"
    write_mesh(path, warped_mesh(sample), VertexData(remarks=("solid bone",)))
    assert len(read_mesh(path).mesh.faces) == len(sample.source.mesh.faces)


@pytest.mark.parametrize("suffix", [".tps", ".fcsv", ".mrk.json", ".pp", ".tag", ".landmarkAscii"])
def test_landmarks_say_how_they_came_about_and_read_back(tmp_path, suffix):
    path = tmp_path / f"femur{suffix}"
    marks = [Landmark("a", (1, 2, 3)), Landmark("b", (4, 5, 6.5))]
    write_landmarks(path, marks, Side.SOURCE, unit="mm", remarks=REMARKS)
    found = read_landmarks(path, Side.SOURCE)
    assert [x.source for x in found.landmarks] == [x.source for x in marks]
    assert found.skipped == ()
    assert "session sha256:12" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize("suffix", [".csv", ".bigwarp.csv", ".pts", ".nts"])
def test_formats_without_comments_stay_as_their_readers_want_them(tmp_path, suffix):
    marks = [Landmark("a", (1, 2, 3), (1, 2, 4))]
    for name, remarks in (("told", REMARKS), ("untold", ())):
        folder = tmp_path / name
        folder.mkdir()
        write_landmarks(folder / f"femur{suffix}", marks, Side.SOURCE, remarks=remarks)
    told, untold = (
        (tmp_path / name / f"femur{suffix}").read_bytes() for name in ("told", "untold")
    )
    assert told == untold


def test_what_is_warped_on_the_command_line_says_the_session(sample, tmp_path):
    path = tmp_path / "warped.ply"
    FileWarper(sample).warp(sample.source.path, path)
    assert session_hash(sample).encode() in path.read_bytes()


def test_coefficients_and_scripts_say_the_session(sample, tmp_path):
    assert session_coefficients(sample).session == session_hash(sample)
    script = script_of(edits.set_penalty(sample, 2.5), tmp_path)
    assert session_hash(edits.set_penalty(sample, 2.5)) in script
    assert "# 16 pairs. Warping penalty: 2.5 mm." in script


def test_an_animation_says_how_it_came_about(tmp_path):
    path = tmp_path / "blend.gif"
    grey = [np.full((4, 6, 3), level, np.uint8) for level in (0, 200)]
    write_gif(path, grey, 1.0, remarks=REMARKS)
    assert b"session sha256:12" in path.read_bytes()


def test_provenance_names_program_settings_and_meshes(sample):
    first, second, source, destination = provenance(edits.set_penalty(sample, 2.5))
    assert first.startswith("Made by pinwarp ")
    assert len(first) <= 80, "binary STL has room for no more"
    assert "16 pairs" in second
    assert "2.5 mm" in second
    assert sample.source.sha256 in source
    assert sample.destination.sha256 in destination


def methods(session):
    warp = solved(session)
    return methods_of(warp, quality_of(warp.result))


def test_the_methods_say_equation_penalty_pairs_error_and_versions(sample):
    words, *cited = methods(edits.set_penalty(sample, 2.5))
    for told in (
        "U(r) = r",
        "16 pairs of homologous landmarks",
        "2.5 mm was subtracted from the diagonal",
        "K − sI",
        "leave-one-out error",
        "numpy",
        session_hash(edits.set_penalty(sample, 2.5)),
    ):
        assert told in words
    assert any(work.startswith("Bookstein") for work in cited)
    assert any(work.startswith("Wahba") for work in cited)


def test_the_methods_of_another_convention_do_not_claim_that_it_smooths(sample):
    from pinwarp.core.spline import PenaltyConvention

    legacy = replace(
        sample,
        settings=replace(sample.settings, penalty=0.5, convention=PenaltyConvention.OPYNSIM),
    )
    words, *cited = methods(legacy)
    assert "K + αI" in words
    assert "does not smooth" in words
    assert not any(work.startswith("Wahba") for work in cited)


def test_the_methods_of_few_pairs_tell_no_error(sample):
    few = replace(sample, landmarks=sample.landmarks[:3])
    assert "leave-one-out" not in methods(few)[0]
