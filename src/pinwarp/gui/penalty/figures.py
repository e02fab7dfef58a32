"""What the penalty does, in figures and in words."""

from __future__ import annotations

import html
import math

from qtpy.QtGui import QResizeEvent
from qtpy.QtWidgets import QHBoxLayout, QLabel, QSizePolicy, QWidget

from pinwarp.core.findings import FindingKind
from pinwarp.core.lengths import Ruler, rounding_among
from pinwarp.core.spline import PenaltyConvention
from pinwarp.gui.style import theme
from pinwarp.session.judging.suggested import about_suggested
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpResult

NO_FIGURE = "–"


_LANDMARKS_ONLY = "; of the warp of the landmarks, not of the refined one"


class FigureLabel(QLabel):
    """A number below its title."""

    def __init__(self, title: str, tip: str) -> None:
        super().__init__()
        self._title, self._tip = title, tip
        self.setToolTip(tip)
        self.setMinimumWidth(self.fontMetrics().horizontalAdvance(f"{title} "))
        self.show_text(NO_FIGURE)

    def show_more(self, tip: str) -> None:
        """Say more in the tip."""
        self.setToolTip(self._tip + tip)

    def show_text(self, text: str) -> None:
        """Show another number, formatted."""
        self.setText(f"<small>{self._title}</small><br><b>{html.escape(text)}</b>")


class PenaltyFigures(QWidget):
    """The figures of the warp at the present penalty."""

    def __init__(self) -> None:
        super().__init__()
        self.flexibility = FigureLabel("Flexibility", "Share of the non-affine freedom left")
        self.residual = FigureLabel("RMS residual", "How far the warped landmarks miss theirs")
        self.left_out = FigureLabel(
            "Leave-one-out", "RMS distance by which each landmark is missed when it is left out"
        )
        self.pairs = FigureLabel("Pairs", "Landmarks placed on both meshes that take part")
        self._refined, self._doubt, self._accepted = "", "", 0
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(theme.SPACE)
        for figure in (self.flexibility, self.residual, self.left_out, self.pairs):
            row.addWidget(figure)
        row.addStretch(1)

    def show_result(self, result: WarpResult | None, ruler: Ruler) -> None:
        """Show residual and pairs of a warp."""
        refined = result is not None and result.inputs.refinement is not None
        self._refined = _LANDMARKS_ONLY if refined else ""
        self.flexibility.show_more(self._refined)
        self._show_tips()
        rms = tidy_residual(result)
        self.residual.show_text(NO_FIGURE if rms is None else ruler.text(rms))
        count = len(result.inputs.source) if result is not None else 0
        # The one is evidence, the other is not.
        accepted = min(self._accepted, count)
        self.pairs.show_text(f"{count - accepted} + {accepted}" if accepted else str(count))

    def show_session(self, session: Session, ruler: Ruler) -> None:
        """Say which pairs of a session prove nothing."""
        kind, found = FindingKind.ACCEPTED, about_suggested(session, ruler)
        accepted = [one for one in found if one.finding.kind is kind]
        self._accepted = sum(len(one.names) for one in accepted)
        self._doubt = "".join(f".\n{one.sentence}" for one in accepted)
        self._show_tips()

    def _show_tips(self) -> None:
        self.left_out.show_more(self._refined + self._doubt)
        self.pairs.show_more(self._doubt)

    def show_flexibility(self, flexibility: float | None) -> None:
        """Show the flexibility, or that there is none to speak of."""
        self.flexibility.show_text(NO_FIGURE if flexibility is None else f"{flexibility:.0%}")

    def show_left_out(self, length: float, ruler: Ruler) -> None:
        """Show the leave-one-out error; NaN where there is none."""
        known = math.isfinite(length)
        self.left_out.show_text(ruler.text(length, 3) if known else NO_FIGURE)


class Notes(QLabel):
    """Words as high as they need to be at the width that there is, one line at least."""

    def __init__(self) -> None:
        super().__init__()
        self.setWordWrap(True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def show_words(self, warnings: str, advice: str = "") -> None:
        """Show warnings, and after them advice that need not alarm."""
        words = [
            f'<span style="color: {colour}">{html.escape(text, quote=False)}</span>'
            for text, colour in (
                (warnings, theme.warning_text_colour().name()),
                (advice, theme.quiet_text_colour().name()),
            )
            if text
        ]
        self.setText("&nbsp; ".join(words))
        self._fit_height()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Break the lines anew."""
        super().resizeEvent(event)
        self._fit_height()

    def _fit_height(self) -> None:
        line = self.fontMetrics().height()
        self.setFixedHeight(max(line, self.heightForWidth(self.width()) if self.text() else 0))


def tidy_residual(result: WarpResult | None) -> float | None:
    """Return the RMS residual of a warp; one that is only rounding is 0."""
    rms = result.rms_residual if result is not None else None
    if rms is None or result is None:
        return None
    return 0.0 if rms < rounding_among(result.inputs.destination) else rms


def warnings_of(session: Session, result: WarpResult | None, ruler: Ruler) -> str:
    """Say what must be known about a warp before its figures are trusted.

    Parameters
    ----------
    session
        Whose pairs have the names.
    result
        The warp.
    ruler
        How lengths are told.
    """
    if result is not None and result.problem:
        return result.problem
    notes: list[str] = []
    factor = result.factor if result is not None else None
    has_modes = factor is not None and len(factor.poles) > 0
    if result is not None and result.spline is not None:
        names = [pair.name for pair in session.pairs]
        notes = [
            finding.describe(names, ruler)
            for finding in result.spline.findings
            if all(row < len(names) for row in finding.rows)
        ]
    if session.settings.convention is PenaltyConvention.OPYNSIM and has_modes and not notes:
        notes.append(
            "OPynSim's published equation has poles (the ticks): the warp overshoots before "
            "each and flips behind it."
        )
    return "  ".join(notes)


def is_nearly_planar(result: WarpResult | None) -> bool:
    """Whether the landmarks of a warp lie nearly in a plane."""
    findings = result.spline.findings if result is not None and result.spline is not None else ()
    return any(finding.kind is FindingKind.NEARLY_PLANAR for finding in findings)
