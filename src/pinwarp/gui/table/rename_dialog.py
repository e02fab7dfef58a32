"""New names for many landmarks at once, with a preview of what they would be."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

from qtpy.QtCore import QSize, Qt
from qtpy.QtGui import QBrush, QIcon
from qtpy.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHeaderView,
    QLabel,
    QLineEdit,
    QSizePolicy,
    QSpinBox,
    QTabWidget,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.errors import PinwarpError
from pinwarp.gui.style import theme
from pinwarp.gui.style.icons import icon
from pinwarp.session.naming import names_by_pattern, names_by_replacing


class RenameDialog(QDialog):
    """Asks for a pattern, or what to find and replace.

    Parameters
    ----------
    names
        The names as they are, in the order they are counted.
    check
        Raises a PinwarpError with the reason when new names cannot be given.
    parent
        The window.
    """

    def __init__(
        self, names: Sequence[str], check: Callable[[dict[str, str]], object], parent: QWidget
    ) -> None:
        super().__init__(parent)
        self._names = list(names)
        self._check = check
        self.new_names: dict[str, str] = {}
        many = f"{len(names)} landmarks" if len(names) > 1 else names[0]
        self.setWindowTitle(f"Rename {many}")
        self.pattern = QLineEdit("{name}")
        self.first = QSpinBox()
        self.first.setRange(0, 99_999)
        self.first.setValue(1)
        self.find = QLineEdit()
        self.replacement = QLineEdit()
        self.ways = QTabWidget()
        self.preview = QTreeWidget()
        self.problem = QLabel()
        kinds = QDialogButtonBox.StandardButton
        self.buttons = QDialogButtonBox(kinds.Ok | kinds.Cancel)
        self._lay_out()
        for signal in (
            self.pattern.textChanged,
            self.first.valueChanged,
            self.find.textChanged,
            self.replacement.textChanged,
            self.ways.currentChanged,
        ):
            signal.connect(lambda _value: self._show())
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self._show()
        # Ready to type behind the name.
        self.pattern.setFocus()
        self.pattern.end(False)

    def _lay_out(self) -> None:
        by_pattern, by_text = QWidget(), QWidget()
        form = QFormLayout(by_pattern)
        form.addRow("&Pattern", self.pattern)
        form.addRow("&First number", self.first)
        hint = QLabel("{name} is the name as it is, {n} counts, {n:02} with two digits")
        theme.make_quiet(hint)
        hint.setWordWrap(True)
        form.addRow(hint)
        form = QFormLayout(by_text)
        form.addRow("Fi&nd", self.find)
        form.addRow("&Replace with", self.replacement)
        self.ways.addTab(by_pattern, "Pattern")
        self.ways.addTab(by_text, "Find and replace")
        self.preview.setRootIsDecorated(False)
        self.preview.setAlternatingRowColors(True)
        self.preview.setSelectionMode(QTreeWidget.SelectionMode.NoSelection)
        self.preview.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.preview.setHeaderLabels(["Now", "Then"])
        self.preview.header().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        height = self.preview.fontMetrics().height() + 7
        for name in self._names:
            QTreeWidgetItem(self.preview, [name, name]).setSizeHint(0, QSize(0, height))
        self.problem.setWordWrap(True)
        # Room for a reason of two lines, so that nothing jumps.
        self.problem.setMinimumHeight(2 * self.problem.fontMetrics().lineSpacing())
        self.problem.setAlignment(Qt.AlignmentFlag.AlignTop)
        for button in self.buttons.buttons():
            button.setIcon(QIcon())
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setText("Rename")
        column = QVBoxLayout(self)
        for widget in (self.ways, self.preview, self.problem, self.buttons):
            column.addWidget(widget, 1 if widget is self.preview else 0)
        self.ways.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.resize(460, 480)

    def _wanted(self) -> dict[str, str]:
        if self.ways.currentIndex() == 0:
            return names_by_pattern(self._names, self.pattern.text(), self.first.value())
        return names_by_replacing(self._names, self.find.text(), self.replacement.text())

    def _show(self) -> None:
        problem, wanted = "", {}
        try:
            wanted = self._wanted()
            self._check(wanted)
        except PinwarpError as error:
            problem = str(error)
        changed = {a: b for a, b in wanted.items() if a != b}
        self.new_names = {} if problem else changed
        self.problem.setText(problem)
        self.problem.setStyleSheet(
            f"color: {theme.warning_text_colour().name()};" if problem else ""
        )
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(bool(self.new_names))
        doubled = {name for name, times in Counter(wanted.values()).items() if times > 1}
        for i, name in enumerate(self._names):
            item, new_name = self.preview.topLevelItem(i), wanted.get(name, "")
            item.setText(1, new_name)
            wrong = new_name in doubled or bool(problem and f" {new_name}:" in problem)
            item.setForeground(1, QBrush(theme.warning_text_colour()) if wrong else QBrush())
            item.setIcon(1, icon("warning", theme.WARNING_COLOUR) if wrong else QIcon())
