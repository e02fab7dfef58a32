"""Bones are shown upright, the head up, as far as anything tells where it is."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv

from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.camera_pose import Pose
from pinwarp.gui.scene.fronts import fronts
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.io.samples import assets_folder

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
# The sample bones have z up. These lie along x, one with its head towards +x, one towards -x.
LYING = {1.0: np.array([[0, 0, 1.0], [0, 1, 0], [-1, 0, 0]])}
LYING[-1.0] = np.diag([-1.0, -1.0, 1.0]) @ LYING[1.0]


def sample(name, turn=None):
    mesh = read_mesh(assets_folder() / f"femur_{name}.ply").mesh
    return mesh if turn is None else mesh.with_vertices(mesh.vertices @ turn.T)


def ups(source, destination, rotation=None):
    drawn = {
        side: pv.PolyData.from_regular_faces(mesh.vertices, mesh.faces)
        for side, mesh in zip(Side, (source, destination), strict=True)
        if mesh is not None
    }
    found = fronts(drawn, rotation)
    for frame in found.values():
        assert np.allclose(frame.T @ frame, np.eye(3))
        assert np.linalg.det(frame) == pytest.approx(1)
    return [found[side][:, 1].tolist() for side in found]


@pytest.mark.parametrize("head", LYING)
def test_a_bone_along_x_is_shown_the_same_way_up_as_the_other_one(head):
    lying, standing = sample("generic", LYING[head]), sample("subject")
    assert ups(lying, standing) == [[head, 0, 0], [0, 0, 1]]
    assert ups(standing, lying) == [[0, 0, 1], [head, 0, 0]]
    # By itself nothing tells it: as the file has it.
    assert ups(lying, None) == [[1, 0, 0]]
    # Where both lie, the destination is as the source is.
    for other in LYING:
        assert ups(sample("subject", LYING[other]), lying) == [[1, 0, 0], [head * other, 0, 0]]


def test_pairs_tell_it_before_the_shapes_do():
    lying, standing = sample("generic", LYING[1.0]), sample("subject")
    for head in LYING:
        assert ups(lying, standing, LYING[head].T) == [[head, 0, 0], [0, 0, 1]]


def test_where_an_axis_is_up_in_anatomical_frames_it_stays_up():
    upside_down = sample("generic", np.diag([1.0, -1.0, -1.0]))
    assert ups(upside_down, sample("subject")) == [[0, 0, 1], [0, 0, 1]]


def test_a_bone_that_opened_head_down_is_turned_when_the_other_one_comes(user, tmp_path):
    write_mesh(tmp_path / "lying.ply", sample("generic", LYING[-1.0]))
    views, documents = user.window.viewports, user.window.parts.documents

    def up(side):
        return Pose.of(views[side].camera).frame[:, 1]

    documents.open_mesh(SOURCE, tmp_path / "lying.ply")
    user.settle()
    assert np.allclose(up(SOURCE), [1, 0, 0])
    documents.open_mesh(DESTINATION, assets_folder() / "femur_subject.ply")
    user.settle()
    assert np.allclose(up(SOURCE), [-1, 0, 0])
    assert np.allclose(up(DESTINATION), [0, 0, 1])
    user.trigger("view_back")
    assert np.allclose(up(SOURCE), [-1, 0, 0])
