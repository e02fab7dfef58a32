"""User stories: the grid that is bent by the warp."""

from __future__ import annotations

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt
from tests.gui.test_warp_panel import (
    DESTINATION,
    SOURCE,
    show_panel,
    slide,
    warp_of,
)

from pinwarp.core.components import applied
from pinwarp.core.landmarks import positions
from pinwarp.gui.scene.camera_pose import Pose
from pinwarp.session.view import GridKind


def grid(user, side):
    return user.window.viewports[side].grid_lines


def bent(user):
    """The source's grid as the applied warp takes it."""
    session = user.session
    factor, spline = warp_of(session)
    target = positions(session.pairs, DESTINATION)
    shown = applied(spline, factor, target, session.settings.components, session.settings.blend)
    lines = grid(user, SOURCE)
    return shown.evaluate(lines.reshape(-1, 3)).reshape(lines.shape)


def actors(user, side):
    return set(user.window.viewports[side].renderer.actors)


@pytest.mark.parametrize("key", ["grid_box", "grid_plane_x", "grid_plane_y", "grid_plane_z"])
def test_a_grid_is_straight_on_the_source_and_warped_on_the_destination(user, key):
    user.open_sample()
    assert grid(user, SOURCE) is None
    user.trigger(key)
    lines = grid(user, SOURCE)
    straight = np.linspace(lines[:, 0], lines[:, -1], lines.shape[1], axis=1)
    assert np.allclose(lines, straight, atol=1e-3)
    low, high = user.session.mesh(SOURCE).bounds
    middle = (low + high) / 2
    assert np.allclose((lines.min(axis=(0, 1)) + lines.max(axis=(0, 1))) / 2, middle, atol=1e-3)
    if key == "grid_box":
        assert (lines.min(axis=(0, 1)) < low).all()
        assert (lines.max(axis=(0, 1)) > high).all()
    else:
        axis = "xyz".index(key[-1])
        assert np.ptp(lines[:, :, axis]) == 0
    assert np.allclose(grid(user, DESTINATION), bent(user), atol=1e-3)


def test_the_key_d_goes_through_the_grids_and_back_to_none(user):
    user.open_sample()
    user.window.viewports[SOURCE].setFocus()
    seen = []
    for _ in GridKind:
        user.press(Qt.Key.Key_D)
        seen.append(user.editor.view.grid)
        assert user.window.actions_by_key[f"grid_{seen[-1].name.lower()}"].isChecked()
        assert user.window.parts.warp.panel.grid.currentData() == seen[-1]
    assert seen == [*list(GridKind)[1:], GridKind.NONE]
    assert grid(user, SOURCE) is None
    assert grid(user, DESTINATION) is None


def test_the_grid_is_chosen_on_the_panel_and_its_plane_moved_there(user):
    user.open_sample()
    show_panel(user)
    panel = user.window.parts.warp.panel
    assert not panel.grid_share.isVisible()
    panel.grid.setFocus()
    for _ in range(4):
        user.press(Qt.Key.Key_Down, widget=panel.grid)
    assert user.editor.view.grid is GridKind.PLANE_Z
    low, high = user.session.mesh(SOURCE).bounds[:, 2]
    assert np.allclose(grid(user, SOURCE)[:, :, 2], (low + high) / 2, atol=1e-3)
    before = user.editor.undo_label
    slide(user, panel.grid_share, 25)
    assert panel.grid_value.text() == "25% of z"
    assert np.allclose(grid(user, SOURCE)[:, :, 2], low + 0.25 * (high - low), atol=1e-3)
    assert np.allclose(grid(user, DESTINATION), bent(user), atol=1e-3)
    assert user.editor.undo_label == before, "a way of looking is not undone"


def test_the_grid_follows_a_landmark_while_it_is_dragged(user):
    user.open_sample()
    user.trigger("grid_box")
    before = grid(user, DESTINATION)
    user.drag_a_landmark(release=False)
    assert user.editor.is_previewing
    during = grid(user, DESTINATION)
    assert not np.allclose(during, before, atol=0.1)
    assert np.allclose(during, bent(user), atol=1e-3)
    user.press(Qt.Key.Key_Escape, widget=user.window.viewports[DESTINATION])
    assert np.allclose(grid(user, DESTINATION), before, atol=1e-4)


def test_the_grid_follows_penalty_and_blend(user):
    user.open_sample()
    user.trigger("grid_box")
    slider = user.window.parts.penalty.panel.slider
    slide(user, slider, slider.maximum() // 2)
    assert user.session.settings.penalty > 0
    assert np.allclose(grid(user, DESTINATION), bent(user), atol=1e-3)
    show_panel(user)
    slide(user, user.window.parts.warp.panel.blend, 40, release=False)
    assert user.session.settings.blend == pytest.approx(0.4)
    assert np.allclose(grid(user, DESTINATION), bent(user), atol=1e-3)


def test_a_rigid_fit_keeps_the_grid_straight(user):
    user.open_sample()
    user.trigger("grid_box")
    user.trigger("apply_rigid")
    lines, source = grid(user, DESTINATION), grid(user, SOURCE)
    assert np.allclose(
        np.linalg.norm(np.diff(lines, axis=1), axis=2),
        np.linalg.norm(np.diff(source, axis=1), axis=2),
        atol=1e-3,
    )


def test_grids_are_one_actor_each_and_leave_none_behind(user):
    user.open_sample()
    before = {side: actors(user, side) for side in (SOURCE, DESTINATION)}
    for key in ("grid_box", "grid_plane_x", "grid_plane_y", "grid_box"):
        user.trigger(key)
        for side, names in before.items():
            assert len(actors(user, side) - names) == 1
    user.trigger("grid_none")
    assert {side: actors(user, side) for side in before} == before


def test_without_a_warp_only_the_source_has_a_grid(user):
    user.trigger("grid_box")
    assert grid(user, SOURCE) is None
    user.open_sample_meshes()
    assert grid(user, SOURCE) is not None
    assert grid(user, DESTINATION) is None
    user.open_sample()
    assert np.allclose(grid(user, DESTINATION), bent(user), atol=1e-3)
    user.editor.select(*(landmark.name for landmark in user.session.landmarks))
    user.trigger("delete_landmark")
    assert grid(user, SOURCE) is not None
    assert grid(user, DESTINATION) is None


def test_another_source_has_its_own_grid(user):
    user.open_sample()
    user.trigger("grid_box")
    user.trigger("swap_sides")
    low, high = user.session.mesh(SOURCE).bounds
    lines = grid(user, SOURCE)
    assert np.allclose(
        (lines.min(axis=(0, 1)) + lines.max(axis=(0, 1))) / 2, (low + high) / 2, atol=1e-3
    )
    assert np.allclose(grid(user, DESTINATION), bent(user), atol=1e-3)


def test_fit_and_clicks_see_the_bones_as_if_there_were_no_grid(user):
    user.open_sample()
    user.trigger("fit")
    poses = {s: Pose.of(v.camera) for s, v in user.window.viewports.items()}
    user.trigger("grid_box")
    user.trigger("fit")
    for side, viewport in user.window.viewports.items():
        assert Pose.of(viewport.camera).is_at(poses[side])
    count = len(user.session.landmarks)
    user.click(SOURCE, user.free_place(SOURCE))
    assert len(user.session.landmarks) == count + 1
    placed = np.array(user.session.landmarks[-1].source)
    _, distance = user.window.viewports[SOURCE].surface.closest(placed)
    assert distance < 1e-3


def test_a_cross_section_and_linked_cameras_go_on_with_a_grid(user):
    user.open_sample()
    user.trigger("grid_box")
    user.trigger("section")
    assert user.editor.view.section is not None
    assert np.allclose(grid(user, DESTINATION), bent(user), atol=1e-3)
    corner = QPoint(20, 150)
    before = Pose.of(user.window.viewports[DESTINATION].camera)
    user.drag(user.window.viewports[SOURCE], corner, corner + QPoint(60, 20))
    assert not Pose.of(user.window.viewports[DESTINATION].camera).is_at(before)


def test_the_lines_are_seen(user):
    user.open_sample()
    viewport = user.window.viewports[DESTINATION]
    pictures = [viewport.grab().toImage()]
    user.trigger("grid_box")
    pictures.append(viewport.grab().toImage())
    place = grid(user, DESTINATION)[0, 0]
    # Pixels of the picture, whatever the screen's are.
    ((x, y),) = viewport.project(np.array([place])) * pictures[0].devicePixelRatio()
    around = [(round(x) + i, round(y) + j) for i in range(-3, 4) for j in range(-3, 4)]
    before, after = ([x.pixelColor(*at).lightness() for at in around] for x in pictures)
    assert (np.array(before) - after).max() > 30
