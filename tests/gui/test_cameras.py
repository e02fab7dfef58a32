"""Wherever a camera stands, the mouse is safe and there is a way back to the bone."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from qtpy.QtCore import QPoint, QPointF, Qt
from qtpy.QtTest import QTest
from tests.gui.test_views import orbit, pan, scroll
from vtkmodules.vtkRenderingCore import vtkCamera

from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.camera_pose import Pose
from pinwarp.gui.scene.sight import Sight, through_ball
from pinwarp.gui.views.canvas import FURTHEST, NEAREST

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
HOSTILE = {
    "behind": ((0, 0, 5000), (0, 0, 9000), (0, 1, 0)),
    "huge": ((0, 0, 1e150), (0, 0, 0), (0, 1, 0)),
    "huge and behind": ((0, 0, 1e200), (0, 0, 2e200), (0, 1, 0)),
    "tiny": ((0, 0, 1e-200), (0, 0, 0), (0, 1, 0)),
    "nowhere": ((1, 2, 3), (1, 2, 3), (0, 1, 0)),
    "up along the view": ((0, 0, 500), (0, 0, 0), (0, 0, 1)),
    "no up": ((0, 0, 500), (0, 0, 0), (0, 0, 0)),
}
numbers = st.floats(-1e100, 1e100, allow_nan=False)
vectors = st.tuples(numbers, numbers, numbers)


def put(camera, pose):
    position, focal, up = pose
    camera.SetPosition(*position)
    camera.SetFocalPoint(*focal)
    camera.SetViewUp(*up)


@given(vectors, vectors, vectors, st.booleans(), vectors)
def test_whatever_the_camera_a_sight_is_of_finite_numbers_or_none(at, focal, up, parallel, point):
    camera = vtkCamera()
    camera.SetParallelProjection(parallel)
    put(camera, (at, focal, up))
    sight = Sight.of(camera, 1.5)
    if sight is None:
        return
    assert np.allclose(sight.frame.T @ sight.frame, np.eye(3), atol=1e-6)
    start, direction = sight.ray(0.3, -0.8)
    assert np.isfinite([*start, *direction]).all()
    assert np.linalg.norm(direction) == pytest.approx(1)
    ((x, y),) = sight.places([point])
    assert np.isnan([x, y]).all() or not np.isnan([x, y]).any()
    assert sight.units_per_height(point) > 0


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.01, 900), st.booleans())
def test_a_place_on_the_ray_through_a_place_of_the_view_is_seen_there(x, y, far, parallel):
    camera = vtkCamera()
    camera.SetParallelProjection(parallel)
    camera.SetParallelScale(70)
    put(camera, ((10, -300, 40), (5, 2, 30), (0.1, 0.2, 1)))
    sight = Sight.of(camera, 1.5)
    start, direction = sight.ray(x, y)
    assert np.allclose(sight.places([start + far * direction]), [[x, y]], atol=1e-8)
    matrix = camera.GetCompositeProjectionTransformMatrix(1.5, -1, 1)
    clip = np.array(matrix.MultiplyPoint([*(start + far * direction), 1.0]))
    assert np.allclose(clip[:2] / clip[3], [x, y], atol=1e-8), "as VTK draws it"
    if not parallel:
        assert np.isnan(sight.places([start - far * direction])).all()


def test_a_line_of_sight_begins_at_the_eye_inside_a_ball_and_misses_one_beside_it():
    along = np.array([0.0, 0.0, 1.0])
    start, end = through_ball(np.zeros(3), along, np.zeros(3), 2.0)
    assert start.tolist() == [0, 0, 0]
    assert end.tolist() == [0, 0, 2]
    assert through_ball(np.array([3.0, 0, -9]), along, np.zeros(3), 2.0) is None
    far = through_ball(np.array([0, 0, -1e150]), along, np.zeros(3), 2.0)
    assert far is None or np.isfinite(far).all()


@pytest.fixture
def sample(user):
    user.open_sample()
    return user


def is_in_sight(user):
    return all(viewport.is_bone_seen for viewport in user.window.viewports.values())


@pytest.mark.parametrize("link", ["link_linked", "link_rotation", "link_free"])
def test_a_hostile_camera_harms_nothing_and_home_brings_the_bones_back(sample, link):
    sample.trigger(link)
    sample.editor.select(sample.session.pairs[0].name)
    for side in Side:
        viewport = sample.window.viewports[side]
        for pose in HOSTILE.values():
            put(viewport.camera, pose)
            viewport.renderer.ResetCameraClippingRange()
            near, far = viewport.camera.GetClippingRange()
            assert near < far
            assert viewport.layer.is_bone_lost == (not viewport.is_bone_seen)
            for at in (QPoint(20, 20), QPoint(viewport.rect().center())):
                QTest.mouseMove(viewport, at)
                viewport.layer.grab()
            place = np.array(sample.session.pairs[0].position(side))
            assert np.isfinite(viewport.in_view_plane(QPointF(40, 30), place)).all()
            viewport.pick(QPointF(40, 30))
            viewport.pick(QPointF(40, 30), np.inf)
            assert np.isfinite(viewport.project(place[None])).all()
            assert np.isfinite(viewport.pixels_per_unit(place))
            viewport.behind_surface(place[None])
            QTest.keyClick(sample.window, Qt.Key.Key_F)
            QTest.keyClick(sample.window, Qt.Key.Key_Home)
            assert is_in_sight(sample)
    sample.settle()


def test_a_bone_behind_the_camera_is_told_and_the_mouse_moves_and_drags_on(sample):
    viewport = sample.window.viewports[SOURCE]
    put(viewport.camera, HOSTILE["behind"])
    viewport.renderer.ResetCameraClippingRange()
    sample.settle()
    assert viewport.layer.is_bone_lost
    before = sample.session
    for at in (QPoint(30, 30), QPoint(200, 160), viewport.rect().center()):
        QTest.mouseMove(viewport, at)
        QTest.mouseClick(viewport, Qt.MouseButton.LeftButton, pos=at)
    orbit(sample, SOURCE)
    pan(sample, SOURCE)
    scroll(sample, SOURCE, 2)
    sample.window.resize(1000, 640)
    sample.press(Qt.Key.Key_K)
    assert sample.session == before, "a click beside every bone places nothing"
    sample.press(Qt.Key.Key_Home)
    assert is_in_sight(sample)
    assert not viewport.layer.is_bone_lost


def test_the_wheel_takes_no_camera_through_the_bone_or_out_of_the_world(sample):
    for side in Side:
        viewport = sample.window.viewports[side]
        size = float(np.linalg.norm(viewport.bone.bounds_size))
        for notches in (120, -200):
            scroll(sample, side, notches)
            distance = Pose.of(viewport.camera).distance
            assert 0.99 * NEAREST * size <= distance <= 1.01 * FURTHEST * size
            assert Pose.of(viewport.camera).is_proper
            there = sample.window.viewports[side.other]
            assert Pose.of(there.camera).is_proper
        sample.press(Qt.Key.Key_Home)
        assert is_in_sight(sample)
    # As far out as it goes one notch in is one notch in: the view is not stuck.
    viewport = sample.window.viewports[SOURCE]
    scroll(sample, SOURCE, -200)
    furthest = viewport.camera.distance
    scroll(sample, SOURCE, 3)
    assert viewport.camera.distance < 0.95 * furthest


def test_a_bone_that_was_panned_away_says_how_it_comes_back(sample):
    viewport = sample.window.viewports[SOURCE]
    for _ in range(8):
        pan(sample, SOURCE, (0, 400))
    assert viewport.layer.is_bone_lost
    sample.press(Qt.Key.Key_Home)
    assert not viewport.layer.is_bone_lost


def test_the_key_that_changes_how_cameras_move_together_says_what_it_switched_to(sample):
    said = []
    for _ in range(3):
        sample.press(Qt.Key.Key_K)
        said.append(sample.window.statusBar().currentMessage())
    assert len(set(said)) == 3
    assert all(words.startswith("Cameras: ") for words in said)
