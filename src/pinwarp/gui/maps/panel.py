"""The panel of the maps: which one is shown, its figures, and its range."""

from __future__ import annotations

import math

from qtpy.QtCore import Qt, Signal
from qtpy.QtGui import QAction
from qtpy.QtWidgets import (
    QButtonGroup,
    QCheckBox,
    QComboBox,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QRadioButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.lengths import Ruler
from pinwarp.core.maps import MapKind, Range, SurfaceMap, must_be_relative
from pinwarp.gui.maps.histogram import HistogramView
from pinwarp.gui.maps.words import TITLES, figure, meaning_of, note_of
from pinwarp.gui.maps.work import MapWork
from pinwarp.gui.style import theme
from pinwarp.gui.style.colour_scale import ColourScale
from pinwarp.session.judging.survey import Survey
from pinwarp.session.view import ViewState

_ROWS = (
    ("Mean", "mean"),
    ("RMS", "rms"),
    ("95 % are below", "percentile_95"),
    ("Maximum", "maximum"),
)


class MapPanel(QWidget):
    """Shows the map of the warp in figures, and asks for another one or another range.

    Parameters
    ----------
    suggest
        The action that places the next landmark where it helps most.
    next_key, accept_key
        Which keys show the next map, and accept a ghost.
    """

    map_requested = Signal(object)
    range_requested = Signal(object)
    relative_requested = Signal(bool)

    def __init__(self, suggest: QAction, next_key: str, accept_key: str) -> None:
        super().__init__()
        self._accept_key = accept_key
        self._shown_range: Range = (0.0, 1.0)
        self._ruler = Ruler()
        self.choice = QComboBox()
        self.choice.setAccessibleName("Map")
        for kind in (None, *MapKind):
            self.choice.addItem("No map" if kind is None else TITLES[kind], kind)
        self.choice.setToolTip(f"What the warped source is coloured by ({next_key} shows the next)")
        self.meaning = _words()
        self.work = MapWork()
        self.note = _words()
        self.histogram = HistogramView()
        self.series = _words()
        self.figures = QLabel()
        self.figures.setTextFormat(Qt.TextFormat.RichText)
        self.figures.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.automatic = QRadioButton("Follows the map")
        self.fixed = QRadioButton("Fixed")
        self.fixed.setToolTip("Keep the colours' range, to compare warps and sessions by colour")
        self._radios = QButtonGroup(self)
        self.low, self.high = _number("Lowest value"), _number("Highest value")
        self.unit = QLabel()
        self.relative = QCheckBox("Take out the overall difference in size")
        self.place_next = QPushButton("Place Next Landmark Here")
        self.place_next.setToolTip(suggest.toolTip())
        self.advice = _words()
        self._lay_out()
        self.choice.activated.connect(self._on_chosen)
        self._radios.buttonClicked.connect(self._on_radio)
        for line in (self.low, self.high):
            line.editingFinished.connect(self._on_typed)
        self.relative.clicked.connect(self.relative_requested)
        self.place_next.clicked.connect(suggest.trigger)

    def _lay_out(self) -> None:
        for radio in (self.automatic, self.fixed):
            self._radios.addButton(radio)
        self.range_row = QFrame()
        ranges = QGridLayout(self.range_row)
        ranges.setContentsMargins(0, 0, 0, 0)
        ranges.addWidget(QLabel("Colour range"), 0, 0)
        ranges.addWidget(self.automatic, 0, 1)
        fixed = QHBoxLayout()
        fixed.setSpacing(4)
        for widget in (self.fixed, self.low, QLabel("to"), self.high, self.unit):
            fixed.addWidget(widget)
        fixed.addStretch()
        ranges.addLayout(fixed, 1, 1)
        ranges.setColumnStretch(1, 1)
        inner = QWidget()
        column = QVBoxLayout(inner)
        column.setContentsMargins(12, 10, 12, 10)
        column.setSpacing(theme.SPACE)
        for widget in (
            self.choice,
            self.work,
            self.meaning,
            self.note,
            self.histogram,
            self.series,
            self.figures,
            self.relative,
            self.range_row,
            self.advice,
            self.place_next,
        ):
            column.addWidget(widget)
        column.addStretch()
        scroll = QScrollArea()
        scroll.setAccessibleName("Figures of the map")
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setWidget(inner)
        outer = QVBoxLayout(self)
        outer.setContentsMargins(0, 0, 0, 0)
        outer.addWidget(scroll)

    # What is shown

    def show_survey(
        self,
        survey: Survey | None,
        view: ViewState,
        ruler: Ruler,
        scale: ColourScale | None,
        taken: str | None = None,
    ) -> None:
        """Show a map's figures.

        Parameters
        ----------
        survey
            What was found last.
        view
            Which map is asked for, and its fixed range.
        ruler
            How lengths on the destination are shown.
        scale
            The colours that the map is drawn in; None where there is no map.
        taken
            The landmark that stands already where the next one helps most.
        """
        self.choice.setCurrentIndex(list(MapKind).index(view.map) + 1 if view.map else 0)
        fitted = survey is not None and survey.is_fitted
        self.meaning.setText(meaning_of(view.map, fitted=fitted))
        found = survey.map if survey is not None and survey.kind is view.map else None
        missing = survey.missing if survey is not None and survey.kind is view.map else ""
        self.note.setText(missing)
        self.note.setVisible(bool(missing))
        for widget in (self.histogram, self.figures, self.range_row):
            widget.setVisible(found is not None)
        self.relative.setVisible(found is not None and found.kind.is_ratio)
        self.series.setVisible(found is not None and found.comparison is not None)
        suggestion = found.suggestion if found is not None else None
        for part in (self.advice, self.place_next):
            part.setVisible(suggestion is not None)
        if survey is None or found is None or scale is None:
            return
        self.relative.setChecked(found.overall != 1)
        self.relative.setEnabled(not must_be_relative(survey.size))
        self.relative.setToolTip(
            f"As a whole, lengths grow × {survey.size:.3g} (affine fit of the pairs)"
        )
        self.histogram.show_map(found, scale)
        self.figures.setText(_table(found, ruler))
        self.series.setText(
            f"Bars{' (fitted)' if fitted else ''}: source → destination, in the map's colours<br>"
            f'<span style="color:{theme.WARNING_COLOUR}">━</span> destination → source'
        )
        if suggestion is not None:
            known = f"the warp is known to ± {figure(suggestion.deviation, ruler)} there."
            self.advice.setText(
                f"The next landmark helps most where the star stands on the source: {known}"
                if taken is None
                else f"{taken} stands where it helps most: {known} Place it on the destination "
                f"too: {self._accept_key} accepts its ghost."
            )
            self.place_next.setEnabled(taken is None)
        self._show_range(found, view, ruler, scale)

    def _show_range(
        self, found: SurfaceMap, view: ViewState, ruler: Ruler, scale: ColourScale
    ) -> None:
        is_fixed = view.map_range is not None
        (self.fixed if is_fixed else self.automatic).setChecked(True)
        self._shown_range = scale.range
        self._ruler = Ruler() if found.kind.is_ratio else ruler
        for line, value in zip((self.low, self.high), scale.range, strict=True):
            line.setEnabled(is_fixed)
            if not (line.hasFocus() and line.isModified()):
                line.setText(self._ruler.number(value))
                line.setModified(False)
        self.unit.setText(self._ruler.unit)

    # What the user does

    def _on_chosen(self, index: int) -> None:
        # Qt turns the enumeration into a plain string.
        kind = self.choice.itemData(index)
        self.map_requested.emit(None if kind is None else MapKind(kind))

    def _on_radio(self) -> None:
        self.range_requested.emit(self._shown_range if self.fixed.isChecked() else None)

    def _on_typed(self) -> None:
        if not (self.low.isModified() or self.high.isModified()):
            return
        wanted = _range_of(self.low.text(), self.high.text(), self._ruler)
        kind = self.choice.currentData()
        is_ratio = kind is not None and MapKind(kind).is_ratio
        for line in (self.low, self.high):
            line.setModified(False)
        if wanted is None or (is_ratio and wanted[0] <= 0):
            self.note.setText(
                "The range needs two numbers, the lower one first"
                + (" and above 0." if is_ratio else ".")
            )
            self.note.show()
            for line, value in zip((self.low, self.high), self._shown_range, strict=True):
                line.setText(self._ruler.number(value))
            return
        self.note.hide()
        self.range_requested.emit(wanted)


def _words() -> QLabel:
    label = QLabel()
    label.setWordWrap(True)
    return label


def _number(name: str) -> QLineEdit:
    line = QLineEdit()
    line.setAccessibleName(name)
    line.setAlignment(Qt.AlignmentFlag.AlignRight)
    line.setFixedWidth(line.fontMetrics().horizontalAdvance("0.000000") + 8)
    return line


def _range_of(low: str, high: str, ruler: Ruler) -> Range | None:
    try:
        wanted = (ruler.length(low), ruler.length(high))
    except ValueError:
        return None
    return wanted if all(map(math.isfinite, wanted)) and wanted[0] < wanted[1] else None


def _table(found: SurfaceMap, ruler: Ruler) -> str:
    """Return the figures as a small table."""
    compared = found.comparison
    if compared is None:
        ruler = Ruler() if found.kind.is_ratio else ruler
        rows: list[tuple[str, ...]] = [
            ("Lowest", figure(found.lowest, ruler)),
            ("Median", figure(found.median, ruler)),
            ("Highest", figure(found.highest, ruler)),
        ]
        note = note_of(found, ruler.unit) if found.kind.is_ratio else ""
        return _rows_as_html(("", ""), rows) + (f"<p>{note.capitalize()}.</p>" if note else "")
    both = (compared.forward_figures, compared.backward_figures)
    rows = [(name, *(figure(getattr(way, key), ruler) for way in both)) for name, key in _ROWS]
    rows.append(("Hausdorff distance", figure(compared.hausdorff, ruler), ""))
    return _rows_as_html(("", "Source →<br>destination", "Destination →<br>source"), rows)


def _rows_as_html(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    def cells(row: tuple[str, ...], tag: str) -> str:
        first, *others = row
        right = "".join(
            f'<{tag} align="right" style="padding-left:18px">{text}</{tag}>' for text in others
        )
        return f'<tr><td style="padding-bottom:3px">{first}</td>{right}</tr>'

    begin = cells(head, "td") if any(head) else ""
    return f"<table>{begin}{''.join(cells(row, 'td') for row in rows)}</table>"
