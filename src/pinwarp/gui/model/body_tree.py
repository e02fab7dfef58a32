"""The bodies of a model as a list: how far each is."""

from __future__ import annotations

from collections.abc import Iterable

from qtpy.QtCore import Qt, Signal
from qtpy.QtGui import QBrush, QPainter, QPaintEvent, QResizeEvent
from qtpy.QtWidgets import QHeaderView, QTreeWidget, QTreeWidgetItem

from pinwarp.gui.model import words
from pinwarp.gui.style import theme
from pinwarp.session.model.bench import BodyWork, Progress, progress_of
from pinwarp.session.view import LengthUnit

NAME, MESHES, POINTS, WRAPS, STATE, WORST = range(6)
_TITLES = ("Body", "Meshes", "Points", "Wraps", "Pairs", "Worst")
_TIPS = {
    NAME: "A click makes the body's bone the source; what is not ticked is not exported",
    MESHES: "How many meshes make its bone",
    POINTS: "Path points, markers and stations",
    WRAPS: "What muscles wrap over",
    STATE: "None, started, or done: eight pairs and no landmark without its counterpart. "
    "A star: not saved",
    WORST: "The largest leave-one-out error of its landmarks",
}
_WIDEST = {MESHES: "missing", POINTS: "Points", WRAPS: "Wraps", STATE: "started*", WORST: "12.3 mm"}
# A usual name of a body, with its box; and what gives way to names in a small window, in turn.
_NAME, _GIVING_WAY = "calcaneus_r", (WRAPS, POINTS, MESHES)
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_PATH = Qt.ItemDataRole.UserRole
_POINTS = ("path point", "conditional", "moving", "marker", "station")


class BodyTree(QTreeWidget):
    """Shows the bodies; where there is no model it says how to begin."""

    body_chosen = Signal(str)
    body_enabled = Signal(str, bool)

    def __init__(self) -> None:
        super().__init__()
        self._is_rendering = False
        self.setHeaderLabels(_TITLES)
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(True)
        self.setAlternatingRowColors(True)
        self.setAccessibleName("Bodies of the model")
        header, head = self.header(), self.headerItem()
        header.setStretchLastSection(False)
        header.setMinimumSectionSize(24)
        self._widths: dict[int, int] = {}
        header.setSectionResizeMode(NAME, QHeaderView.ResizeMode.Stretch)
        for column, tip in _TIPS.items():
            head.setToolTip(column, tip)
            if column != NAME:
                head.setTextAlignment(column, _RIGHT)
                header.setSectionResizeMode(column, QHeaderView.ResizeMode.Interactive)
                widest = max(_WIDEST[column], _TITLES[column], key=len)
                self._widths[column] = self.fontMetrics().horizontalAdvance(widest) + 14
                header.resizeSection(column, self._widths[column])
        self.currentItemChanged.connect(self._on_current)
        self.itemChanged.connect(self._on_changed)

    def show_bodies(self, bodies: Iterable[BodyWork], chosen: str, wanted: LengthUnit) -> None:
        """Show other bodies, or the same as they are now, lengths as is wanted."""
        shown = list(bodies)
        self._is_rendering = True
        paths = [one.overview.path for one in shown]
        if paths != [self._path(number) for number in range(self.topLevelItemCount())]:
            self.clear()
            for path in paths:
                item = QTreeWidgetItem()
                item.setData(NAME, _PATH, path)
                self.addTopLevelItem(item)
        for number, one in enumerate(shown):
            _write(self.topLevelItem(number), one, wanted)
        current = self.topLevelItem(paths.index(chosen)) if chosen in paths else None
        if current is not self.currentItem():
            self.setCurrentItem(current)
            if current is None:
                self.clearSelection()
        self._is_rendering = False
        self.viewport().update()

    def _path(self, number: int) -> str:
        return str(self.topLevelItem(number).data(NAME, _PATH))

    def _on_current(self, item: QTreeWidgetItem | None, _before: object) -> None:
        if not self._is_rendering and item is not None:
            self.body_chosen.emit(item.data(NAME, _PATH))

    def _on_changed(self, item: QTreeWidgetItem, column: int) -> None:
        if not self._is_rendering and column == NAME:
            on = item.checkState(NAME) == Qt.CheckState.Checked
            self.body_enabled.emit(item.data(NAME, _PATH), on)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Leave out what is less worth than the names where there is no room for both."""
        super().resizeEvent(event)
        spare = self.viewport().width() - sum(self._widths.values())
        wanted = self.fontMetrics().horizontalAdvance(_NAME) + 34
        for column in _GIVING_WAY:
            is_hidden = spare < wanted
            spare += self._widths[column] * is_hidden
            self.setColumnHidden(column, is_hidden)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Say how to begin where there is nothing to show."""
        super().paintEvent(event)
        if self.topLevelItemCount():
            return
        with QPainter(self.viewport()) as painter:
            painter.setPen(theme.quiet_text_colour())
            room = self.viewport().rect().adjusted(24, 12, -24, -12)
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(room, flags, words.EMPTY)


def _write(item: QTreeWidgetItem, one: BodyWork, wanted: LengthUnit) -> None:
    progress = progress_of(one.current)
    texts = {
        NAME: one.name,
        MESHES: words.meshes_in_words(one),
        POINTS: f"{words.count_of(one, *_POINTS)}",
        WRAPS: f"{words.count_of(one, 'wrap')}",
        STATE: words.state_in_words(one),
        WORST: words.worst_in_words(one, wanted),
    }
    for column, text in texts.items():
        item.setText(column, text)
        if column != NAME:
            item.setTextAlignment(column, _RIGHT)
    item.setCheckState(NAME, Qt.CheckState.Checked if one.enabled else Qt.CheckState.Unchecked)
    quiet = QBrush(theme.quiet_text_colour())
    usual = QBrush(theme.text_colour())
    item.setForeground(STATE, quiet if progress is Progress.NONE else usual)
    missing = QBrush(theme.warning_text_colour())
    item.setForeground(MESHES, missing if one.overview.missing else usual)
    about = one.overview
    names = ", ".join(about.meshes) or "no mesh"
    item.setToolTip(
        MESHES, f"{names}; not found: {', '.join(about.missing)}" if about.missing else names
    )
    item.setToolTip(NAME, about.path)
    session = one.current
    pairs = len(session.pairs) if session is not None else 0
    item.setToolTip(STATE, f"{pairs} pairs" + (", not saved" if one.is_unsaved else ""))
