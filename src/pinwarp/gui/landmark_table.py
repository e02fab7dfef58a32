"""The table of landmarks: a model over the session, and the view with its requests."""

from __future__ import annotations

from typing import Any

from qtpy.QtCore import QAbstractTableModel, QItemSelectionModel, QModelIndex, Qt, Signal
from qtpy.QtGui import QColor
from qtpy.QtWidgets import QAbstractItemView, QHeaderView, QTableView, QWidget

from pinwarp.core.landmarks import Landmark, LandmarkState, Position, Side
from pinwarp.gui import theme
from pinwarp.gui.marker_painting import state_icon
from pinwarp.session.editor import Selection
from pinwarp.session.results import WarpResult
from pinwarp.session.session import Session

NAME, SOURCE, DESTINATION, RESIDUAL = range(4)
_TITLES = ("Landmark", "Source", "Dest.", "Residual")
_TIPS = (
    "Double-click or F2 renames; the tick lets the pair take part",
    "Whether it is placed on the source mesh; the tip shows where",
    "Whether it is placed on the destination mesh; the tip shows where",
    "Distance from the warped source landmark to its destination",
)
_SIDES = {SOURCE: Side.SOURCE, DESTINATION: Side.DESTINATION}


class LandmarkModel(QAbstractTableModel):
    """The session's landmarks as Qt's views want them; holds no truth of its own."""

    rename_requested = Signal(str, str)
    enable_requested = Signal(str, bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._session = Session()
        self._residuals: dict[str, float] = {}

    @property
    def landmarks(self) -> tuple[Landmark, ...]:
        """The landmarks in the order of the rows."""
        return self._session.landmarks

    def show_session(self, session: Session) -> None:
        """Show the landmarks of a session, touching only what differs."""
        old, self._session = self._session, session
        if len(old.landmarks) != len(session.landmarks):
            self.beginResetModel()
            self.endResetModel()
        elif old.landmarks is not session.landmarks:
            last = self.index(len(session.landmarks) - 1, RESIDUAL)
            self.dataChanged.emit(self.index(0, 0), last)

    def show_result(self, result: WarpResult | None) -> None:
        """Show the residuals of a warp."""
        residuals: dict[str, float] = {}
        if result is not None and result.residuals is not None:
            pairs = self._session.pairs
            if len(pairs) == len(result.residuals):
                names = (pair.name for pair in pairs)
                residuals = dict(zip(names, result.residuals.tolist(), strict=True))
        if residuals != self._residuals:
            self._residuals = residuals
            if self.landmarks:
                last = self.index(len(self.landmarks) - 1, RESIDUAL)
                self.dataChanged.emit(self.index(0, RESIDUAL), last)

    def rowCount(self, parent: QModelIndex | None = None) -> int:
        """Return the number of landmarks."""
        return 0 if parent is not None and parent.isValid() else len(self.landmarks)

    def columnCount(self, parent: QModelIndex | None = None) -> int:
        """Return the number of columns."""
        return 0 if parent is not None and parent.isValid() else len(_TITLES)

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = 0) -> Any:
        """Return the titles of the columns."""
        if orientation != Qt.Orientation.Horizontal or not 0 <= section < len(_TITLES):
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return _TITLES[section]
        if role == Qt.ItemDataRole.ToolTipRole:
            return _TIPS[section]
        return None

    def flags(self, index: QModelIndex) -> Qt.ItemFlag:
        """Return what can be done with a cell."""
        if not index.isValid():
            return Qt.ItemFlag.NoItemFlags
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        if index.column() == NAME:
            flags |= Qt.ItemFlag.ItemIsEditable
            if self.landmarks[index.row()].state is not LandmarkState.PASSENGER:
                flags |= Qt.ItemFlag.ItemIsUserCheckable
        return flags

    def data(self, index: QModelIndex, role: int = 0) -> Any:
        """Return what a cell shows."""
        if not index.isValid() or index.row() >= len(self.landmarks):
            return None
        landmark, column = self.landmarks[index.row()], index.column()
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.EditRole):
            return self._text(landmark, column)
        if role == Qt.ItemDataRole.DecorationRole and column == NAME:
            return state_icon(landmark.state)
        if role == Qt.ItemDataRole.CheckStateRole and column == NAME:
            if landmark.state is LandmarkState.PASSENGER:
                return None
            return Qt.CheckState.Checked if landmark.enabled else Qt.CheckState.Unchecked
        if role == Qt.ItemDataRole.ForegroundRole and not landmark.enabled:
            return QColor(theme.STATE_COLOURS[LandmarkState.DISABLED])
        if role == Qt.ItemDataRole.TextAlignmentRole and column != NAME:
            across = (
                Qt.AlignmentFlag.AlignRight if column == RESIDUAL else Qt.AlignmentFlag.AlignHCenter
            )
            return int(across | Qt.AlignmentFlag.AlignVCenter)
        if role == Qt.ItemDataRole.ToolTipRole:
            if column in _SIDES:
                return position_text(landmark.position(_SIDES[column]))
            return f"{landmark.name}: {landmark.state.value}"
        return None

    def _text(self, landmark: Landmark, column: int) -> str:
        if column == NAME:
            return landmark.name
        if column == RESIDUAL:
            residual = self._residuals.get(landmark.name)
            return "" if residual is None else _residual_text(residual, landmark)
        if landmark.position(_SIDES[column]) is not None:
            return "✓"
        return "carried" if landmark.state is LandmarkState.PASSENGER else "–"

    def setData(self, index: QModelIndex, value: Any, role: int = 0) -> bool:
        """Ask for what the user typed or ticked; the session decides."""
        if not index.isValid() or index.column() != NAME:
            return False
        landmark = self.landmarks[index.row()]
        if role == Qt.ItemDataRole.EditRole and str(value) != landmark.name:
            self.rename_requested.emit(landmark.name, str(value))
            return True
        if role == Qt.ItemDataRole.CheckStateRole:
            self.enable_requested.emit(landmark.name, Qt.CheckState(value) == Qt.CheckState.Checked)
            return True
        return False


def _residual_text(residual: float, landmark: Landmark) -> str:
    size = max(abs(x) for x in landmark.destination or (1.0,))
    return "0" if residual < 1e-9 * max(size, 1e-300) else f"{residual:.3g}"


class LandmarkTable(QTableView):
    """The table; it renders the selection of the editor and asks for another."""

    selection_requested = Signal(list, object)

    def __init__(self, model: LandmarkModel, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setModel(model)
        self._model = model
        self._rendering = False
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
        )
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.setWordWrap(False)
        self.setAccessibleName("Landmarks")
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 9)
        header = self.horizontalHeader()
        header.setHighlightSections(False)
        header.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        header.setMinimumSectionSize(50)
        header.setSectionResizeMode(NAME, QHeaderView.ResizeMode.Stretch)
        for column in (SOURCE, DESTINATION, RESIDUAL):
            width = self.fontMetrics().horizontalAdvance(_TITLES[column]) + 20
            header.resizeSection(column, width)
        self.selectionModel().selectionChanged.connect(self._on_selected)

    def show_selection(self, selection: Selection) -> None:
        """Select the rows of the selected landmarks."""
        self._rendering = True
        selector = self.selectionModel()
        rows = [
            i
            for i, landmark in enumerate(self._model.landmarks)
            if landmark.name in selection.names
        ]
        if sorted(index.row() for index in selector.selectedRows()) != rows:
            selector.clearSelection()
            for row in rows:
                selector.select(
                    self._model.index(row, NAME),
                    QItemSelectionModel.SelectionFlag.Select
                    | QItemSelectionModel.SelectionFlag.Rows,
                )
            if rows:
                self.scrollTo(self._model.index(rows[0], NAME))
                if not self.hasFocus():
                    selector.setCurrentIndex(
                        self._model.index(rows[0], NAME), QItemSelectionModel.SelectionFlag.NoUpdate
                    )
        self._rendering = False

    def _on_selected(self) -> None:
        if self._rendering:
            return
        rows = sorted(index.row() for index in self.selectionModel().selectedRows())
        names = [self._model.landmarks[row].name for row in rows]
        self.selection_requested.emit(names, _SIDES.get(self.currentIndex().column()))


def position_text(position: Position | None) -> str:
    """Return a position for people."""
    return "not placed" if position is None else "({:.5g}, {:.5g}, {:.5g})".format(*position)
