"""All keys and mouse gestures on one sheet over the window, made from the actions themselves."""

from __future__ import annotations

from collections.abc import Sequence

from qtpy.QtCore import QEvent, QObject, QPointF, QRectF, Qt
from qtpy.QtGui import (
    QAction,
    QColor,
    QFont,
    QKeyEvent,
    QKeySequence,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
)
from qtpy.QtWidgets import QWidget

from pinwarp.gui.capability.action import DEED, name_and_held
from pinwarp.gui.scene.key_words import with_own_keys

Lines = list[tuple[str, str]]

_MOUSE: Lines = [
    ("Click on a bone", "place the landmark that is asked for, or a new one"),
    ("Ctrl+click on the source", "add a passenger"),
    ("Shift+click on a bone", "put the selected landmark there"),
    ("Click a landmark", "select it everywhere"),
    ("Drag a landmark", "slide it over the bone (Esc puts it back)"),
    ("Shift+drag a landmark", "move it in the view plane, off the bone"),
    ("Click or drag a ghost", "make it the next one, or put it right"),
    ("Drag a handle of a curve", "shape it; onto a landmark anchors it there"),
    ("Arrow keys", "nudge the selection (Shift: ten times as far)"),
    ("Ctrl+arrow keys, Page Up", "turn the bones, zoom"),
    ("Enter, Tab at the crosshair", "click there, go to the other bone"),
    ("Drag, wheel, right drag", "orbit, zoom, pan"),
    ("Ctrl+drag", "turn this bone alone"),
    ("Drop files on a bone", "open meshes, landmarks, sessions"),
]
_COLUMNS = 2


class ShortcutOverlay(QWidget):
    """A sheet over a window; any key or click takes it away.

    Parameters
    ----------
    window
        What it covers.
    groups
        Titles and the actions listed under each.
    """

    def __init__(self, window: QWidget, groups: Sequence[tuple[str, Sequence[QAction]]]) -> None:
        super().__init__(window)
        self._groups = groups
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName("Keys and mouse gestures")
        self.hide()
        window.installEventFilter(self)

    def lines(self) -> list[tuple[str, Lines]]:
        """Return what is listed: titles, and keys with what they do."""
        listed: list[tuple[str, Lines]] = [
            ("Mouse", [(with_own_keys(keys), words) for keys, words in _MOUSE])
        ]
        for title, actions in self._groups:
            entries = [entry for entry in map(_entry, actions) if entry[0]]
            if entries:
                listed.append((title, entries))
        return listed

    def toggle(self) -> None:
        """Show the sheet, or take it away."""
        if self.isVisible():
            self.hide()
            return
        self.setGeometry(self.parentWidget().rect())
        self.show()
        self.raise_()
        self.setFocus()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Stay as large as the window."""
        if event.type() == QEvent.Type.Resize and self.isVisible():
            self.setGeometry(self.parentWidget().rect())
        return super().eventFilter(watched, event)

    def event(self, event: QEvent) -> bool:
        """Take every key before a shortcut does: it only closes the sheet."""
        if event.type() == QEvent.Type.ShortcutOverride:
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, _event: QKeyEvent) -> None:
        """Close."""
        self.hide()

    def mousePressEvent(self, _event: QMouseEvent) -> None:
        """Close."""
        self.hide()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the groups in columns on a dark sheet."""
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.fillRect(self.rect(), QColor(20, 24, 30, 225))
            listed = self.lines()
            rows = [len(entries) + 2 for _, entries in listed]
            columns = _in_columns(rows, _COLUMNS)
            longest = max(sum(rows[i] for i in column) for column in columns)
            # A low window moves the lines together.
            line = min(painter.fontMetrics().height() + 5, (self.height() - 32) // longest)
            heights = [count * line for count in rows]
            width = min(1000, self.width() - 60)
            tallest = max(sum(heights[i] for i in column) for column in columns)
            top = max(16.0, (self.height() - tallest) / 2)
            left = (self.width() - width) / 2
            for number, column in enumerate(columns):
                at = QPointF(left + number * width / _COLUMNS, top)
                for i in column:
                    self._paint_group(painter, *listed[i], at, width / _COLUMNS - 24, line)
                    at += QPointF(0, heights[i])

    def _paint_group(
        self, painter: QPainter, title: str, entries: Lines, at: QPointF, width: float, line: int
    ) -> None:
        bold = QFont(self.font())
        bold.setWeight(QFont.Weight.DemiBold)
        painter.setFont(bold)
        painter.setPen(QColor("#9fd0f5"))
        painter.drawText(QRectF(at.x(), at.y(), width, line), Qt.AlignmentFlag.AlignVCenter, title)
        painter.setPen(QPen(QColor(255, 255, 255, 50), 1))
        painter.drawLine(at + QPointF(0, line), at + QPointF(width, line))
        painter.setFont(self.font())
        split = 0.36 * width
        for row, (key, words) in enumerate(entries, start=1):
            y = at.y() + row * line + 3
            painter.setPen(QColor("#ffffff"))
            painter.drawText(QRectF(at.x(), y, split, line), Qt.AlignmentFlag.AlignVCenter, key)
            painter.setPen(QColor("#c9d1da"))
            painter.drawText(
                QRectF(at.x() + split, y, width - split, line), Qt.AlignmentFlag.AlignVCenter, words
            )


def _entry(action: QAction) -> tuple[str, str]:
    """Return the keys of an action and what it does; a key that is held stands behind a tab."""
    words, held = name_and_held(action)
    native = QKeySequence.SequenceFormat.NativeText
    keys = [key.toString(native) for key in action.shortcuts()] + [held] * bool(held)
    return ", ".join(keys), action.property(DEED) or words.rstrip("…")


def _in_columns(heights: Sequence[float], count: int) -> list[list[int]]:
    """Share groups over columns of about the same height, in order."""
    columns: list[list[int]] = [[]]
    limit, used = sum(heights) / count, 0.0
    for index, height in enumerate(heights):
        if used + height / 2 > limit and len(columns) < count:
            columns.append([])
            used = 0.0
        columns[-1].append(index)
        used += height
    return columns
