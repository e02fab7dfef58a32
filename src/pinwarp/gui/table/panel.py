"""The table of landmarks with its filter box and its menus."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from qtpy.QtCore import QEvent, QPoint, Qt
from qtpy.QtGui import QAction, QKeySequence, QResizeEvent
from qtpy.QtWidgets import QHBoxLayout, QLabel, QLineEdit, QMenu, QVBoxLayout, QWidget

from pinwarp.gui.findings.panel import FindingsPanel
from pinwarp.gui.style.icons import icon
from pinwarp.gui.table.table import LandmarkTable

# The words of the row menu, by the keys of the actions; "focus" is whatever the key F does.
_ROW_MENU = (
    "rename rename_many note - toggle_enabled toggle_locked toggle_role - swap_destinations - "
    "focus - copy paste - delete_side delete_landmark"
)


class FilterLine(QLineEdit):
    """A line whose Esc empties it; Down goes to the rows."""

    def __init__(self, rows: QWidget) -> None:
        super().__init__()
        self._rows = rows
        self.setPlaceholderText("Filter by name or state")
        self.setToolTip(
            "Words that the name, note or state contains, such as: incomplete, suspect (Ctrl+F)"
        )
        self.setAccessibleName("Filter the landmarks")
        self.setClearButtonEnabled(True)
        self.addAction(icon("search"), QLineEdit.ActionPosition.LeadingPosition)

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
    """The filter above the table, and below it what was noticed about the pairs.

    Parameters
    ----------
    table, findings
        The table and the list.
    actions
        The window's actions by key, of which the menus are made.
    """

    def __init__(
        self, table: LandmarkTable, findings: FindingsPanel, actions: Mapping[str, QAction]
    ) -> None:
        super().__init__()
        self.table = table
        self.findings = findings
        self._actions = actions
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
        column.addWidget(findings)
        self.row_menu = QMenu(table)
        self.header_menu = QMenu(table)
        self.original_order = self.header_menu.addAction("Original &Order")
        self.original_order.triggered.connect(lambda: table.restore_order())
        self.header_menu.addAction(actions["show_coordinates"])
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
        self._actions["show_coordinates"].toggled.connect(table.show_coordinates)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Leave most of the height to the table."""
        super().resizeEvent(event)
        self.findings.set_room(self.height() // 3)

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
        menu, actions = self.row_menu, dict(self._actions)
        # Whoever has the key F looks at what is selected.
        key = QKeySequence("F")
        focus = [action for action in actions.values() if action.shortcut() == key]
        menu.clear()
        for word in _ROW_MENU.split():
            if word == "-":
                menu.addSeparator()
            elif word == "focus":
                menu.addActions(focus)
            else:
                menu.addAction(actions[word])
        menu.popup(self.table.viewport().mapToGlobal(at))

    def _show_header_menu(self, at: QPoint) -> None:
        self.original_order.setEnabled(self.table.order.sortColumn() >= 0)
        self.header_menu.popup(self.table.horizontalHeader().mapToGlobal(at))
