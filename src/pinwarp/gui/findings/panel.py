"""The list of what was noticed about the pairs, below the table: what to check, and remedies."""

from __future__ import annotations

from collections.abc import Sequence

from qtpy.QtCore import QEvent, Qt, Signal
from qtpy.QtGui import QPalette, QResizeEvent
from qtpy.QtWidgets import (
    QLabel,
    QScrollArea,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.findings import FindingKind
from pinwarp.gui.findings.row import FindingRow
from pinwarp.gui.style import theme
from pinwarp.session.judging.quality import NamedFinding

# So many rows are shown.
MOST_ROWS = 50


class FindingsPanel(QWidget):
    """The findings, the gravest first; hidden where there is nothing to say."""

    chosen = Signal(object)
    swap_requested = Signal(object)
    mirror_requested = Signal(str)
    reading_requested = Signal(object)
    scale_requested = Signal(object)
    replace_requested = Signal(str)
    disable_requested = Signal(object, list)

    def __init__(self) -> None:
        super().__init__()
        self._room = 0
        self._axis = ""
        self._found: tuple[NamedFinding, ...] = ()
        self._rows: list[FindingRow] = []
        self.header = QToolButton()
        self.header.setAutoRaise(True)
        self.header.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.header.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.header.setToolTip("Show or hide what was noticed about the pairs")
        self._content = QWidget()
        self._column = QVBoxLayout(self._content)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(0)
        self.more = QLabel()
        self.more.setContentsMargins(6, 4, 4, 4)
        self._column.addWidget(self.more)
        self.judged = QLabel(wordWrap=True)
        self.judged.setContentsMargins(6, 4, 4, 4)
        theme.make_quiet(self.judged)
        self._column.addWidget(self.judged)
        self.scroll = QScrollArea()
        self.scroll.setWidgetResizable(True)
        self.scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.scroll.setWidget(self._content)
        self.header.clicked.connect(lambda: self.set_open(self.scroll.isHidden()))
        self._content.setBackgroundRole(QPalette.ColorRole.Base)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.header)
        column.addWidget(self.scroll)
        self.set_open(True)
        self.hide()

    @property
    def rows(self) -> list[FindingRow]:
        """The rows that are filled, from the top."""
        return self._rows[: min(len(self._found), MOST_ROWS)]

    def show_findings(
        self, found: Sequence[NamedFinding], mirror_axis: str = "", judged: str = ""
    ) -> None:
        """Show these findings.

        Parameters
        ----------
        found
            The gravest first; beyond the first 50 only their number is told.
        mirror_axis
            Across which axis the source can be mirrored, if it is asked for.
        judged
            At which penalty the pairs were judged, where that has to be said.
        """
        if (tuple(found), mirror_axis, judged) == (self._found, self._axis, self.judged.text()):
            return
        self.judged.setText(judged)
        self.judged.setVisible(bool(judged))
        self._found, self._axis = tuple(found), mirror_axis
        shown = self._found[:MOST_ROWS]
        while len(self._rows) < len(shown):
            self._add_row()
        for row, one in zip(self._rows, shown, strict=False):
            row.show_finding(one, mirror_axis)
        for i, row in enumerate(self._rows):
            row.setVisible(i < len(shown))
        left_out = len(found) - len(shown)
        self.more.setText(f"and {left_out:,} more, which are less grave")
        self.more.setVisible(left_out > 0)
        self.header.setText(heading(found))
        font = self.font()
        font.setBold(any(one.finding.is_grave for one in found))
        self.header.setFont(font)
        self.setVisible(bool(found))
        self._fit()

    def _add_row(self) -> None:
        row = FindingRow()
        self._rows.append(row)
        self._column.insertWidget(len(self._rows) - 1, row)
        row.chosen.connect(lambda: self.chosen.emit(row.found))
        row.swap_requested.connect(lambda: self.swap_requested.emit(row.found))
        row.mirror_requested.connect(lambda: self.mirror_requested.emit(self._axis))
        row.reading_requested.connect(lambda: self.reading_requested.emit(row.found))
        row.scale_requested.connect(self.scale_requested)
        row.replace_requested.connect(self.replace_requested)
        row.disable_requested.connect(lambda names: self.disable_requested.emit(row.found, names))

    def show_selection(self, names: Sequence[str]) -> None:
        """Mark the finding whose landmarks are selected."""
        for row in self.rows:
            concerned = row.found.names if row.found is not None else ()
            row.set_current(bool(concerned) and set(concerned) == set(names))

    def focus_row(self, number: int) -> None:
        """Let the keys go to a finding, if it is one of those that are shown."""
        if number >= len(self.rows):
            return
        self.set_open(True)
        self._rows[number].setFocus()
        self.scroll.ensureWidgetVisible(self._rows[number], 0, 0)

    def set_room(self, height: int) -> None:
        """Take no more than this height; what does not fit is scrolled."""
        self._room = height
        self._fit()

    def _fit(self) -> None:
        # Not the viewport's width, which follows only later.
        frame = 2 * self.scroll.frameWidth()
        needed = self._content.heightForWidth(self.width() - frame) + frame
        left = max(self._room - self.header.sizeHint().height(), 0)
        self.scroll.setFixedHeight(min(needed, left))

    def set_open(self, shown: bool) -> None:
        """Show the findings, or only how many there are."""
        arrow = Qt.ArrowType.DownArrow if shown else Qt.ArrowType.RightArrow
        self.header.setArrowType(arrow)
        self.scroll.setVisible(shown)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Wrap the sentences anew."""
        super().resizeEvent(event)
        self._fit()

    def changeEvent(self, event: QEvent) -> None:
        """Keep up with another font."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self._fit()


def heading(found: Sequence[NamedFinding]) -> str:
    """Return how many findings there are, in words.

    Examples
    --------
    >>> from pinwarp.core.findings import Finding
    >>> kinds = (FindingKind.DISPLACED, FindingKind.ISOLATED, FindingKind.ISOLATED)
    >>> heading([NamedFinding(Finding(kind, (0,), 1.0), ("a",), "") for kind in kinds])
    '1 to check, 2 isolated'
    """
    grave = sum(one.finding.is_grave for one in found)
    worth = sum(one.finding.kind is FindingKind.WORTH_A_LOOK for one in found)
    isolated = sum(one.finding.kind is FindingKind.ISOLATED for one in found)
    known = len(found) - grave - worth - isolated
    counts = (
        (grave, "to check"),
        (worth, "worth a look"),
        (known, "worth knowing"),
        (isolated, "isolated"),
    )
    return ", ".join(f"{count} {words}" for count, words in counts if count)
