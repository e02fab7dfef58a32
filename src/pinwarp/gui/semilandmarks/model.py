"""The curves and patches as a tree: a row for each, and below it its points."""

from __future__ import annotations

import math
from typing import Any

from qtpy.QtCore import QAbstractItemModel, QModelIndex, QObject, QSize, Qt, Signal
from qtpy.QtGui import QColor, QIcon, QPainter, QPixmap

from pinwarp.core.groups import Patch
from pinwarp.core.lengths import Ruler
from pinwarp.gui.semilandmarks.shown import Shown, ShownGroup
from pinwarp.gui.semilandmarks.words import kind_of, state_of
from pinwarp.gui.style import theme

NAME, KIND, POINTS, FREED, SLIDE, STATE = range(6)
TITLES = ("Name", "Kind", "Points", "Freed", "Slide", "State")
_TIPS = {
    POINTS: "How many semilandmarks; double-click to change",
    FREED: "How many have no counterpart on the destination, and take no part",
    SLIDE: "How far the one went that went furthest, from where the landmarks alone put it",
    STATE: "Whether the curve is drawn on the destination, or only expected there",
}
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter


class GroupModel(QAbstractItemModel):
    """Renders what is shown; asks for other names and counts.

    Parameters
    ----------
    parent
        Who owns it.
    """

    rename_requested = Signal(str, str)
    count_requested = Signal(str, int)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._groups: tuple[ShownGroup, ...] = ()
        self._ruler = Ruler()

    def show(self, shown: Shown, ruler: Ruler) -> None:
        """Show other curves and patches, or the same with other figures."""
        before = [(x.group.name, x.group.count) for x in self._groups]
        if before == [(x.group.name, x.group.count) for x in shown.groups]:
            self._groups, self._ruler = shown.groups, ruler
            if before:
                last = self.index(len(before) - 1, len(TITLES) - 1)
                self.dataChanged.emit(self.index(0, 0), last)
                for row, (_, count) in enumerate(before):
                    above = self.index(row, 0)
                    if count:
                        last = self.index(count - 1, len(TITLES) - 1, above)
                        self.dataChanged.emit(self.index(0, 0, above), last)
            return
        self.beginResetModel()
        self._groups, self._ruler = shown.groups, ruler
        self.endResetModel()

    def group(self, index: QModelIndex) -> ShownGroup | None:
        """Return the curve or patch that a cell belongs to."""
        if not index.isValid():
            return None
        row = index.internalId() - 1 if index.internalId() else index.row()
        return self._groups[row] if row < len(self._groups) else None

    @staticmethod
    def point(index: QModelIndex) -> int | None:
        """Return the number of the point that a cell belongs to, None in the row of a group."""
        return index.row() if index.isValid() and index.internalId() else None

    def index_of(self, name: str, number: int | None = None) -> QModelIndex:
        """Return the first cell of a group, or of one of its points."""
        for row, one in enumerate(self._groups):
            if one.group.name == name:
                above = self.index(row, 0)
                return above if number is None else self.index(number, 0, above)
        return QModelIndex()

    # What Qt asks for

    def index(self, row: int, column: int, parent: QModelIndex | None = None) -> QModelIndex:
        """Return a cell."""
        above = QModelIndex() if parent is None else parent
        if not self.hasIndex(row, column, above):
            return QModelIndex()
        return self.createIndex(row, column, above.row() + 1 if above.isValid() else 0)

    def parent(self, index: QModelIndex | None = None) -> Any:
        """Return the group above a point."""
        if index is None:
            return super().parent()
        if not index.isValid() or not index.internalId():
            return QModelIndex()
        return self.createIndex(index.internalId() - 1, 0, 0)

    def rowCount(self, parent: QModelIndex | None = None) -> int:
        """Return how many groups there are, or points in one."""
        if parent is None or not parent.isValid():
            return len(self._groups)
        if parent.internalId() or parent.column() > 0 or parent.row() >= len(self._groups):
            return 0
        return self._groups[parent.row()].group.count

    def columnCount(self, _parent: QModelIndex | None = None) -> int:
        """Return how many columns there are."""
        return len(TITLES)

    def headerData(
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """Return a title."""
        if orientation != Qt.Orientation.Horizontal:
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return TITLES[section]
        if role == Qt.ItemDataRole.ToolTipRole:
            return _TIPS.get(section)
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return _alignment(section)
        return None

    def flags(self, index: QModelIndex) -> Qt.ItemFlag:
        """Say what can be done with a cell."""
        if not index.isValid():
            return Qt.ItemFlag.NoItemFlags
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        if not index.internalId() and index.column() in (NAME, POINTS):
            flags |= Qt.ItemFlag.ItemIsEditable
        return flags

    def data(self, index: QModelIndex, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return what a cell says."""
        one = self.group(index)
        if one is None:
            return None
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return _alignment(index.column())
        number = self.point(index)
        if number is not None:
            is_there = number < one.group.count and role == Qt.ItemDataRole.DisplayRole
            return self._of_point(one, number, index.column()) if is_there else None
        if role == Qt.ItemDataRole.DecorationRole and index.column() == NAME:
            return group_icon(theme.group_colour(index.row()).name())
        if role == Qt.ItemDataRole.EditRole and index.column() == POINTS:
            return one.group.count
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.EditRole):
            return self._of_group(one, index.column())
        if role == Qt.ItemDataRole.ToolTipRole and index.column() in (NAME, KIND):
            return _tip_of(one)
        return None

    def setData(self, index: QModelIndex, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Ask for another name or count."""
        one = self.group(index)
        if one is None or role != Qt.ItemDataRole.EditRole or index.internalId():
            return False
        if index.column() == NAME and value != one.group.name:
            self.rename_requested.emit(one.group.name, str(value))
        elif index.column() == POINTS and value != one.group.count:
            self.count_requested.emit(one.group.name, int(value))
        return False

    def _of_group(self, one: ShownGroup, column: int) -> str:
        slide = one.largest_slide
        match column:
            case 0:
                return one.group.name
            case 1:
                return kind_of(one.group)
            case 2:
                return f"{one.group.count:,}"
            case 3:
                return f"{one.freed:,}" if one.freed else "–"
            case 4:
                return "–" if slide is None else self._ruler.text(slide, 3)
            case _:
                return state_of(one.group)

    def _of_point(self, one: ShownGroup, number: int, column: int) -> str:
        slid = float(one.slid[number])
        if column == NAME:
            return f"{number + 1}"
        if number in one.group.excluded:
            return "excluded" if column == STATE else ""
        if column == SLIDE and math.isfinite(slid) and not one.is_freed[number]:
            return self._ruler.text(slid, 3)
        if column == FREED and one.is_freed[number]:
            return "freed"
        return ""


def _alignment(column: int) -> Qt.AlignmentFlag:
    if column == STATE:
        # Else it would stand close to the figure before it.
        return Qt.AlignmentFlag.AlignCenter
    return _RIGHT if column in (POINTS, FREED, SLIDE) else _LEFT


def _tip_of(one: ShownGroup) -> str:
    group = one.group
    kind = kind_of(group)
    words = f"{group.name}: {'closed curve' if kind == 'closed' else kind}"
    if isinstance(group, Patch):
        return f"{words} inside {group.around}" if group.around else f"{words}, whole surface"
    anchors = ", ".join(handle.landmark for handle in group.anchors)
    return f"{words}, anchored at {anchors}" if anchors else words


def group_icon(colour: str) -> QIcon:
    """Return a dot in a group's colour."""
    pixmap = QPixmap(QSize(32, 32))
    pixmap.setDevicePixelRatio(2.0)
    pixmap.fill(Qt.GlobalColor.transparent)
    with QPainter(pixmap) as painter:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QColor(theme.PAPER))
        painter.setBrush(QColor(colour))
        painter.drawEllipse(3, 3, 10, 10)
    icon = QIcon(pixmap)
    # Else Qt tints it in a selected row.
    icon.addPixmap(pixmap, QIcon.Mode.Selected)
    return icon
