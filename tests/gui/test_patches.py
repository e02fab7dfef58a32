"""User stories: semilandmarks spread over surfaces."""

from __future__ import annotations

import numpy as np
from qtpy.QtCore import QPoint, Qt
from qtpy.QtTest import QTest
from tests.gui.drawing import (
    CTRL,
    DESTINATION,
    LEFT,
    PLAIN,
    SHIFT,
    SOURCE,
    choose,
    dots,
    draw,
    names,
    panel,
    part,
    ring,
)

from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.gui.scene.drawables import DotKind, ToolWords
from pinwarp.io.samples import sample_session
from pinwarp.session import edits

ENTER, ESC = Qt.Key.Key_Return, Qt.Key.Key_Escape


def said(user):
    return user.window.statusBar().currentMessage()


def test_the_whole_surface_is_covered_by_one_key_and_the_count_is_dragged(user):
    user.open_sample()
    before = user.session
    user.press(Qt.Key.Key_C, SHIFT)
    (patch,) = user.session.groups
    assert (patch.name, patch.count, patch.around) == ("patch_1", 300, "")
    assert user.editor.undo_label == "Spread patch_1"
    assert user.editor.view.group == "patch_1"
    assert user.window.parts.warps.result.not_sliding is None
    for side in (SOURCE, DESTINATION):
        places, view = dots(user, side).positions, user.window.viewports[side]
        assert len(places) == 300
        assert max(view.surface.closest(place)[1] for place in places[::10]) < 0.1
        # Those behind the bone are treated as landmarks' signs are.
        assert 50 < view.layer.semilandmarks.hidden_dots(dots(user, side)).sum() < 250
    # Fewer are the first of more, and many steps of a drag are one to undo.
    slider = panel(user).slider
    panel(user).parentWidget().raise_()
    user.settle()
    start = QPoint(int(0.27 * slider.width()), slider.height() // 2)
    user.drag(slider, start, start + QPoint(-20, 0), steps=4)
    thinned = user.session.groups[0]
    assert thinned.count < 300
    assert thinned.points == patch.points[: thinned.count]
    spin = panel(user).spin
    spin.setFocus()
    spin.selectAll()
    QTest.keyClicks(spin, "330")
    QTest.keyClick(spin, ENTER)
    user.settle()
    assert user.session.groups[0].count == 330
    assert len(dots(user, DESTINATION).positions) == 330
    user.press(Qt.Key.Key_Z, CTRL)
    assert user.session.groups == (patch,)
    user.press(Qt.Key.Key_Z, CTRL)
    assert user.session == before
    assert dots(user, SOURCE) is None


def test_a_patch_fills_the_clicked_side_of_a_closed_curve(user):
    user.open_sample()
    middle, around = ring(user, 8)
    draw(user, around, end=None)
    view = user.window.viewports[SOURCE]
    user.press(Qt.Key.Key_C, SHIFT)
    assert "inside a closed curve" in view.drawn(ToolWords).words
    assert user.window.actions_by_key["add_patch"].isChecked()
    # Left by Esc, and nothing happens.
    user.press(ESC)
    assert names(user) == ["curve_1"]
    user.press(Qt.Key.Key_C, SHIFT)
    user.click(DESTINATION, user.free_place(DESTINATION))
    assert "laid over the source" in said(user)
    user.click(SOURCE, around[0])
    assert "lies on the curve" in said(user)
    assert part(user).patch_tool.is_active
    user.click(SOURCE, middle)
    assert names(user) == ["curve_1", "patch_1"]
    patch = user.session.groups[1]
    assert patch.around == "curve_1"
    assert not part(user).patch_tool.is_active
    places = np.array([view.project(np.array([point]))[0] for point in patch.points])
    radius = np.hypot(*(QPoint(around[0] - middle)).toTuple())
    assert (np.hypot(*(places - [middle.x(), middle.y()]).T) < 1.1 * radius).all()
    # The whole surface in spite of the curve.
    user.press(Qt.Key.Key_C, SHIFT)
    user.press(ENTER)
    assert user.session.groups[2].around == ""
    user.trigger("add_whole_patch")
    assert names(user)[2:] == ["patch_2", "patch_3"]
    # Without its curve the patch stays as it is.
    choose(user, "curve_1")
    user.trigger("remove_group")
    assert user.session.groups[0].points == patch.points
    while user.editor.undo_label is not None:
        user.press(Qt.Key.Key_Z, CTRL)
    assert names(user) == []


def test_points_of_a_patch_are_listed_pinned_and_excluded(user):
    user.open_sample()
    user.press(Qt.Key.Key_C, SHIFT)
    choose(user, "patch_1", 250)
    assert panel(user).model.rowCount(panel(user).model.index_of("patch_1")) == 300
    assert "mm" in panel(user).model.index(250, 4, panel(user).model.index_of("patch_1")).data()
    chosen = dots(user, DESTINATION)
    assert np.flatnonzero(chosen.kinds == DotKind.CHOSEN).tolist() == [250]
    pairs = len(user.session.pairs)
    user.trigger("pin_point")
    assert len(user.session.pairs) == pairs + 1
    assert user.session.groups[0].excluded == {250}
    assert part(user).note.text() == "299 semilandmarks"
    user.press(Qt.Key.Key_Z, CTRL)
    assert len(user.session.pairs) == pairs
    assert user.session.groups[0].excluded == frozenset()
    # A click on an empty part of the view chooses none, and another row another.
    choose(user, "patch_1")
    assert (dots(user, DESTINATION).kinds == DotKind.AT_REST).all()
    assert not user.window.actions_by_key["pin_point"].isEnabled()


def test_what_is_spread_meanwhile_is_not_lost_nor_laid_over_another_bone(user):
    user.open_sample()
    view = user.window.viewports[DESTINATION]
    marker = next(
        m for m, out in zip(view.layer.markers, view.layer.hidden(), strict=True)
        if not out and m.movable
    )  # fmt: skip
    at = user.place_of(DESTINATION, marker.position)
    # A landmark is dragged while points are spread: both are there in the end.
    user.window.actions_by_key["add_whole_patch"].trigger()
    user.drag(view, at, at + QPoint(0, 15), release=False)
    QTest.mouseRelease(view, LEFT, PLAIN, at + QPoint(0, 15))
    user.settle()
    assert names(user) == ["patch_1"]
    assert user.session.landmark(marker.name).destination != marker.position
    assert user.editor.undo_label == "Spread patch_1"
    # A landmark that came meanwhile is kept away from.
    user.window.actions_by_key["add_whole_patch"].trigger()
    user.editor.commit(edits.set_unit(user.editor.committed, "cm"), "Change unit")
    user.settle()
    assert names(user) == ["patch_1", "patch_2"]
    assert user.session.unit == "cm"
    # Another session is opened meanwhile: it gets none of it.
    user.window.actions_by_key["add_whole_patch"].trigger()
    panel(user).count_requested.emit("patch_1", 400)
    user.window.parts.documents.open_session(sample_session())
    user.settle()
    assert names(user) == []
    # And the window may close while it is busy.
    user.window.actions_by_key["add_whole_patch"].trigger()


def test_a_patch_asked_of_the_next_bone_while_one_of_the_last_is_spread_is_made(user):
    user.open_sample()
    before = user.session.mesh(SOURCE)
    # Nothing settles in between, as when hands are fast and the bone is large.
    QTest.keyClick(user.window, Qt.Key.Key_C, SHIFT)
    user.window.actions_by_key["mirror_x"].trigger()
    mirrored = user.session.mesh(SOURCE)
    assert mirrored is not before
    QTest.keyClick(user.window, Qt.Key.Key_C, SHIFT)
    user.settle()
    assert names(user) == ["patch_1"]
    points = user.session.groups[0].points
    assert SurfaceIndex(mirrored).distances(np.array(points)).max() < 1e-6


def test_sides_with_a_patch_are_not_swapped_and_it_is_said_why(user):
    user.open_sample()
    user.press(Qt.Key.Key_C, SHIFT)
    before = user.session
    assert names(user) == ["patch_1"]
    user.trigger("swap_sides")
    assert user.session == before
    assert said(user).startswith("patch_1 cannot change sides")
