"""The penalty in figures: its exact value, the unit, and the equation that it enters."""

from __future__ import annotations

import math

from qtpy.QtCore import Qt, Signal
from qtpy.QtWidgets import QComboBox, QHBoxLayout, QLabel, QLineEdit, QWidget

from pinwarp.core.basis import Basis
from pinwarp.core.lengths import Ruler
from pinwarp.core.spline import PenaltyConvention
from pinwarp.gui.style import theme
from pinwarp.session.edits import UNITS
from pinwarp.session.rulers import Rulers
from pinwarp.session.session import Session

# With the basis r² log r both conventions are one equation.
_EQUATIONS = {
    (PenaltyConvention.REGULARISING, Basis.R): "Regularising",
    (PenaltyConvention.OPYNSIM, Basis.R): "OPynSim (published)",
    (PenaltyConvention.REGULARISING, Basis.R2_LOG_R): "Basis r² log r",
}


class ExactPenalty(QWidget):
    """Shows value, unit and equation, and asks for others."""

    penalty_requested = Signal(float)
    unit_requested = Signal(str)
    equation_requested = Signal(object, object)
    refused = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._session = Session()
        self._rulers = Rulers()
        self.value = QLineEdit()
        self.value.setAccessibleName("Warping penalty")
        self.value.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.value.setFixedWidth(self.fontMetrics().horizontalAdvance("0.00000000") + 14)
        self.value.setToolTip("The exact penalty, such as 5 or 0.5 cm, or “affine”")
        # Only where lengths are shown in another unit than that of the files.
        self.shown_unit = QLabel()
        self.unit = QComboBox()
        self.unit.setAccessibleName("Unit of the files")
        # With the basis r² log r they are squared, and wider.
        self.unit.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        self.unit.setToolTip("The unit that the files are in: nothing is converted")
        self.equation = QComboBox()
        self.equation.setAccessibleName("Equation of the warp")
        # It may be narrower than its longest words.
        self.equation.setMinimumContentsLength(8)
        self.equation.setSizeAdjustPolicy(
            QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon
        )
        self.equation.addItems(list(_EQUATIONS.values()))
        self.equation.setToolTip(
            "Regularising is right for every new warp. The others reproduce results made "
            "elsewhere: with OPynSim, or with Bookstein's basis r² log r in place of r"
        )
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addWidget(self.value)
        row.addWidget(self.shown_unit)
        row.addWidget(self.unit)
        row.addSpacing(theme.SPACE)
        row.addWidget(self.equation, 1)
        self.value.editingFinished.connect(self._on_typed)
        self.unit.activated.connect(self._on_unit)
        self.equation.activated.connect(self._on_equation)

    @property
    def _ruler(self) -> Ruler:
        return self._session.settings.penalty_ruler(self._rulers.session)

    def show_rulers(self, rulers: Rulers) -> None:
        """Show the penalty in another unit."""
        self._rulers = rulers
        self._show_value()

    def _show_value(self) -> None:
        session = self._session
        if not self.value.hasFocus() or not self.value.isModified():
            self.value.setText(self._ruler.number(session.settings.penalty, 6))
            self.value.setModified(False)
        self.shown_unit.setText(f"{self._ruler.unit}  Files:")
        self.shown_unit.setVisible(self._rulers.session.unit != session.unit)

    def show_session(self, session: Session) -> None:
        """Show the penalty of a session; what is being typed stays."""
        self._session = session
        self._show_value()
        units = [*UNITS, *([session.unit] if session.unit not in UNITS else [])]
        texts = [session.settings.penalty_unit(unit) for unit in units]
        if [self.unit.itemText(i) for i in range(self.unit.count())] != texts:
            self.unit.clear()
            for text, unit in zip(texts, units, strict=True):
                self.unit.addItem(text, unit)
        self.unit.setCurrentIndex(units.index(session.unit))
        self.equation.setCurrentIndex([*_EQUATIONS].index(equation_of(session)))

    def _on_typed(self) -> None:
        if not self.value.isModified():
            return
        typed = self.value.text()
        text = typed.strip().lower()
        try:
            affine = text in ("affine", "inf", "∞")
            penalty = math.inf if affine else self._ruler.length(text)
            valid = penalty >= 0
        except ValueError:
            valid = False
        self.value.setModified(False)
        if valid:
            self.penalty_requested.emit(penalty)
            return
        self._show_value()
        self.refused.emit(f"“{typed}” is not a penalty: type a number of 0 or more, or “affine”.")

    def _on_unit(self, index: int) -> None:
        self.unit_requested.emit(self.unit.itemData(index))

    def _on_equation(self, index: int) -> None:
        self.equation_requested.emit(*list(_EQUATIONS)[index])


def equation_of(session: Session) -> tuple[PenaltyConvention, Basis]:
    """Return what tells the equation of one session from another's."""
    return session.settings.convention, session.settings.basis
