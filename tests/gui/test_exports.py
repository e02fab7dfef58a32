"""User stories: what leaves the window as files."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv

from pinwarp.core.components import Components
from pinwarp.core.landmarks import Side, positions
from pinwarp.gui.tasks.dialogs import Existing
from pinwarp.io.coefficients import read_coefficients
from pinwarp.io.landmark_files import read_landmarks, write_landmarks
from pinwarp.io.meshes import read_mesh
from pinwarp.io.samples import assets_folder
from pinwarp.session import edits
from pinwarp.session.judging.mesh_data import warped_mesh_data
from pinwarp.session.outputs.exports import session_coefficients, warped_mesh, warped_passengers
from pinwarp.session.outputs.script import script_of

FIGURES = {"distance_mm", "det_j", "largest_stretch", "smallest_stretch", "deviation_mm"}


@pytest.fixture
def sample(user):
    user.open_sample()
    return user


def said(user) -> str:
    return user.window.statusBar().currentMessage()


@pytest.mark.parametrize("suffix", [".vtp", ".vtk"])
def test_a_warped_mesh_carries_normals_and_what_the_warp_does(sample, tmp_path, suffix):
    path = tmp_path / f"warped{suffix}"
    sample.dialogs.saves = [path]
    sample.trigger("export_mesh")
    assert np.array_equal(read_mesh(path).mesh.vertices, warped_mesh(sample.session).vertices)
    found = pv.read(path)
    assert set(found.point_data) >= FIGURES
    assert found.point_data["Normals"].shape == (found.n_points, 3)
    assert found.point_data["distance_mm"].max() < 4
    assert "the full warp (16 pairs, penalty 0 mm)" in said(sample)


def test_a_ply_has_them_as_properties_of_its_vertices(sample, tmp_path):
    path = tmp_path / "warped.ply"
    sample.dialogs.saves = [path]
    sample.trigger("export_mesh")
    warped = warped_mesh(sample.session)
    assert np.array_equal(read_mesh(path).mesh.vertices, warped.vertices)
    head, _, body = path.read_bytes().partition(b"end_header\n")
    names = [line.split()[-1] for line in head.decode().splitlines() if "property " in line][:-1]
    assert set(names) >= FIGURES | {"nx", "ny", "nz"}
    layout = [(name, "<f8" if name in "xyz" else "<f4") for name in names]
    rows = np.frombuffer(body, layout, count=len(warped.vertices))
    expected = warped_mesh_data(sample.session)
    for name, values in expected.scalars.items():
        assert np.array_equal(rows[name], values.astype(np.float32)), name
    assert np.array_equal(rows["nz"], expected.normals[:, 2].astype(np.float32))


def test_an_obj_has_normals_and_an_stl_neither(sample, tmp_path):
    obj, stl = tmp_path / "warped.obj", tmp_path / "warped.stl"
    sample.dialogs.saves = [obj, stl]
    sample.trigger("export_mesh")
    sample.trigger("export_mesh")
    vertices = warped_mesh(sample.session).vertices
    assert obj.read_text().count("\nvn ") == len(vertices)
    assert np.array_equal(read_mesh(obj).mesh.vertices, vertices)
    assert len(read_mesh(stl).mesh.vertices) == len(vertices)


def test_warped_landmarks_are_named_and_say_which_part_of_the_warp_it_was(sample, tmp_path):
    path = tmp_path / "carried.landmarks.csv"
    sample.editor.commit(edits.set_components(sample.session, Components.RIGID), "Apply")
    sample.settle()
    sample.dialogs.saves = [path]
    sample.trigger("export_warped")
    found = read_landmarks(path, Side.DESTINATION).landmarks
    assert [x.name for x in found] == [pair.name for pair in sample.session.pairs]
    source = positions(sample.session.pairs, Side.SOURCE)
    carried = session_coefficients(sample.session).spline.evaluate(source)
    assert np.array_equal(positions(found, Side.DESTINATION), carried)
    told = said(sample)
    assert told.startswith("Exported carried.landmarks.csv: the rigid fit only")
    assert "The format has no place for notes" in told


def test_passengers_go_into_any_landmark_format(sample, tmp_path):
    path = tmp_path / "passengers.mrk.json"
    sample.dialogs.saves = [path]
    sample.trigger("export_passengers")
    found = read_landmarks(path, Side.DESTINATION).landmarks
    expected = positions(warped_passengers(sample.session), Side.DESTINATION)
    assert np.allclose(positions(found, Side.DESTINATION), expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", ["warp.json", "warp.npz"])
def test_coefficients_are_those_of_the_session(sample, tmp_path, name):
    path = tmp_path / name
    sample.dialogs.saves = [path]
    sample.trigger("export_coefficients")
    found, expected = read_coefficients(path), session_coefficients(sample.session)
    assert np.array_equal(found.spline.weights, expected.spline.weights)
    assert found.names == expected.names
    assert said(sample).startswith(f"Exported {name}: the full warp")


def test_a_name_without_a_suffix_gets_one_and_replaces_nothing(sample, tmp_path):
    sample.dialogs.saves = [tmp_path / "warp", tmp_path / "warp"]
    sample.trigger("export_coefficients")
    written = (tmp_path / "warp.json").read_bytes()
    sample.editor.commit(edits.set_penalty(sample.session, 5.0), "Change penalty")
    sample.settle()
    sample.trigger("export_coefficients")
    ((title, text),) = sample.dialogs.errors
    assert title == "warp.json is there already"
    assert "whole name" in text
    assert (tmp_path / "warp.json").read_bytes() == written


def test_a_suffix_that_means_another_format_is_refused(sample, tmp_path):
    sample.dialogs.saves = [tmp_path / "warp.xml", tmp_path / "warp.sh", tmp_path / "bone.jpg"]
    sample.trigger("export_coefficients")
    sample.trigger("export_script")
    (_, first), (_, second) = sample.dialogs.errors
    assert ".json, .npz" in first
    assert ".py" in second
    assert list(tmp_path.iterdir()) == []


def test_a_script_is_written_for_the_place_where_it_is(sample, tmp_path):
    path = tmp_path / "warp.py"
    sample.dialogs.saves = [path]
    sample.trigger("export_script")
    assert path.read_text(encoding="utf-8") == script_of(sample.session, tmp_path)


@pytest.mark.parametrize(
    ("key", "name"),
    [
        ("export_mesh", "a.ply"),
        ("export_warped", "a.csv"),
        ("export_passengers", "a.csv"),
        ("export_coefficients", "a.json"),
        ("export_script", "a.py"),
    ],
)
def test_what_cannot_be_written_is_told_and_leaves_nothing(sample, tmp_path, key, name):
    sample.dialogs.saves = [tmp_path / "nowhere" / name]
    sample.trigger(key)
    ((_, text),) = sample.dialogs.errors
    assert "No such file or directory" in text
    assert list(tmp_path.iterdir()) == []


def test_without_pairs_there_is_no_warp_to_export(user):
    user.open_sample_meshes()
    actions = user.window.actions_by_key
    for key in ("export_mesh", "export_warped", "export_coefficients", "export_script"):
        assert not actions[key].isEnabled(), key
    assert not actions["warp_files"].isEnabled()
    assert actions["export_picture"].isEnabled()


# Other files through the warp


@pytest.fixture
def inputs(sample, tmp_path):
    """A mesh, landmarks, and a file that is neither."""
    folder = tmp_path / "inputs"
    folder.mkdir()
    mesh, landmarks, bad = folder / "muscle.ply", folder / "sites.landmarks.csv", folder / "no.obj"
    mesh.write_bytes((assets_folder() / "femur_generic.ply").read_bytes())
    write_landmarks(landmarks, sample.session.pairs, Side.SOURCE)
    bad.write_text("nothing of the kind")
    return [mesh, landmarks, bad]


def warp_files(user, inputs, folder):
    user.dialogs.opens_many, user.dialogs.folders = [inputs], [folder]
    user.trigger("warp_files")


def test_any_files_are_warped_into_a_folder_and_the_bad_one_is_named(sample, inputs, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    warp_files(sample, inputs, out)
    assert sorted(x.name for x in out.iterdir()) == [
        "muscle_warped.ply",
        "sites_warped.landmarks.csv",
    ]
    expected = warped_mesh(sample.session).vertices
    assert np.array_equal(read_mesh(out / "muscle_warped.ply").mesh.vertices, expected)
    found = read_landmarks(out / "sites_warped.landmarks.csv", Side.DESTINATION).landmarks
    destination = positions(sample.session.pairs, Side.DESTINATION)
    assert np.allclose(positions(found, Side.DESTINATION), destination, rtol=0, atol=1e-9)
    ((_, text, details),) = sample.dialogs.told
    assert "2 files written" in text
    assert "the full warp" in text
    assert "1 file could not be warped" in text
    assert "no.obj: failed. no.obj" in details
    assert "muscle.ply → muscle_warped.ply" in details


@pytest.mark.parametrize("answer", list(Existing))
def test_what_is_there_already_is_asked_about(sample, inputs, tmp_path, answer):
    older = tmp_path / "muscle_warped.ply"
    older.write_bytes(b"older")
    sample.dialogs.existing = answer
    warp_files(sample, inputs[:2], tmp_path)
    assert sample.dialogs.existing_questions == [["muscle_warped.ply"]]
    assert (older.read_bytes() == b"older") == (answer is not Existing.REPLACE)
    others = (tmp_path / "sites_warped.landmarks.csv").exists()
    assert others == (answer is not Existing.CANCEL)


def test_neither_inputs_nor_the_session_are_ever_replaced(sample, tmp_path):
    """Even where their names are such that a warped file would be called the same."""
    first, second = tmp_path / "a.ply", tmp_path / "a_warped.ply"
    for path in (first, second):
        path.write_bytes((assets_folder() / "femur_generic.ply").read_bytes())
    sample.dialogs.existing = Existing.REPLACE
    before = second.read_bytes()
    warp_files(sample, [first, second], tmp_path)
    assert "choose another folder" in sample.dialogs.errors[0][1]
    sample.window.parts.documents.open_mesh(Side.SOURCE, second)
    sample.settle()
    warp_files(sample, [first], tmp_path)
    assert "choose another folder" in sample.dialogs.errors[1][1]
    assert second.read_bytes() == before


def test_a_cancelled_run_says_how_far_it_came(sample, inputs, tmp_path, qtbot):
    many = []
    for number in range(12):
        many.append(inputs[0].with_name(f"part{number:02}.ply"))
        many[-1].write_bytes(inputs[0].read_bytes())
    out = tmp_path / "out"
    out.mkdir()
    sample.dialogs.opens_many, sample.dialogs.folders = [many], [out]
    sample.window.jobs.progressed.connect(
        lambda share, _stage: sample.window.cancel.click() if share >= 0.15 else None
    )
    sample.trigger("warp_files")
    written = len(list(out.iterdir()))
    assert 2 <= written < 12
    ((_, text, _),) = sample.dialogs.told
    assert f"{written} files written" in text
    assert f"Cancelled before the other {12 - written} file" in text
