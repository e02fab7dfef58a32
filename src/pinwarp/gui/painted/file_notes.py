"""What was left out of a mesh when it was read: a line below its file's name that opens it."""

from __future__ import annotations

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from pinwarp.core.words import counted
from pinwarp.gui.style import theme

# In logical pixels, as the caption above it.
MARGIN = 12
MOST_WIDTH = 420
_STYLE = f"""
    QPushButton {{
        background: transparent; border: none; padding: 1px 0;
        text-align: left; text-decoration: underline;
    }}
    QPushButton:focus {{ border: 1px dotted {theme.QUIET_INK}; }}
    QLabel {{
        color: {theme.INK}; background: {theme.PAPER}; border: 1px solid {theme.QUIET_INK};
        border-radius: 6px; padding: 6px 8px;
    }}
"""


class FileNotes(QWidget):
    """Stands below the caption of its viewport while there are notes; a click opens or closes them.

    A message passes; what is missing from a mesh does not.
    """

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.notes: tuple[str, ...] = ()
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        self.set_dark(False)
        self.button = QPushButton()
        self.button.setCursor(Qt.CursorShape.PointingHandCursor)
        self.button.setToolTip("What was changed or left out when the file was read")
        self.button.clicked.connect(lambda _checked: self._open(not self.is_open))
        self.label = QLabel()
        self.label.setTextFormat(Qt.TextFormat.PlainText)
        self.label.setWordWrap(True)
        self.label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.label.hide()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(2)
        column.addWidget(self.button, 0, Qt.AlignmentFlag.AlignLeft)
        column.addWidget(self.label)
        self.hide()

    def set_dark(self, dark: bool) -> None:
        """Write for a dark background, or for a light one."""
        ink, _ = theme.inks(dark)
        self.setStyleSheet(f"{_STYLE} QPushButton {{ color: {ink.name()}; }}")

    @property
    def is_open(self) -> bool:
        """Whether the notes can be read now."""
        return not self.label.isHidden()

    def show_notes(self, notes: tuple[str, ...]) -> None:
        """Offer the notes of a file, closed; nothing where it has none."""
        if notes == self.notes:
            return
        self.notes = notes
        self.label.setText("\n".join(f"• {note}" for note in notes))
        self.button.setText(f"{counted(len(notes), 'note')} on this file")
        self.setVisible(bool(notes))
        self._open(False)

    def _open(self, is_open: bool) -> None:
        self.label.setVisible(is_open)
        self.button.setAccessibleName(f"{self.button.text()}: {'close' if is_open else 'open'}")
        self.place()

    def place(self) -> None:
        """Stand below the name of the file, no wider than the viewport."""
        width = min(MOST_WIDTH, self.parentWidget().width() - 2 * MARGIN)
        if self.is_open:
            # As narrow as the words allow.
            widest = max(map(self.label.fontMetrics().horizontalAdvance, self.notes), default=0)
            width = min(width, widest + 48)
        else:
            width = min(width, self.button.sizeHint().width())
        self.setFixedWidth(max(width, 1))
        self.layout().activate()
        height = self.layout().heightForWidth(width)
        self.setFixedHeight(max(height, self.layout().minimumSize().height()))
        self.move(MARGIN, round(MARGIN + 2.2 * self.fontMetrics().height()))
