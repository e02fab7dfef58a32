"""The window itself: on the screen as a whole, its panels without a word too many."""

from __future__ import annotations

import threading

import pytest
from qtpy.QtCore import QPoint, QRect, QSettings, Qt
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication, QDockWidget, QStyleOptionTab, QTabBar, QToolButton
from tests.gui.conftest import Driver, close_window, open_window

from pinwarp.core.findings import FindingKind
from pinwarp.core.landmarks import Side
from pinwarp.gui.files.file_dialogs import Answer
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.window.main_window import MainWindow
from pinwarp.gui.window.text_size import write_in
from pinwarp.session.session import Session


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


def test_panels_get_their_width_back_when_the_window_grows_again(user):
    window = user.window
    landmarks = next(x for x in window.findChildren(QDockWidget) if x.objectName() == "landmarks")
    width = landmarks.width()
    for wanted in (width, width + 90):
        # By the border, as somebody drags it.
        edge = landmarks.mapTo(window, QPoint(-3, 200))
        end = edge - QPoint(wanted - landmarks.width(), 0)
        handle = window.windowHandle()
        QTest.mouseMove(handle, edge)
        QTest.mousePress(handle, Qt.MouseButton.LeftButton, pos=edge)
        QTest.mouseMove(handle, end)
        user.settle()
        QTest.mouseRelease(handle, Qt.MouseButton.LeftButton, pos=end)
        user.settle()
        assert landmarks.width() == pytest.approx(wanted, abs=3)
        window.resize(1024, 580)
        user.settle()
        assert landmarks.width() == pytest.approx(width, abs=3), "its tabs need it"
        window.resize(1280, 800)
        user.settle()
        assert landmarks.width() == pytest.approx(wanted, abs=3)


@pytest.fixture(params=[100, 125, 150])
def text_of_any_size(qapp, request):
    before = QApplication.font()
    write_in(request.param)
    yield
    QApplication.setFont(before)


def names_in_tabs(window):
    """The tabs at the right edge, as they are read, and how much of their row is beyond its end."""
    (bar,) = (x for x in window.findChildren(QTabBar) if x.isVisible() and x.count() == 6)
    read = []
    for row in range(bar.count()):
        option = QStyleOptionTab()
        bar.initStyleOption(option, row)
        read.append(option.text)
        words = bar.fontMetrics().horizontalAdvance(bar.tabText(row))
        assert bar.tabRect(row).width() >= words + 16
    return read, bar.tabRect(bar.count() - 1).right() + 1 - bar.width()


def test_no_name_of_a_panel_is_cut_in_a_small_window_with_large_text(text_of_any_size, user):
    window = user.window
    docks = {dock.objectName(): dock for dock in window.findChildren(QDockWidget)}
    docks["model"].show()
    whole = ["Landmarks", "Warp", "Map", "Semilandmarks", "Refine", "Model"]
    for size in ((1280, 800), (1100, 640), (1024, 580), (1280, 800)):
        # Step by step, as a border is dragged.
        for _ in range(2):
            window.resize(*size)
            user.settle()
        assert window.width() == size[0]
        # The front one needs most: the first and the longest in turn.
        for front in ("semilandmarks", "landmarks"):
            docks[front].raise_()
            user.settle()
            read, beyond = names_in_tabs(window)
            assert (read, max(beyond, 0)) == (whole, 0), size
    # Whoever makes them narrower scrolls.
    window.resizeDocks([docks["landmarks"]], [300], Qt.Orientation.Horizontal)
    user.settle()
    read, beyond = names_in_tabs(window)
    assert read == whole
    assert beyond > 0
    scroll = [x for x in window.findChildren(QToolButton) if isinstance(x.parent(), QTabBar)]
    assert any(button.isVisible() for button in scroll)


def test_new_and_close_leave_an_empty_window_and_ask_about_unsaved_work(user):
    user.open_sample()
    user.press(Qt.Key.Key_W, Qt.KeyboardModifier.ControlModifier)
    assert user.session == Session()
    assert user.dialogs.unsaved_questions == 0, "nothing was unsaved"
    user.open_sample()
    user.click(Side.SOURCE, user.free_place(Side.SOURCE))
    worked = user.session
    user.dialogs.unsaved = Answer.CANCEL
    user.press(Qt.Key.Key_N, Qt.KeyboardModifier.ControlModifier)
    assert user.session == worked
    user.dialogs.unsaved = Answer.DISCARD
    user.press(Qt.Key.Key_N, Qt.KeyboardModifier.ControlModifier)
    assert user.session == Session()
    assert user.editor.undo_label is None
    assert not user.window.isWindowModified()


def test_the_layout_goes_back_to_what_it_was_at_first(user):
    docks = {dock.objectName(): dock for dock in user.window.findChildren(QDockWidget)}
    before = {name: dock.geometry() for name, dock in docks.items() if not dock.isHidden()}
    docks["landmarks"].setFloating(True)
    docks["penalty"].close()
    user.window.addDockWidget(Qt.DockWidgetArea.LeftDockWidgetArea, docks["map"])
    user.settle()
    user.trigger("reset_layout")
    after = {name: dock.geometry() for name, dock in docks.items() if not dock.isHidden()}
    assert after.keys() == before.keys()
    for name in ("landmarks", "penalty"):
        assert docks[name].isVisible()
        assert after[name] == before[name]


def test_the_order_of_the_table_and_its_coordinates_are_there_the_next_time(
    nothing_leaks, qtbot, dialogs, tmp_path, state_folder
):
    window = open_window(dialogs, tmp_path, state_folder)
    user = Driver(window, dialogs, qtbot)
    user.open_sample()
    header = window.parts.table.table.horizontalHeader()
    at = QPoint(header.sectionViewportPosition(0) + 10, header.height() // 2)
    for _ in range(2):
        QTest.mouseClick(header.viewport(), Qt.MouseButton.LeftButton, pos=at)
    user.trigger("show_coordinates")
    close_window(window, dialogs)
    window = open_window(dialogs, tmp_path, state_folder)
    table = window.parts.table.table
    assert table.shows_coordinates
    assert window.actions_by_key["show_coordinates"].isChecked()
    assert table.horizontalHeader().sortIndicatorSection() == 0
    assert table.horizontalHeader().sortIndicatorOrder() is Qt.SortOrder.DescendingOrder
    close_window(window, dialogs)


def test_k_says_how_the_cameras_move_now(user):
    user.open_sample()
    user.press(Qt.Key.Key_K)
    assert "rotation only" in user.window.statusBar().currentMessage()


def test_no_penalty_is_suggested_while_a_swap_stands_in_the_list(user):
    user.open_sample()
    panel, take = user.window.parts.penalty.panel, user.window.actions_by_key["take_suggested"]
    names = ("midshaft_linea_aspera", "medial_epicondyle")
    user.editor.select(*names)
    user.trigger("swap_destinations")
    kinds = {found.kind for found in user.window.parts.quality.quality.findings}
    assert FindingKind.SWAPPED in kinds
    assert not take.isEnabled()
    assert not panel.suggested.isEnabled()
    assert panel.suggested.text() == "Suggested: settle first"
    assert "exchanged" in panel.suggested.toolTip()
    before = user.session
    user.press(Qt.Key.Key_T)
    assert user.session == before


def test_the_window_goes_before_what_runs_is_waited_for(user, monkeypatch):
    """Figures of a huge mesh take seconds, and are told to stop; nobody sees the wait."""
    user.open_sample()
    seen, begun, wait = [], threading.Event(), threading.Event()

    def endless(_inputs):
        begun.set()
        wait.wait(30)

    monkeypatch.setattr(user.window.parts.quality._judge, "_function", endless)
    user.window.parts.quality._judge.request(None)
    assert begun.wait(10)
    shut_down = LatestWins.shut_down

    def recorded(job):
        seen.append(user.window.isVisible())
        wait.set()
        shut_down(job)

    monkeypatch.setattr(LatestWins, "shut_down", recorded)
    user.dialogs.unsaved = Answer.DISCARD
    user.press(Qt.Key.Key_Q, Qt.KeyboardModifier.ControlModifier)
    assert seen
    assert not any(seen)
