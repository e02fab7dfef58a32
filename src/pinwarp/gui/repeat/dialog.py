"""Landmark precision: which files are repeats, and what they say."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from qtpy.QtCore import QSize, Qt, Signal
from qtpy.QtGui import QDragEnterEvent, QDropEvent, QIcon, QKeySequence, QShortcut
from qtpy.QtWidgets import (
    QAbstractItemView,
    QButtonGroup,
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QPlainTextEdit,
    QPushButton,
    QRadioButton,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.landmarks import Side
from pinwarp.core.lengths import Ruler
from pinwarp.gui.repeat.spread_table import SpreadTable
from pinwarp.gui.style import theme
from pinwarp.gui.style.choice import lead_tab_to_checked
from pinwarp.gui.tasks.dropping import dropped_files
from pinwarp.session.repeat.level import PenaltyOfNoise
from pinwarp.session.repeat.measuring import Asked, Measured

_SIZE = QSize(760, 640)
_FILES, _NOTES = 4, 5
_PLAIN = Ruler()
INVITATION = "Add the files of a set that was digitised two or more times, or drop them here."


class PrecisionDialog(QDialog):
    """Shows what it is given; what is to be compared is emitted by ``asked_for``.

    ``penalty_wanted`` and ``keep_wanted`` say that a button was clicked.
    """

    asked_for = Signal(object)
    files_wanted = Signal()
    penalty_wanted = Signal()
    keep_wanted = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._asked = Asked()
        self.setWindowTitle("Landmark Precision")
        self.setWindowModality(Qt.WindowModality.WindowModal)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setAcceptDrops(True)
        self.files = QListWidget()
        self.add = QPushButton("Add Files…")
        self.remove = QPushButton("Remove")
        self.sides = {side: QRadioButton(side.value.capitalize()) for side in Side}
        self.with_session = QCheckBox("This session's own landmarks are one of the repeats")
        self.by_order = QCheckBox("Match by order, not by name")
        self.adapt = QCheckBox("Bring all to the frame and unit of the first")
        self.notes = QPlainTextEdit()
        self.table = SpreadTable()
        self.spread, self.axes, self.penalty = (QLabel() for _ in range(3))
        self.done_words = QLabel()
        self.use = QPushButton("Use This Penalty")
        self.keep = QPushButton("Keep Spreads with the Session")
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        self._set_up()
        self._lay_out()
        self._connect()
        self.show_measured(Measured(self._asked, problem=INVITATION))

    def _set_up(self) -> None:
        line = self.fontMetrics().lineSpacing()
        self.files.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.files.setFixedHeight(_FILES * (line + 4))
        self.files.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.files.setAccessibleName("Repeats")
        self.sides[self._asked.side].setChecked(True)
        self.adapt.setToolTip(
            "Where one seems to have x and y negated (LPS or RAS), or to be a thousand times as "
            "large; nothing is guessed without this"
        )
        self.by_order.setToolTip("For files without names, or with others")
        self.notes.setReadOnly(True)
        # What is dropped there is for the dialog.
        self.notes.setAcceptDrops(False)
        self.notes.setFixedHeight(_NOTES * line + 12)
        self.notes.setAccessibleName("What to know about the files")
        self.use.setToolTip(
            "The ratio of this noise to the warp's own variance, as a penalty of the regularising "
            "convention; one undo brings the old one back"
        )
        self.keep.setToolTip(
            "Residuals and left-out errors are then told in units of them, too; they are saved "
            "with the session"
        )
        for label in (self.spread, self.axes, self.penalty, self.done_words):
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setWordWrap(True)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        for button in self.buttons.buttons():
            button.setIcon(QIcon())
        for button in (self.add, self.remove, self.use, self.keep):
            button.setAutoDefault(False)

    def _lay_out(self) -> None:
        beside = QVBoxLayout()
        beside.addWidget(self.add)
        beside.addWidget(self.remove)
        beside.addStretch()
        row = QHBoxLayout()
        row.addWidget(self.files, 1)
        row.addLayout(beside)
        sides = QHBoxLayout()
        sides.addWidget(QLabel("Digitised again:"))
        # Radio buttons of one parent would exclude one another in any case; this says which do.
        group = QButtonGroup(self)
        for button in self.sides.values():
            group.addButton(button)
            sides.addWidget(button)
        lead_tab_to_checked(group)
        sides.addSpacing(3 * theme.SPACE)
        sides.addWidget(self.with_session)
        sides.addStretch()
        ways = QHBoxLayout()
        ways.addWidget(self.by_order)
        ways.addSpacing(3 * theme.SPACE)
        ways.addWidget(self.adapt)
        ways.addStretch()
        figures = QFormLayout()
        figures.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        figures.addRow("Pooled spread:", self.spread)
        figures.addRow("Share of each axis:", self.axes)
        figures.addRow("Penalty for this noise:", self.penalty)
        last = QHBoxLayout()
        last.addWidget(self.use)
        last.addWidget(self.keep)
        last.addWidget(self.done_words, 1)
        last.addWidget(self.buttons)
        column = QVBoxLayout(self)
        column.setContentsMargins(16, 14, 16, 12)
        column.setSpacing(10)
        for one in (row, sides, ways, self.notes, self.table, figures, last):
            if isinstance(one, QWidget):
                column.addWidget(one, 1 if one is self.table else 0)
            else:
                column.addLayout(one)
        self.resize(_SIZE)

    def _connect(self) -> None:
        self.add.clicked.connect(self.files_wanted)
        self.remove.clicked.connect(self._remove)
        QShortcut(
            QKeySequence(Qt.Key.Key_Delete),
            self.files,
            self._remove,
            context=Qt.ShortcutContext.WidgetShortcut,
        )
        self.files.itemSelectionChanged.connect(self._renew_remove)
        for side, button in self.sides.items():
            button.toggled.connect(lambda on, side=side: self._ask(side=side) if on else None)
        self.with_session.toggled.connect(lambda on: self._ask(with_session=on))
        self.by_order.toggled.connect(lambda on: self._ask(by_order=on))
        self.adapt.toggled.connect(lambda on: self._ask(adapt=on))
        self.use.clicked.connect(self.penalty_wanted)
        self.keep.clicked.connect(self.keep_wanted)
        self.buttons.rejected.connect(self.reject)

    # What is asked

    def add_files(self, paths: list[Path]) -> None:
        """Take files that are not there yet."""
        known = self._asked.paths
        self._ask(paths=(*known, *(x for x in dict.fromkeys(paths) if x not in known)))

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Take files from the outside."""
        dropped_files(event)

    def dropEvent(self, event: QDropEvent) -> None:
        """Add the files that were dropped."""
        if paths := dropped_files(event):
            self.add_files(paths)

    def _remove(self) -> None:
        rows = {index.row() for index in self.files.selectedIndexes()}
        self._ask(paths=tuple(x for i, x in enumerate(self._asked.paths) if i not in rows))

    def _ask(self, **changes: object) -> None:
        self.say("")
        before, self._asked = self._asked, replace(self._asked, **changes)  # type: ignore[arg-type]  # by name
        if before.paths != self._asked.paths:
            self.files.clear()
            self.files.addItems([str(path) for path in self._asked.paths])
        self._renew_remove()
        # Until the answer is there the old one must not be used.
        self.use.setEnabled(False)
        self.keep.setEnabled(False)
        self.asked_for.emit(self._asked)

    def _renew_remove(self) -> None:
        self.remove.setEnabled(bool(self.files.selectedIndexes()))

    # What came of it

    def show_measured(self, found: Measured, ruler: Ruler = _PLAIN, own: Ruler = _PLAIN) -> None:
        """Show what repeats say, or why they say nothing.

        Parameters
        ----------
        found
            What was measured.
        ruler, own
            How the lengths of the repeats are told, and those of the session.
        """
        repeats = found.repeats
        if not found.asked.paths:
            found = replace(found, problem=INVITATION)
        tick = f"Tick “{self.adapt.text()}” for that." if found.other_frame else ""
        told = (f"{found.problem} {tick}".rstrip(), *found.notes)
        self.notes.setPlainText("\n".join(filter(None, told)))
        self.notes.setVisible(bool(self.notes.toPlainText()))
        self.table.show_repeats(repeats, ruler)
        self.spread.setText("–")
        self.axes.setText("–")
        self.penalty.setText("–")
        if repeats is not None:
            figures = repeats.figures
            low, high = (ruler.number(x, 3) for x in figures.interval)
            one = ruler.text(math.sqrt(figures.variance), 3)
            self.spread.setText(
                f"{ruler.text(figures.spread, 3)} (95%: {low} to {high}); of one "
                f"coordinate {one}, {figures.freedom} degrees of freedom"
            )
            shares = figures.axis_variances / figures.axis_variances.sum()
            self.axes.setText(
                ", ".join(f"{axis} {share:.0%}" for axis, share in zip("xyz", shares, strict=True))
            )
        if found.penalty is not None:
            self.penalty.setText(_penalty_words(found.penalty, own))
        self._renew_remove()

    def say(self, words: str) -> None:
        """Say what came of a click."""
        self.done_words.setText(words)

    def show_possible(self, *, use: bool, keep: bool) -> None:
        """Let the buttons be clicked where that changes something."""
        self.use.setEnabled(use)
        self.keep.setEnabled(keep)


def _penalty_words(found: PenaltyOfNoise, ruler: Ruler) -> str:
    low, high = (ruler.number(x, 3) for x in (found.low, found.high))
    return f"{ruler.text(found.penalty, 3)} ({low} to {high}). {found.words}"
