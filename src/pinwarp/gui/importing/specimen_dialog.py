"""Which specimen of a file that holds several is meant."""

from __future__ import annotations

from qtpy.QtCore import QSize
from qtpy.QtGui import QIcon
from qtpy.QtWidgets import QDialog, QDialogButtonBox, QLabel, QListWidget, QVBoxLayout, QWidget

from pinwarp.gui.style import theme
from pinwarp.session.importing.landmarks import Arriving

_SIZE = QSize(420, 380)


class SpecimenDialog(QDialog):
    """Lists the specimens of a file; ``chosen`` is the one that is marked.

    Parameters
    ----------
    arriving
        The file, read as far as its first specimen.
    parent
        The window.
    """

    def __init__(self, arriving: Arriving, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        side = "" if arriving.side is None else f"{arriving.side.value} "
        self.setWindowTitle("Choose a specimen")
        self.specimens = QListWidget()
        self.specimens.addItems(arriving.reading.specimens)
        self.specimens.setCurrentRow(arriving.reading.specimens.index(arriving.reading.specimen))
        self.specimens.setAlternatingRowColors(True)
        self.specimens.setUniformItemSizes(True)
        self.specimens.item(0).setSizeHint(QSize(0, self.fontMetrics().height() + 7))
        self.specimens.setAccessibleName("Specimens of the file")
        kinds = QDialogButtonBox.StandardButton
        self.buttons = QDialogButtonBox(kinds.Ok | kinds.Cancel)
        for button in self.buttons.buttons():
            button.setIcon(QIcon())
        choose = self.buttons.button(kinds.Ok)
        choose.setText("Choose")
        choose.setDefault(True)
        head = QLabel(
            f"{arriving.path.name} holds {len(arriving.reading.specimens):,} specimens. "
            f"Which one are the {side}landmarks of?"
        )
        font = head.font()
        font.setBold(True)
        head.setFont(font)
        head.setWordWrap(True)
        note = QLabel("The other side may come from another specimen of the same file.")
        note.setWordWrap(True)
        palette = note.palette()
        palette.setColor(note.foregroundRole(), theme.quiet_text_colour())
        note.setPalette(palette)
        column = QVBoxLayout(self)
        column.setContentsMargins(16, 14, 16, 12)
        column.setSpacing(10)
        for widget in (head, self.specimens, note, self.buttons):
            column.addWidget(widget)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self.specimens.itemDoubleClicked.connect(lambda _item: self.accept())
        self.specimens.setFocus()
        self.resize(_SIZE)

    @property
    def chosen(self) -> str:
        """The specimen that is marked."""
        return self.specimens.currentItem().text()
