"""User stories: the previous penalty, for as long as B is held."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from qtpy.QtCore import QEvent, QPoint, Qt
from qtpy.QtGui import QKeyEvent
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication, QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui.penalty.comparison import PenaltyTrail
from pinwarp.gui.scene.drawables import Badge
from pinwarp.session import edits
from pinwarp.session.editor import Editor


@pytest.fixture
def user(user):
    """Has opened the sample and set two penalties, 20 and then 5."""
    user.open_sample()
    for penalty in (20.0, 5.0):
        commit(user, penalty)
    return user


def commit(user, penalty):
    user.editor.commit(edits.set_penalty(user.session, penalty), "Change penalty")
    user.settle()


def hold(user, widget=None):
    QTest.keyPress(widget or user.window, Qt.Key.Key_B)
    user.settle()


def let_go(user, widget=None):
    QTest.keyRelease(widget or user.window, Qt.Key.Key_B)
    user.settle()


def badge(user):
    shown = user.window.viewports[Side.DESTINATION].drawn(Badge)
    return shown.words if shown is not None else ""


def shown(user):
    return user.window.viewports[Side.DESTINATION].overlay_points


def test_holding_b_shows_the_previous_penalty_and_letting_go_the_present_one(user):
    present, residual = shown(user), user.window.parts.penalty.panel.figures.residual.text()
    hold(user)
    assert user.session.settings.penalty == 20
    assert user.editor.committed.settings.penalty == 5
    assert badge(user) == "B: previous penalty 20 mm (hold)"
    assert user.window.parts.penalty.panel.value.text() == "20"
    assert user.window.parts.penalty.panel.figures.residual.text() != residual
    assert np.abs(shown(user) - present).max() > 0.01
    let_go(user)
    assert user.session.settings.penalty == 5
    assert not user.editor.is_previewing
    assert badge(user) == ""
    assert user.window.parts.penalty.panel.figures.residual.text() == residual
    assert np.abs(shown(user) - present).max() < 1e-3


def test_a_comparison_leaves_nothing_in_the_history(user):
    user.trigger("undo")
    assert (user.editor.undo_label, user.editor.redo_label) == ("Change penalty",) * 2
    before = (user.session, user.editor.is_dirty)
    hold(user)
    assert user.session.settings.penalty == 5, "what was undone came before"
    let_go(user)
    assert (user.session, user.editor.is_dirty) == before
    assert (user.editor.undo_label, user.editor.redo_label) == ("Change penalty",) * 2


@pytest.mark.parametrize("focus", ["table", "viewport", "slider"])
def test_the_key_counts_wherever_the_focus_is(user, focus):
    window = user.window
    widget = {
        "table": window.parts.table.table,
        "viewport": window.viewports[Side.SOURCE],
        "slider": window.parts.penalty.panel.slider,
    }[focus]
    widget.setFocus()
    hold(user, widget)
    assert user.session.settings.penalty == 20
    let_go(user, widget)
    assert user.session.settings.penalty == 5


def test_a_name_with_a_b_in_it_can_be_typed(user):
    field = user.window.parts.table.panel.filter
    field.setFocus()
    user.qtbot.keyClicks(field, "b")
    assert field.text() == "b"
    assert not user.editor.is_previewing


def test_the_key_that_repeats_itself_changes_nothing(user):
    hold(user)
    for kind in (QEvent.Type.KeyRelease, QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress) * 3:
        event = QKeyEvent(kind, Qt.Key.Key_B, Qt.KeyboardModifier.NoModifier, "b", True)
        QApplication.sendEvent(user.window, event)
        user.settle()
        assert user.session.settings.penalty == 20
    let_go(user)
    assert user.session.settings.penalty == 5


def test_another_window_in_front_ends_it(user, qtbot):
    hold(user)
    other = QWidget()
    qtbot.addWidget(other)
    other.show()
    other.activateWindow()
    assert QTest.qWaitForWindowActive(other)
    user.settle()
    assert user.session.settings.penalty == 5
    assert badge(user) == ""
    let_go(user)
    assert not user.editor.is_previewing


def test_a_click_while_it_is_held_ends_it_before_it_counts(user):
    hold(user)
    user.click(Side.SOURCE, user.free_place(Side.SOURCE))
    assert len(user.session.landmarks) == 21
    assert user.session.settings.penalty == 5, "no preview slips into what is committed"
    assert badge(user) == ""
    let_go(user)
    assert user.session.settings.penalty == 5


def test_undo_while_it_is_held_ends_it(user):
    hold(user)
    user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert user.session.settings.penalty == 20
    assert not user.editor.is_previewing
    let_go(user)
    assert user.session.settings.penalty == 20


def test_a_commit_from_elsewhere_while_it_is_held_stands(user):
    hold(user)
    user.editor.commit(edits.set_unit(user.editor.committed, "cm"), "Change unit")
    user.settle()
    assert (user.session.unit, user.session.settings.penalty) == ("cm", 5)
    assert badge(user) == ""
    let_go(user)
    assert user.session.unit == "cm"


def test_during_a_drag_of_the_slider_the_key_waits(user):
    slider = user.window.parts.penalty.panel.slider
    share = slider.value() / slider.maximum()
    start = QPoint(round(slider.place_of(share)), slider.height() // 2)
    end = QPoint(200, slider.height() // 2)
    user.drag(slider, start, end, release=False)
    sliding = user.session.settings.penalty
    hold(user)
    assert user.session.settings.penalty == sliding
    let_go(user)
    QTest.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=end)
    user.settle()
    assert not user.editor.is_previewing


def test_the_menu_goes_back_to_the_previous_penalty_and_forth(user):
    user.trigger("swap_penalty")
    assert user.session.settings.penalty == 20
    assert user.editor.undo_label == "Go back to previous penalty"
    user.trigger("swap_penalty")
    assert user.session.settings.penalty == 5
    user.trigger("undo")
    assert user.session.settings.penalty == 20


def test_without_a_previous_penalty_the_key_says_so(user):
    user.editor.replace_all(user.session, None)
    user.settle()
    assert not user.window.actions_by_key["swap_penalty"].isEnabled()
    hold(user)
    assert "no previous penalty" in user.window.statusBar().currentMessage()
    assert not user.editor.is_previewing
    let_go(user)


def test_the_sheet_of_shortcuts_names_the_key(user):
    (lines,) = [lines for title, lines in user.window.shortcuts.lines() if title == "Warp"]
    assert ("B (hold)", "Compare with Previous Penalty") in lines


@given(st.lists(st.sampled_from([0.0, 1.0, 2.0, "undo", "redo", "unit"]), max_size=20))
def test_the_previous_penalty_is_the_last_other_one_that_was_committed(acts):
    editor = Editor()
    trail, seen = PenaltyTrail(editor), [0.0]
    for act in acts:
        if act == "undo":
            editor.undo()
        elif act == "redo":
            editor.redo()
        elif act == "unit":
            other = "cm" if editor.committed.unit == "mm" else "mm"
            editor.commit(edits.set_unit(editor.committed, other), "Change unit")
        else:
            editor.commit(edits.set_penalty(editor.committed, act), "Change penalty")
        trail.follow()
        seen.append(editor.committed.settings.penalty)
        others = [penalty for penalty in seen if penalty != seen[-1]]
        assert trail.previous == (others[-1] if others else None)
