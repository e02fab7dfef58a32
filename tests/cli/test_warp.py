"""Meshes and landmarks through a session's warp."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.session.study import bone, shape

from pinwarp.core.basis import Basis
from pinwarp.core.components import Components
from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.io.landmark_files import read_landmarks, write_landmarks
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.session import edits
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.mesh_units import scale_side
from pinwarp.session.outputs.exports import warped_mesh
from pinwarp.session.warp.solved import solved


@pytest.fixture
def session(study):
    return study / "study.pinwarp.csv"


def test_without_inputs_the_source_mesh_is_warped(pinwarp_command, session, tmp_path):
    outcome = pinwarp_command("warp", session, "-o", tmp_path / "out")
    expected = warped_mesh(read_session(session))
    written = read_mesh(tmp_path / "out" / "source_warped.ply").mesh
    assert np.array_equal(written.vertices, expected.vertices)
    assert np.array_equal(written.faces, expected.faces)
    assert "the full warp, 8 pairs" in outcome.stdout


def test_the_warped_source_lies_on_the_destination(pinwarp_command, session, tmp_path):
    pinwarp_command("warp", session, "-o", tmp_path / "bone.ply")
    apart = read_mesh(tmp_path / "bone.ply").mesh.vertices - shape(bone().vertices, 0)
    assert np.linalg.norm(apart, axis=1).mean() < 2


def test_several_files_go_into_a_folder_in_their_own_formats(pinwarp_command, session, tmp_path):
    other = tmp_path / "cartilage.stl"
    write_mesh(other, Mesh(bone().vertices[:3] + 1, [[0, 1, 2]]))
    marks = tmp_path / "stations.landmarks.csv"
    write_landmarks(marks, [Landmark("a", (1, 2, 3)), Landmark("b", (4, 5, 6))], Side.SOURCE)
    pinwarp_command("warp", session, other, marks, "--out", tmp_path / "out")
    spline = solved(read_session(session)).applied
    stations = read_landmarks(tmp_path / "out" / "stations_warped.landmarks.csv", Side.DESTINATION)
    assert stations.names == ("a", "b")
    assert stations.landmarks[1].destination == as_position(spline.evaluate([[4, 5, 6]])[0])
    cartilage = read_mesh(tmp_path / "out" / "cartilage_warped.stl").mesh
    assert cartilage.vertices == pytest.approx(
        spline.evaluate(read_mesh(other).mesh.vertices), rel=1e-6
    )


def test_the_format_of_a_single_output_is_that_of_its_suffix(pinwarp_command, session, tmp_path):
    pinwarp_command("warp", session, "-o", tmp_path / "deep" / "bone.obj")
    assert len(read_mesh(tmp_path / "deep" / "bone.obj").mesh.vertices) == len(bone().vertices)


def test_options_go_before_what_the_session_says(pinwarp_command, session, tmp_path):
    opened = read_session(session)
    for name, options, changed in (
        ("a", ["--penalty", "inf"], edits.set_penalty(opened, np.inf)),
        ("b", ["--components", "rigid"], edits.set_components(opened, Components.RIGID)),
        ("c", ["--blend", "0.5"], edits.set_blend(opened, 0.5)),
    ):
        out = tmp_path / f"{name}.ply"
        pinwarp_command("warp", session, "-o", out, *options)
        assert np.allclose(read_mesh(out).mesh.vertices, warped_mesh(changed).vertices), options


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--penalty", "-1"], "must be 0 or more"),
        (["--blend", "2"], "must be from 0 to 1"),
        (["--components", "elastic"], "elastic"),
    ],
)
def test_options_that_mean_nothing_are_refused(pinwarp_command, session, tmp_path, options, words):
    outcome = pinwarp_command("warp", session, "-o", tmp_path / "x.ply", *options, exit_code=2)
    assert words in outcome.stderr
    assert not (tmp_path / "x.ply").exists()


def test_an_output_that_is_there_is_replaced_only_by_force(pinwarp_command, session, tmp_path):
    out = tmp_path / "bone.ply"
    out.write_text("precious")
    outcome = pinwarp_command("warp", session, "-o", out, exit_code=2)
    assert "bone.ply is there already: use --force" in outcome.stderr
    assert out.read_text() == "precious"
    pinwarp_command("warp", session, "-o", out, "--force")
    assert len(read_mesh(out).mesh.vertices) == len(bone().vertices)


def test_an_input_is_never_replaced(pinwarp_command, session, study):
    before = (study / "source.ply").read_bytes()
    link = study / "link.ply"
    link.symlink_to(study / "source.ply")
    # Another name of the same file, as SOURCE.PLY is one on Windows and macOS.
    other = study / "other.ply"
    other.hardlink_to(study / "source.ply")
    for out in (study / "source.ply", link, other):
        outcome = pinwarp_command("warp", session, "-o", out, "--force", exit_code=2)
        assert "would be replaced, but it is read" in outcome.stderr
    assert (study / "source.ply").read_bytes() == before


@pytest.mark.parametrize("name", ["study.pinwarp.csv", "source.ply"])
def test_neither_the_session_nor_its_meshes_are_ever_replaced(
    pinwarp_command, session, study, name
):
    before = (study / name).read_bytes()
    marks = study / "source.csv"
    pinwarp_command("warp", session, marks, "-o", study / name, "--force", exit_code=2)
    assert (study / name).read_bytes() == before


def test_two_inputs_of_one_name_are_refused_before_anything_is_written(
    pinwarp_command, session, study, tmp_path
):
    (tmp_path / "b").mkdir()
    twin = tmp_path / "b" / "Source.ply"
    twin.write_bytes((study / "source.ply").read_bytes())
    out = tmp_path / "out"
    outcome = pinwarp_command("warp", session, study / "source.ply", twin, "-o", out, exit_code=2)
    assert "would both become" in outcome.stderr
    assert not out.exists()


def test_a_bad_file_does_not_keep_the_others_from_being_warped(
    pinwarp_command, session, study, tmp_path
):
    bad = tmp_path / "bad.stl"
    bad.write_text("nonsense")
    out = tmp_path / "out"
    outcome = pinwarp_command("warp", session, bad, study / "source.ply", "-o", out, exit_code=2)
    assert outcome.stderr.startswith("pinwarp: bad.stl: ")
    assert [path.name for path in out.iterdir()] == ["source_warped.ply"]


def test_inputs_of_a_mirrored_session_are_mirrored_like_its_source(
    pinwarp_command, session, study, tmp_path
):
    mirrored = edits.mirror_source(read_session(session), "x")
    write_session(session, mirrored)
    out = tmp_path / "a.ply"
    outcome = pinwarp_command("warp", session, study / "source.ply", "-o", out)
    assert "mirrors its source (x): so are the inputs" in outcome.stderr
    written, expected = read_mesh(out).mesh, warped_mesh(mirrored)
    assert np.allclose(written.vertices, expected.vertices)
    assert np.array_equal(written.faces, expected.faces)
    (study / "source.ply").unlink()
    outcome = pinwarp_command(
        "warp", session, study / "source.csv", "-o", out, "--force", exit_code=2
    )
    assert "where the mirror is" in outcome.stderr


def test_inputs_of_a_scaled_session_are_scaled_like_its_source(
    pinwarp_command, session, study, tmp_path
):
    scaled = scale_side(read_session(session), Side.SOURCE, 0.001)
    write_session(session, scaled)
    out = tmp_path / "a.ply"
    outcome = pinwarp_command("warp", session, study / "source.ply", "-o", out)
    assert "scales its source by 0.001: so are the inputs" in outcome.stderr
    assert np.allclose(read_mesh(out).mesh.vertices, warped_mesh(scaled).vertices)


def test_landmarks_can_be_warped_without_any_mesh(pinwarp_command, session, study, tmp_path):
    for mesh in (study / "source.ply", study / "s0.stl"):
        mesh.unlink()
    out = tmp_path / "muscle.fcsv"
    pinwarp_command("warp", session, study / "muscle.csv", "-o", out)
    assert read_landmarks(out, Side.SOURCE).names == ("muscle",)
    outcome = pinwarp_command("warp", session, "-o", tmp_path / "x.ply", exit_code=2)
    assert "source.ply" in outcome.stderr


def test_landmarks_in_ras_keep_their_frame_in_slicers_files(pinwarp_command, session, tmp_path):
    marks = tmp_path / "ras.fcsv"
    marks.write_text(
        "# Markups fiducial file version = 4.11\n# CoordinateSystem = RAS\n"
        "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
        "1,1,2,3,0,0,0,1,1,1,0,a,,\n"
    )
    outcome = pinwarp_command("warp", session, marks, "-o", tmp_path / "out.fcsv")
    assert "in RAS and were taken as they are" in outcome.stderr
    reading = read_landmarks(tmp_path / "out.fcsv", Side.SOURCE)
    x, y, z = solved(read_session(session)).applied.evaluate([[1, 2, 3]])[0]
    assert reading.frame == "LPS"
    assert reading.landmarks[0].source == pytest.approx((-x, -y, z))


def test_a_session_without_pairs_says_so(pinwarp_command, session, tmp_path):
    write_session(session, replace(read_session(session), landmarks=()))
    outcome = pinwarp_command("warp", session, "-o", tmp_path / "x.ply", exit_code=2)
    assert "There is no pair yet" in outcome.stderr
    assert "Traceback" not in outcome.output


def test_a_source_that_moved_is_found_again_by_its_content(
    pinwarp_command, session, study, tmp_path
):
    expected = warped_mesh(read_session(session))
    (study / "source.ply").rename(study / "renamed.ply")
    out = tmp_path / "a.ply"
    pinwarp_command("warp", session, "-o", out)
    assert np.allclose(read_mesh(out).mesh.vertices, expected.vertices)


def test_another_basis_can_be_asked_for_with_a_penalty_that_means_something(
    pinwarp_command, session, tmp_path
):
    pinwarp_command("warp", session, "--basis", "r2logr", "-o", tmp_path / "a.ply")
    opened = edits.set_basis(read_session(session), Basis.R2_LOG_R)
    assert np.array_equal(read_mesh(tmp_path / "a.ply").mesh.vertices, warped_mesh(opened).vertices)
    write_session(session, edits.set_penalty(read_session(session), 2.0))
    refused = pinwarp_command(
        "warp", session, "--basis", "r2logr", "-o", tmp_path / "b.ply", exit_code=2
    )
    assert "penalty of 2 mm is for the basis r: say --penalty in mm²" in " ".join(
        refused.stderr.split()
    )
    asked = ("--basis", "r2logr", "--penalty", "40", "-o", tmp_path / "c.ply")
    pinwarp_command("warp", session, *asked)
    expected = warped_mesh(edits.set_penalty(opened, 40.0)).vertices
    assert np.array_equal(read_mesh(tmp_path / "c.ply").mesh.vertices, expected)
