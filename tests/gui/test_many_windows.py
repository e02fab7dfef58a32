"""Many windows at once, panels that float, and all of it closed in any order."""

from __future__ import annotations

import numpy as np
import pytest
from qtpy.QtCore import QEvent, QPoint, Qt
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QAbstractButton, QApplication, QDockWidget
from tests.gui.conftest import Driver, ScriptedDialogs, close_window, open_window

from pinwarp.core.landmarks import Side
from pinwarp.gui.window.main_window import MainWindow

# Ten do, too; each takes seconds to open.
COUNT = 3


@pytest.fixture
def users(nothing_leaks, qtbot, tmp_path, state_folder):
    """Windows of one user, on one state folder; those still open are closed."""
    made = []
    for _ in range(COUNT):
        dialogs = ScriptedDialogs()
        made.append(Driver(open_window(dialogs, tmp_path, state_folder), dialogs, qtbot))
    yield made
    for one in made:
        close_window(one.window, one.dialogs)
    made.clear()


def test_windows_work_side_by_side_and_are_closed_in_any_order(users):
    for one in users:
        one.window.actions_by_key["open_sample"].trigger()
    for number, one in enumerate(users):
        one.settle()
        one.window.activateWindow()
        assert QTest.qWaitForWindowActive(one.window)
        one.editor.select(*[pair.name for pair in one.session.pairs][: number + 1])
        one.press(Qt.Key.Key_Delete)
        assert len(one.session.pairs) == 15 - number
    # What is done in one window is not done in another.
    assert [len(one.session.pairs) for one in users] == list(range(15, 15 - COUNT, -1))
    order = np.random.default_rng(5).permutation(COUNT).tolist()
    for place, number in enumerate(order):
        one = users[number]
        one.window.close()
        assert not one.window.isVisible()
        assert one.dialogs.errors == []
        for other in (users[i] for i in order[place + 1 : place + 2]):
            other.window.activateWindow()
            assert QTest.qWaitForWindowActive(other.window)
            before = other.session
            other.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
            assert len(other.session.pairs) == 16 != len(before.pairs)
            other.press(Qt.Key.Key_Y, Qt.KeyboardModifier.ControlModifier)
            assert other.session == before


def docks_of(user):
    return [dock for dock in user.window.findChildren(QDockWidget) if not dock.isHidden()]


def float_all(user):
    """Float every panel, as a double click on its title or its tab does."""
    found = docks_of(user)
    for dock in found:
        dock.setFloating(True)
        user.settle()
        assert dock.isFloating()
        assert dock.isVisible()
    return found


def test_a_window_is_closed_with_all_its_panels_floating(user):
    user.open_sample()
    panels = float_all(user)
    assert len(panels) >= 6
    user.window.close()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    QApplication.processEvents()
    assert not any(panel.isVisible() for panel in panels)
    assert not [x for x in QApplication.topLevelWidgets() if x.isVisible()]


def test_all_landmarks_are_deleted_and_undone_while_panels_float(user):
    user.open_sample()
    float_all(user)
    names = [mark.name for mark in user.session.landmarks]
    table = user.window.parts.table.table
    user.press(Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier, table)
    assert len(user.editor.selection.names) == len(names)
    user.press(Qt.Key.Key_Delete, Qt.KeyboardModifier.ControlModifier)
    assert user.session.landmarks == ()
    user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert [mark.name for mark in user.session.landmarks] == names
    assert table.model().rowCount() == len(names)
    # A click on a bone reaches it as ever.
    user.click(Side.SOURCE, user.free_place(Side.SOURCE))
    assert len(user.session.landmarks) == len(names) + 1


def test_floating_panels_go_home_with_reset_layout_and_keep_what_they_show(user):
    user.open_sample()
    before = {dock.objectName(): dock.geometry() for dock in docks_of(user)}
    for dock in float_all(user):
        dock.move(dock.pos() + QPoint(40, 60))
    user.trigger("reset_layout")
    for dock in docks_of(user):
        assert not dock.isFloating()
    after = {dock.objectName(): dock.geometry() for dock in docks_of(user)}
    assert after.keys() == before.keys()
    for name in ("landmarks", "penalty"):
        assert after[name] == before[name]
    assert user.window.parts.table.table.model().rowCount() == len(user.session.landmarks)


def test_a_floating_panel_is_closed_by_its_button_and_opened_again_by_the_menu(user):
    user.open_sample()
    for dock in float_all(user):
        button = dock.findChild(QAbstractButton, "qt_dockwidget_closebutton")
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
        user.settle()
        assert dock.isHidden(), dock.objectName()
        dock.toggleViewAction().trigger()
        user.settle()
        assert dock.isVisible(), dock.objectName()
        assert isinstance(dock.parentWidget(), MainWindow)
