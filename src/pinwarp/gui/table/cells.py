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
    QRectF,
    QSize,
    Qt,
    Signal,
)
from qtpy.QtGui import QColor, QIcon, QPainter, QPalette
from qtpy.QtWidgets import (
    QLineEdit,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QToolTip,
    QWidget,
)

from pinwarp.gui.style import theme
from pinwarp.gui.table.model import SHARE, LandmarkModel
from pinwarp.gui.table.order import LandmarkOrder

_KEYS = (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Tab, Qt.Key.Key_Backtab)
_LONGEST_MS = 8000
_PADDING = 4


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


class FigureCells(LandmarkCells):
    """Numbers before a bar that shows how large each is, behind a sign where there is one."""

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: QModelIndex) -> None:
        """Paint the bar under the number, so that both are read."""
        cell = QStyleOptionViewItem(option)
        self.initStyleOption(cell, index)
        style, palette = cell.widget.style(), cell.palette
        style.drawPrimitive(
            QStyle.PrimitiveElement.PE_PanelItemViewItem, cell, painter, cell.widget
        )
        active = bool(cell.state & QStyle.StateFlag.State_Active)
        group = QPalette.ColorGroup.Active if active else QPalette.ColorGroup.Inactive
        selected = bool(cell.state & QStyle.StateFlag.State_Selected)
        role = QPalette.ColorRole.HighlightedText if selected else QPalette.ColorRole.Text
        ink = palette.color(group, role)
        room = QRectF(cell.rect).adjusted(_PADDING, 0, -_PADDING, 0)
        share = index.data(SHARE)
        if share:
            bar = room.adjusted(0, 3, 0, -3)
            bar.setWidth(max(bar.width() * share, 1))
            colour = QColor(theme.OUTLINE if selected else theme.BAR_COLOUR)
            colour.setAlphaF(0.28)
            painter.fillRect(bar, colour)
        if not cell.icon.isNull():
            mode = QIcon.Mode.Selected if selected else QIcon.Mode.Normal
            side = cell.decorationSize.height()
            sign = QRectF(room.left(), room.center().y() - side / 2, side, side)
            cell.icon.paint(painter, sign.toRect(), mode=mode)
        painter.setPen(ink)
        painter.drawText(room, cell.displayAlignment, cell.text)


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
