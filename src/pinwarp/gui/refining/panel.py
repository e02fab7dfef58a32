"""Refine to surface: how fine, how strictly the landmarks, and what came of it."""

from __future__ import annotations

import math

from qtpy.QtCore import Qt, Signal
from qtpy.QtGui import QPalette
from qtpy.QtWidgets import (
    QApplication,
    QCheckBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QScrollArea,
    QSlider,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.features import FeatureRange
from pinwarp.core.lengths import Ruler
from pinwarp.gui.capability.action import Action
from pinwarp.gui.refining.length_field import LengthField
from pinwarp.gui.refining.words import ABOUT, worth_as_html, worth_in_words
from pinwarp.gui.style import theme
from pinwarp.session.warp.refining import RefinementOptions, Verification

_STEPS = 100


class RefiningPanel(QScrollArea):
    """Shows what the refinement of a session is, and asks for another.

    Parameters
    ----------
    without, remove, check
        The actions that have a button here.
    refine_key
        Which key begins.
    """

    refine_requested = Signal()
    turn_requested = Signal()
    cancel_requested = Signal()
    options_changed = Signal()

    def __init__(self, without: Action, remove: Action, check: Action, refine_key: str) -> None:
        super().__init__()
        self.setAccessibleName("Refine to surface")
        self._range: FeatureRange | None = None
        self._is_busy = False
        self.feature = LengthField(
            "Smallest feature",
            "Automatic",
            (
                "Only what is larger is bent: the smaller, the closer, and the longer it takes",
                "What 1200 places over the source resolve",
            ),
            may_be_zero=False,
        )
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setRange(0, _STEPS)
        self.slider.setAccessibleName("Smallest feature")
        self.slider.setToolTip("Left follows small features, right only bends the bone as a whole")
        self.tolerance = LengthField(
            "Landmark tolerance",
            "As the penalty",
            (
                "A penalty of the landmarks meanwhile: 0 meets each, more lets those miss that "
                "are uncertain. Worth a try where the refined warp folds.",
                "The warping penalty of the session",
            ),
            may_be_zero=True,
        )
        self.turned = QCheckBox("One mesh is inside out: take it the other way round")
        self.refine = QPushButton()
        # The window's sheet makes it stand out.
        self.refine.setProperty("primary", True)
        self.refine.setToolTip(f"Fit the warp to the whole surface ({refine_key})")
        self.bar = QProgressBar()
        self.bar.setRange(0, 100)
        self.stage = _words()
        self.cancel = QPushButton("Cancel")
        self.problem = _words()
        self.turn = QPushButton()
        self.state = _words()
        self.without, self.remove, self.check = map(_button, (without, remove, check))
        self.sentence = _words()
        self.table = _words()
        self.table.setTextFormat(Qt.TextFormat.RichText)
        for label in (self.state, self.problem, self.sentence, self.table):
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._lay_out()
        self._connect()
        self.show_idle()
        self.show_problem("")
        self.show_worth(None, Ruler())
        self.turned.hide()

    def _lay_out(self) -> None:
        about = _words(ABOUT)
        theme.make_quiet(about)
        self._choices = QWidget()
        choices = QVBoxLayout(self._choices)
        choices.setContentsMargins(0, 0, 0, 0)
        choices.setSpacing(4)
        choices.addWidget(QLabel("<b>Bends features larger than</b>"))
        choices.addWidget(self.feature)
        choices.addWidget(self.slider)
        choices.addSpacing(theme.SPACE)
        choices.addWidget(QLabel("<b>Landmark tolerance</b>"))
        choices.addWidget(self.tolerance)
        choices.addWidget(self.turned)
        busy = QHBoxLayout()
        busy.addWidget(self.bar, 1)
        busy.addWidget(self.cancel)
        looks = QHBoxLayout()
        for button in (self.without, self.remove):
            looks.addWidget(button)
        looks.addStretch()
        inside = QWidget()
        column = QVBoxLayout(inside)
        column.setContentsMargins(12, 10, 12, 10)
        column.setSpacing(theme.SPACE)
        column.addWidget(about)
        column.addWidget(self._choices)
        column.addWidget(self.refine)
        column.addWidget(self.stage)
        column.addLayout(busy)
        column.addWidget(self.problem)
        column.addWidget(self.turn, 0, Qt.AlignmentFlag.AlignLeft)
        column.addWidget(self.state)
        column.addLayout(looks)
        column.addSpacing(theme.SPACE)
        column.addWidget(self.check, 0, Qt.AlignmentFlag.AlignLeft)
        column.addWidget(self.sentence)
        column.addWidget(self.table)
        column.addStretch()
        self.setWidget(inside)
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)

    def _connect(self) -> None:
        self.slider.valueChanged.connect(self._on_slid)
        self.feature.changed.connect(self._on_feature)
        self.tolerance.changed.connect(self.options_changed)
        for field in (self.feature, self.tolerance):
            field.refused.connect(self.show_problem)
        self.turned.clicked.connect(lambda _on: self.options_changed.emit())
        self.refine.clicked.connect(lambda _checked: self.refine_requested.emit())
        self.turn.clicked.connect(lambda _checked: self.turn_requested.emit())
        self.cancel.clicked.connect(lambda _checked: self.cancel_requested.emit())

    # What is chosen

    @property
    def options(self) -> RefinementOptions:
        """How to refine, as it is chosen here."""
        return RefinementOptions(self.feature.value, self.tolerance.value, self.turned.isChecked())

    def show_options(self, options: RefinementOptions) -> None:
        """Show how to refine."""
        self.feature.show_value(options.smallest_feature)
        self.tolerance.show_value(options.landmark_tolerance)
        self.show_turned(options.turn_destination)
        self._place_handle()

    def show_turned(self, turned: bool) -> None:
        """Show whether a mesh is taken the other way round, from the first time on."""
        self.turned.setChecked(turned)
        self.turned.setVisible(turned or not self.turned.isHidden())

    def show_usual(self, features: FeatureRange | None, penalty: float, ruler: Ruler) -> None:
        """Show what is taken without a choice; no range of features without a source mesh."""
        self._range = features
        self.feature.show_usual(math.nan if features is None else features.usual, ruler)
        self.feature.setEnabled(features is not None)
        self.slider.setEnabled(features is not None)
        self.tolerance.show_usual(penalty, ruler)
        self._place_handle()

    def _place_handle(self) -> None:
        if self._range is None or self.slider.isSliderDown():
            return
        low, high = math.log(self._range.finest), math.log(self._range.coarsest)
        share = (math.log(self.feature.length) - low) / (high - low)
        self.slider.blockSignals(True)
        self.slider.setValue(round(_STEPS * min(max(share, 0.0), 1.0)))
        self.slider.blockSignals(False)

    def _on_slid(self, step: int) -> None:
        if self._range is not None:
            low, high = self._range.finest, self._range.coarsest
            # Nobody wants 16.0372 mm.
            self.feature.show_value(float(f"{low * (high / low) ** (step / _STEPS):.3g}"))
            self.options_changed.emit()

    def _on_feature(self) -> None:
        self._place_handle()
        self.options_changed.emit()

    # What is shown

    def show_state(self, words: str, *, again: bool, is_warning: bool) -> None:
        """Show what is known of the refinement.

        Parameters
        ----------
        words
            Sentences.
        again
            Whether the session was refined before.
        is_warning
            Whether the words are to be heeded.
        """
        self.refine.setText("Refine Again" if again else "Refine")
        self.state.setText(words)
        _colour(self.state, is_warning)

    def show_problem(self, words: str, *, remedy: str = "", blocks: bool = False) -> None:
        """Show why a refinement cannot begin or did not come about, and the way out.

        Parameters
        ----------
        words
            Empty where there is no problem.
        remedy
            What the button says that turns a mesh round, or back; hidden without.
        blocks
            Whether there is no use in trying.
        """
        self.problem.setText(words)
        self.problem.setVisible(bool(words))
        _colour(self.problem, is_warning=True)
        self.turn.setText(remedy)
        self.turn.setVisible(bool(remedy))
        self.refine.setEnabled(not blocks)

    def show_busy(self, stage: str, share: float) -> None:
        """Show how far it is; without words those of before stay."""
        self._show_busy(True)
        if stage:
            self.stage.setText(stage)
        self.bar.setValue(round(100 * share))

    def show_idle(self) -> None:
        """Show that nothing is under way."""
        self._show_busy(False)

    def _show_busy(self, busy: bool) -> None:
        if self.isAncestorOf(QApplication.focusWidget() or self) and busy != self._is_busy:
            # Else the keyboard would go to whatever stands next: R is then typed into a field.
            self.setFocus()
        self._is_busy = busy
        for widget in (self.stage, self.bar, self.cancel):
            widget.setVisible(busy)
        for widget in (self.refine, self.state):
            widget.setVisible(not busy)
        self._choices.setEnabled(not busy)
        self.cancel.setEnabled(busy)

    def show_worth(self, worth: Verification | None, ruler: Ruler) -> None:
        """Show what the check found; None before it."""
        for label in (self.sentence, self.table):
            label.setVisible(worth is not None)
        if worth is not None:
            self.sentence.setText(worth_in_words(worth, ruler))
            self.table.setText(worth_as_html(worth, ruler))


def _words(text: str = "") -> QLabel:
    label = QLabel(text)
    label.setWordWrap(True)
    return label


def _button(action: Action) -> QToolButton:
    button = QToolButton()
    button.setDefaultAction(action)
    button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
    # The keyboard stays with the bones.
    button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    return button


def _colour(label: QLabel, is_warning: bool) -> None:
    palette = QPalette()
    if is_warning:
        palette.setColor(QPalette.ColorRole.WindowText, theme.warning_text_colour())
    label.setPalette(palette)
