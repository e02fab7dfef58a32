"""The Model tab: the bodies above, what becomes of the chosen one's elements below."""

from __future__ import annotations

from collections.abc import Sequence

from qtpy.QtCore import Qt, Signal
from qtpy.QtWidgets import (
    QCheckBox,
    QComboBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.model_rows import ElementRow
from pinwarp.core.words import counted
from pinwarp.gui.capability.action import Action
from pinwarp.gui.model import words
from pinwarp.gui.model.body_tree import BodyTree
from pinwarp.gui.model.rule_tree import RuleTree
from pinwarp.gui.style import theme
from pinwarp.session.model.bench import Bench
from pinwarp.session.model.rules import Rule
from pinwarp.session.rulers import ruler_of
from pinwarp.session.view import LengthUnit


class ModelPanel(QWidget):
    """Shows bodies and rules, and asks for others.

    Parameters
    ----------
    export, save, shown
        The actions that have a button, or a box, here.
    """

    rule_requested = Signal(object)

    def __init__(self, export: Action, save: Action, shown: Action) -> None:
        super().__init__()
        self._is_rendering = False
        self._body = ""
        self.bodies = BodyTree()
        self.rules = RuleTree()
        self.title, self.problem, self.details = QLabel(), QLabel(), QLabel()
        self.rule = QComboBox()
        self.rule.setAccessibleName("Rule")
        self.only_flagged = QCheckBox("Only flagged")
        self.only_flagged.setToolTip("Leave out what asks for no look")
        self.drawn = QCheckBox("Drawn")
        self.drawn.setToolTip(f"{shown.toolTip()}. {words.WITHOUT_WRAPPING}")
        self.drawn.setChecked(shown.isChecked())
        self.drawn.clicked.connect(lambda _on: shown.trigger())
        shown.toggled.connect(self.drawn.setChecked)
        self.export, self.save = _button(export, primary=True), _button(save)
        self._lay_out()
        self.rule.activated.connect(self._on_rule)
        self.only_flagged.toggled.connect(self.rules.show_only_flagged)

    def _lay_out(self) -> None:
        for label in (self.title, self.problem, self.details):
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setWordWrap(True)
            label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Minimum)
        self.problem.setStyleSheet(f"color: {theme.warning_text_colour().name()};")
        self.details.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.details.setMinimumHeight(4 * self.fontMetrics().lineSpacing())
        self.details.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        above = QHBoxLayout()
        above.addWidget(self.title, 1)
        above.addWidget(self.only_flagged)
        above.addWidget(self.drawn)
        choice = QHBoxLayout()
        choice.addWidget(QLabel("Rule"))
        choice.addWidget(self.rule, 1)
        buttons = QHBoxLayout()
        buttons.addWidget(self.save)
        buttons.addStretch(1)
        buttons.addWidget(self.export)
        self.lower = QWidget()
        lower = QVBoxLayout(self.lower)
        lower.setContentsMargins(0, 0, 0, 0)
        lower.setSpacing(6)
        lower.addLayout(above)
        lower.addWidget(self.problem)
        lower.addWidget(self.rules, 1)
        lower.addWidget(self.details)
        lower.addLayout(choice)
        split = QSplitter(Qt.Orientation.Vertical)
        split.setChildrenCollapsible(False)
        split.addWidget(self.bodies)
        split.addWidget(self.lower)
        split.setStretchFactor(0, 2)
        split.setStretchFactor(1, 5)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 4, 6, 6)
        column.setSpacing(6)
        column.addWidget(split, 1)
        column.addLayout(buttons)
        self.bodies.setMinimumHeight(7 * self.fontMetrics().lineSpacing())
        self.lower.hide()

    def show_bench(self, bench: Bench | None, chosen: str, wanted: LengthUnit) -> None:
        """Show the bodies of a model, one of them chosen, and lengths as is wanted."""
        bodies = () if bench is None else tuple(bench.bodies.values())
        self.bodies.show_bodies(bodies, chosen, wanted)
        self.rules.show_ruler(ruler_of("m", 1.0, wanted))
        self.lower.setVisible(bench is not None)
        self.rules.setVisible(bool(chosen))
        if chosen != self._body:
            # Until it is known what stands on the other one; saving changes nothing here.
            self._body = chosen
            self.rule.setEnabled(False)
        if not chosen:
            self.title.setText(words.NO_BODY)
            self.show_rows((), "", (), "")

    def show_rows(
        self, rows: Sequence[ElementRow], name: str, notes: Sequence[str], problem: str
    ) -> None:
        """Show what becomes of the elements of a body."""
        self.rules.show_rows(rows)
        flags = sum(bool(row.flag) for row in rows)
        if name:
            told = f", {flags} flagged" if flags else ""
            self.title.setText(f"{name}: {counted(len(rows), 'element')}{told}")
        text = "\n".join(filter(None, (problem, *notes)))
        self.problem.setText(text)
        self.problem.setVisible(bool(text))

    def show_chosen(
        self,
        chosen: Sequence[ElementRow],
        choices: Sequence[Rule],
        rule: Rule | None,
        hint: str,
    ) -> None:
        """Show the words of what is chosen, or a hint, and which rules it can have."""
        self.details.setText(_details(chosen) or hint)
        self._is_rendering = True
        self.rule.clear()
        for each in choices:
            is_frame_kept = each is Rule.CARRY and Rule.TURN in choices
            self.rule.addItem(words.TURN_KEPT if is_frame_kept else words.RULES[each], each)
        self.rule.setCurrentIndex(-1 if rule is None else self.rule.findData(rule))
        self.rule.setEnabled(bool(choices))
        self.rule.setPlaceholderText("Several" if choices else "Nothing to choose")
        self._is_rendering = False

    def _on_rule(self, number: int) -> None:
        if not self._is_rendering:
            self.rule_requested.emit(Rule(self.rule.itemData(number)))


def _details(chosen: Sequence[ElementRow]) -> str:
    if not chosen:
        return ""
    if len(chosen) > 1:
        return counted(len(chosen), "element")
    (row,) = chosen
    # A long path may be broken where it has a slash.
    path = row.path.replace("/", "/\u200b")
    return "\n".join(filter(None, (f"{path} ({row.kind}, line {row.line})", row.words, row.flag)))


def _button(action: Action, *, primary: bool = False) -> QPushButton:
    button = QPushButton(action.text().replace("&", ""))
    button.setToolTip(action.toolTip())
    # The window's sheet makes it stand out.
    button.setProperty("primary", primary)
    button.setMinimumWidth(button.fontMetrics().horizontalAdvance(button.text()) + 28)
    button.setEnabled(action.isEnabled())
    button.clicked.connect(lambda _checked=False: action.trigger())
    action.enabledChanged.connect(button.setEnabled)
    return button
