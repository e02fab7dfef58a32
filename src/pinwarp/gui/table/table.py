"""The table of landmarks: renders the editor's selection and asks for another."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence

from qtpy.QtCore import (
    QEvent,
    QItemSelection,
    QItemSelectionModel,
    QModelIndex,
    QPoint,
    QRect,
    QSettings,
    Qt,
    QTimer,
    Signal,
)
from qtpy.QtGui import QMouseEvent, QPainter, QPaintEvent, QResizeEvent
from qtpy.QtWidgets import QAbstractItemView, QHeaderView, QStyle, QTableView, QWidget

from pinwarp.gui.style import theme
from pinwarp.gui.table.cells import FigureCells, LandmarkCells, NameCells
from pinwarp.gui.table.columns import COLUMNS, LOCKED, NAME, column_number
from pinwarp.gui.table.model import LandmarkModel
from pinwarp.gui.table.order import LandmarkOrder
from pinwarp.session.view import Selection

__all__ = ["LandmarkModel", "LandmarkTable"]

_NAME, _LOCKED = column_number(NAME), column_number(LOCKED)
_LEAST_NAME_WIDTH = 96
_SIGN = 16
# Figures that run are painted ten times a second: faster nobody reads.
_READING_MS = 100
_EMPTY_HINT = "Click the same place\non both bones"


class LandmarkTable(QTableView):
    """The table; every row is one landmark, in the session's order unless sorted."""

    selection_requested = Signal(list, object)
    lock_requested = Signal(list, bool)
    refused = Signal(str)

    def __init__(self, model: LandmarkModel, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._model = model
        self.order = LandmarkOrder(model, self)
        self.setModel(self.order)
        self._cells = LandmarkCells(model, self.order, self)
        self._names = NameCells(model, self.order, self)
        self.setItemDelegate(self._cells)
        self.setItemDelegateForColumn(_NAME, self._names)
        self._numbers = FigureCells(model, self.order, self)
        for number, column in enumerate(COLUMNS):
            if column.has_bar:
                self.setItemDelegateForColumn(number, self._numbers)
        for cells in (self._cells, self._names):
            cells.refused.connect(self.refused)
        self._painted_at = -math.inf
        self._reading = QTimer(self, singleShot=True)
        self._reading.timeout.connect(self._paint_behind)
        # Rows and columns, first and last: Qt would forget cells that it is not told of at once.
        self._behind: set[tuple[int, int, int, int]] = set()
        self._rendering = False
        self._fitting = False
        self._set_up_rows()
        self._set_up_header()
        self._set_up_dragging()
        self.selectionModel().selectionChanged.connect(self._on_selected)

    def _set_up_rows(self) -> None:
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
        )
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.setWordWrap(False)
        # Arrows go from cell to cell: there must be a way out of the table by keys.
        self.setTabKeyNavigation(False)
        # The ends of names tell them apart more often than the middles.
        self.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.setAccessibleName("Landmarks")
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 9)

    def _set_up_header(self) -> None:
        header = self.horizontalHeader()
        header.setHighlightSections(False)
        header.setMinimumSectionSize(24)
        header.setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
        header.setSortIndicatorClearable(True)
        header.setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        self.setSortingEnabled(True)
        self.show_coordinates(False)
        # Later: while rows are sorted Qt lays the sections out anew, one after the other.
        self._fit_later = QTimer(self, singleShot=True, interval=0)
        self._fit_later.timeout.connect(self._fit_name)
        header.sectionResized.connect(lambda *_: None if self._fitting else self._fit_later.start())
        header.sortIndicatorChanged.connect(lambda *_: self._on_order())

    def _set_up_dragging(self) -> None:
        self.setDragDropMode(QAbstractItemView.DragDropMode.DragDrop)
        self.setDefaultDropAction(Qt.DropAction.MoveAction)
        self.setDragDropOverwriteMode(False)
        self.setDropIndicatorShown(True)

    # Columns

    def show_coordinates(self, shown: bool) -> None:
        """Show or hide the columns that are there on demand."""
        self.shows_coordinates = shown
        self._fitting = True
        for number, column in enumerate(COLUMNS):
            if column.on_demand:
                self.setColumnHidden(number, not shown)
        self._fitting = False
        self._fit_columns()

    def _fit_columns(self) -> None:
        """Give each column room for its title and for what it usually says; names have the rest.

        The arrow of the order takes its room only in the column that is sorted by.
        """
        header = self.horizontalHeader()
        mark = self.style().pixelMetric(QStyle.PixelMetric.PM_HeaderMarkSize, None, header)
        margin = self.style().pixelMetric(QStyle.PixelMetric.PM_HeaderMargin, None, header)
        sorted_by = header.sortIndicatorSection()
        self._fitting = True
        for number, column in enumerate(COLUMNS):
            if number != _NAME and not self.isColumnHidden(number):
                lines = self._model.title(number).split("\n")
                title = max(_width(header, line) for line in lines) or _SIGN
                sign = _SIGN if column.is_numeric and column.icon is not None else 0
                cell = sign + _width(self, column.widest) + 12
                arrow = mark + margin if number == sorted_by else 0
                header.resizeSection(number, max(title + arrow + 2 * margin, cell))
        self._fitting = False
        self._fit_name()

    def _fit_name(self) -> None:
        """Give the names the rest of the width."""
        if self._fitting:
            return
        self._fitting = True
        header = self.horizontalHeader()
        others = sum(header.sectionSize(n) for n in range(len(COLUMNS)) if n != _NAME)
        # A second time, as the first may let a scroll bar come or go.
        for _ in range(2):
            header.resizeSection(_NAME, max(self.viewport().width() - others, _LEAST_NAME_WIDTH))
        self._fitting = False

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Let the names have what is gained or lost."""
        super().resizeEvent(event)
        self._fit_name()

    # Order and filter

    def set_filter(self, text: str) -> None:
        """Show only the landmarks that match; hidden ones are no longer selected."""
        before = self._selected_names()
        self._rendering = True
        self.order.set_filter(text)
        self._rendering = False
        self._on_order()
        if self._selected_names() != before:
            self._on_selected()

    def restore_order(self) -> None:
        """Sort by nothing: the order of the session."""
        self.horizontalHeader().setSortIndicator(-1, Qt.SortOrder.AscendingOrder)

    def _on_order(self) -> None:
        # A place between sorted rows means nothing to the session.
        self.setDragEnabled(self.order.is_original)
        self._fit_columns()
        self.viewport().update()

    def remember(self, settings: QSettings) -> None:
        """Note the order of the rows, and whether coordinates are shown."""
        header = self.horizontalHeader()
        number = header.sortIndicatorSection()
        key = COLUMNS[number].key if 0 <= number < len(COLUMNS) else ""
        settings.setValue("table/sorted_by", key)
        settings.setValue(
            "table/descending", header.sortIndicatorOrder() is Qt.SortOrder.DescendingOrder
        )
        settings.setValue("table/coordinates", self.shows_coordinates)

    def recall(self, settings: QSettings) -> None:
        """Order the rows as they were, and show coordinates where they were shown."""
        self.show_coordinates(settings.value("table/coordinates", False, type=bool))
        keys = {column.key for column in COLUMNS}
        key = str(settings.value("table/sorted_by", ""))
        if key in keys:
            downwards = settings.value("table/descending", False, type=bool)
            order = Qt.SortOrder.DescendingOrder if downwards else Qt.SortOrder.AscendingOrder
            self.horizontalHeader().setSortIndicator(column_number(key), order)

    # Selection

    def show_selection(self, selection: Selection) -> None:
        """Select the rows of the selected landmarks."""
        selector, wanted = self.selectionModel(), set(selection.names)
        indexes = (
            self.order.mapFromSource(self._model.index(row, _NAME))
            for row, landmark in enumerate(self._model.landmarks)
            if landmark.name in wanted
        )
        rows = sorted(index.row() for index in indexes if index.isValid())
        if self._selected_rows() == rows:
            return
        chosen = QItemSelection()
        for row in rows:
            index = self.order.index(row, _NAME)
            chosen.select(index, index)
        flags = QItemSelectionModel.SelectionFlag
        self._rendering = True
        selector.select(chosen, flags.ClearAndSelect | flags.Rows)
        if rows:
            first = self.order.index(rows[0], _NAME)
            self.scrollTo(first)
            if not self.hasFocus():
                selector.setCurrentIndex(first, flags.NoUpdate)
        self._rendering = False

    def _selected_rows(self) -> list[int]:
        # Qt's own selectedRows() asks for the flags of every cell: 50 ms for 500 rows.
        ranges = self.selectionModel().selection()
        return sorted({row for r in ranges for row in range(r.top(), r.bottom() + 1)})

    def _selected_names(self) -> list[str]:
        return [self.order.landmark(self.order.index(row, 0)).name for row in self._selected_rows()]

    def _on_selected(self) -> None:
        if self._rendering or self._model.is_updating:
            return
        current = self.currentIndex()
        side = COLUMNS[current.column()].side if current.isValid() else None
        self.selection_requested.emit(self._selected_names(), side)

    def index_of(self, name: str, column: int = _NAME) -> QModelIndex:
        """Return the cell of a landmark as it is shown; an invalid index where it is hidden."""
        for row, landmark in enumerate(self._model.landmarks):
            if landmark.name == name:
                return self.order.mapFromSource(self._model.index(row, column))
        return QModelIndex()

    def rename(self, name: str) -> None:
        """Open the name of a landmark for typing; what is being typed already stays open."""
        index = self.index_of(name)
        if index.isValid() and self.state() != QAbstractItemView.State.EditingState:
            self.setFocus()
            self.scrollTo(index)
            self.edit(index)

    # Mouse and keys

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Turn a click on a lock; on a selected row it turns those of the whole selection."""
        index = self.indexAt(event.pos())
        if index.isValid() and index.column() == _LOCKED and _is_plain_click(event):
            landmark = self.order.landmark(index)
            chosen = self._selected_names()
            names = chosen if landmark.name in chosen else [landmark.name]
            self.lock_requested.emit(names, not landmark.locked)
            return
        super().mousePressEvent(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Take two quick clicks on a lock for what they are."""
        if self.indexAt(event.pos()).column() == _LOCKED:
            self.mousePressEvent(event)
        else:
            super().mouseDoubleClickEvent(event)

    def changeEvent(self, event: QEvent) -> None:
        """Keep the columns wide enough for another font."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self._fit_columns()

    def dataChanged(self, first: QModelIndex, last: QModelIndex, roles: Sequence[int] = ()) -> None:
        """Show what has changed: at once, but of figures that run not every one."""
        too_soon = _READING_MS - 1e3 * (time.monotonic() - self._painted_at)
        # An open cell wants to know.
        if too_soon <= 0 or self.state() == QAbstractItemView.State.EditingState:
            super().dataChanged(first, last, roles)
            return
        self._behind.add((first.row(), first.column(), last.row(), last.column()))
        if not self._reading.isActive():
            self._reading.start(math.ceil(too_soon))

    def _paint_behind(self) -> None:
        """Show the figures that have changed since, and no more: names take longest."""
        behind, self._behind = self._behind, set()
        for top, left, bottom, right in behind:
            first, last = self.order.index(top, left), self.order.index(bottom, right)
            self.viewport().update(self.visualRect(first) | self.visualRect(last))

    def paintEvent(self, event: QPaintEvent) -> None:
        """Say what to do where there is nothing to show."""
        super().paintEvent(event)
        self._painted_at = time.monotonic()
        if self.order.rowCount():
            return
        hint = "No landmark matches\nthe filter" if self.order.is_filtered else _EMPTY_HINT
        with QPainter(self.viewport()) as painter:
            painter.setPen(theme.quiet_text_colour())
            room = self.viewport().rect().adjusted(12, 12, -12, -12)
            painter.drawText(_upper_half(room), Qt.AlignmentFlag.AlignCenter, hint)


def _width(widget: QWidget, text: str) -> int:
    return int(widget.fontMetrics().horizontalAdvance(text))


def _upper_half(room: QRect) -> QRect:
    return QRect(room.topLeft(), QPoint(room.right(), room.center().y()))


def _is_plain_click(event: QMouseEvent) -> bool:
    return bool(event.button() == Qt.MouseButton.LeftButton and not event.modifiers())
