"""The window itself: on the screen as a whole, its panels without a word too many."""

from __future__ import annotations

import pytest
from qtpy.QtCore import QPoint, QRect, QSettings, Qt
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QDockWidget
from tests.gui.conftest import close_window

from pinwarp.gui.window.main_window import MainWindow


@pytest.fixture
def too_large(nothing_leaks, qtbot, dialogs, qapp, tmp_path):
    """A window that is shown larger than the screen, and partly off it."""
    window = MainWindow(QSettings(str(tmp_path / "s.ini"), QSettings.Format.IniFormat), dialogs)
    room = window.screen().availableGeometry()
    window.setGeometry(room.left() + 60, room.top() + 40, room.width() + 300, room.height() + 200)
    window.show()
    assert QTest.qWaitForWindowExposed(window)
    yield window, room
    close_window(window, dialogs)


def test_a_window_larger_than_the_screen_is_made_to_fit_status_bar_and_all(too_large, qtbot):
    window, room = too_large
    qtbot.waitUntil(lambda: room.contains(window.frameGeometry()))
    hint = window.statusBar()
    assert room.contains(QRect(hint.mapToGlobal(QPoint(0, 0)), hint.size()))


def test_a_panel_behind_a_tab_has_its_title_once_and_on_its_own_a_title_bar(user):
    window = user.window
    landmarks = next(x for x in window.findChildren(QDockWidget) if x.objectName() == "landmarks")
    assert landmarks.titleBarWidget().height() == 0
    landmarks.setFloating(True)
    user.settle()
    assert landmarks.titleBarWidget() is None
    landmarks.setFloating(False)
    user.settle()
    assert landmarks.titleBarWidget().height() == 0


def test_names_have_the_width_that_figures_leave_them_and_all_is_seen_in_a_small_window(user):
    user.open_sample()
    table = user.window.parts.table.table
    name = table.columnWidth(0)
    longest = max(table.fontMetrics().horizontalAdvance(mark.name) for mark in user.session.pairs)
    assert name >= longest + 44
    # The arrow of the order has its room where it stands, and only there.
    header = table.horizontalHeader()
    residual = next(
        n
        for n in range(header.count())
        if "Residual" in str(table.model().headerData(n, Qt.Orientation.Horizontal))
    )
    before = table.columnWidth(residual)
    at = QPoint(header.sectionViewportPosition(residual) + 10, header.height() // 2)
    QTest.mouseClick(header.viewport(), Qt.MouseButton.LeftButton, pos=at)
    user.settle()
    assert table.columnWidth(residual) > before
    QTest.mouseClick(header.viewport(), Qt.MouseButton.LeftButton, pos=at)
    QTest.mouseClick(header.viewport(), Qt.MouseButton.LeftButton, pos=at)
    user.settle()
    assert table.columnWidth(residual) == before
    user.window.resize(1024, 580)
    user.settle()
    assert table.horizontalScrollBar().maximum() == 0
