"""User stories: looking at both bones."""

from __future__ import annotations

import numpy as np
import pytest
from qtpy.QtCore import QPoint, QPointF, QRectF, Qt
from qtpy.QtGui import QColor, QImage, QPainter, QWheelEvent
from qtpy.QtWidgets import QApplication, QMenu

from pinwarp.core.alignment import Similarity, fit_similarity
from pinwarp.core.landmarks import Landmark, Side, as_position, positions
from pinwarp.core.mesh import Mesh
from pinwarp.gui.drawn.section import Section
from pinwarp.gui.painted.scale_bar import paint_scale_bar
from pinwarp.gui.scene.camera_pose import Pose, inverse
from pinwarp.gui.scene.drawables import Caption, Markers, ScaleBar
from pinwarp.gui.window.menus import shortcut_groups
from pinwarp.io.mesh_formats.ply import write_ply
from pinwarp.io.meshes import read_mesh
from pinwarp.io.samples import assets_folder
from pinwarp.session import edits
from pinwarp.session.view import LinkMode

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
# The destination lies on its back in another corner of the room, a tenth larger, in metres.
# It lies along x, and its front is the other one's back.
TURNED = Similarity(
    np.array([[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]]),
    0.0011,
    np.array([0.4, -2, 1.0]),
)


@pytest.fixture
def turned(user, tmp_path):
    """The same femur twice, the second one turned, moved and scaled; no landmarks yet."""
    path = assets_folder() / "femur_generic.ply"
    mesh = read_mesh(path).mesh
    other = tmp_path / "turned.ply"
    write_ply(other, Mesh(TURNED.apply(mesh.vertices), mesh.faces))
    user.window.parts.documents.open_mesh(SOURCE, path)
    user.window.parts.documents.open_mesh(DESTINATION, other)
    user.settle()
    return user


def places(user, count):
    vertices = user.session.mesh(SOURCE).vertices
    rows = [int(np.argmax(vertices @ d)) for d in np.random.default_rng(1).normal(size=(40, 3))]
    chosen = list(dict.fromkeys(rows))[:count]
    return vertices[chosen]


def pair(user, count, one_by_one=False):
    landmarks = [
        Landmark(f"p{i}", as_position(p), as_position(TURNED.apply(p)))
        for i, p in enumerate(places(user, count))
    ]
    for some in [[x] for x in landmarks] if one_by_one else [landmarks]:
        user.editor.commit(edits.import_pairs(user.session, some), "Import pairs")
        user.settle()


def pose(user, side):
    return Pose.of(user.window.viewports[side].camera)


def orbit(user, side, by=(70, 25)):
    corner = QPoint(20, 150)
    user.drag(user.window.viewports[side], corner, corner + QPoint(*by))


def pan(user, side, by=(30, -40)):
    corner = QPoint(20, 150)
    viewport = user.window.viewports[side]
    user.drag(viewport, corner, corner + QPoint(*by), button=Qt.MouseButton.MiddleButton)


def scroll(user, side, notches=3):
    viewport = user.window.viewports[side]
    at = QPointF(viewport.rect().center())
    for _ in range(abs(notches)):
        event = QWheelEvent(
            at,
            QPointF(viewport.mapToGlobal(at.toPoint())),
            QPoint(),
            QPoint(0, 120 if notches > 0 else -120),
            Qt.MouseButton.NoButton,
            Qt.KeyboardModifier.NoModifier,
            Qt.ScrollPhase.NoScrollPhase,
            False,
        )
        QApplication.sendEvent(viewport, event)
    user.settle()


def sees_the_same(user, tolerance=0.02):
    """Whether corresponding places are at the same place of both views, in shares of the height."""
    landmarks = user.session.pairs
    seen = []
    for side in Side:
        viewport = user.window.viewports[side]
        centre = np.array([viewport.width(), viewport.height()]) / 2
        seen.append((viewport.project(positions(landmarks, side)) - centre) / viewport.height())
    return np.abs(seen[0] - seen[1]).max() < tolerance


def from_the_same_side(user):
    there = TURNED.rotation @ pose(user, SOURCE).frame
    return np.allclose(there, pose(user, DESTINATION).frame, atol=1e-6)


# Linked cameras


def test_pairs_from_a_file_show_both_bones_from_the_same_side(turned):
    assert not from_the_same_side(turned)
    pair(turned, 6)
    assert from_the_same_side(turned)
    assert sees_the_same(turned)


@pytest.mark.parametrize("side", Side)
def test_orbit_pan_and_zoom_of_either_view_move_both(turned, side):
    pair(turned, 6)
    for move in (orbit, pan, scroll):
        before = {s: pose(turned, s) for s in Side}
        move(turned, side)
        assert not any(before[s].is_at(pose(turned, s)) for s in Side)
        assert from_the_same_side(turned)
        assert sees_the_same(turned)


def test_two_pairs_link_the_motion_but_not_the_side(turned):
    pair(turned, 2)
    before = {side: pose(turned, side) for side in Side}
    orbit(turned, SOURCE)
    after = {side: pose(turned, side) for side in Side}
    by = {side: before[side].frame.T @ after[side].frame for side in Side}
    assert not np.allclose(by[SOURCE], np.eye(3), atol=0.1)
    assert np.allclose(by[SOURCE], by[DESTINATION], atol=1e-6)
    assert not from_the_same_side(turned)


def test_the_third_pair_turns_nothing_until_a_camera_moves(turned):
    pair(turned, 2, one_by_one=True)
    before = pose(turned, DESTINATION)
    pair(turned, 4, one_by_one=True)
    assert pose(turned, DESTINATION).is_at(before)
    orbit(turned, SOURCE, (10, 0))
    assert from_the_same_side(turned)
    assert sees_the_same(turned)


def test_home_takes_over_the_pairs_too(turned):
    pair(turned, 4, one_by_one=True)
    turned.press(Qt.Key.Key_Home)
    assert from_the_same_side(turned)
    for side in Side:
        viewport = turned.window.viewports[side]
        seen = viewport.project(turned.session.mesh(side).vertices)
        height = np.ptp(seen[:, 1]) / viewport.height()
        assert 0.8 < height < 0.92
        assert seen.min() > 0
        assert (seen < [viewport.width(), viewport.height()]).all()


def test_home_keeps_the_side_that_is_seen_and_shift_home_goes_back_to_the_first(turned):
    first = {side: pose(turned, side) for side in Side}
    pair(turned, 4, one_by_one=True)
    orbit(turned, SOURCE)
    scroll(turned, SOURCE, 5)
    seen = {side: pose(turned, side) for side in Side}
    turned.press(Qt.Key.Key_Home)
    for side in Side:
        assert np.allclose(pose(turned, side).frame, seen[side].frame, atol=1e-6)
        viewport = turned.window.viewports[side]
        places = viewport.project(turned.session.mesh(side).vertices)
        assert places.min() > 0
        assert (places < [viewport.width(), viewport.height()]).all()
    turned.press(Qt.Key.Key_Home, Qt.KeyboardModifier.ShiftModifier)
    assert np.allclose(pose(turned, SOURCE).frame, first[SOURCE].frame, atol=1e-6)
    assert from_the_same_side(turned)


def test_pairs_on_one_line_do_not_turn_the_other_bone(turned):
    low, high = turned.session.mesh(SOURCE).bounds
    line = [low + t * (high - low) for t in (0, 0.3, 0.6, 1)]
    landmarks = [
        Landmark(f"p{i}", as_position(p), as_position(TURNED.apply(p))) for i, p in enumerate(line)
    ]
    before = pose(turned, DESTINATION)
    turned.editor.commit(edits.import_pairs(turned.session, landmarks), "Import pairs")
    turned.settle()
    assert pose(turned, DESTINATION).is_at(before)


def test_k_goes_through_linked_rotation_only_and_free(turned):
    pair(turned, 6)
    actions = turned.window.actions_by_key
    assert actions["link_linked"].isChecked()
    turned.press(Qt.Key.Key_K)
    assert turned.editor.view.link is LinkMode.ROTATION
    assert actions["link_rotation"].isChecked()
    before = pose(turned, DESTINATION)
    pan(turned, SOURCE)
    scroll(turned, SOURCE)
    assert np.allclose(pose(turned, DESTINATION).focal_point, before.focal_point)
    assert pose(turned, DESTINATION).distance == pytest.approx(before.distance)
    orbit(turned, SOURCE)
    assert from_the_same_side(turned)
    assert np.allclose(pose(turned, DESTINATION).focal_point, before.focal_point)
    turned.press(Qt.Key.Key_K)
    assert turned.editor.view.link is LinkMode.FREE
    before = pose(turned, DESTINATION)
    orbit(turned, SOURCE)
    assert pose(turned, DESTINATION).is_at(before)
    turned.press(Qt.Key.Key_K)
    assert actions["link_linked"].isChecked()
    assert sees_the_same(turned), "a link that is switched on acts at once"


def test_each_view_keeps_its_own_clipping_range(turned):
    pair(turned, 6)
    scroll(turned, SOURCE)
    near_far = [turned.window.viewports[side].camera.GetClippingRange() for side in Side]
    assert near_far[0][1] > 100
    assert near_far[1][1] < 10


def test_an_empty_view_neither_follows_nor_leads(user):
    user.window.parts.documents.open_mesh(SOURCE, assets_folder() / "femur_generic.ply")
    user.settle()
    before = pose(user, DESTINATION)
    orbit(user, SOURCE)
    assert pose(user, DESTINATION).is_at(before)
    user.window.parts.documents.open_mesh(DESTINATION, assets_folder() / "femur_subject.ply")
    user.settle()
    there = user.window.viewports[DESTINATION]
    seen = there.project(user.session.mesh(DESTINATION).vertices)
    assert seen.min() > 0


def test_looking_is_never_undone_nor_unsaved(user):
    user.open_sample()
    dirty = user.editor.is_dirty
    orbit(user, SOURCE)
    for key in (Qt.Key.Key_K, Qt.Key.Key_2, Qt.Key.Key_F):
        user.press(key)
    assert user.editor.undo_label is None
    assert user.editor.is_dirty == dirty


# Standard views and focus


def test_keys_one_to_six_look_from_the_six_sides_of_the_source(turned):
    pair(turned, 6)
    front = None
    directions = {}
    for key in "123456":
        turned.press(getattr(Qt.Key, f"Key_{key}"))
        frame = pose(turned, SOURCE).frame
        assert np.allclose(np.abs(frame).max(axis=0), 1), "along the axes of the source's frame"
        assert from_the_same_side(turned)
        front = frame if front is None else front
        directions[key] = frame[:, 2] @ front
    expected = {
        "1": (0, 0, 1),
        "2": (0, 0, -1),
        "3": (-1, 0, 0),
        "4": (1, 0, 0),
        "5": (0, 1, 0),
        "6": (0, -1, 0),
    }
    for key, direction in expected.items():
        assert np.allclose(directions[key], direction), key


def test_f_centres_both_views_on_the_selected_landmark(turned):
    pair(turned, 6)
    before = pose(turned, SOURCE)
    chosen = turned.session.landmarks[2]
    turned.editor.select(chosen.name)
    turned.press(Qt.Key.Key_F)
    for side in Side:
        assert np.allclose(pose(turned, side).focal_point, chosen.position(side))
    assert pose(turned, SOURCE).distance < 0.7 * before.distance
    assert np.allclose(pose(turned, SOURCE).frame, before.frame)
    orbit(turned, DESTINATION)
    for side in Side:
        assert np.allclose(pose(turned, side).focal_point, chosen.position(side))


def test_f_shows_where_the_missing_side_of_a_landmark_must_be(turned):
    pair(turned, 6)
    place = places(turned, 7)[6]
    turned.editor.commit(
        edits.place(turned.session, DESTINATION, as_position(TURNED.apply(place)))[0], "Place"
    )
    turned.editor.select(turned.session.landmarks[-1].name)
    turned.press(Qt.Key.Key_F)
    assert np.allclose(pose(turned, SOURCE).focal_point, place, atol=0.01)


def test_f_without_a_selection_shows_everything(turned):
    pair(turned, 6)
    turned.editor.select()
    scroll(turned, SOURCE, 5)
    near = pose(turned, SOURCE).distance
    turned.press(Qt.Key.Key_F)
    assert pose(turned, SOURCE).distance > 1.2 * near
    assert sees_the_same(turned)


# Without a window


def test_a_mapped_pose_sees_the_mapped_bone_and_the_way_back_is_exact():
    rng = np.random.default_rng(0)
    fit = fit_similarity(rng.normal(size=(5, 3)), rng.normal(size=(5, 3)))
    here = Pose(rng.normal(size=3), rng.normal(size=3), rng.normal(size=3), 2.0)
    there = here.mapped(fit)
    assert there.distance == pytest.approx(fit.scale * here.distance)
    assert np.allclose(there.frame, fit.rotation @ here.frame)
    back = there.mapped(inverse(fit))
    assert np.allclose(back.position, here.position)
    assert np.allclose(back.frame, here.frame)


# Scale bar, landmark size, wireframe, cross-section


@pytest.mark.parametrize("parallel", [False, True])
def test_the_scale_bar_is_as_long_as_its_length_looks_at_the_focal_plane(user, parallel):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    viewport.camera.SetParallelProjection(parallel)
    here = pose(user, SOURCE)
    across = 50.0 * here.frame[:, 0]
    ends = viewport.project(np.array([here.focal_point, here.focal_point + across]))
    pixels = float(np.linalg.norm(ends[1] - ends[0]))
    assert 50.0 / viewport.unit_per_pixel == pytest.approx(pixels, rel=1e-6)
    assert viewport.drawn(ScaleBar).ruler.unit == "mm"


def test_the_scale_bar_is_in_the_corner_in_the_unit_of_the_session(qapp):
    view = QRectF(0, 0, 400, 300)
    picture = QImage(400, 300, QImage.Format.Format_RGB32)
    picture.fill(Qt.GlobalColor.white)
    painter = QPainter(picture)
    where = paint_scale_bar(painter, view, 0.5, "cm")
    painter.end()
    assert where.width() == pytest.approx(100, abs=2), "50 cm"
    assert view.contains(where)
    assert where.right() > 380
    assert where.bottom() > 280
    assert picture.pixelColor(int(where.center().x()), int(where.bottom())) != QColor("white")


def test_brackets_change_the_size_of_the_landmarks_within_bounds(user):
    user.open_sample()
    viewport = user.window.viewports[SOURCE]
    assert viewport.drawn(Markers).radius == 6
    user.press(Qt.Key.Key_BracketRight)
    assert viewport.drawn(Markers).radius == 7
    for _ in range(8):
        user.press(Qt.Key.Key_BracketRight)
    assert viewport.drawn(Markers).radius == 12
    assert not user.window.actions_by_key["markers_larger"].isEnabled()
    for _ in range(10):
        user.press(Qt.Key.Key_BracketLeft)
    assert viewport.drawn(Markers).radius == 4


def test_shift_w_draws_the_bones_as_edges_and_back(user):
    user.open_sample()
    for style in ("Wireframe", "Surface"):
        user.press(Qt.Key.Key_W, Qt.KeyboardModifier.ShiftModifier)
        for viewport in user.window.viewports.values():
            assert viewport.renderer.actors["bone"].prop.style == style
    assert user.window.viewports[DESTINATION].renderer.actors["overlay"].prop.style == "Surface"


def test_the_cross_section_lets_a_click_through_to_the_inside(user):
    user.open_sample_meshes()
    viewport = user.window.viewports[SOURCE]
    place = user.places_down_the_bone(SOURCE, 5)[4]
    at = user.place_of(SOURCE, place)
    eye = pose(user, SOURCE).frame[:, 2]
    renders = viewport.renders
    user.press(Qt.Key.Key_X)
    assert viewport.renders > renders
    user.click(SOURCE, at)
    (landmark,) = user.session.landmarks
    depths = user.session.mesh(SOURCE).vertices @ eye
    middle = (depths.min() + depths.max()) / 2
    assert np.array(place) @ eye > middle
    assert np.array(landmark.source) @ eye <= middle + 1e-6
    # The cut stays where it is in the bone when the camera turns.
    before = viewport.section.plane.GetNormal()
    orbit(user, SOURCE)
    assert viewport.section.plane.GetNormal() == before
    user.press(Qt.Key.Key_X)
    assert viewport.section is None
    assert viewport.renderer.actors["bone"].mapper.GetClippingPlanes() is None or (
        viewport.renderer.actors["bone"].mapper.GetClippingPlanes().GetNumberOfItems() == 0
    )


def test_landmarks_on_the_part_that_is_cut_away_are_faint_and_cannot_be_grabbed(user):
    user.open_sample_meshes()
    place = user.places_down_the_bone(SOURCE, 5)[1]
    user.click_position(SOURCE, place)
    layer = user.window.viewports[SOURCE].layer
    assert not layer.hidden()[0]
    user.press(Qt.Key.Key_X)
    assert layer.hidden()[0]
    slider = user.window.parts.looks.section_slider
    user.drag(slider, slider.rect().center(), QPoint(2, slider.height() // 2))
    assert user.editor.view.section == 0
    assert not layer.hidden()[0]


def test_the_overlay_is_cut_too_and_its_inside_is_drawn(user):
    user.open_sample()
    overlay = user.window.viewports[DESTINATION].renderer.actors["overlay"]
    assert overlay.prop.culling == "back"
    user.press(Qt.Key.Key_X)
    assert overlay.mapper.GetClippingPlanes().GetNumberOfItems() == 1
    assert overlay.prop.culling == "none"
    user.press(Qt.Key.Key_X)
    assert overlay.prop.culling == "back"


def test_a_section_clips_towards_the_eye_and_sight_begins_at_the_cut():
    section = Section([0, 0, 1.0], np.array([[0, 0, 0], [0, 0, 10.0]]))
    section.move(0.3)
    assert section.clips([[0, 0, 8.0], [0, 0, 6.0]]).tolist() == [True, False]
    eye, far = np.array([0, 0, 100.0]), np.array([0, 0, -100.0])
    assert np.allclose(section.entry(eye, far), [0, 0, 7])
    assert section.entry(eye, np.array([0, 0, 9.0])) is None
    assert np.allclose(section.entry(far, eye), far)


def test_escape_during_a_drag_brings_the_overlay_back(user):
    user.open_sample()
    there = user.window.viewports[DESTINATION]
    before = there.overlay_points
    marker = next(
        m
        for m, hidden in zip(there.layer.markers, there.layer.hidden(), strict=True)
        if not hidden and m.movable
    )
    start = user.place_of(DESTINATION, marker.position)
    user.drag(there, start, start + QPoint(0, 25), release=False)
    assert not np.allclose(there.overlay_points, before)
    user.press(Qt.Key.Key_Escape, widget=there)
    assert np.allclose(there.overlay_points, before)


# The menu


def test_every_action_can_be_reached_in_a_menu_inner_menus_included(user):
    menus = user.window.menuBar().findChildren(QMenu)
    found = {action.objectName() for menu in menus for action in menu.actions()}
    actions = user.window.actions_by_key
    assert set(actions) <= found
    listed = [
        action.objectName()
        for _, group in shortcut_groups(actions.values())
        for action in group
        if action.objectName()
    ]
    assert len(listed) == len(set(listed)) == len(actions)
    assert {"&Import", "&Look From", "Ca&meras"} <= {menu.title() for menu in menus}


# Whole bones


def test_swapping_the_sides_takes_every_position_with_its_bone_and_can_be_undone(user):
    user.open_sample()
    before = user.session
    user.trigger("swap_sides")
    after = user.session
    assert after.mesh(SOURCE) is before.mesh(DESTINATION)
    assert after.landmarks[0].source == before.landmarks[0].destination
    assert user.window.viewports[SOURCE].drawn(Caption).file == "femur_subject.ply"
    vertices = after.mesh(SOURCE).vertices
    assert len(user.window.viewports[DESTINATION].overlay_points) == len(vertices)
    shown = {marker.name for marker in user.window.viewports[DESTINATION].layer.markers}
    assert shown == {x.name for x in after.landmarks if x.destination is not None}
    assert user.editor.undo_label == "Swap source and destination"
    user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert user.session == before
    assert edits.swap_sides(after) == before


def test_a_mirrored_source_is_saved_and_comes_back_the_same(user, sample_copy):
    user.window.parts.documents.open_session(sample_copy)
    user.settle()
    mesh, landmark = user.session.mesh(SOURCE), user.session.landmarks[0]
    bytes_before = user.session.source.path.read_bytes()
    user.trigger("mirror_x")
    mirrored = user.session.mesh(SOURCE)
    middle = mesh.bounds[:, 0].mean()
    assert np.allclose(mirrored.vertices[:, 0], 2 * middle - mesh.vertices[:, 0])
    assert np.array_equal(mirrored.vertices[:, 1:], mesh.vertices[:, 1:])
    assert user.session.landmarks[0].source[0] == pytest.approx(2 * middle - landmark.source[0])
    surface = user.window.viewports[SOURCE].surface
    assert not surface.inside_out, "triangles turn round, so that normals point outwards"
    assert "mirrored" in user.window.viewports[SOURCE].drawn(Caption).file
    user.press(Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
    assert "# source_mirrored: x\n" in sample_copy.read_text(encoding="utf-8")
    saved = user.session
    user.trigger("open_sample")
    user.window.parts.documents.open_session(sample_copy)
    user.settle()
    assert np.array_equal(user.session.mesh(SOURCE).vertices, mirrored.vertices)
    assert np.array_equal(user.session.mesh(SOURCE).faces, mirrored.faces)
    assert user.session.landmarks == saved.landmarks
    assert user.session.source.path.read_bytes() == bytes_before, "the mesh file is untouched"


def test_mirroring_is_one_step_to_undo_and_needs_a_source(user):
    assert not user.window.actions_by_key["mirror_x"].isEnabled()
    user.open_sample()
    before = user.session
    user.trigger("mirror_z")
    assert user.editor.undo_label == "Mirror source across z"
    user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert user.session == before
