"""The bar above the bones in which the guide asks for one landmark after the other."""

from __future__ import annotations

import html

from qtpy.QtCore import Signal

from pinwarp.core.landmarks import LandmarkState
from pinwarp.gui.style.bar import Bar
from pinwarp.session.guide import GuideStep
from pinwarp.session.session import Session

_ASKS = {
    LandmarkState.EMPTY: "click it on either bone",
    LandmarkState.SOURCE_ONLY: "click it on the destination",
    LandmarkState.DESTINATION_ONLY: "click it on the source",
    LandmarkState.PAIRED: "placed on both bones",
    LandmarkState.SUGGESTED: "only suggested on the destination",
}


class GuideBar(Bar):
    """Says what is asked for; asks to skip, to go back and to end."""

    skip_requested = Signal()
    back_requested = Signal()
    end_requested = Signal()

    def __init__(self) -> None:
        super().__init__(progress_width=110)
        self.back = self.add_button(
            "Back", "Ask for the previous incomplete landmark", self.back_requested
        )
        self.skip = self.add_button(
            "Skip", "Ask for the next incomplete landmark", self.skip_requested
        )
        self.end = self.add_button("End", "Stop asking; the landmarks stay", self.end_requested)

    def show_step(self, session: Session, step: GuideStep | None) -> None:
        """Show what the guide asks for; None hides the bar."""
        self.setVisible(step is not None)
        if step is None:
            return
        self.show_share(step.complete, max(1, step.total))
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
