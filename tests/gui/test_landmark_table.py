"""User stories: working with many landmarks in the table."""

from __future__ import annotations

import time
import warnings
from dataclasses import replace

import pytest
from qtpy.QtCore import QEvent, QMimeData, QObject, QPoint, QPointF, QRect, Qt
from qtpy.QtGui import QDragEnterEvent, QDragMoveEvent, QDropEvent, QGuiApplication
from qtpy.QtTest import QTest
from qtpy.QtWidgets import (
    QApplication,
    QInputDialog,
    QLineEdit,
    QPlainTextEdit,
    QStyle,
    QStyleOptionHeader,
    QToolTip,
)

from pinwarp.core.landmarks import Landmark, LandmarkState, Role, Side
from pinwarp.gui.style import theme
from pinwarp.gui.table.columns import COLUMNS, column_number
from pinwarp.gui.table.rename_dialog import RenameDialog
from pinwarp.session import edits

CONTROL, SHIFT, ALT = (
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.AltModifier,
)
NO_KEY = Qt.KeyboardModifier.NoModifier


class TableUser:
    """Clicks and types in the table."""

    def __init__(self, user) -> None:
        self.user = user
        self.window = user.window
        self.table = user.window.parts.table.table
        self.panel = user.window.parts.table.panel

    @property
    def session(self):
        return self.user.session

    def shown(self):
        order = self.table.order
        return [order.landmark(order.index(row, 0)).name for row in range(order.rowCount())]

    def selected(self):
        return self.user.editor.selection.names

    def said(self):
        return self.window.statusBar().currentMessage()

    def cell(self, name, key="name"):
        return self.table.visualRect(self.table.index_of(name, column_number(key)))

    def click(self, name, key="name", modifier=NO_KEY, button=Qt.MouseButton.LeftButton):
        at = self.cell(name, key).center()
        QTest.mouseClick(self.table.viewport(), button, modifier, at)
        self.user.settle()

    def double_click(self, name, key="name"):
        at = self.cell(name, key).center()
        QTest.mouseClick(self.table.viewport(), Qt.MouseButton.LeftButton, NO_KEY, at)
        QTest.mouseDClick(self.table.viewport(), Qt.MouseButton.LeftButton, NO_KEY, at)
        return self.table.findChild(QLineEdit)

    def click_header(self, key):
        header = self.table.horizontalHeader()
        x = header.sectionViewportPosition(column_number(key)) + 15
        at = QPoint(x, header.height() // 2)
        QTest.mouseClick(header.viewport(), Qt.MouseButton.LeftButton, NO_KEY, at)

    def press(self, key, modifier=NO_KEY):
        self.user.press(key, modifier, self.table)

    def choose(self, menu, words):
        """Click an entry of an open menu."""
        action = next(a for a in menu.actions() if a.text().replace("&", "") == words)
        at = menu.actionGeometry(action).center()
        QTest.mouseClick(menu, Qt.MouseButton.LeftButton, NO_KEY, at)
        self.user.settle()

    def undo(self, label):
        assert self.user.editor.undo_label == label
        assert self.window.actions_by_key["undo"].text() == f"&Undo {label}"
        self.user.trigger("undo")


def landmark(name, i):
    return Landmark(name, (i, 2 * i, 0.5), (i, 2 * i, 1.5))


@pytest.fixture
def four(user):
    """Four pairs: b, a10, a9, c; c lacks its destination."""
    landmarks = [landmark(name, i) for i, name in enumerate(["b", "a10", "a9", "c"])]
    session = edits.import_pairs(user.session, landmarks)
    user.editor.replace_all(edits.remove_side(session, "c", Side.DESTINATION), None)
    user.settle()
    return TableUser(user)


class Paints(QObject):
    """Counts how often a widget is painted."""

    def __init__(self, widget):
        super().__init__()
        self.count = 0
        widget.installEventFilter(self)

    def eventFilter(self, _widget, event):
        self.count += event.type() == QEvent.Type.Paint
        return False


def test_figures_that_run_are_painted_ten_times_a_second_and_the_last_ones_too(four):
    table = four.table
    model = table.order.sourceModel()
    paints = Paints(table.viewport())
    begin = time.monotonic()
    for _ in range(30):
        QApplication.processEvents()
        model.dataChanged.emit(model.index(0, 0), model.index(3, len(COLUMNS) - 1))
    before, passed = paints.count, time.monotonic() - begin
    assert before <= 2 + passed / 0.1
    four.user.qtbot.waitUntil(lambda: paints.count > before)


# Sorting, filtering, order


def test_a_header_click_sorts_and_the_third_brings_the_order_back(four):
    before = four.session
    four.click_header("name")
    assert four.shown() == ["a9", "a10", "b", "c"]
    four.click_header("name")
    assert four.shown() == ["c", "b", "a10", "a9"]
    four.click_header("name")
    assert four.shown() == ["b", "a10", "a9", "c"]
    assert four.session is before


def test_the_header_menu_brings_the_order_back(four):
    four.click_header("name")
    header = four.table.horizontalHeader()
    header.customContextMenuRequested.emit(QPoint(20, 8))
    four.choose(four.panel.header_menu, "Original Order")
    assert four.shown() == ["b", "a10", "a9", "c"]


def test_what_has_no_number_comes_last_in_both_directions(four):
    four.window.parts.table.model.show_values("residual", {"b": 1.0, "a10": 3.0, "a9": 2.0})
    four.click_header("residual")
    assert four.shown() == ["b", "a9", "a10", "c"]
    four.click_header("residual")
    assert four.shown() == ["a10", "a9", "b", "c"]


def test_control_f_filters_by_name_or_state_and_escape_shows_all(four):
    four.user.press(Qt.Key.Key_F, CONTROL)
    assert four.panel.filter.hasFocus()
    QTest.keyClicks(four.panel.filter, "A1")
    assert four.shown() == ["a10"]
    assert four.panel.count.text() == "1 of 4"
    QTest.keyClick(four.panel.filter, Qt.Key.Key_Escape)
    assert len(four.shown()) == 4
    QTest.keyClicks(four.panel.filter, "incomplete")
    assert four.shown() == ["c"]
    QTest.keyClick(four.panel.filter, Qt.Key.Key_Down)
    assert four.table.hasFocus()


def test_a_filter_deselects_what_it_hides(four):
    four.click("b")
    four.click("c", modifier=CONTROL)
    four.panel.filter.setText("c")
    assert four.selected() == ("c",)


def test_a_disabled_pair_stays_dimmed_and_out_under_sorting_and_filtering(four):
    four.user.editor.commit(edits.set_enabled(four.session, ["b"], False), "Disable b")
    four.user.settle()
    four.click_header("name")
    four.panel.filter.setText("disabled")
    assert four.shown() == ["b"]
    colour = four.table.index_of("b").data(Qt.ItemDataRole.ForegroundRole)
    assert colour.name() == theme.STATE_COLOURS[LandmarkState.DISABLED]
    assert [x.name for x in four.session.pairs] == ["a10", "a9"]
    four.click("b")
    four.press(Qt.Key.Key_D, CONTROL)
    assert four.session.landmark("b").enabled


def test_rows_are_dragged_to_another_place(four):
    table = four.table
    four.click("a9")
    data = four.window.parts.table.model.mimeData([four.window.parts.table.model.index(2, 0)])
    at = QPointF(four.cell("b").left() + 60, four.cell("b").top() + 1)
    drop(table, data, at)
    assert four.shown() == ["a9", "b", "a10", "c"]
    assert four.selected() == ("a9",)
    four.undo("Reorder a9")
    assert four.shown() == ["b", "a10", "a9", "c"]


def drop(table, data: QMimeData, at: QPointF) -> None:
    """Let go of dragged rows; what Qt sends while a drag is under way."""
    arguments = (data, Qt.MouseButton.LeftButton, NO_KEY)
    move = Qt.DropAction.MoveAction
    with warnings.catch_warnings():
        # PySide calls the only constructors that there are deprecated.
        warnings.simplefilter("ignore", DeprecationWarning)
        events = [
            kind(at.toPoint(), move, *arguments) for kind in (QDragEnterEvent, QDragMoveEvent)
        ]
    for event in (*events, QDropEvent(at, move, *arguments)):
        QApplication.sendEvent(table.viewport(), event)


def test_rows_are_not_dragged_while_sorted_or_filtered(four):
    assert four.table.dragEnabled()
    four.click_header("name")
    assert not four.table.dragEnabled()
    four.table.restore_order()
    assert four.table.dragEnabled()
    four.panel.filter.setText("a")
    assert not four.table.dragEnabled()


def test_alt_and_arrows_move_rows_in_one_step(four):
    four.click("a9")
    four.press(Qt.Key.Key_Up, ALT)
    four.press(Qt.Key.Key_Up, ALT)
    assert four.shown() == ["a9", "b", "a10", "c"]
    four.press(Qt.Key.Key_Down, ALT)
    assert four.shown() == ["b", "a9", "a10", "c"]
    four.undo("Reorder a9")
    assert four.shown() == ["b", "a10", "a9", "c"]
    four.click_header("name")
    four.press(Qt.Key.Key_Up, ALT)
    assert "original order" in four.said()


# Several at once


def test_a_stretch_of_rows_is_selected_in_the_views_and_disabled_in_one_step(four):
    four.click("b")
    four.click("a9", modifier=SHIFT)
    assert four.selected() == ("b", "a10", "a9")
    markers = four.window.viewports[Side.SOURCE].layer.markers
    assert [m.name for m in markers if m.selected] == ["b", "a10", "a9"]
    four.press(Qt.Key.Key_D, CONTROL)
    assert four.session.pairs == ()
    assert four.window.actions_by_key["toggle_enabled"].text() == "&Enable"
    four.undo("Disable 3 landmarks")
    assert len(four.session.pairs) == 3


def test_several_landmarks_are_deleted_at_once(four):
    four.click("b")
    four.click("c", modifier=CONTROL)
    four.press(Qt.Key.Key_Delete, CONTROL)
    assert four.shown() == ["a10", "a9"]
    four.undo("Delete 2 landmarks")


def test_a_click_on_the_lock_turns_it_and_selects_nothing(four):
    four.click("a9", "locked")
    assert [x.name for x in four.session.landmarks if x.locked] == ["a9"]
    assert four.selected() == ()
    four.click("a9", "locked")
    assert not four.session.landmark("a9").locked
    four.undo("Unlock a9")


def test_a_click_on_a_selected_lock_turns_all_selected(four):
    four.click("b")
    four.click("a10", modifier=CONTROL)
    four.click("b", "locked")
    assert [x.name for x in four.session.landmarks if x.locked] == ["b", "a10"]
    assert four.selected() == ("b", "a10")
    four.press(Qt.Key.Key_L, CONTROL)
    four.undo("Unlock 2 landmarks")
    four.undo("Lock 2 landmarks")


def test_the_menu_makes_a_passenger_and_a_pair_again(four):
    before = four.session
    four.click("a9", button=Qt.MouseButton.RightButton)
    assert four.selected() == ("a9",)
    four.table.customContextMenuRequested.emit(four.cell("a9").center())
    four.choose(four.panel.row_menu, "Make Passenger")
    assert four.session.landmark("a9").role is Role.PASSENGER
    four.table.customContextMenuRequested.emit(four.cell("a9").center())
    four.choose(four.panel.row_menu, "Make Pair")
    assert four.session == before
    four.undo("Make a9 a pair")
    four.undo("Make a9 a passenger")


def test_the_menu_offers_everything_with_its_key(four):
    four.click("a9")
    four.table.customContextMenuRequested.emit(four.cell("a9").center())
    entries = [
        (a.text().replace("&", ""), a.shortcut().toString())
        for a in four.panel.row_menu.actions()
        if not a.isSeparator()
    ]
    four.panel.row_menu.close()
    expected = [
        ("Rename Landmark", "F2"),
        ("Rename Several…", "Ctrl+F2"),
        ("Note…", "Shift+F2"),
        ("Disable", "Ctrl+D"),
        ("Lock", "Ctrl+L"),
        ("Make Passenger", "Ctrl+Shift+P"),
        ("Copy", "Ctrl+C"),
        ("Paste", "Ctrl+V"),
        ("Delete Position", "Del"),
        ("Delete Landmark", "Ctrl+Del"),
    ]
    assert [entry for entry in entries if entry in expected] == expected


def test_a_note_is_written_and_found_by_the_filter(four):
    four.click("b")
    four.press(Qt.Key.Key_F2, SHIFT)
    dialog = four.window.findChild(QInputDialog)
    QTest.keyClicks(dialog.findChild(QPlainTextEdit), "worn")
    dialog.accept()
    assert four.session.landmark("b").note == "worn"
    four.panel.filter.setText("worn")
    assert four.shown() == ["b"]
    four.undo("Note on b")


# Names


def test_a_taken_name_is_refused_in_place_and_the_editor_stays(four):
    line = four.double_click("b")
    line.selectAll()
    QTest.keyClicks(line, "a9")
    QTest.keyClick(line, Qt.Key.Key_Return)
    reason = "There is already a landmark called a9: choose another name."
    assert QToolTip.text() == reason
    assert four.said() == reason
    assert line.isVisible()
    assert line.selectedText() == "a9"
    QTest.keyClicks(line, "apex")
    QTest.keyClick(line, Qt.Key.Key_Return)
    four.user.settle()
    assert four.shown() == ["apex", "a10", "a9", "c"]
    assert four.selected() == ("apex",)
    four.undo("Rename b")


def test_escape_gives_a_refused_name_up(four):
    line = four.double_click("b")
    line.setText("a9")
    QTest.keyClick(line, Qt.Key.Key_Return)
    QTest.keyClick(line, Qt.Key.Key_Escape)
    assert four.table.findChild(QLineEdit) is None or not line.isVisible()
    assert four.shown() == ["b", "a10", "a9", "c"]
    assert four.user.editor.undo_label is None


def test_the_key_for_renaming_leaves_a_name_that_is_being_typed_alone(four):
    four.click("a9")
    four.press(Qt.Key.Key_F2)
    line = four.table.findChild(QLineEdit)
    line.selectAll()
    QTest.keyClicks(line, "ape")
    four.press(Qt.Key.Key_F2)
    assert four.table.findChild(QLineEdit) is line
    assert four.user.editor.undo_label is None
    QTest.keyClicks(line, "x")
    QTest.keyClick(line, Qt.Key.Key_Return)
    four.user.settle()
    assert four.shown() == ["b", "a10", "apex", "c"]


def test_a_name_that_does_not_fit_the_filter_is_taken_and_leaves_the_table(four):
    four.table.set_filter("a")
    four.click("a9")
    four.press(Qt.Key.Key_F2)
    line = four.table.findChild(QLineEdit)
    line.selectAll()
    QTest.keyClicks(line, "zz")
    QTest.keyClick(line, Qt.Key.Key_Tab)
    four.user.settle()
    assert [landmark.name for landmark in four.session.landmarks] == ["b", "a10", "zz", "c"]
    assert four.shown() == ["a10"]


def test_many_are_renamed_by_a_pattern(four):
    four.click("b")
    four.click("a9", modifier=SHIFT)
    four.press(Qt.Key.Key_F2)
    dialog = four.window.findChild(RenameDialog)
    dialog.pattern.selectAll()
    QTest.keyClicks(dialog.pattern, "c")
    rename = dialog.buttons.button(dialog.buttons.StandardButton.Ok)
    assert "already a landmark called c" in dialog.problem.text()
    assert not rename.isEnabled()
    assert not dialog.preview.topLevelItem(0).icon(1).isNull(), "not by its colour alone"
    dialog.pattern.selectAll()
    QTest.keyClicks(dialog.pattern, "p_{n:02}")
    assert dialog.preview.topLevelItem(0).icon(1).isNull()
    assert dialog.problem.text() == ""
    assert dialog.preview.topLevelItem(2).text(1) == "p_03"
    QTest.mouseClick(rename, Qt.MouseButton.LeftButton)
    four.user.settle()
    assert four.shown() == ["p_01", "p_02", "p_03", "c"]
    assert four.selected() == ("p_01", "p_02", "p_03")
    four.undo("Rename 3 landmarks")
    assert four.shown() == ["b", "a10", "a9", "c"]


def test_many_are_renamed_by_find_and_replace(four):
    four.click("a10")
    four.click("a9", modifier=SHIFT)
    four.press(Qt.Key.Key_F2, CONTROL)
    dialog = four.window.findChild(RenameDialog)
    dialog.ways.setCurrentIndex(1)
    QTest.keyClicks(dialog.find, "a")
    QTest.keyClicks(dialog.replacement, "left_")
    QTest.keyClick(dialog, Qt.Key.Key_Return)
    four.user.settle()
    assert four.shown() == ["b", "left_10", "left_9", "c"]


# Coordinates


def test_a_typed_number_moves_a_landmark_and_a_bad_one_is_refused(four):
    four.user.trigger("show_coordinates")
    line = four.double_click("a9", "source_y")
    assert line.text() == "4.0"
    line.selectAll()
    QTest.keyClicks(line, "far")
    QTest.keyClick(line, Qt.Key.Key_Return)
    assert four.said() == "'far' is not a number. Type one such as 12.5."
    assert line.isVisible()
    QTest.keyClicks(line, "7.25")
    QTest.keyClick(line, Qt.Key.Key_Return)
    four.user.settle()
    assert four.session.landmark("a9").source == (2, 7.25, 0.5)
    four.undo("Move a9")


def test_an_unplaced_side_takes_three_numbers(four):
    four.user.trigger("show_coordinates")
    line = four.double_click("c", "destination_x")
    QTest.keyClicks(line, "7")
    QTest.keyClick(line, Qt.Key.Key_Return)
    assert "type all three" in four.said()
    QTest.keyClicks(line, "7 8 9")
    QTest.keyClick(line, Qt.Key.Key_Return)
    four.user.settle()
    assert four.session.landmark("c").destination == (7, 8, 9)


def test_the_coordinates_of_a_locked_landmark_cannot_be_typed(four):
    four.user.trigger("show_coordinates")
    four.click("a9", "locked")
    assert four.double_click("a9", "source_x") is None


def test_while_all_are_frozen_nothing_moves_by_typing_or_pasting(four):
    before = four.session
    four.click("a9")
    four.press(Qt.Key.Key_C, CONTROL)
    four.user.editor.look(locked=True)
    four.user.trigger("show_coordinates")
    line = four.double_click("a9", "source_x")
    QTest.keyClicks(line, "5")
    QTest.keyClick(line, Qt.Key.Key_Return)
    four.user.settle()
    assert "locked" in four.said()
    text = QGuiApplication.clipboard().text()
    QGuiApplication.clipboard().setText(text.replace("4.0", "7.0"))
    four.press(Qt.Key.Key_V, CONTROL)
    assert "locked" in four.user.dialogs.told[0][1]
    assert four.session == before


def test_coordinates_come_and_go_and_the_names_get_the_rest(four):
    table, header = four.table, four.table.horizontalHeader()
    before = header.sectionSize(0)
    four.user.trigger("show_coordinates")
    assert not table.isColumnHidden(column_number("source_x"))
    four.user.trigger("show_coordinates")
    assert table.isColumnHidden(column_number("source_x"))
    assert header.sectionSize(0) == before
    for text in ("a", "zzz", ""):
        four.panel.filter.setText(text)
        four.click_header("name")
        four.user.settle()
        assert header.sectionSize(0) == before
    header.resizeSection(column_number("residual"), 90)
    four.user.settle()
    assert header.length() == table.viewport().width()


def test_no_title_is_cut(four):
    four.user.trigger("show_coordinates")
    header, style = four.table.horizontalHeader(), four.table.style()
    option = QStyleOptionHeader()
    option.initFrom(header)
    option.sortIndicator = QStyleOptionHeader.SortIndicator.SortDown
    for section, column in enumerate(COLUMNS):
        option.rect = QRect(0, 0, header.sectionSize(section), header.height())
        room = style.subElementRect(QStyle.SubElement.SE_HeaderLabel, option, header)
        words = column.short_title or column.title
        needed = 16 if column.header_icon else header.fontMetrics().horizontalAdvance(words)
        assert room.width() >= needed, column.title


# Spreadsheets


def test_rows_are_copied_as_a_spreadsheet_takes_them(four):
    four.click("c")
    four.press(Qt.Key.Key_C, CONTROL)
    header, row = QGuiApplication.clipboard().text().splitlines()
    assert header.split("\t")[:4] == ["name", "role", "enabled", "source_x"]
    assert row.split("\t") == ["c", "pair", "1", "3.0", "6.0", "0.5", "", "", "", ""]


def test_pasted_rows_change_known_landmarks_and_add_new_ones_in_one_step(four):
    before = four.session
    QGuiApplication.clipboard().setText(
        "name\tdestination_x\tdestination_y\tdestination_z\tnote\n"
        "c\t1\t2\t3\t\nnew\t\t\t\tlook here\nb\t1\toops\t3\t\n"
    )
    four.press(Qt.Key.Key_V, CONTROL)
    assert four.session.landmark("c").state is LandmarkState.PAIRED
    assert four.session.landmark("new").note == "look here"
    assert four.selected() == ("c", "new")
    ((_, text, details),) = four.user.dialogs.told
    assert "line 4: 'oops' is not a number" in text + details
    four.undo("Paste 2 landmarks")
    assert four.session == before


STRANGERS = "name\tsource_x\tsource_y\tsource_z\nsoleus\t1\t2\t3\nplantaris\t4\t5\t6\n"


@pytest.fixture
def paired(four):
    marks = tuple(x for x in four.session.landmarks if x.is_pair)
    four.user.editor.replace_all(replace(four.session, landmarks=marks), None)
    four.user.settle()
    return four


@pytest.mark.parametrize(("answer", "role"), [(0, Role.PASSENGER), (1, Role.PAIR), (2, None)])
def test_rows_that_would_wait_for_ever_are_asked_about(paired, answer, role):
    before = paired.session
    assert before.landmarks
    QGuiApplication.clipboard().setText(STRANGERS)
    paired.user.dialogs.choices = [answer]
    paired.press(Qt.Key.Key_V, CONTROL)
    ((_, text, _, labels),) = paired.user.dialogs.choice_questions
    assert text.startswith("2 landmarks are not here yet")
    assert labels == ["Add as Passengers", "Add as New Landmarks", "Cancel"]
    if role is None:
        assert paired.session is before
        assert "nothing was changed" in paired.said()
        return
    assert [x.role for x in paired.session.landmarks[-2:]] == [role] * 2
    paired.undo("Paste 2 landmarks")
    assert paired.session == before


def test_the_rows_that_are_known_can_be_pasted_alone(paired):
    before = paired.session
    name = before.landmarks[0].name
    QGuiApplication.clipboard().setText(f"{STRANGERS}{name}\t7\t8\t9\n")
    paired.user.dialogs.choices = [2]
    paired.press(Qt.Key.Key_V, CONTROL)
    assert paired.user.dialogs.choice_questions[0][3][2] == "Only the Others"
    assert [x.name for x in paired.session.landmarks] == [x.name for x in before.landmarks]
    assert paired.session.landmark(name).source == (7, 8, 9)


def test_pasting_moves_no_locked_landmark(four):
    four.click("c")
    four.press(Qt.Key.Key_C, CONTROL)
    four.click("c", "locked")
    text = QGuiApplication.clipboard().text()
    QGuiApplication.clipboard().setText(text.replace("3.0", "4.0"))
    four.press(Qt.Key.Key_V, CONTROL)
    assert four.session.landmark("c").source == (3, 6, 0.5)
    assert "locked" in four.user.dialogs.told[0][1]


def test_text_that_is_no_table_is_refused_in_words(four):
    QGuiApplication.clipboard().setText("some sentence")
    four.press(Qt.Key.Key_V, CONTROL)
    assert "no landmarks to paste" in four.said()
    assert four.user.editor.undo_label is None


# What is left to do


def test_n_finds_the_next_incomplete_landmark_and_goes_round(four):
    session = edits.remove_side(four.session, "a10", Side.SOURCE)
    four.user.editor.commit(session, "Delete")
    four.panel.filter.setText("b")
    found = []
    for _ in range(3):
        four.press(Qt.Key.Key_N)
        found += four.selected()
    assert found == ["a10", "c", "a10"]
    assert four.panel.filter.text() == ""
    four.user.editor.commit(edits.remove(four.session, ["a10", "c"]), "Delete")
    four.press(Qt.Key.Key_N)
    assert four.said() == "All landmarks are complete."


def test_an_empty_table_says_what_to_do(user):
    table = user.window.parts.table.table
    empty = table.viewport().grab().toImage()
    user.editor.commit(edits.import_pairs(user.session, [landmark("a", 1)]), "Import")
    user.settle()
    filled = table.viewport().grab().toImage()
    # Pixels of the picture, whatever the screen's are.
    reach = round(20 * filled.devicePixelRatio())
    row = filled.height() // 4
    middle = [(x, row + y) for x in range(filled.width()) for y in range(-reach, reach)]
    assert any(empty.pixelColor(x, y) != filled.pixelColor(x, y) for x, y in middle)
