"""The elements of a body as a tree: what becomes of each, and how far it moves."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from qtpy.QtCore import Qt, Signal
from qtpy.QtGui import QBrush
from qtpy.QtWidgets import QAbstractItemView, QHeaderView, QTreeWidget, QTreeWidgetItem

from pinwarp.core.lengths import Ruler
from pinwarp.core.model_rows import ElementRow
from pinwarp.gui.model import words
from pinwarp.gui.style import theme
from pinwarp.session.model.elements import muscle_of

ELEMENT, RULE, MOVED, PLUS_MINUS, FLAG = range(5)
_TITLES = ("Element", "Rule", "Moved", "±", "")
_TIPS = {
    RULE: "What becomes of it: carried, turned with the bone, or kept as it is",
    MOVED: "How far the bone moves it, in {unit}",
    PLUS_MINUS: "How far that may be off, in {unit}: the standard deviation of one coordinate",
    FLAG: "Marked where there is something to look at",
}
_WIDEST = {RULE: "made anew ", MOVED: "123.4 ", PLUS_MINUS: "12.3 ", FLAG: "12 "}
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_KEY = Qt.ItemDataRole.UserRole
Key = tuple[str, str, int]


def _key(row: ElementRow) -> Key:
    return (row.path, row.kind, row.line)


class RuleTree(QTreeWidget):
    """Shows the rows of a body below headings; muscles have their points below them."""

    chosen = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._rows: dict[Key, ElementRow] = {}
        self._items: dict[Key, QTreeWidgetItem] = {}
        self._only_flagged = False
        # Models are in metres.
        self._ruler = Ruler("mm", 1000.0)
        self.setHeaderLabels(_TITLES)
        self.setUniformRowHeights(True)
        self.setAlternatingRowColors(True)
        self.setIndentation(12)
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setAccessibleName("Elements of the body")
        header, head = self.header(), self.headerItem()
        header.setStretchLastSection(False)
        header.setMinimumSectionSize(24)
        header.setSectionResizeMode(ELEMENT, QHeaderView.ResizeMode.Stretch)
        for column, widest in _WIDEST.items():
            header.setSectionResizeMode(column, QHeaderView.ResizeMode.Interactive)
            header.resizeSection(column, self.fontMetrics().horizontalAdvance(widest) + 12)
            head.setToolTip(column, _TIPS[column].format(unit=self._ruler.unit))
            head.setTextAlignment(column, _RIGHT if column > RULE else Qt.AlignmentFlag.AlignLeft)
        self.itemSelectionChanged.connect(self.chosen)

    @property
    def rows(self) -> tuple[ElementRow, ...]:
        """The rows that are chosen, a heading standing for all below it."""
        found: dict[Key, ElementRow] = {}
        for item in self.selectedItems():
            for one in (item, *_below(item)) if item.parent() is None else (item,):
                row = self._rows.get(_key_of(one))
                if row is not None:
                    found[_key(row)] = row
        return tuple(found.values())

    def show_rows(self, rows: Sequence[ElementRow]) -> None:
        """Show other rows, or the same with other figures."""
        new = {_key(row): row for row in rows}
        if new.keys() != self._rows.keys():
            self.blockSignals(True)
            self._fill(rows)
            self.blockSignals(False)
            self._rows = new
            self.chosen.emit()
        self._rows = new
        for key, row in new.items():
            _write(self._items[key], row, self._ruler)
        for number in range(self.topLevelItemCount()):
            item = self.topLevelItem(number)
            flags = sum(bool(self._rows[_key_of(one)].flag) for one in _below(item) if _key_of(one))
            _flag(item, f"{flags}" if flags else "")
        self.show_only_flagged(self._only_flagged)

    def show_ruler(self, ruler: Ruler) -> None:
        """Tell lengths otherwise."""
        if ruler == self._ruler:
            return
        self._ruler = ruler
        for column, tip in _TIPS.items():
            self.headerItem().setToolTip(column, tip.format(unit=ruler.unit))
        for key, row in self._rows.items():
            _write(self._items[key], row, ruler)

    def show_only_flagged(self, only: bool) -> None:
        """Leave out what asks for no look, or show everything."""
        self._only_flagged = only
        for number in range(self.topLevelItemCount()):
            _hide(self.topLevelItem(number), only)

    def choose(self, path: str) -> None:
        """Choose an element by its path."""
        for key, item in self._items.items():
            if key[0] == path:
                self.setCurrentItem(item)
                return

    def _fill(self, rows: Sequence[ElementRow]) -> None:
        self.clear()
        self._items = {}
        headings: dict[str, QTreeWidgetItem] = {}
        by_group: dict[str, list[ElementRow]] = {group: [] for group in words.GROUPS}
        for row in rows:
            by_group[words.group_of(row)].append(row)
        for group, found in by_group.items():
            if not found:
                continue
            heading = headings[group] = QTreeWidgetItem([f"{group} ({_count(group, found)})"])
            heading.setFirstColumnSpanned(False)
            font = heading.font(ELEMENT)
            font.setBold(True)
            heading.setFont(ELEMENT, font)
            self.addTopLevelItem(heading)
            muscles: dict[str, QTreeWidgetItem] = {}
            # A muscle's own row comes before those of its points.
            for row in sorted(found, key=lambda one: muscle_of(one.path) != ""):
                above = muscles.get(muscle_of(row.path), heading)
                item = self._items[_key(row)] = QTreeWidgetItem(above)
                item.setData(ELEMENT, _KEY, _key(row))
                item.setText(ELEMENT, words.name_of(row))
                item.setToolTip(ELEMENT, f"{row.path} ({row.kind}, line {row.line})")
                muscles.setdefault(row.path, item)
            heading.setExpanded(group in (words.FRAMES, words.WRAPS, words.MUSCLES))
            for muscle in muscles.values():
                muscle.setExpanded(True)


def _count(group: str, rows: Sequence[ElementRow]) -> int:
    if group != words.MUSCLES:
        return len(rows)
    return len({muscle_of(row.path) or row.path for row in rows})


def _write(item: QTreeWidgetItem, row: ElementRow, ruler: Ruler) -> None:
    for column, text in (
        (RULE, words.outcome_in_words(row)),
        (MOVED, words.length_in_words(row.moved, ruler)),
        (PLUS_MINUS, words.length_in_words(row.plus_minus, ruler)),
    ):
        item.setText(column, text)
        item.setTextAlignment(column, _RIGHT if column > RULE else Qt.AlignmentFlag.AlignLeft)
    _flag(item, "!" if row.flag else "")
    item.setToolTip(FLAG, row.flag)


def _flag(item: QTreeWidgetItem, text: str) -> None:
    item.setText(FLAG, text)
    item.setTextAlignment(FLAG, Qt.AlignmentFlag.AlignCenter)
    item.setForeground(FLAG, QBrush(theme.warning_text_colour()))
    font = item.font(FLAG)
    font.setBold(True)
    item.setFont(FLAG, font)


def _key_of(item: QTreeWidgetItem) -> Any:
    data = item.data(ELEMENT, _KEY)
    return None if data is None else tuple(data)


def _below(item: QTreeWidgetItem) -> Iterable[QTreeWidgetItem]:
    for number in range(item.childCount()):
        yield item.child(number)
        yield from _below(item.child(number))


def _hide(item: QTreeWidgetItem, only: bool) -> bool:
    """Hide an item where nothing of it is flagged; say whether it is hidden."""
    below = [_hide(item.child(number), only) for number in range(item.childCount())]
    is_heading = item.parent() is None
    hidden = only and all(below) and (is_heading or not item.text(FLAG))
    item.setHidden(hidden)
    return hidden
