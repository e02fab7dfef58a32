"""The warping penalty: a slider from interpolation to the affine fit, its value, its effect."""

from __future__ import annotations

import math
from collections.abc import Sequence

from qtpy.QtCore import Qt, Signal
from qtpy.QtGui import QAction
from qtpy.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QMenu,
    QPushButton,
    QToolButton,
    QWidget,
)

from pinwarp.core.basis import Basis
from pinwarp.core.factor import SourceFactor
from pinwarp.core.findings import FindingKind
from pinwarp.core.lengths import Ruler
from pinwarp.core.quality import PenaltyCurve
from pinwarp.core.spline import PenaltyConvention
from pinwarp.gui.penalty.exact import ExactPenalty, equation_of
from pinwarp.gui.penalty.figures import (
    Notes,
    PenaltyFigures,
    is_nearly_planar,
    tidy_residual,
    warnings_of,
)
from pinwarp.gui.penalty.plot import PenaltyPlot, Plotted
from pinwarp.gui.penalty.slider import STEPS, PenaltySlider
from pinwarp.gui.style import theme
from pinwarp.session.judging.quality import LEAST_PAIRS, Quality, penalty_advice
from pinwarp.session.rulers import Rulers
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpResult

_NO_CURVE = "From five pairs on, leave-one-out error and residual are drawn here."
_TOO_FEW = "The penalty acts from five pairs on."
_WAITS = "Suggested: settle first"
_WAITS_FOR = {
    FindingKind.SWAPPED: "two landmarks seem to be exchanged",
    FindingKind.MIRRORED: "one of the two sets seems to be mirrored",
}
_NO_SUGGESTION = "With semilandmarks no penalty is suggested."
_PLANAR = "Keep the warp tame across the plane that the landmarks lie in"
_NOT_PLANAR = "Landmarks can be treated as planar with the basis r only"
_OTHER_CONVENTION = "The curve and its suggestion are of the regularising convention."


class PenaltyPanel(QWidget):
    """Shows the session's penalty and asks for another.

    Parameters
    ----------
    curve, snapshots
        The actions that have a button here; behind the first snapshot's are the others.
    """

    penalty_previewed = Signal(float)
    penalty_requested = Signal(float)
    equation_requested = Signal(object, object)
    planar_requested = Signal(bool)
    unit_requested = Signal(str)

    def __init__(self, curve: QAction, snapshots: Sequence[QAction]) -> None:
        super().__init__()
        self._factor: SourceFactor | None = None
        self._result: WarpResult | None = None
        self._quality: Quality | None = None
        self._rulers = Rulers()
        self._session = Session()
        self._sliding = False

        self.slider = PenaltySlider()
        self.slider.setAccessibleName("Warping penalty")
        self.slider.setMinimumWidth(120)
        self.slider.setToolTip(
            "How much the warp is smoothed: left meets every landmark, right is the affine fit"
        )
        self.plot = PenaltyPlot(self.slider, self)
        self.exact = exact = ExactPenalty()
        self.value, self.unit, self.equation = exact.value, exact.unit, exact.equation
        self.figures = PenaltyFigures()
        self.suggested = QPushButton()
        self.warning = Notes()
        self.planar = QPushButton("Treat as planar")
        self.planar.setCheckable(True)
        self._lay_out(curve, snapshots)

        self.slider.sliderPressed.connect(self._on_pressed)
        self.slider.valueChanged.connect(self._on_slid)
        self.slider.sliderReleased.connect(self._on_released)
        self.plot.penalty_requested.connect(self.penalty_requested)
        self.suggested.clicked.connect(self.take_suggested)
        exact.penalty_requested.connect(self.penalty_requested)
        exact.unit_requested.connect(self.unit_requested)
        exact.equation_requested.connect(self.equation_requested)
        exact.refused.connect(self.warning.show_words)
        self.planar.clicked.connect(self.planar_requested)
        self.show_session(self._session)
        self.show_result(None)

    def _lay_out(self, curve: QAction, snapshots: Sequence[QAction]) -> None:
        slider = QHBoxLayout()
        slider.setSpacing(theme.SPACE)
        # What stands at the curves' ends takes more room than the ends of the slider.
        for text, reserved in (("Interpolates", "Interpolates"), ("Affine", "Leave-one-out")):
            label = QLabel(text)
            label.setFixedWidth(self.fontMetrics().horizontalAdvance(reserved) + 4)
            slider.addWidget(label)
        slider.insertWidget(1, self.slider, 1)
        buttons = QHBoxLayout()
        buttons.setSpacing(4)
        buttons.addWidget(self.suggested, 1)
        buttons.addWidget(_tool_button(curve))
        # Kept: Python must not let go of a menu that Qt still shows.
        self._snapshot_menu = QMenu(self)
        self._snapshot_menu.addActions(snapshots[1:])
        snapshot = _tool_button(snapshots[0])
        snapshot.setMenu(self._snapshot_menu)
        snapshot.setPopupMode(QToolButton.ToolButtonPopupMode.MenuButtonPopup)
        buttons.addWidget(snapshot)
        below = QHBoxLayout()
        below.addWidget(self.warning, 1)
        below.addWidget(self.planar)
        self._grid = grid = QGridLayout(self)
        grid.setContentsMargins(12, 4, 12, 6)
        grid.setHorizontalSpacing(2 * theme.SPACE)
        grid.setVerticalSpacing(4)
        grid.setColumnStretch(0, 1)
        grid.addWidget(self.plot, 0, 0, 2, 1)
        grid.addWidget(self.exact, 0, 1)
        grid.addWidget(self.figures, 1, 1)
        grid.addLayout(slider, 2, 0)
        grid.addLayout(buttons, 2, 1)
        grid.addLayout(below, 3, 0, 1, 2)

    def show_plot(self, shown: bool) -> None:
        """Show the curve above the slider, or make room for the bones."""
        self.plot.setVisible(shown)
        # Without the curve the figures take its place.
        self._grid.addWidget(self.figures, *((1, 1) if shown else (0, 0)))

    # What is shown

    def show_rulers(self, rulers: Rulers) -> None:
        """Show all lengths in another unit."""
        self._rulers = rulers
        self.show_result(self._result)
        self._show_curve()
        self._show_present()
        self.exact.show_rulers(rulers)

    def show_session(self, session: Session) -> None:
        """Show the penalty of a session."""
        before, self._session = self._session, session
        if equation_of(session) != equation_of(before):
            self._show_curve()
        self.exact.show_session(session)
        self._place_handle()

    def show_result(self, result: WarpResult | None) -> None:
        """Show what the penalty does."""
        self.figures.show_result(result, self._rulers.destination)
        if result is not None and result.factor is not None and not result.factor.has_modes:
            # While a source landmark moves, the penalty's scale is not known: it will be at rest.
            return
        self._result = result
        self._factor = result.factor if result is not None else None
        self.slider.setEnabled(self._penalty_acts)
        self.value.setEnabled(self._penalty_acts)
        self.figures.show_flexibility(result.flexibility if result is not None else None)
        self._show_words()
        basis = self._session.settings.basis
        self.planar.setVisible(is_nearly_planar(result) or self._session.settings.planar)
        self.planar.setEnabled(basis is Basis.R)
        self.planar.setToolTip(_PLANAR if basis is Basis.R else _NOT_PLANAR)
        self.planar.setChecked(self._session.settings.planar)
        opynsim = self._session.settings.convention is PenaltyConvention.OPYNSIM
        poles = self._factor.poles.tolist() if self._factor is not None and opynsim else []
        self.slider.set_poles(tuple(self._share_of(pole) for pole in poles))
        if not self._penalty_acts:
            # What is drawn was of pairs that are gone.
            self._quality = None
            self._show_curve()
        self._place_handle()

    def show_quality(self, quality: Quality | None) -> None:
        """Show the curve that the pairs make, and what it suggests."""
        self._quality = quality
        self._show_curve()
        self._show_words()
        self._show_present()

    @property
    def _of_penalty(self) -> Ruler:
        return self._session.settings.penalty_ruler(self._rulers.session)

    @property
    def _penalty_acts(self) -> bool:
        """Whether there is anything beyond the affine fit that a penalty could smooth."""
        return self._factor is not None and len(self._factor.poles) > 0

    @property
    def _without_suggestion(self) -> str:
        """Why the pairs draw no curve, where that is not for want of pairs."""
        slides = self._result is not None and self._result.semilandmarks is not None
        return _NO_SUGGESTION if slides else ""

    @property
    def _curve(self) -> PenaltyCurve | None:
        return self._quality.curve if self._quality is not None else None

    def _show_curve(self) -> None:
        curve, factor, rulers = self._curve, self._factor, self._rulers
        if curve is None or factor is None or self._quality is None:
            count = len(self._result.inputs.source) if self._result is not None else 0
            self.plot.show_curve(
                None, self._without_suggestion or _NO_CURVE * (count < LEAST_PAIRS)
            )
        else:
            regular = self._session.settings.convention is PenaltyConvention.REGULARISING
            title = [f"RMS over {len(self._quality.inputs.source)} pairs"]
            title += [] if regular else ["by the regularising convention"]
            title += [] if self._quality.inputs.settings.is_whole else ["of the whole warp"]
            title += [] if self._quality.inputs.refinement is None else ["not refined"]
            told = (rulers.session, rulers.destination)
            self.plot.show_curve(Plotted(curve, factor, *told, regular, ", ".join(title)))
        self._show_suggestion()

    def _show_words(self) -> None:
        curve = self._curve
        advice = penalty_advice(curve, self._of_penalty) if curve is not None else ""
        if curve is not None and self._session.settings.convention is PenaltyConvention.OPYNSIM:
            advice = ""
        is_solved = self._result is not None and self._result.spline is not None
        if is_solved and not self._penalty_acts:
            advice = _TOO_FEW
        self.warning.show_words(
            warnings_of(self._session, self._result, self._rulers.session), advice
        )

    def _show_suggestion(self) -> None:
        curve, penalty = self._curve, self.suggestion
        there = penalty is not None and penalty == self._session.settings.penalty
        self.suggested.setEnabled(penalty is not None and not there)
        words = "No penalty suggested"
        ruler = self._of_penalty
        tip = penalty_advice(curve, ruler) if curve is not None else self._without_suggestion
        if penalty is not None:
            length = ruler.text(penalty, 3)
            words = f"At suggested: {length}" if there else f"Use suggested: {length}"
            tip = f"The penalty with the least leave-one-out error (T). {tip}"
        elif self._waits_for:
            words, tip = _WAITS, f"No penalty is suggested while {self._waits_for}: see the list."
        elif curve is not None and curve.suggested is not None:
            tip = _OTHER_CONVENTION
        self.suggested.setText(words)
        self.suggested.setToolTip(tip)

    def _show_present(self) -> None:
        """Mark the penalty on the curve, with the figures that it has there."""
        session = self._session
        share = self._share_of(session.settings.penalty)
        figures = self._figures_at(session.settings.penalty, share)
        left_out = figures[0] if figures else self._left_out_alone()
        self.figures.show_left_out(left_out, self._rulers.destination)
        self.plot.show_present(share if self._penalty_acts else None, figures)
        self._show_suggestion()

    def _left_out_alone(self) -> float:
        """Return the leave-one-out error where semilandmarks slide: it has no curve then."""
        quality, penalty = self._quality, self._session.settings.penalty
        if quality is None or quality.left_out is None or not self._without_suggestion:
            return math.nan
        return quality.left_out.rms if quality.inputs.settings.penalty == penalty else math.nan

    def _figures_at(self, penalty: float, share: float) -> tuple[float, float] | None:
        """Return leave-one-out error and residual: as solved, else as the curve has them."""
        quality, result = self._quality, self._result
        if quality is None or quality.curve is None or result is None:
            return None
        if self._session.settings.convention is PenaltyConvention.OPYNSIM and penalty > 0:
            return None
        left_out, residual = quality.curve.at(1.0 - share)
        exact = quality.inputs.settings.penalty == penalty and not quality.curve.is_affine
        if quality.left_out is not None and exact:
            left_out = quality.left_out.rms
        if result.inputs.settings.is_whole and result.inputs.settings.penalty == penalty:
            residual = tidy_residual(result) or 0.0
        return left_out, residual

    # The slider's scale is flexibility: it has no unit and suits every set of landmarks

    def _share_of(self, penalty: float) -> float:
        if self._factor is None or not self._penalty_acts:
            return 0.0
        return 1.0 - self._factor.flexibility(penalty)

    def _place_handle(self) -> None:
        self._show_present()
        if self._sliding:
            return
        self.slider.blockSignals(True)
        self.slider.setValue(round(self._share_of(self._session.settings.penalty) * STEPS))
        self.slider.blockSignals(False)

    def _penalty_at_handle(self) -> float:
        if self._factor is None:
            return self._session.settings.penalty
        return self._factor.penalty_at(1.0 - self.slider.value() / STEPS)

    # What the user does

    @property
    def suggestion(self) -> float | None:
        """The penalty that may be taken in one go, if the pairs suggest one."""
        regular = self._session.settings.convention is PenaltyConvention.REGULARISING
        if self._curve is None or self._waits_for or not regular:
            return None
        return self._curve.suggested

    @property
    def _waits_for(self) -> str:
        """What is to be settled before a penalty can be suggested: it would smooth that over."""
        if self._curve is None or self._quality is None or self._curve.suggested is None:
            return ""
        kinds = [finding.kind for finding in self._quality.findings]
        return next((words for kind, words in _WAITS_FOR.items() if kind in kinds), "")

    def take_suggested(self) -> None:
        """Ask for the suggested penalty."""
        if self.suggestion is not None:
            self.penalty_requested.emit(self.suggestion)

    def _on_pressed(self) -> None:
        self._sliding = True

    def _on_slid(self, _value: int) -> None:
        penalty = self._penalty_at_handle()
        if self._sliding:
            self.penalty_previewed.emit(penalty)
        else:
            self.penalty_requested.emit(penalty)

    def _on_released(self) -> None:
        self._sliding = False
        self.penalty_requested.emit(self._penalty_at_handle())


def _tool_button(action: QAction) -> QToolButton:
    button = QToolButton()
    button.setDefaultAction(action)
    # The keyboard stays with the bones.
    button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    return button
