"""What the status bar says of the refinement, with a way to have it again."""

from __future__ import annotations

from qtpy.QtCore import Signal
from qtpy.QtWidgets import QHBoxLayout, QLabel, QPushButton, QWidget

from pinwarp.session.session import Session
from pinwarp.session.warp.refined import OUT_OF_DATE, is_out_of_date, refinement_in_words


class RefinementNote(QWidget):
    """What was fitted is no landmark: neither the table nor the markers tell of it."""

    again_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.label = QLabel()
        self.again = QPushButton("Refine Again")
        self.again.setFlat(True)
        self.again.clicked.connect(lambda _checked: self.again_requested.emit())
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addWidget(self.label)
        row.addWidget(self.again)
        self.hide()

    def show_session(self, session: Session) -> None:
        """Say what became of the refinement of a session; nothing where it has none."""
        text = refinement_in_words(session)
        stale = bool(text) and is_out_of_date(session)
        if text != self.label.text():
            self.label.setText(text)
            self.setToolTip(OUT_OF_DATE if stale else "")
            self.again.setVisible(stale)
        self.setVisible(bool(text))
