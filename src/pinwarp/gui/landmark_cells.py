"""Cells of the landmark table: what cannot stand in one is refused in place, with the reason."""

from __future__ import annotations

from qtpy.QtCore import (
    QAbstractItemModel,
    QEvent,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QPoint,
    QRect,
    QSize,
    Qt,
    Signal,
)
from qtpy.QtWidgets import (
    QLineEdit,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QToolTip,
    QWidget,
)

from pinwarp.gui import theme
from pinwarp.gui.landmark_model import LandmarkModel
from pinwarp.gui.landmark_order import LandmarkOrder

_KEYS = (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Tab, Qt.Key.Key_Backtab)
_LONGEST_MS = 8000


class LandmarkCells(QStyledItemDelegate):
    """The editor of a cell stays open until what it says is accepted, or Esc."""

    refused = Signal(str)

    def __init__(self, model: LandmarkModel, order: LandmarkOrder, parent: QWidget) -> None:
        super().__init__(parent)
        self._model = model
        self._order = order
        self._index = QPersistentModelIndex()

    def createEditor(
        self, parent: QWidget, _option: QStyleOptionViewItem, index: QModelIndex
    ) -> QWidget:
        """Return a line to type in."""
        self._index = QPersistentModelIndex(self._order.mapToSource(index))
        line = QLineEdit(parent)
        line.setFrame(False)
        line.textEdited.connect(lambda _text: self._forgive(line))
        return line

    def eventFilter(self, editor: QObject, event: QEvent) -> bool:
        """Keep the editor open where its text is refused."""
        is_key = event.type() == QEvent.Type.KeyPress and event.key() in _KEYS
        if is_key and isinstance(editor, QLineEdit) and (problem := self._problem(editor)):
            self._refuse(editor, problem)
            return True
        return bool(super().eventFilter(editor, event))

    def setModelData(self, editor: QWidget, model: QAbstractItemModel, index: QModelIndex) -> None:
        """Hand on what was typed; what is refused when one clicks elsewhere is dropped."""
        if isinstance(editor, QLineEdit) and (problem := self._problem(editor)):
            self.refused.emit(problem)
            return
        super().setModelData(editor, model, index)

    def _problem(self, line: QLineEdit) -> str:
        index = QModelIndex(self._index)
        return self._model.problem(index, line.text()) if index.isValid() else ""

    def _refuse(self, line: QLineEdit, problem: str) -> None:
        line.setStyleSheet(f"border: 2px solid {theme.WARNING_COLOUR};")
        line.selectAll()
        below = line.mapToGlobal(QPoint(0, line.height() - 8))
        QToolTip.showText(below, problem, line, QRect(), _LONGEST_MS)
        self.refused.emit(problem)

    @staticmethod
    def _forgive(line: QLineEdit) -> None:
        if line.styleSheet():
            line.setStyleSheet("")
            QToolTip.hideText()


class NameCells(LandmarkCells):
    """Names that begin at one edge, whether there is a tick before them or not."""

    def initStyleOption(self, option: QStyleOptionViewItem, index: QModelIndex) -> None:
        """Keep the room of a tick free where there is none."""
        super().initStyleOption(option, index)
        if not option.features & QStyleOptionViewItem.ViewItemFeature.HasCheckIndicator:
            style = option.widget.style()
            tick = style.pixelMetric(QStyle.PixelMetric.PM_IndicatorWidth, option, option.widget)
            margin = style.pixelMetric(QStyle.PixelMetric.PM_FocusFrameHMargin) + 1
            width = option.decorationSize.width() + tick + 2 * margin
            option.decorationSize = QSize(width, option.decorationSize.height())
            option.decorationAlignment = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
