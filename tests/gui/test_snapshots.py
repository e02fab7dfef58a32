"""User stories: pictures of several penalties side by side."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from qtpy.QtCore import Qt
from qtpy.QtGui import QImage
from qtpy.QtTest import QTest

from pinwarp.core.landmarks import Side
from pinwarp.session import edits


@pytest.fixture
def strip(user):
    user.open_sample()
    return user.window.parts.snapshots.strip


def commit(user, penalty):
    user.editor.commit(edits.set_penalty(user.session, penalty), "Change penalty")
    user.settle()


def click(user, widget):
    QTest.mouseClick(widget, Qt.MouseButton.LeftButton)
    user.settle()


def colours(picture: QImage) -> set[int]:
    return {
        picture.pixel(x, y)
        for x in range(0, picture.width(), 3)
        for y in range(0, picture.height(), 3)
    }


def test_the_strip_is_there_only_when_there_are_snapshots(user, strip):
    assert not strip.isVisible()
    height = user.window.viewports[Side.DESTINATION].height()
    user.press(Qt.Key.Key_P)
    assert strip.isVisible()
    assert len(strip.tiles) == 1
    click(user, strip.tiles[0].close_button)
    assert not strip.isVisible()
    assert user.window.viewports[Side.DESTINATION].height() == height
    # Another session has none of the one before.
    user.press(Qt.Key.Key_P)
    user.press(Qt.Key.Key_N, Qt.KeyboardModifier.ControlModifier)
    assert not strip.isVisible()
    assert user.window.parts.snapshots.snapshots == ()


def test_a_snapshot_shows_the_bones_with_penalty_and_figures(user, strip):
    commit(user, 40.0)
    user.press(Qt.Key.Key_P)
    shot = strip.tiles[0].snapshot
    assert len(colours(shot.picture)) > 100, "a bone is no flat plate"
    figures = user.window.parts.penalty.panel.figures
    words = strip.tiles[0].words.text()
    assert "<b>40 mm</b>" in words
    assert f"{shot.flexibility:.0%}" in figures.flexibility.text()
    assert f"{shot.residual:.4g} mm" in figures.residual.text()
    assert f"{shot.leave_one_out:.3g} mm" in figures.left_out.text()


def test_a_click_on_a_snapshot_takes_its_penalty_and_can_be_undone(user, strip):
    commit(user, 40.0)
    user.press(Qt.Key.Key_P)
    commit(user, 3.0)
    assert "present" not in strip.tiles[0].accessibleName()
    click(user, strip.tiles[0])
    assert user.session.settings.penalty == 40
    assert "present" in strip.tiles[0].accessibleName()
    user.trigger("undo")
    assert user.session.settings.penalty == 3


def test_a_snapshot_of_pairs_that_changed_says_so_until_they_are_back(user, strip):
    user.press(Qt.Key.Key_P)
    user.editor.select(user.session.landmarks[2].name)
    user.trigger("toggle_enabled")
    assert "pairs changed" in strip.tiles[0].words.text()
    user.trigger("undo")
    assert "pairs changed" not in strip.tiles[0].words.text()
    user.trigger("swap_sides")
    assert "mesh changed" in strip.tiles[0].words.text()


def test_a_sweep_takes_five_and_leaves_the_session_as_it_was(user, strip, tmp_path):
    commit(user, 7.0)
    user.dialogs.saves.append(tmp_path / "session.pinwarp.csv")
    user.trigger("save_as")
    commit(user, 9.0)
    user.trigger("undo")
    editor = user.editor
    before = (editor.session, editor.undo_label, editor.redo_label, editor.is_dirty)
    assert not editor.is_dirty
    user.trigger("sweep")
    assert (editor.session, editor.undo_label, editor.redo_label, editor.is_dirty) == before
    assert not editor.is_previewing
    shots = [tile.snapshot for tile in strip.tiles]
    assert [shot.flexibility for shot in shots] == pytest.approx([1, 0.75, 0.5, 0.25, 0])
    assert shots[0].inputs.settings.penalty == 0
    assert math.isinf(shots[-1].inputs.settings.penalty)
    residuals = [shot.residual for shot in shots]
    assert residuals == sorted(residuals)
    assert all(a.picture != b.picture for a, b in pairwise(shots))
    assert len({shot.picture.size().toTuple() for shot in shots}) == 1
    assert "Affine fit" in strip.tiles[-1].words.text()
    user.trigger("redo")
    assert user.session.settings.penalty == 9


def test_whoever_acts_during_a_sweep_stops_it(user, strip):
    window = user.window
    window.actions_by_key["sweep"].trigger()
    assert user.editor.is_previewing
    QTest.keyClick(window, Qt.Key.Key_Escape)
    user.settle()
    assert not user.editor.is_previewing
    assert strip.tiles == []
    assert "stopped" in window.statusBar().currentMessage()


def test_a_commit_during_a_sweep_stands(user, strip):
    user.window.actions_by_key["sweep"].trigger()
    user.editor.commit(edits.set_penalty(user.editor.committed, 11.0), "Change penalty")
    user.settle()
    assert user.session.settings.penalty == 11
    assert not user.editor.is_previewing
    assert strip.tiles == []


def test_a_window_can_be_closed_in_the_middle_of_a_sweep(user, strip):
    user.window.actions_by_key["sweep"].trigger()
    user.window.close()
    assert not user.editor.is_previewing


def test_only_the_newest_twelve_are_kept_and_all_can_be_cleared(user, strip):
    for _ in range(2):
        user.trigger("sweep")
    commit(user, 5.0)
    for _ in range(3):
        user.press(Qt.Key.Key_P)
    assert len(strip.tiles) == 12
    assert strip.tiles[0].snapshot.flexibility == pytest.approx(0.75)
    assert strip.horizontalScrollBar().maximum() > 0
    assert strip.horizontalScrollBar().value() == strip.horizontalScrollBar().maximum()
    user.trigger("clear_snapshots")
    assert not strip.isVisible()
    assert not user.window.actions_by_key["clear_snapshots"].isEnabled()


def test_without_a_warp_there_is_nothing_to_picture(user):
    user.press(Qt.Key.Key_P)
    assert "no warp" in user.window.statusBar().currentMessage()
    user.trigger("sweep")
    assert "five pairs" in user.window.statusBar().currentMessage()
    assert not user.window.parts.snapshots.strip.isVisible()
