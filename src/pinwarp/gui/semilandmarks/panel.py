"""The panel of the semilandmarks: what there is, what each is worth, and what can be done."""

from __future__ import annotations

from collections.abc import Sequence

from qtpy.QtCore import QEvent, QItemSelectionModel, QModelIndex, Qt, Signal
from qtpy.QtGui import QAction, QKeyEvent, QPainter, QPaintEvent
from qtpy.QtWidgets import (
    QAbstractItemView,
    QGridLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QSizePolicy,
    QSlider,
    QSpinBox,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QToolButton,
    QTreeView,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.groups import MOST_POINTS, Curve
from pinwarp.core.lengths import Ruler
from pinwarp.gui.semilandmarks.model import NAME, POINTS, GroupModel
from pinwarp.gui.semilandmarks.shown import Shown
from pinwarp.gui.semilandmarks.words import freed_words, why_not
from pinwarp.gui.style import theme

# What the slider offers; any number can be typed.
CURVE_COUNTS, PATCH_COUNTS = (2, 100), (50, 1000)
_WIDEST = {1: "closed ", 2: "Points ", 3: "Freed ", 4: "123.4 mm ", 5: "drawn "}
_ACROSS = 4


class GroupCells(QStyledItemDelegate):
    """Counts are typed into a spin box."""

    def createEditor(
        self, parent: QWidget, option: QStyleOptionViewItem, index: QModelIndex
    ) -> QWidget:
        """Return what a cell is edited in."""
        if index.column() != POINTS:
            return super().createEditor(parent, option, index)
        spin = QSpinBox(parent)
        spin.setFrame(False)
        spin.setRange(0, MOST_POINTS)
        return spin


class GroupTree(QTreeView):
    """The tree; where it is empty it says how to begin.

    Parameters
    ----------
    model
        What it shows.
    """

    remove_requested = Signal()

    def __init__(self, model: GroupModel) -> None:
        super().__init__()
        self.empty_words = ""
        self.setModel(model)
        self.setItemDelegate(GroupCells(self))
        self.setUniformRowHeights(True)
        self.setAlternatingRowColors(True)
        self.setRootIsDecorated(True)
        self.setIndentation(14)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
        )
        self.setExpandsOnDoubleClick(False)
        self.setAccessibleName("Semilandmarks")
        header = self.header()
        header.setStretchLastSection(False)
        header.setMinimumSectionSize(24)
        header.setSectionResizeMode(NAME, QHeaderView.ResizeMode.Stretch)
        for column, words in _WIDEST.items():
            header.setSectionResizeMode(column, QHeaderView.ResizeMode.Interactive)
            header.resizeSection(column, self.fontMetrics().horizontalAdvance(words) + 12)

    def event(self, event: QEvent) -> bool:
        """Take Delete before the landmarks do."""
        if event.type() == QEvent.Type.ShortcutOverride and event.key() == Qt.Key.Key_Delete:
            event.accept()
            return True
        return bool(super().event(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Ask for the chosen one to be removed."""
        if event.key() == Qt.Key.Key_Delete:
            self.remove_requested.emit()
        else:
            super().keyPressEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Say how to begin where there is nothing to show."""
        super().paintEvent(event)
        if self.model().rowCount():
            return
        with QPainter(self.viewport()) as painter:
            painter.setPen(theme.quiet_text_colour())
            room = self.viewport().rect().adjusted(24, 24, -24, -24)
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(room, flags, self.empty_words)


class SemilandmarkPanel(QWidget):
    """Shows curves and patches, and asks for others.

    Parameters
    ----------
    actions
        Those that have a button here, row by row.
    empty_words
        How to begin.
    """

    group_chosen = Signal(str)
    # A point of a group by its number; -1 for none.
    point_chosen = Signal(str, int)
    frame_requested = Signal()
    count_requested = Signal(str, int)

    def __init__(self, actions: Sequence[QAction], empty_words: str) -> None:
        super().__init__()
        self._shown: Shown | None = None
        self._chosen = ""
        self._rendering = False
        self.model = GroupModel(self)
        self.tree = GroupTree(self.model)
        self.tree.empty_words = empty_words
        self.problem = QLabel()
        self.freed = QLabel()
        self.frame = QPushButton("Show Them")
        self.frame.setToolTip("Look at the points without a counterpart, on both bones")
        self.count_label = QLabel("Points")
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setAccessibleName("Number of points")
        self.spin = QSpinBox()
        self.spin.setRange(0, MOST_POINTS)
        self.spin.setKeyboardTracking(False)
        self.spin.setAccessibleName("Number of points, typed")
        self._lay_out(actions)
        self._connect()

    def _lay_out(self, actions: Sequence[QAction]) -> None:
        for label in (self.problem, self.freed):
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setWordWrap(True)
            label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Minimum)
        self.problem.setStyleSheet(f"color: {theme.warning_text_colour().name()};")
        self.problem.hide()
        freed = QHBoxLayout()
        freed.addWidget(self.freed, 1)
        freed.addWidget(self.frame)
        self._freed_row = QWidget()
        self._freed_row.setLayout(freed)
        freed.setContentsMargins(0, 0, 0, 0)
        count = QHBoxLayout()
        count.setSpacing(theme.SPACE)
        count.addWidget(self.count_label)
        count.addWidget(self.slider, 1)
        count.addWidget(self.spin)
        buttons = QGridLayout()
        buttons.setSpacing(4)
        for number, action in enumerate(actions):
            buttons.addWidget(_button(action), number // _ACROSS, number % _ACROSS)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 4, 6, 6)
        column.setSpacing(6)
        column.addWidget(self.problem)
        column.addWidget(self.tree, 1)
        column.addWidget(self._freed_row)
        column.addLayout(count)
        column.addLayout(buttons)

    def _connect(self) -> None:
        self.tree.selectionModel().currentChanged.connect(self._on_current)
        self.frame.clicked.connect(lambda _checked=False: self.frame_requested.emit())
        self.model.count_requested.connect(self.count_requested)
        for widget in (self.slider, self.spin):
            widget.valueChanged.connect(self._on_count)

    def show_groups(self, shown: Shown, ruler: Ruler, chosen: str) -> None:
        """Show curves and patches with their figures, one of them chosen."""
        self._shown = shown
        number = self.model.point(self.tree.currentIndex())
        opened = [
            x.group.name
            for x in shown.groups
            if self.tree.isExpanded(self.model.index_of(x.group.name))
        ]
        self._rendering = True
        self.model.show(shown, ruler)
        for name in opened:
            self.tree.expand(self.model.index_of(name))
        self._choose(chosen, number if chosen == self._chosen else None)
        self._rendering = False
        self._chosen = chosen
        why = why_not(shown)
        self.problem.setText(why)
        self.problem.setVisible(bool(why))
        one = shown.group(chosen)
        words = freed_words(shown, one) or freed_words(shown)
        self.freed.setText(words)
        self._freed_row.setVisible(bool(words))
        self._show_count()
        self.tree.viewport().update()

    def _choose(self, chosen: str, number: int | None) -> None:
        index = self.model.index_of(chosen, number)
        if not index.isValid():
            index = self.model.index_of(chosen)
        current = self.tree.currentIndex()
        if (current.row(), current.internalId()) == (index.row(), index.internalId()):
            return
        flags = QItemSelectionModel.SelectionFlag
        selection = self.tree.selectionModel()
        if index.isValid():
            selection.setCurrentIndex(index, flags.ClearAndSelect | flags.Rows)
        else:
            selection.clear()

    def _show_count(self) -> None:
        one = self._shown.group(self._chosen) if self._shown is not None else None
        for widget in (self.count_label, self.slider, self.spin):
            widget.setEnabled(one is not None)
        self.count_label.setText("Points" if one is None else f"Points of {one.group.name}")
        if one is None:
            return
        for widget in (self.slider, self.spin):
            widget.blockSignals(True)
        least, most = CURVE_COUNTS if isinstance(one.group, Curve) else PATCH_COUNTS
        if not self.slider.isSliderDown():
            # While one drags, what was asked for a moment ago must not pull the handle back.
            self.slider.setRange(least, most)
            self.slider.setPageStep(max(1, most // 20))
            self.slider.setValue(one.group.count)
        if not self.spin.hasFocus() or not self.slider.isSliderDown():
            self.spin.setValue(one.group.count)
        for widget in (self.slider, self.spin):
            widget.blockSignals(False)

    def _on_count(self, count: int) -> None:
        if self._chosen:
            self.count_requested.emit(self._chosen, count)

    def _on_current(self, index: QModelIndex, _before: QModelIndex) -> None:
        if self._rendering:
            return
        one, number = self.model.group(index), self.model.point(index)
        name = one.group.name if one is not None else ""
        self.group_chosen.emit(name)
        self.point_chosen.emit(name, -1 if number is None else number)


def _button(action: QAction) -> QToolButton:
    button = QToolButton()
    button.setDefaultAction(action)
    button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
    button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
    # The keyboard stays with the bones.
    button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    return button
