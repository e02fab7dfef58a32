"""The spread of every landmark, sorted by whatever header is clicked."""

from __future__ import annotations

import math
from typing import Any

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QHeaderView, QTreeWidget, QTreeWidgetItem

from pinwarp.core.lengths import Ruler
from pinwarp.gui.style import theme
from pinwarp.gui.style.icons import icon
from pinwarp.session.naming import natural
from pinwarp.session.repeat.comparing import Repeats

LANDMARK, COUNT, SPREAD, X, Y, Z = range(6)
_TIPS = {
    LANDMARK: "Marked where the spread is larger than chance makes of the median one",
    COUNT: "In how many repeats it was placed",
    SPREAD: "Root mean square distance from the mean of the repeats, with n - 1",
    X: "The share of x in the square of the spread",
    Y: "The share of y in the square of the spread",
    Z: "The share of z in the square of the spread",
}
_WIDEST = {COUNT: "Repeats ", SPREAD: "Spread (mm) ", X: "100 % ", Y: "100 % ", Z: "100 % "}
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_KEY = Qt.ItemDataRole.UserRole


class _Item(QTreeWidgetItem):
    """A row that sorts by its numbers, not by how they are written."""

    def __lt__(self, other: QTreeWidgetItem) -> bool:
        """Whether it stands before another in the column that is sorted by."""
        tree = self.treeWidget()
        column = tree.sortColumn() if tree is not None else LANDMARK
        return bool(self.data(column, _KEY) < other.data(column, _KEY))


class SpreadTable(QTreeWidget):
    """A row per landmark, the largest spread first until somebody sorts otherwise."""

    def __init__(self) -> None:
        super().__init__()
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(True)
        self.setAlternatingRowColors(True)
        self.setAccessibleName("Spread of every landmark")
        self.show_repeats(None, Ruler())
        self.setSortingEnabled(True)
        self.sortByColumn(SPREAD, Qt.SortOrder.DescendingOrder)
        header = self.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(LANDMARK, QHeaderView.ResizeMode.Stretch)
        for column, widest in _WIDEST.items():
            header.setSectionResizeMode(column, QHeaderView.ResizeMode.Interactive)
            # Room for the arrow that says by what is sorted.
            header.resizeSection(column, self.fontMetrics().horizontalAdvance(widest) + 30)

    def show_repeats(self, repeats: Repeats | None, ruler: Ruler) -> None:
        """Show the landmarks of some repeats, or none."""
        unit = ruler.unit
        self.setHeaderLabels(
            ["Landmark", "Repeats", f"Spread ({unit})" if unit else "Spread", "x", "y", "z"]
        )
        for column, tip in _TIPS.items():
            self.headerItem().setToolTip(column, tip)
            if column != LANDMARK:
                # In the middle: at the right edge stands the arrow that says by what is sorted.
                self.headerItem().setTextAlignment(column, Qt.AlignmentFlag.AlignCenter)
        self.clear()
        if repeats is None:
            return
        figures = repeats.figures
        for row, name in enumerate(repeats.names):
            item = _Item()
            _write(item, LANDMARK, name, natural(name))
            count, spread = int(figures.counts[row]), float(figures.spreads[row])
            _write(item, COUNT, str(count), count)
            known = not math.isnan(spread)
            _write(item, SPREAD, ruler.number(spread) if known else "", spread if known else -1.0)
            for column, share in zip((X, Y, Z), figures.shares[row].tolist(), strict=True):
                _write(
                    item,
                    column,
                    "" if math.isnan(share) else f"{share:.0%}",
                    -1.0 if math.isnan(share) else share,
                )
            if figures.outstanding[row]:
                item.setIcon(LANDMARK, icon("warning", theme.WARNING_COLOUR))
                item.setToolTip(LANDMARK, f"{name} stands out: look at it in every repeat")
            self.addTopLevelItem(item)
        self.scrollToTop()


def _write(item: QTreeWidgetItem, column: int, text: str, key: Any) -> None:
    item.setText(column, text)
    item.setData(column, _KEY, key)
    if column != LANDMARK:
        item.setTextAlignment(column, _RIGHT)
