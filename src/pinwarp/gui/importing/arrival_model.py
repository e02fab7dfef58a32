"""The landmarks of a file that is about to be imported, as the rows of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from qtpy.QtCore import QAbstractTableModel, QModelIndex, QObject, Qt
from qtpy.QtGui import QColor

from pinwarp.core.landmarks import Side
from pinwarp.gui.style import theme
from pinwarp.session.importing.landmarks import Arrival, Fate

_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter

# Behind a number that is flush right.
_GAP = "\u2002"


class ArrivalModel(QAbstractTableModel):
    """Name, coordinates and what happens; thousands of rows are only looked at when shown.

    Parameters
    ----------
    sides
        The sides whose coordinates are shown.
    units
        The unit of each.
    parent
        Who owns it.
    """

    def __init__(self, sides: Sequence[Side], units: Mapping[Side, str], parent: QObject) -> None:
        super().__init__(parent)
        self._arrivals: Sequence[Arrival] = ()
        self._coordinates = [(side, axis) for side in sides for axis in range(3)]
        self._titles = ["Name"]
        for side, axis in self._coordinates:
            letter = "xyz"[axis]
            title = letter if len(sides) == 1 else f"{side.value[0].upper()} {letter}"
            unit = units[side]
            self._titles.append(f"{title} ({unit})" if unit else title)
        self._titles.append(f"{_GAP}What happens")

    def show_arrivals(self, arrivals: Sequence[Arrival]) -> None:
        """Show what becomes of them; there are as many rows as before, but for the first time."""
        if not arrivals:
            return
        if len(arrivals) == len(self._arrivals):
            self._arrivals = arrivals
            last = self.index(len(arrivals) - 1, self.columnCount() - 1)
            self.dataChanged.emit(self.index(0, 0), last)
            return
        self.beginResetModel()
        self._arrivals = arrivals
        self.endResetModel()

    def rowCount(self, parent: QModelIndex | None = None) -> int:
        """Return how many landmarks there are."""
        return 0 if parent is not None and parent.isValid() else len(self._arrivals)

    def columnCount(self, parent: QModelIndex | None = None) -> int:
        """Return how many columns there are."""
        return 0 if parent is not None and parent.isValid() else len(self._titles)

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = 0) -> Any:
        """Return the titles."""
        if orientation != Qt.Orientation.Horizontal or not 0 <= section < len(self._titles):
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return self._titles[section]
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return self._alignment(section)
        return None

    def data(self, index: QModelIndex, role: int = 0) -> Any:
        """Return what a cell shows."""
        if not index.isValid():
            return None
        arrival, column = self._arrivals[index.row()], index.column()
        match role:
            case Qt.ItemDataRole.DisplayRole if column == len(self._titles) - 1:
                return f"{_GAP}{arrival.words}"
            case Qt.ItemDataRole.DisplayRole | Qt.ItemDataRole.ToolTipRole:
                return self._text(arrival, column)
            case Qt.ItemDataRole.TextAlignmentRole:
                return self._alignment(column)
            case Qt.ItemDataRole.ForegroundRole if column == len(self._titles) - 1:
                return _colour(arrival.fate)
        return None

    def _alignment(self, column: int) -> Qt.AlignmentFlag:
        return _RIGHT if 0 < column <= len(self._coordinates) else _LEFT

    def _text(self, arrival: Arrival, column: int) -> str:
        if column == 0:
            return arrival.landmark.name
        if column > len(self._coordinates):
            return arrival.words
        side, axis = self._coordinates[column - 1]
        position = arrival.landmark.position(side)
        return "" if position is None else f"{position[axis]:.6g}"


def _colour(fate: Fate) -> QColor | None:
    """Return a colour for what deserves a look; the words say the same."""
    if fate is Fate.REPLACES:
        return theme.warning_text_colour()
    return theme.quiet_text_colour() if fate in (Fate.SAME, Fate.LEFT_OUT) else None
