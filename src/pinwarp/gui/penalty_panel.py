"""The warping penalty: a slider from interpolation to the affine fit, its value, its effect."""

from __future__ import annotations

import math

from qtpy.QtCore import QRectF, Qt, Signal
from qtpy.QtGui import QColor, QPainter, QPaintEvent, QPen
from qtpy.QtWidgets import (
    QComboBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QSizePolicy,
    QSlider,
    QStyle,
    QStyleOptionSlider,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.factor import SourceFactor
from pinwarp.core.findings import FindingKind
from pinwarp.core.spline import PenaltyConvention
from pinwarp.gui import theme
from pinwarp.session.edits import UNITS
from pinwarp.session.results import WarpResult
from pinwarp.session.session import Session

STEPS = 1000

_CONVENTIONS = {
    PenaltyConvention.REGULARISING: "Regularising",
    PenaltyConvention.OPYNSIM: "OPynSim (published)",
}


def format_length(value: float, unit: str) -> str:
    """Return a length with a sensible number of digits and its unit.

    Examples
    --------
    >>> format_length(2.40047, "mm"), format_length(float("inf"), "mm")
    ('2.4 mm', 'affine')
    """
    if math.isinf(value):
        return "affine"
    return f"{value:.4g} {unit}"


class PenaltySlider(QSlider):
    """A slider that can show where the poles of the OPYNSIM convention lie."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self.setRange(0, STEPS)
        self.setPageStep(STEPS // 20)
        self._poles: tuple[float, ...] = ()

    @property
    def poles(self) -> tuple[float, ...]:
        """Where the poles are, as shares of the slider's length."""
        return self._poles

    def set_poles(self, shares: tuple[float, ...]) -> None:
        """Mark poles at these shares of the slider's length."""
        if shares != self._poles:
            self._poles = shares
            self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the slider, and a tick above the groove for each pole."""
        super().paintEvent(event)
        if not self._poles:
            return
        option = QStyleOptionSlider()
        self.initStyleOption(option)
        handle = self.style().subControlRect(
            QStyle.ComplexControl.CC_Slider, option, QStyle.SubControl.SC_SliderHandle, self
        )
        span = self.width() - handle.width()
        painter = QPainter(self)
        painter.setPen(QPen(QColor(theme.WARNING_COLOUR), 1.5))
        for share in self._poles:
            x = handle.width() / 2 + share * span
            painter.drawLine(QRectF(x, 0, 0, 7).topLeft(), QRectF(x, 0, 0, 7).bottomLeft())
        painter.end()


class PenaltyPanel(QWidget):
    """Shows the session's penalty and asks for another."""

    penalty_previewed = Signal(float)
    penalty_requested = Signal(float)
    convention_requested = Signal(object)
    planar_requested = Signal(bool)
    unit_requested = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._factor: SourceFactor | None = None
        self._result: WarpResult | None = None
        self._session = Session()
        self._sliding = False

        self.slider = PenaltySlider()
        self.slider.setAccessibleName("Warping penalty")
        self.slider.setMinimumWidth(240)
        self.slider.setToolTip(
            "How much the warp is smoothed: left meets every landmark, right is the affine fit"
        )
        self.value = QLineEdit()
        self.value.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.value.setFixedWidth(self.fontMetrics().horizontalAdvance("0.00000000"))
        self.value.setToolTip("The exact penalty, a length in mesh units, or “affine”")
        self.unit = QComboBox()
        self.unit.setToolTip("The unit of the meshes: shown beside numbers, nothing is converted")
        self.flexibility = self._figure("Flexibility", "Share of the non-affine freedom left")
        self.residual = self._figure("RMS residual", "How far the warped landmarks miss theirs")
        self.pairs = self._figure("Pairs", "Landmarks placed on both meshes that take part")
        self.convention = QComboBox()
        for convention, text in _CONVENTIONS.items():
            self.convention.addItem(text, convention)
        self.convention.setToolTip(
            "Regularising is right for every new warp; OPynSim reproduces results made elsewhere"
        )
        self.warning = QLabel()
        self.warning.setWordWrap(True)
        self.warning.setStyleSheet(f"color: {theme.WARNING_COLOUR};")
        self.warning.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.planar = QPushButton("Treat as planar")
        self.planar.setCheckable(True)
        self.planar.setToolTip("Keep the warp tame across the plane that the landmarks lie in")
        self._lay_out()

        self.slider.sliderPressed.connect(self._on_pressed)
        self.slider.valueChanged.connect(self._on_slid)
        self.slider.sliderReleased.connect(self._on_released)
        self.value.editingFinished.connect(self._on_typed)
        self.unit.textActivated.connect(self.unit_requested)
        self.convention.activated.connect(self._on_convention)
        self.planar.clicked.connect(self.planar_requested)
        self.show_session(self._session)
        self.show_result(None)

    def _figure(self, title: str, tip: str) -> QLabel:
        label = QLabel()
        label.setTextFormat(Qt.TextFormat.RichText)
        label.setToolTip(tip)
        label.setProperty("title", title)
        label.setMinimumWidth(self.fontMetrics().horizontalAdvance(f"{title}  "))
        return label

    def _lay_out(self) -> None:
        ends = QHBoxLayout()
        for text in ("Interpolates", "Affine"):
            label = QLabel(text)
            label.setEnabled(False)
            ends.addWidget(label)
            if text == "Interpolates":
                ends.addStretch()
        slider_and_ends = QVBoxLayout()
        slider_and_ends.setSpacing(0)
        slider_and_ends.addWidget(self.slider)
        slider_and_ends.addLayout(ends)

        row = QHBoxLayout()
        row.setSpacing(2 * theme.SPACE)
        row.addLayout(slider_and_ends, 1)
        exact = QHBoxLayout()
        exact.setSpacing(4)
        exact.addWidget(self.value)
        exact.addWidget(self.unit)
        row.addLayout(exact)
        for figure in (self.flexibility, self.residual, self.pairs):
            row.addWidget(figure)
        row.addWidget(self.convention)

        below = QHBoxLayout()
        below.addWidget(self.warning, 1)
        below.addWidget(self.planar)
        grid = QGridLayout(self)
        grid.setContentsMargins(12, 6, 12, 8)
        grid.setVerticalSpacing(4)
        grid.addLayout(row, 0, 0)
        grid.addLayout(below, 1, 0)

    # What is shown

    def show_session(self, session: Session) -> None:
        """Show the penalty of a session."""
        unit_changed = session.unit != self._session.unit
        self._session = session
        if unit_changed:
            self.show_result(self._result)
        if not self.value.hasFocus() or not self.value.isModified():
            penalty = session.warping_penalty
            self.value.setText("affine" if math.isinf(penalty) else f"{penalty:.6g}")
            self.value.setModified(False)
        self._show_unit(session.unit)
        self.convention.setCurrentIndex(self.convention.findData(session.convention))
        self._place_handle()

    def _show_unit(self, unit: str) -> None:
        units = [*UNITS, *([unit] if unit not in UNITS else [])]
        if [self.unit.itemText(i) for i in range(self.unit.count())] != units:
            self.unit.clear()
            self.unit.addItems(units)
        self.unit.setCurrentText(unit)

    def show_result(self, result: WarpResult | None) -> None:
        """Show what the penalty does."""
        if result is not None and result.factor is not None and not result.factor.has_modes:
            # While a source landmark moves, the penalty's scale is not known: it will be at rest.
            self._show_residual(result)
            return
        self._result = result
        self._factor = result.factor if result is not None else None
        has_modes = self._factor is not None and len(self._factor.poles) > 0
        self.slider.setEnabled(has_modes)
        self.value.setEnabled(has_modes)
        flexibility = result.flexibility if result is not None else None
        self._set_figure(self.flexibility, "–" if flexibility is None else f"{flexibility:.0%}")
        self._show_residual(result)
        self._show_warnings(result, has_modes)
        self._place_handle()

    def _show_residual(self, result: WarpResult | None) -> None:
        rms = result.rms_residual if result is not None else None
        count = len(result.inputs.source) if result is not None else 0
        text = "–" if rms is None else format_length(_tidy(rms, result), self._session.unit)
        self._set_figure(self.residual, text)
        self._set_figure(self.pairs, str(count))

    def _set_figure(self, label: QLabel, text: str) -> None:
        title = label.property("title")
        label.setText(f"<small>{title}</small><br><b>{text}</b>")

    def _show_warnings(self, result: WarpResult | None, has_modes: bool) -> None:
        notes: list[str] = []
        nearly_planar = False
        if result is not None and result.problem:
            notes.append(result.problem)
        elif result is not None and result.spline is not None:
            names = [pair.name for pair in self._session.pairs]
            for finding in result.spline.findings:
                nearly_planar |= finding.kind is FindingKind.NEARLY_PLANAR
                if all(row < len(names) for row in finding.rows):
                    notes.append(finding.describe(names, self._session.unit))
            if not has_modes:
                notes.append("The penalty acts from five pairs on.")
        opynsim = self._session.convention is PenaltyConvention.OPYNSIM
        if opynsim and has_modes and not notes:
            notes.append(
                "OPynSim's published equation has poles (the ticks): the warp overshoots before "
                "each and flips behind it."
            )
        self.warning.setText("  ".join(notes))
        self.planar.setVisible(nearly_planar or self._session.planar)
        self.planar.setChecked(self._session.planar)
        self.slider.set_poles(
            tuple(self._share_of(float(pole)) for pole in self._factor.poles)
            if opynsim and self._factor is not None and has_modes
            else ()
        )

    # The slider's scale is flexibility: it has no unit and suits every set of landmarks

    def _share_of(self, penalty: float) -> float:
        if self._factor is None or not len(self._factor.poles):
            return 0.0
        return 1.0 - self._factor.flexibility(penalty)

    def _place_handle(self) -> None:
        if self._sliding:
            return
        self.slider.blockSignals(True)
        self.slider.setValue(round(self._share_of(self._session.warping_penalty) * STEPS))
        self.slider.blockSignals(False)

    def _penalty_at_handle(self) -> float:
        if self._factor is None:
            return self._session.warping_penalty
        return self._factor.penalty_at(1.0 - self.slider.value() / STEPS)

    # What the user does

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

    def _on_typed(self) -> None:
        if not self.value.isModified():
            return
        text = self.value.text().strip().lower().removesuffix(self._session.unit).strip()
        try:
            penalty = math.inf if text in ("affine", "inf", "∞") else float(text.replace(",", "."))
            valid = penalty >= 0
        except ValueError:
            valid = False
        self.value.setModified(False)
        if not valid:
            self.warning.setText(
                f"“{self.value.text()}” is not a penalty: type a number of 0 or more, or “affine”."
            )
            self.value.setText(f"{self._session.warping_penalty:.6g}")
            return
        self.penalty_requested.emit(penalty)

    def _on_convention(self, index: int) -> None:
        # Qt turns the enumeration into a plain string.
        self.convention_requested.emit(PenaltyConvention(self.convention.itemData(index)))


def _tidy(residual: float, result: WarpResult | None) -> float:
    """Return 0 for a residual that is only rounding."""
    if result is None or not result.inputs.destination:
        return residual
    size = max(abs(x) for position in result.inputs.destination for x in position)
    return 0.0 if residual < 1e-9 * size else residual
