"""A subject of whom there are landmarks but no surface, as from MRI; and points alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt

from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.drawables import Caption, Hint
from pinwarp.gui.style import theme
from pinwarp.io.samples import assets_folder
from pinwarp.session.session import Session

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


def without(user, *sides) -> None:
    """The sample as it is opened where some of its meshes were never made."""
    user.open_sample()
    session = user.session
    user.editor.replace_all(Session(), None)
    user.settle()
    for side in sides:
        session = replace(session, **{side.value: None})
    user.editor.replace_all(session, None)
    user.settle()


def places(user, side) -> np.ndarray:
    view = user.window.viewports[side]
    return view.project(np.array([pair.position(side) for pair in user.session.pairs]))


def is_framed(user, side) -> bool:
    view, seen = user.window.viewports[side], places(user, side)
    inside = (seen > 0).all() and (seen < [view.width(), view.height()]).all()
    return bool(inside and np.ptp(seen[:, 1]) > 0.6 * view.height())


def test_without_a_destination_mesh_the_warped_source_is_the_bone(user):
    without(user, DESTINATION)
    view = user.window.viewports[DESTINATION]
    actor = view.renderer.actors["overlay"]
    assert actor.GetVisibility()
    assert actor.prop.opacity == 1.0
    assert actor.prop.color.hex_rgb == theme.SOURCE_COLOUR
    assert view.drawn(Hint) is None
    assert view.drawn(Caption).file == "no mesh yet (Ctrl+2)"
    assert is_framed(user, DESTINATION)
    # Hiding the overlay hides nothing: it is all there is.
    user.trigger("overlay")
    assert actor.GetVisibility()
    # Opened in the end, the bone is what it always was, and the warp lies over it.
    user.window.parts.documents.open_mesh(DESTINATION, assets_folder() / "femur_subject.ply")
    user.settle()
    assert view.renderer.actors["overlay"].prop.color.hex_rgb == theme.OVERLAY_COLOUR


def test_without_a_destination_mesh_landmarks_are_dragged_and_the_bone_follows(user):
    without(user, DESTINATION)
    view = user.window.viewports[DESTINATION]
    name = user.session.pairs[0].name
    before, points = user.session.landmark(name).destination, view.overlay_points
    start = user.place_of(DESTINATION, before)
    user.drag(view, start, start + QPoint(-25, 10))
    after = user.session.landmark(name).destination
    assert (user.place_of(DESTINATION, after) - start - QPoint(-25, 10)).manhattanLength() <= 2
    assert np.abs(view.overlay_points - points).max() > 1
    user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert user.session.landmark(name).destination == before


def test_a_map_of_distances_says_that_there_is_no_destination(user):
    without(user, DESTINATION)
    user.trigger("map_distance")
    assert "destination" in user.window.statusBar().currentMessage()
    user.trigger("map_volume")
    assert user.window.viewports[DESTINATION].renderer.actors["overlay"].prop.opacity == 1.0


def test_points_alone_are_framed_and_shown(user):
    without(user, SOURCE, DESTINATION)
    for side in Side:
        assert user.window.viewports[side].drawn(Hint) is None
        assert is_framed(user, side)
    assert "no mesh" in user.window.parts.guidance.hint.text()


@pytest.mark.parametrize("key", ["export_report", "export_mesh", "export_picture"])
def test_report_mesh_and_picture_leave_without_a_destination_mesh(user, key):
    without(user, DESTINATION)
    assert user.window.actions_by_key[key].isEnabled()


def test_the_report_is_written_without_a_destination_mesh(user, tmp_path):
    without(user, DESTINATION)
    user.dialogs.saves.append(tmp_path / "report.html")
    user.trigger("export_report")
    user.settle()
    assert not user.dialogs.errors
    assert "fovea_capitis" in (tmp_path / "report.html").read_text(encoding="utf-8")
