"""The table of landmarks with its filter box and its menus."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from qtpy.QtCore import QEvent, QPoint, Qt
from qtpy.QtGui import QResizeEvent
from qtpy.QtWidgets import QHBoxLayout, QLabel, QLineEdit, QMenu, QVBoxLayout, QWidget

from pinwarp.gui.style.icons import icon
from pinwarp.gui.table.table import LandmarkTable

# The words of the row menu, by the keys of the actions; "focus" is whatever the key F does.


class FilterLine(QLineEdit):
    """A line whose Esc empties it; Down goes to the rows."""

    def __init__(self, rows: QWidget) -> None:
        super().__init__()
        self._rows = rows
        self.setPlaceholderText("Filter by name or state")
        self.setAccessibleName("Filter the landmarks")
        self.setClearButtonEnabled(True)
        self.addAction(icon("search"), QLineEdit.ActionPosition.LeadingPosition)

    def name_key(self, key: str) -> None:
        """Say which key goes here."""
        self.setToolTip(
            f"Words that the name, note or state contains, such as: incomplete, suspect ({key})"
        )

    def event(self, event: QEvent) -> bool:
        """Take Esc before the window does."""
        is_key = event.type() in (QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress)
        if is_key and event.key() == Qt.Key.Key_Escape and self.text():
            event.accept()
            if event.type() == QEvent.Type.KeyPress:
                self.clear()
            return True
        if event.type() == QEvent.Type.KeyPress and event.key() in (
            Qt.Key.Key_Down,
            Qt.Key.Key_Return,
            Qt.Key.Key_Enter,
        ):
            self._rows.setFocus()
            return True
        return bool(super().event(event))


class LandmarkPanel(QWidget):
    """The filter above the table, and room below it.

    Parameters
    ----------
    table
        The table. Its menus are filled by the window.
    """

    def __init__(self, table: LandmarkTable) -> None:
        super().__init__()
        self.table = table
        self._share_room: Callable[[int], None] | None = None
        self.filter = FilterLine(table)
        self.count = QLabel()
        self.count.hide()
        row = QHBoxLayout()
        row.setContentsMargins(4, 4, 4, 0)
        row.addWidget(self.filter, 1)
        row.addWidget(self.count)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        column.addLayout(row)
        column.addWidget(table, 1)
        self.row_menu = QMenu(table)
        self.header_menu = QMenu(table)
        self.original_order = self.header_menu.addAction("Original &Order")
        self.original_order.triggered.connect(lambda: table.restore_order())
        self._connect()

    def _connect(self) -> None:
        table, header = self.table, self.table.horizontalHeader()
        self.filter.textChanged.connect(self._on_filter)
        for signal in (table.order.rowsInserted, table.order.rowsRemoved, table.order.modelReset):
            signal.connect(lambda *_: self._show_count())
        table.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        table.customContextMenuRequested.connect(self._show_row_menu)
        header.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        header.customContextMenuRequested.connect(self._show_header_menu)

    def put_below(self, widget: QWidget, set_room: Callable[[int], None]) -> None:
        """Put a widget below the table; it is told how high it may be, so that rows are left."""
        self._share_room = set_room
        self.layout().addWidget(widget)
        set_room(self.height() // 3)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Leave most of the height to the table."""
        super().resizeEvent(event)
        if self._share_room is not None:
            self._share_room(self.height() // 3)

    def start_filtering(self) -> None:
        """Let the user type a filter."""
        self.filter.setFocus(Qt.FocusReason.ShortcutFocusReason)
        self.filter.selectAll()

    def reveal(self, names: Iterable[str]) -> None:
        """Take the filter away where it hides one of these."""
        if any(not self.table.index_of(name).isValid() for name in names):
            self.filter.clear()

    def _on_filter(self, text: str) -> None:
        self.table.set_filter(text)
        self._show_count()

    def _show_count(self) -> None:
        order = self.table.order
        self.count.setVisible(order.is_filtered)
        self.count.setText(f"{order.rowCount()} of {order.sourceModel().rowCount()}")

    def _show_row_menu(self, at: QPoint) -> None:
        self.row_menu.popup(self.table.viewport().mapToGlobal(at))

    def _show_header_menu(self, at: QPoint) -> None:
        self.original_order.setEnabled(self.table.order.sortColumn() >= 0)
        self.header_menu.popup(self.table.horizontalHeader().mapToGlobal(at))
