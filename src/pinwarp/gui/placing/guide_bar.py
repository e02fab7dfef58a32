"""The bar above the bones in which the guide asks for one landmark after the other."""

from __future__ import annotations

import html

from qtpy.QtCore import Qt, Signal
from qtpy.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QWidget,
)

from pinwarp.core.landmarks import LandmarkState
from pinwarp.gui.style import theme
from pinwarp.session.guide import GuideStep
from pinwarp.session.session import Session

_ASKS = {
    LandmarkState.EMPTY: "click it on either bone",
    LandmarkState.SOURCE_ONLY: "click it on the destination",
    LandmarkState.DESTINATION_ONLY: "click it on the source",
    LandmarkState.PAIRED: "placed on both bones",
    LandmarkState.SUGGESTED: "only suggested on the destination",
}


class GuideBar(QFrame):
    """Says what is asked for; asks to skip, to go back and to end."""

    skip_requested = Signal()
    back_requested = Signal()
    end_requested = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setAutoFillBackground(True)
        self.words = QLabel()
        self.words.setTextFormat(Qt.TextFormat.RichText)
        # A long name must not push the table aside.
        self.words.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.progress = QProgressBar()
        self.progress.setFixedWidth(110)
        self.progress.setFormat("%v of %m")
        self.back = QPushButton("Back")
        self.skip = QPushButton("Skip")
        self.end = QPushButton("End")
        for button, tip, signal in (
            (self.back, "Ask for the previous incomplete landmark", self.back_requested),
            (self.skip, "Ask for the next incomplete landmark", self.skip_requested),
            (self.end, "Stop asking; the landmarks stay", self.end_requested),
        ):
            button.setToolTip(tip)
            # The keyboard stays with the bones.
            button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            button.clicked.connect(lambda _checked=False, signal=signal: signal.emit())
        row = QHBoxLayout(self)
        row.setContentsMargins(12, 4, 8, 4)
        row.setSpacing(theme.SPACE)
        row.addWidget(self.words, 1)
        for widget in (self.progress, self.back, self.skip, self.end):
            row.addWidget(widget)
        self.hide()

    def show_step(self, session: Session, step: GuideStep | None) -> None:
        """Show what the guide asks for; None hides the bar."""
        self.setVisible(step is not None)
        if step is None:
            return
        self.progress.setRange(0, max(1, step.total))
        self.progress.setValue(step.complete)
        landmark = session.landmark(step.name) if step.name else None
        if landmark is None:
            self.words.setText(f"<b>All {step.total} landmarks are placed.</b>")
        else:
            asks = _ASKS.get(landmark.state, "")
            self.words.setText(
                f"Place <b>{html.escape(landmark.name)}</b> ({step.place} of {step.total}): {asks}"
            )
        for button in (self.back, self.skip):
            button.setEnabled(landmark is not None)
