"""Figures in rows: to be read, selected and copied."""

from __future__ import annotations

import html
from collections.abc import Sequence

from qtpy.QtCore import QEvent, Qt, Signal
from qtpy.QtGui import QColor, QKeyEvent, QKeySequence
from qtpy.QtWidgets import QLabel, QToolTip

from pinwarp.gui.style import theme
from pinwarp.session.judging.warp_figures import Figure, FigureRow

_ACROSS = 3


class FiguresView(QLabel):
    """Titles on the left, up to three figures beside them, each with its unit.

    ``copy_requested`` asks for everything as a table: Ctrl+C while no text is selected.
    """

    copy_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setTextFormat(Qt.TextFormat.RichText)
        self.setTextInteractionFlags(
            Qt.TextInteractionFlag.TextSelectableByMouse
            | Qt.TextInteractionFlag.TextSelectableByKeyboard
        )
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.setAccessibleName("The warp taken apart")
        self.rows: Sequence[FigureRow] = ()
        # What each line belongs to.
        self._lines: list[FigureRow] = []

    def show_rows(self, rows: Sequence[FigureRow]) -> None:
        """Show other figures; a selection stays as long as they are the same."""
        if rows != self.rows:
            self.rows = rows
            self.setText(self._table())

    def _table(self) -> str:
        quiet = theme.quiet_text_colour()
        quiet_name = quiet.name(QColor.NameFormat.HexArgb)
        lines = []
        self._lines = []
        for row in self.rows:
            title = html.escape(row.title)
            for first in range(0, len(row.figures), _ACROSS):
                cells = "".join(
                    _cells(figure, quiet_name) for figure in row.figures[first : first + _ACROSS]
                )
                lines.append(f"<tr><td>{title}</td>{cells}</tr>")
                self._lines.append(row)
                title = ""
        return f'<table cellspacing="0" cellpadding="2">{"".join(lines)}</table>'

    def event(self, event: QEvent) -> bool:
        """Claim Ctrl+C before the window copies landmarks; say what a line means."""
        if event.type() == QEvent.Type.ToolTip and self._lines:
            # All lines are of one height.
            share = event.pos().y() / max(1, self.sizeHint().height())
            line = min(int(share * len(self._lines)), len(self._lines) - 1)
            QToolTip.showText(event.globalPos(), self._lines[line].meaning, self)
            return True
        if event.type() == QEvent.Type.ShortcutOverride and event.matches(
            QKeySequence.StandardKey.Copy
        ):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Copy what is selected, or everything."""
        if event.matches(QKeySequence.StandardKey.Copy) and not self.hasSelectedText():
            self.copy_requested.emit()
        else:
            super().keyPressEvent(event)


def _cells(figure: Figure, quiet: str) -> str:
    """Return a cell for the name and one for the number."""
    text = html.escape(figure.text).replace(" ", "&nbsp;")
    name = f'<td align="right" style="padding-left:5px; color:{quiet}">{figure.name}</td>'
    return f'{name}<td align="right" style="padding-left:3px">{text}</td>'
