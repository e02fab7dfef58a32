"""One row of the list of findings: what was noticed, and what can be done about it."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import partial

from qtpy.QtCore import QEvent, QObject, QSize, Qt, Signal
from qtpy.QtGui import QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPalette
from qtpy.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QMenu,
    QPushButton,
    QSizePolicy,
    QStyle,
    QStyleOptionFocusRect,
    QVBoxLayout,
)

from pinwarp.core.findings import FindingKind
from pinwarp.gui.style import theme
from pinwarp.gui.table.columns import finding_icon
from pinwarp.session.judging.different_units import DifferentUnits
from pinwarp.session.judging.elsewhere import Elsewhere
from pinwarp.session.judging.quality import NamedFinding
from pinwarp.session.mesh_units import scaling_words

# What is put right by placing a landmark anew, if it is wrong.
_REPLACED = (FindingKind.DISPLACED, FindingKind.EITHER, FindingKind.WORTH_A_LOOK)
# Longer words than this are broken anywhere.
_LONGEST_WORD = 24
_SIGN = 16
# So many names there are to choose from.
MOST_CHOICES = 20
_PRESSING = (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Space)


class FindingRow(QFrame):
    """One finding: a sign, a sentence, and what can be done about it."""

    chosen = Signal()
    swap_requested = Signal()
    mirror_requested = Signal()
    reading_requested = Signal()
    scale_requested = Signal(object)
    replace_requested = Signal(str)
    disable_requested = Signal(list)

    def __init__(self) -> None:
        super().__init__()
        self.found: NamedFinding | None = None
        self._current = False
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.sign = QLabel()
        self.sign.setFixedWidth(_SIGN)
        self.sentence = QLabel()
        self.sentence.setTextFormat(Qt.TextFormat.PlainText)
        self.sentence.setWordWrap(True)
        self.sentence.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.sentence.setAlignment(Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft)
        self.remedy = QPushButton()
        self.remedy.clicked.connect(self._on_remedy)
        self.disable = QPushButton("Disable")
        self.disable.clicked.connect(self._on_disable)
        self.choice = QMenu(self.disable)
        self.which = QMenu(self.remedy)
        self._lay_out()

    def _lay_out(self) -> None:
        buttons = QVBoxLayout()
        buttons.setSpacing(2)
        for button in (self.remedy, self.disable):
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            button.setCursor(Qt.CursorShape.ArrowCursor)
            button.installEventFilter(self)
            buttons.addWidget(button)
        buttons.addStretch()
        row = QHBoxLayout(self)
        row.setContentsMargins(6, 4, 4, 4)
        row.setSpacing(6)
        row.addWidget(self.sign, 0, Qt.AlignmentFlag.AlignTop)
        row.addWidget(self.sentence, 1)
        row.addLayout(buttons)

    def show_finding(self, found: NamedFinding, mirror_axis: str) -> None:
        """Show a finding; the axis is the one to mirror across, empty where that cannot be."""
        kind, names, grave = found.finding.kind, found.names, found.finding.is_grave
        remedy, tip = "", ""
        if kind is FindingKind.SWAPPED:
            remedy, tip = "Swap", f"Exchange the destinations of {' and '.join(names)}"
        elif kind is FindingKind.MIRRORED and mirror_axis:
            remedy = f"Mirror Across {mirror_axis.upper()}"
            tip = f"Mirror the source across {mirror_axis}: a left bone becomes a right one"
        elif isinstance(found, Elsewhere) and found.fit is not None:
            remedy = found.fit.action
            tip = f"Read all {found.side.value} {found.what} another way; their mesh stays"
        elif isinstance(found, Elsewhere):
            remedy = "Open Mesh…"
            tip = f"Open the mesh that the {found.side.value} {found.what} were placed on"
        elif isinstance(found, DifferentUnits) and found.ways:
            remedy, tip = "Scale", "Bring one mesh to the unit of the other, with its landmarks"
        elif kind in _REPLACED:
            remedy, tip = "Re-place", f"Show where the other pairs expect {' or '.join(names)}"
        self._show_button(self.remedy, remedy, tip)
        may_sit_out = kind is not FindingKind.SUGGESTED and (grave or remedy)
        self._show_button(
            self.disable,
            "Disable" if names and may_sit_out else "",
            f"Let {names[0]} take no part" if len(names) == 1 else "Let one of them take no part",
        )
        if self.found is None or (names, kind) != (self.found.names, self.found.finding.kind):
            self._fill_choice(names, kind)
        self._fill_which(found)
        if self.found is None or found.sentence != self.found.sentence:
            self.sentence.setText(_breakable(found.sentence))
            self.setAccessibleName(found.sentence)
        self.found = found
        palette = self.palette()
        if not grave:
            palette.setColor(QPalette.ColorRole.WindowText, theme.quiet_text_colour())
        self.sentence.setPalette(palette)
        self.sign.setPixmap(finding_icon([found]).pixmap(QSize(_SIGN, _SIGN)))

    @staticmethod
    def _show_button(button: QPushButton, words: str, tip: str) -> None:
        button.setVisible(bool(words))
        button.setText(words)
        button.setToolTip(tip)

    def _fill_choice(self, names: Sequence[str], kind: FindingKind) -> None:
        self.choice.clear()
        several = len(names) > 1
        self.disable.setMenu(self.choice if several else None)
        choices = [(name.replace("&", "&&"), [name]) for name in names[:MOST_CHOICES]]
        if kind is FindingKind.SWAPPED:
            choices.append(("&Both", list(names)))
        elif len(names) > 2:
            choices.append((f"&All but {names[0].replace('&', '&&')}", list(names[1:])))
        for words, chosen in choices:
            action = self.choice.addAction(words)
            action.triggered.connect(
                lambda _checked=False, chosen=chosen: self.disable_requested.emit(chosen)
            )

    def _fill_which(self, found: NamedFinding) -> None:
        """Let the remedy ask which one, where there are several."""
        ways: dict[str, Callable[[], None]] = {}
        if found.finding.kind is FindingKind.EITHER:
            for name in found.names:
                words = name.replace("&", "&&")
                ways[words] = partial(self.replace_requested.emit, name)
        elif isinstance(found, DifferentUnits):
            for side, factor in found.ways:
                words = scaling_words(f"the {side.value.capitalize()}", factor)
                ways[words] = partial(self.scale_requested.emit, side)
        # Figures change while the menu may be open.
        if list(ways) == [action.text() for action in self.which.actions()]:
            return
        self.which.clear()
        for words, do in ways.items():
            self.which.addAction(words).triggered.connect(lambda _checked=False, do=do: do())
        self.remedy.setMenu(self.which if ways else None)

    def set_current(self, current: bool) -> None:
        """Say whether its landmarks are the selected ones."""
        if current != self._current:
            self._current = current
            self.update()

    def _on_remedy(self) -> None:
        if isinstance(self.found, Elsewhere):
            self.reading_requested.emit()
            return
        if self.found is None:
            return
        match self.found.finding.kind:
            case FindingKind.SWAPPED:
                self.swap_requested.emit()
            case FindingKind.MIRRORED:
                self.mirror_requested.emit()
            case FindingKind.DISPLACED | FindingKind.WORTH_A_LOOK:
                self.replace_requested.emit(self.found.names[0])

    def _on_disable(self) -> None:
        if self.found is not None and len(self.found.names) == 1:
            self.disable_requested.emit(list(self.found.names))

    def event(self, event: QEvent) -> bool:
        """Take Space and Enter before the window does."""
        if event.type() == QEvent.Type.ShortcutOverride and event.key() in _PRESSING:
            event.accept()
            return True
        return bool(super().event(event))

    def eventFilter(self, button: QObject, event: QEvent) -> bool:
        """Let Space and Enter press the buttons."""
        kind = event.type()
        if (
            kind not in (QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress)
            or event.key() not in _PRESSING
        ):
            return bool(super().eventFilter(button, event))
        event.accept()
        if kind == QEvent.Type.KeyPress:
            button.click()
        return True

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Choose the finding."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.chosen.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Choose the finding by Enter or Space; the arrows go to its neighbours."""
        match event.key():
            case key if key in _PRESSING:
                self.chosen.emit()
            case Qt.Key.Key_Down | Qt.Key.Key_Up:
                self._neighbour(1 if event.key() == Qt.Key.Key_Down else -1).setFocus()
            case _:
                event.ignore()

    def _neighbour(self, step: int) -> FindingRow:
        rows = [row for row in self.parent().findChildren(FindingRow) if row.isVisible()]
        return rows[min(max(rows.index(self) + step, 0), len(rows) - 1)]

    def paintEvent(self, event: QPaintEvent) -> None:
        """Show which one is selected, and where the keys go."""
        super().paintEvent(event)
        with QPainter(self) as painter:
            if self._current:
                shade = self.palette().color(QPalette.ColorRole.Highlight)
                shade.setAlphaF(0.16)
                painter.fillRect(self.rect(), shade)
            if self.hasFocus():
                option = QStyleOptionFocusRect()
                option.initFrom(self)
                option.rect = self.rect().adjusted(1, 1, -1, -1)
                element = QStyle.PrimitiveElement.PE_FrameFocusRect
                self.style().drawPrimitive(element, option, painter, self)


def _breakable(text: str) -> str:
    """Let words that are too long for a line be broken, by spaces of no width."""
    return re.sub(rf"(\S{{{_LONGEST_WORD}}})(?=\S)", "\\1\u200b", text)
