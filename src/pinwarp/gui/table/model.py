"""The session's landmarks as Qt's views want them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from numpy.typing import NDArray
from qtpy.QtCore import QAbstractTableModel, QMimeData, QModelIndex, Qt, Signal
from qtpy.QtGui import QColor
from qtpy.QtWidgets import QWidget

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Landmark, LandmarkState, Side
from pinwarp.gui.style import theme
from pinwarp.gui.style.icons import icon
from pinwarp.gui.table.columns import COLUMNS, NAME, Column, Row, column_number
from pinwarp.session.judging.quality import NamedFinding, Quality
from pinwarp.session.repeat.spreads import spreads_on_destination
from pinwarp.session.rulers import Rulers
from pinwarp.session.session import Session
from pinwarp.session.warp.pair_names import pair_names
from pinwarp.session.warp.result import WarpInputs, WarpResult

_ROLE, _FLAG = Qt.ItemDataRole, Qt.ItemFlag
# The role under which a cell says how large its number is beside the largest of its column.
SHARE = _ROLE.UserRole
# Numbers without a column: tips ask for them when they are shown.
_ONLY_TOLD = ("standardised", "spread")
_ROWS_MIME = "application/x-pinwarp-landmarks"
# Qt asks for several more, cell by cell, each time that one is painted.
_TOLD = {_ROLE.DisplayRole, _ROLE.EditRole, _ROLE.DecorationRole, _ROLE.CheckStateRole}
_TOLD |= {_ROLE.ForegroundRole, _ROLE.TextAlignmentRole, _ROLE.ToolTipRole, SHARE}
# Made once: Qt asks for them cell by cell whenever the selection changes.
_BETWEEN_ROWS = _FLAG.ItemIsDropEnabled
_PLAIN_CELL = _FLAG.ItemIsEnabled | _FLAG.ItemIsSelectable | _FLAG.ItemIsDragEnabled
_TYPED_CELL = _PLAIN_CELL | _FLAG.ItemIsEditable
_TICKED_CELL = _TYPED_CELL | _FLAG.ItemIsUserCheckable


class LandmarkModel(QAbstractTableModel):
    """The session's landmarks; holds no truth of its own, and touches only what differs."""

    edit_requested = Signal(int, str, str)
    enable_requested = Signal(str, bool)
    reorder_requested = Signal(list, int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._session = Session()
        self.rulers = Rulers()
        self._landmarks: list[Landmark] = []
        self._values: dict[str, dict[str, float]] = {}
        self._largest: dict[str, float] = {}
        self._rows: dict[int, Row] = {}
        # By column: sorting compares thousands of times.
        self._sort_keys: dict[int, list[Any]] = {}
        self._findings: dict[str, list[NamedFinding]] = {}
        # What was found by the rows of a warp, which outlast a change of the session.
        self._figures: dict[str, tuple[WarpInputs, Sequence[float]]] = {}
        self.is_updating = False

    @property
    def landmarks(self) -> Sequence[Landmark]:
        """The landmarks in the order of the rows."""
        return self._landmarks

    def row(self, number: int) -> Row:
        """Return a landmark with the numbers found for it."""
        row = self._rows.get(number)
        if row is None:
            landmark = self._landmarks[number]
            name = landmark.name
            found = {key: values[name] for key, values in self._values.items() if name in values}
            row = Row(landmark, found, self._findings.get(name, ()), self.rulers)
        return self._rows.setdefault(number, row)

    def _forget_rows(self) -> None:
        """Put together anew what the cells and the order of the rows are made from."""
        self._rows.clear()
        self._sort_keys.clear()

    def sort_keys(self, column: int) -> Sequence[Any]:
        """Return what the rows are sorted by in a column."""
        if column not in self._sort_keys:
            key = COLUMNS[column].sort_key
            self._sort_keys[column] = [key(self.row(i)) for i in range(len(self._landmarks))]
        return self._sort_keys[column]

    # From the session to the rows

    def show_session(self, session: Session) -> None:
        """Show the landmarks of a session: selection and scroll position outlast it."""
        self._session = session
        # While rows come and go the views' selections are in between: nobody should act on them.
        self.is_updating = True
        if not self._are_renamed(session.landmarks):
            names = [landmark.name for landmark in session.landmarks]
            self._remove_others(set(names))
            self._sort_like(names)
            self._insert(session.landmarks)
        self._update(session.landmarks)
        for key in self._figures:
            self._show_figures(key)
        self.show_values("spread", spreads_on_destination(session))
        self.is_updating = False

    def show_rulers(self, rulers: Rulers) -> None:
        """Show all lengths in another unit."""
        self.rulers = rulers
        self._forget_rows()
        self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, len(COLUMNS) - 1)
        self._announce(range(len(self._landmarks)), 0, len(COLUMNS) - 1)

    def _are_renamed(self, new: Sequence[Landmark]) -> bool:
        """Whether rows only changed: the same ones, some perhaps under a name not used before."""
        if len(new) != len(self._landmarks):
            return False
        changed = [
            (a.name, b.name)
            for a, b in zip(self._landmarks, new, strict=True)
            if a is not b and a.name != b.name
        ]
        return {a for a, _ in changed}.isdisjoint(b for _, b in changed)

    def _remove_others(self, kept: set[str]) -> None:
        gone = [i for i, landmark in enumerate(self._landmarks) if landmark.name not in kept]
        for first, last in reversed(list(_runs(gone))):
            self.beginRemoveRows(QModelIndex(), first, last)
            del self._landmarks[first : last + 1]
            self._forget_rows()
            self.endRemoveRows()

    def _sort_like(self, names: Sequence[str]) -> None:
        place = {name: i for i, name in enumerate(names)}
        before = [landmark.name for landmark in self._landmarks]
        after = sorted(before, key=place.__getitem__)
        if before == after:
            return
        self.layoutAboutToBeChanged.emit()
        old = self.persistentIndexList()
        row = {name: i for i, name in enumerate(after)}
        self._landmarks.sort(key=lambda landmark: place[landmark.name])
        self._forget_rows()
        moved = [self.index(row[before[i.row()]], i.column()) for i in old]
        self.changePersistentIndexList(old, moved)
        self.layoutChanged.emit()

    def _insert(self, new: Sequence[Landmark]) -> None:
        known = {landmark.name for landmark in self._landmarks}
        arriving = [i for i, landmark in enumerate(new) if landmark.name not in known]
        for first, last in _runs(arriving):
            self.beginInsertRows(QModelIndex(), first, last)
            self._landmarks[first:first] = new[first : last + 1]
            self._forget_rows()
            self.endInsertRows()

    def _update(self, new: Sequence[Landmark]) -> None:
        pairs = enumerate(zip(self._landmarks, new, strict=True))
        changed = [i for i, (a, b) in pairs if a is not b and a != b]
        self._landmarks = list(new)
        self._forget_rows()
        self._announce(changed, 0, len(COLUMNS) - 1)

    def _announce(self, rows: Sequence[int], first_column: int, last_column: int) -> None:
        for first, last in _runs(rows):
            self.dataChanged.emit(self.index(first, first_column), self.index(last, last_column))

    def show_result(self, result: WarpResult | None) -> None:
        """Show the residuals of a warp."""
        residuals = result.residuals if result is not None else None
        self._keep_figures("residual", result, residuals)
        self._show_figures("residual")

    def show_quality(self, quality: Quality | None) -> None:
        """Show the leave-one-out errors of a warp."""
        left_out = quality.left_out if quality is not None else None
        self._keep_figures("left_out", quality, left_out.distances if left_out else None)
        self._keep_figures("standardised", quality, left_out.standardised if left_out else None)
        for key in ("left_out", "standardised"):
            self._show_figures(key)

    def _keep_figures(
        self, key: str, found: WarpResult | Quality | None, figures: NDArray | None
    ) -> None:
        inputs = found.inputs if found is not None else WarpInputs.of(Session())
        self._figures[key] = (inputs, figures.tolist() if figures is not None else [])

    def _show_figures(self, key: str) -> None:
        inputs, figures = self._figures[key]
        names = pair_names(inputs, self._session) if figures else ()
        self.show_values(
            key,
            {
                name: figure
                for name, figure in zip(names, figures, strict=True)
                if name is not None and math.isfinite(figure)
            },
        )

    def show_values(self, key: str, values: Mapping[str, float]) -> None:
        """Show numbers in the column of that key, by the landmarks' names."""
        before = self._values.get(key, {})
        if values == before:
            return
        self._values[key] = dict(values)
        self._rows.clear()
        if key in _ONLY_TOLD:
            return
        number = column_number(key)
        self._sort_keys.pop(number, None)
        rows = [
            i
            for i, landmark in enumerate(self._landmarks)
            if before.get(landmark.name) != values.get(landmark.name)
        ]
        self._announce(rows, number, number)
        if COLUMNS[number].has_bar:
            self._measure(number)

    def _measure(self, number: int) -> None:
        """Find the longest bar of a column: if it changes, so do all the others."""
        key, lengths = COLUMNS[number].key, self.sort_keys(number)
        longest = max((length for length in lengths if length is not None), default=0.0)
        if longest != self._largest.get(key) and lengths:
            self._largest[key] = longest
            ends = self.index(0, number), self.index(len(self._landmarks) - 1, number)
            self.dataChanged.emit(*ends, [SHARE])

    def show_findings(self, findings: Iterable[NamedFinding]) -> None:
        """Mark the landmarks about which something was noticed, the gravest first."""
        before, self._findings = self._findings, {}
        self._rows.clear()
        for found in findings:
            for name in found.names:
                self._findings.setdefault(name, []).append(found)
        rows = [
            i
            for i, landmark in enumerate(self._landmarks)
            if before.get(landmark.name) != self._findings.get(landmark.name)
        ]
        number = column_number("left_out")
        self._announce(rows, number, number)

    # What Qt asks for

    def rowCount(self, parent: QModelIndex | None = None) -> int:
        """Return the number of landmarks."""
        return 0 if parent is not None and parent.isValid() else len(self._landmarks)

    def columnCount(self, parent: QModelIndex | None = None) -> int:
        """Return the number of columns."""
        return 0 if parent is not None and parent.isValid() else len(COLUMNS)

    def title(self, column: int) -> str:
        """Return what stands over a column: lengths say their unit in a second line."""
        shown = COLUMNS[column]
        if shown.header_icon:
            return ""
        title = shown.short_title or shown.title
        if not shown.is_length:
            return title
        # What the warp misses is measured on the destination.
        unit = self.rulers.on(shown.side or Side.DESTINATION).unit
        return f"{title}\n{unit}" if unit else title

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = 0) -> Any:
        """Return the titles of the columns."""
        if orientation != Qt.Orientation.Horizontal or not 0 <= section < len(COLUMNS):
            return None
        column = COLUMNS[section]
        match role:
            case _ROLE.DisplayRole:
                return self.title(section)
            case _ROLE.AccessibleTextRole:
                return column.title
            case _ROLE.DecorationRole if column.header_icon:
                return icon(column.header_icon)
            case _ROLE.TextAlignmentRole:
                return _alignment(column)
            case _ROLE.ToolTipRole:
                return f"{column.tip}\nA click sorts; a third one brings back the order"
        return None

    def flags(self, index: QModelIndex) -> Qt.ItemFlag:
        """Return what can be done with a cell."""
        if not index.isValid():
            return _BETWEEN_ROWS
        column = COLUMNS[index.column()]
        if column.edit is None:
            return _PLAIN_CELL
        row = self.row(index.row())
        if column.checked is not None and column.checked(row) is not None:
            return _TICKED_CELL
        return _TYPED_CELL if column.can_edit(row) else _PLAIN_CELL

    def data(self, index: QModelIndex, role: int = 0) -> Any:
        """Return what a cell shows."""
        if role not in _TOLD or not index.isValid() or index.row() >= len(self._landmarks):
            return None
        row, column = self.row(index.row()), COLUMNS[index.column()]
        match role:
            case _ROLE.DisplayRole:
                return column.text(row)
            case _ROLE.EditRole:
                return (column.edit_text or column.text)(row)
            case _ROLE.DecorationRole if column.icon is not None:
                return column.icon(row)
            case _ROLE.CheckStateRole if column.checked is not None:
                return _check_state(column.checked(row))
            case _ROLE.ForegroundRole if not row.landmark.enabled:
                return QColor(theme.STATE_COLOURS[LandmarkState.DISABLED])
            case _ROLE.TextAlignmentRole:
                return _alignment(column)
            case _ROLE.ToolTipRole:
                return (column.cell_tip or column.text)(row)
            case _ if role == SHARE and column.has_bar:
                longest = self._largest.get(column.key)
                length = self.sort_keys(index.column())[index.row()]
                return length / longest if longest and length else 0.0
        return None

    def setData(self, index: QModelIndex, value: Any, role: int = 0) -> bool:
        """Ask for what the user typed or ticked; the session decides."""
        if not index.isValid():
            return False
        row, column = self.row(index.row()), COLUMNS[index.column()]
        if role == _ROLE.EditRole and column.edit is not None:
            if str(value) == (column.edit_text or column.text)(row):
                return False
            self.edit_requested.emit(index.column(), row.landmark.name, str(value))
            return True
        if role == _ROLE.CheckStateRole and column.checked is not None:
            on = Qt.CheckState(value) == Qt.CheckState.Checked
            self.enable_requested.emit(row.landmark.name, on)
            return True
        return False

    def problem(self, index: QModelIndex, text: str) -> str:
        """Return why a text cannot stand in a cell, or nothing."""
        edit = COLUMNS[index.column()].edit
        if edit is not None and text != self.data(index, _ROLE.EditRole):
            try:
                edit(self._session, self._landmarks[index.row()].name, text, self.rulers)
            except PinwarpError as error:
                return str(error)
        return ""

    # Dragging rows

    def supportedDropActions(self) -> Qt.DropAction:
        """Return that rows can be moved."""
        return Qt.DropAction.MoveAction

    def mimeTypes(self) -> list[str]:
        """Return the type of dragged rows, which other programs do not take."""
        return [_ROWS_MIME]

    def mimeData(self, indexes: Sequence[QModelIndex]) -> QMimeData:
        """Return the names of dragged rows."""
        rows = sorted({index.row() for index in indexes})
        data = QMimeData()
        data.setData(_ROWS_MIME, json.dumps([self._landmarks[i].name for i in rows]).encode())
        return data

    def dropMimeData(
        self, data: QMimeData, action: Qt.DropAction, row: int, _column: int, parent: QModelIndex
    ) -> bool:
        """Ask for the rows to be moved; False, as nothing is left to do for the view."""
        if data.hasFormat(_ROWS_MIME) and action == Qt.DropAction.MoveAction:
            names = json.loads(bytes(data.data(_ROWS_MIME).data()))
            row = parent.row() if parent.isValid() else row
            self.reorder_requested.emit(names, row if row >= 0 else len(self._landmarks))
        return False


def _check_state(checked: bool | None) -> Qt.CheckState | None:
    if checked is None:
        return None
    return Qt.CheckState.Checked if checked else Qt.CheckState.Unchecked


def _alignment(column: Column) -> int:
    across = Qt.AlignmentFlag.AlignHCenter
    if column.key == NAME:
        across = Qt.AlignmentFlag.AlignLeft
    elif column.is_numeric:
        across = Qt.AlignmentFlag.AlignRight
    return int(across | Qt.AlignmentFlag.AlignVCenter)


def _runs(rows: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Return rising numbers as stretches without a gap: first and last of each."""
    start = 0
    for i in range(1, len(rows) + 1):
        if i == len(rows) or rows[i] != rows[i - 1] + 1:
            yield rows[start], rows[i - 1]
            start = i
