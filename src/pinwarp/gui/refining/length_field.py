"""A length to type, or to leave to what is usual."""

from __future__ import annotations

import math

from qtpy.QtCore import Qt, Signal
from qtpy.QtWidgets import QCheckBox, QHBoxLayout, QLabel, QLineEdit, QWidget

from pinwarp.core.lengths import Ruler

_SAME = 1e-9


class LengthField(QWidget):
    """Shows a length, the usual one where none was chosen.

    ``changed`` is emitted when the user chose another, ``refused`` why what was typed is none.

    Parameters
    ----------
    name
        What it is, for those who do not see it.
    usual
        What the box says that takes the usual length.
    tips
        Of the length and of that box.
    may_be_zero
        Whether 0 is a length here.
    """

    changed = Signal()
    refused = Signal(str)

    def __init__(self, name: str, usual: str, tips: tuple[str, str], may_be_zero: bool) -> None:
        super().__init__()
        self._name, self._may_be_zero = name, may_be_zero
        self._value: float | None = None
        self._usual = math.nan
        self._ruler = Ruler()
        self.line = QLineEdit()
        self.line.setAccessibleName(name)
        self.line.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.line.setFixedWidth(self.fontMetrics().horizontalAdvance("0.00000000") + 14)
        self.line.setToolTip(tips[0])
        self.unit = QLabel()
        self.box = QCheckBox(usual)
        self.box.setChecked(True)
        self.box.setToolTip(tips[1])
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addWidget(self.line)
        row.addWidget(self.unit)
        row.addStretch()
        row.addWidget(self.box)
        self.line.editingFinished.connect(self._on_typed)
        self.box.clicked.connect(self._on_box)

    @property
    def value(self) -> float | None:
        """What was chosen; None for the usual."""
        return self._value

    @property
    def length(self) -> float:
        """What is shown."""
        return self._usual if self._value is None else self._value

    def show_usual(self, usual: float, ruler: Ruler) -> None:
        """Show what is usual; NaN where nothing is."""
        self._usual, self._ruler = usual, ruler
        self.unit.setText(ruler.unit)
        self._show()

    def show_value(self, value: float | None) -> None:
        """Show what was chosen; the usual length is no choice."""
        same = value is not None and math.isclose(value, self._usual, rel_tol=_SAME)
        self._value = None if same else value
        self._show()

    def _show(self) -> None:
        self.box.setChecked(self._value is None)
        if not (self.line.hasFocus() and self.line.isModified()):
            self.line.setText("" if math.isnan(self.length) else self._ruler.number(self.length))
            self.line.setModified(False)

    def _on_box(self, usual: bool) -> None:
        self._value = None if usual or math.isnan(self._usual) else self._usual
        self._show()
        self.changed.emit()

    def _on_typed(self) -> None:
        if not self.line.isModified():
            return
        self.line.setModified(False)
        text = self.line.text().strip()
        try:
            value = self._ruler.length(text)
        except ValueError:
            value = math.nan
        if math.isfinite(value) and (value > 0 or (value == 0 and self._may_be_zero)):
            self._value = value
            self._show()
            self.changed.emit()
            return
        least = "a length of 0 or more" if self._may_be_zero else "a length above 0"
        self._show()
        self.refused.emit(f"“{text}” is no {self._name.lower()}: type {least}.")
