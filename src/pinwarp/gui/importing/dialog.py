"""What a landmark file holds and what an import would do, before anything is changed."""

from __future__ import annotations

from collections.abc import Sequence

from qtpy.QtCore import QSize, Qt
from qtpy.QtGui import QIcon
from qtpy.QtWidgets import (
    QButtonGroup,
    QDialog,
    QDialogButtonBox,
    QFrame,
    QGridLayout,
    QHeaderView,
    QLabel,
    QRadioButton,
    QTableView,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.landmarks import Side
from pinwarp.core.words import counted, listed
from pinwarp.gui.importing.arrival_model import ArrivalModel
from pinwarp.gui.style import theme
from pinwarp.gui.style.choice import lead_tab_to_checked
from pinwarp.io.landmark_files import LandmarkReading
from pinwarp.session.importing.asking import doubts_of
from pinwarp.session.importing.fit import Fit, distance_from_mesh
from pinwarp.session.importing.landmarks import (
    Arriving,
    ImportChoice,
    Pairing,
    arrivals,
    awaiting,
    can_pair,
    default_pairing,
    group_words,
)
from pinwarp.session.importing.words import left_waiting, summary
from pinwarp.session.mesh_units import unit_on
from pinwarp.session.rulers import Rulers
from pinwarp.session.session import Session

_SIZE = QSize(720, 600)
_MOST_SKIPPED_ROWS = 4
_LEAST_ROWS = 6


class ImportDialog(QDialog):
    """Shows what was understood of a file, and asks how to bring it in.

    ``choice`` is what is chosen as it stands.

    Parameters
    ----------
    session
        The session as it is.
    arriving
        The file that was read.
    rulers
        How distances are told; the file's own numbers keep their unit.
    parent
        The window.
    """

    def __init__(
        self, session: Session, arriving: Arriving, rulers: Rulers, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._session = session
        self._rulers = rulers
        self._arriving = arriving
        what = "pairs" if arriving.side is None else f"{arriving.side.value} landmarks"
        self.setWindowTitle(f"Import {what}")
        self.choice = ImportChoice(default_pairing(session, arriving))
        self.pairings = {pairing: QRadioButton() for pairing in Pairing}
        self.fits: dict[Side, list[QRadioButton]] = {}
        self._groups: list[QButtonGroup] = []
        self.model = ArrivalModel(arriving.sides, self._units(), self)
        self.table = QTableView()
        self.outcome = QLabel()
        self.skipped = QTreeWidget()
        kinds = QDialogButtonBox.StandardButton
        self.buttons = QDialogButtonBox(kinds.Ok | kinds.Cancel)
        self._set_up()
        self._lay_out()
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        # Once it stands in the dialog, which would not know before what Return is for.
        import_it = self.buttons.button(kinds.Ok)
        import_it.setDefault(True)
        import_it.setFocus()
        self._show()
        layout = self.layout()
        if not arriving.landmarks and layout is not None:
            # Of a file of nothing but curves the lines say all.
            self.resize(_SIZE.width(), layout.totalHeightForWidth(_SIZE.width()))

    # What is there

    def _set_up(self) -> None:
        group = QButtonGroup(self)
        self._groups.append(group)
        for pairing, button in self.pairings.items():
            button.setText(_pairing_words(self._session, self._arriving, pairing))
            button.setEnabled(can_pair(self._session, self._arriving, pairing))
            button.setChecked(pairing is self.choice.pairing)
            group.addButton(button)
        lead_tab_to_checked(group)
        group.buttonToggled.connect(lambda _button, on: self._show() if on else None)
        self.table.setModel(self.model)
        self.table.setSelectionMode(QTableView.SelectionMode.NoSelection)
        self.table.setAlternatingRowColors(True)
        self.table.setShowGrid(False)
        self.table.setWordWrap(False)
        # Nothing is chosen in it: Tab leads on to the buttons.
        self.table.setTabKeyNavigation(False)
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 7)
        rows = self.table.verticalHeader().defaultSectionSize()
        # Also under several questions there is something to see.
        self.table.setMinimumHeight(_LEAST_ROWS * rows)
        self.table.setAccessibleName("Landmarks of the file")
        header = self.table.horizontalHeader()
        header.setHighlightSections(False)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        # Thousands of rows are not all measured.
        header.setResizeContentsPrecision(50)
        header.setSectionResizeMode(self.model.columnCount() - 1, QHeaderView.ResizeMode.Stretch)
        for button in self.buttons.buttons():
            button.setIcon(QIcon())
        button = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        button.setText("Import")

    def _lay_out(self) -> None:
        reading = self._arriving.reading
        column = QVBoxLayout(self)
        column.setContentsMargins(16, 14, 16, 12)
        column.setSpacing(10)
        head = QVBoxLayout()
        head.setSpacing(2)
        head.addWidget(_label(_headline(self._arriving), bold=True))
        head.addWidget(_label(_understood(reading), quiet=True))
        for note in reading.notes:
            head.addWidget(_label(note))
        column.addLayout(head)
        if doubts := doubts_of(self._session, self._arriving):
            column.addWidget(self._doubt(doubts))
        for side in self._arriving.doubtful:
            column.addWidget(self._question(side))
        if self._arriving.landmarks:
            ways = QVBoxLayout()
            ways.setSpacing(4)
            ways.addWidget(_label("Bring them in", bold=True))
            for button in self.pairings.values():
                ways.addWidget(button)
            column.addLayout(ways)
            column.addWidget(self.table, 1)
        self.outcome.setWordWrap(True)
        self.outcome.setTextFormat(Qt.TextFormat.PlainText)
        column.addWidget(self.outcome)
        if reading.skipped:
            self._fill_skipped()
            count = len(reading.skipped)
            lines = f"{count:,} line{' was' if count == 1 else 's were'} skipped"
            column.addWidget(_label(lines, bold=True))
            column.addWidget(self.skipped)
        column.addWidget(self.buttons)
        self.resize(_SIZE)

    def _doubt(self, doubts: Sequence[str]) -> QWidget:
        """Return the question whether these are landmarks at all, and why one may ask."""
        frame, column = _marked()
        column.addWidget(_label("Are these landmarks?", bold=True))
        for doubt in doubts:
            column.addWidget(_label(doubt))
        return frame

    def _question(self, side: Side) -> QWidget:
        """Return the ways to read the positions of a side, with how well each fits."""
        fits = self._arriving.fits[side]
        frame, column = _marked()
        ruler, mesh = self._rulers.on(side), self._session.mesh(side)
        size = mesh.diagonal if mesh is not None else 0.0
        far = distance_from_mesh(fits[0].distance, size, ruler, f"the {side.value} mesh")
        column.addWidget(
            _label(
                f"As stored they lie {far} in the median. How are they meant?",
                bold=True,
            )
        )
        grid = QGridLayout()
        grid.setHorizontalSpacing(24)
        grid.setVerticalSpacing(4)
        grid.setColumnStretch(2, 1)
        group = QButtonGroup(self)
        self._groups.append(group)
        self.fits[side] = []
        for row, fit in enumerate(fits):
            button = QRadioButton(fit.describe(self._arriving.reading.frame))
            # What fits best; the question above tells that it is not as stored.
            button.setChecked(row == 1)
            group.addButton(button)
            self.fits[side].append(button)
            grid.addWidget(button, row, 0)
            far = distance_from_mesh(fit.distance, size, ruler)
            grid.addWidget(_label(far, quiet=True), row, 1)
        lead_tab_to_checked(group)
        group.buttonToggled.connect(lambda _button, on: self._show() if on else None)
        column.addLayout(grid)
        return frame

    def _fill_skipped(self) -> None:
        tree, skipped = self.skipped, self._arriving.reading.skipped
        tree.setRootIsDecorated(False)
        tree.setAlternatingRowColors(True)
        tree.setUniformRowHeights(True)
        tree.setSelectionMode(QTreeWidget.SelectionMode.NoSelection)
        tree.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        tree.setHeaderLabels(["Line", "Reason", "What it says"])
        items = [QTreeWidgetItem([str(line.line), line.reason, line.text]) for line in skipped]
        items[0].setSizeHint(0, QSize(0, self.fontMetrics().height() + 7))
        tree.addTopLevelItems(items)
        tree.header().setStretchLastSection(True)
        for number in (0, 1):
            tree.resizeColumnToContents(number)
        rows = min(len(skipped), _MOST_SKIPPED_ROWS)
        height = tree.header().sizeHint().height() + rows * tree.sizeHintForRow(0)
        tree.setFixedHeight(height + 2 * tree.frameWidth() + 2)

    def _units(self) -> dict[Side, str]:
        """Return the unit of the numbers of each side."""
        said = self._arriving.reading.unit
        return {
            side: unit_on(self._session, side)
            if self._session.mesh(side) is not None
            else said or self._session.unit
            for side in self._arriving.sides
        }

    # What is chosen

    def _show(self) -> None:
        """Show what would become of every landmark."""
        pairing = next(p for p, button in self.pairings.items() if button.isChecked())
        self.choice = ImportChoice(pairing, self._chosen_fits())
        found = arrivals(self._session, self._arriving, self.choice)
        self.model.show_arrivals(found)
        waiting = left_waiting(self._session, self._arriving, found)
        groups = group_words(self._session, self._arriving, self.choice)
        self.outcome.setText("\n".join(filter(None, (summary(found, waiting), *groups))))

    def _chosen_fits(self) -> dict[Side, Fit]:
        return {
            side: fit
            for side, buttons in self.fits.items()
            for fit, button in zip(self._arriving.fits[side], buttons, strict=True)
            if button.isChecked()
        }


def _marked() -> tuple[QFrame, QVBoxLayout]:
    """Return a frame that deserves a look, and the column in it."""
    frame = QFrame()
    frame.setObjectName("question")
    frame.setStyleSheet(
        f"#question {{ border: none; border-left: 3px solid {theme.WARNING_COLOUR}; }}"
    )
    column = QVBoxLayout(frame)
    column.setContentsMargins(10, 2, 0, 2)
    column.setSpacing(4)
    return frame, column


def _headline(arriving: Arriving) -> str:
    reading = arriving.reading
    parts = [counted(len(arriving.landmarks), "pair" if reading.is_pairs else "landmark")]
    for is_curve, one, many in ((True, "curve", "curves"), (False, "patch", "patches")):
        if number := sum(group.is_curve is is_curve for group in reading.groups):
            parts.append(counted(number, one, many))
    specimen = f" of {reading.specimen}" if len(reading.specimens) > 1 else ""
    what = listed(parts if arriving.landmarks else parts[1:])
    return f"{what}{specimen} in {arriving.path.name}"


def _understood(reading: LandmarkReading) -> str:
    """Say the format, and what the file itself says about frame and unit."""
    frame = f"frame {reading.frame}" if reading.frame else "no frame given"
    unit = f"unit {reading.unit}" if reading.unit else "no unit given"
    return f"{reading.format} – {frame}, {unit}"


def _pairing_words(session: Session, arriving: Arriving, pairing: Pairing) -> str:
    """Say a way of pairing, and what speaks for it."""
    names, side = [x.name for x in arriving.landmarks], arriving.side
    match pairing:
        case Pairing.BY_NAME:
            known = {landmark.name for landmark in session.landmarks}
            count = len(known.intersection(names))
            return f"By &name: {_of(count, len(names))} known here"
        case Pairing.BY_ORDER if side is not None:
            count = len(awaiting(session, side))
            waits = f"{count or 'none'} waits" if count < 2 else f"{count:,} wait"
            return f"By &order: {waits} for a {side.value} position"
        case Pairing.BY_ORDER:
            return "By &order: only for one side at a time"
        case Pairing.AS_PASSENGERS if side is Side.SOURCE:
            return "As &passengers: the warp carries them, they are not paired"
        case Pairing.AS_PASSENGERS:
            return "As &passengers: only on the source"
        case Pairing.ONLY_KNOWN:
            known = {landmark.name for landmark in session.landmarks}
            count = len(known.intersection(names))
            return f"Only those &known here: {count:,} of {len(names):,}"
    return "As ne&w landmarks, whatever their names"


def _of(count: int, total: int) -> str:
    if count == total:
        return "all are" if total > 1 else "it is"
    return f"{count:,} of {total:,} {'is' if count == 1 else 'are'}" if count else "none is"


def _label(text: str, *, bold: bool = False, quiet: bool = False) -> QLabel:
    label = QLabel(text)
    # Names of files are the user's own, not markup.
    label.setTextFormat(Qt.TextFormat.PlainText)
    label.setWordWrap(not quiet)
    if bold:
        font = label.font()
        font.setBold(True)
        label.setFont(font)
    if quiet:
        theme.make_quiet(label)
    return label
