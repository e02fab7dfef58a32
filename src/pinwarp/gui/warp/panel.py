"""What the warp does: what of it is applied, on the way from the source, and in figures."""

from __future__ import annotations

from qtpy.QtCore import QSize, Qt, Signal
from qtpy.QtWidgets import (
    QComboBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSlider,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.components import Components
from pinwarp.core.lengths import Ruler
from pinwarp.gui.capability.action import Action
from pinwarp.gui.style import theme
from pinwarp.gui.warp.component_list import ComponentList, Remainder
from pinwarp.gui.warp.figures_view import FiguresView
from pinwarp.session.judging.quality import Quality
from pinwarp.session.judging.warp_figures import determined_in_words, rms_text, warp_figures
from pinwarp.session.session import Session
from pinwarp.session.view import GridKind, ViewState
from pinwarp.session.warp.component_words import COMPONENT_WORDS

_GRIDS = {
    GridKind.NONE: "None",
    GridKind.BOX: "Box",
    GridKind.PLANE_X: "Plane across x",
    GridKind.PLANE_Y: "Plane across y",
    GridKind.PLANE_Z: "Plane across z",
}
TAKEN_APART = "The affine fit of the pairs, and how the full warp bends beyond it:"
REFINED_APART = "The affine fit of the pairs, and how the refined warp bends beyond it:"


class WarpPanel(QScrollArea):
    """Shows the applied warp and asks for another.

    Parameters
    ----------
    play
        The action that plays the blend.
    grid_key
        Which key draws the next grid.
    """

    components_requested = Signal(object)
    blend_previewed = Signal(float)
    # The blend, and whether it is one of many small steps.
    blend_requested = Signal(float, bool)
    grid_requested = Signal(object)
    grid_share_requested = Signal(float)
    copy_requested = Signal()

    def __init__(self, play: Action, grid_key: str) -> None:
        super().__init__()
        self.setAccessibleName("Parts of the warp")
        self._ruler = Ruler()
        self._session = Session()
        self._quality: Quality | None = None
        self.components = ComponentList()
        self.play = QToolButton()
        self.play.setDefaultAction(play)
        self.play.setIconSize(QSize(18, 18))
        self.play.setAutoRaise(True)
        self.blend = _slider("Blend", f"How much of it is applied ({play.keys} plays it)", 100)
        self.blend_value = QLabel()
        self.ends = QLabel(), QLabel()
        self.grid = QComboBox()
        for kind, text in _GRIDS.items():
            self.grid.addItem(text, kind)
        self.grid.setToolTip(f"Straight on the source, bent by the warp ({grid_key} for the next)")
        self.grid.setAccessibleName("Grid")
        self.grid_share = _slider("Place of the plane", "Where the plane crosses its axis", 100)
        # The grid's kinds stay where they are while it comes and goes.
        policy = self.grid_share.sizePolicy()
        policy.setRetainSizeWhenHidden(True)
        self.grid_share.setSizePolicy(policy)
        self.grid_value = QLabel()
        self.figures = FiguresView()
        self.copy = QPushButton("Copy")
        self.copy.setToolTip("All figures as a table for a spreadsheet")
        self.sentence = QLabel()
        self.sentence.setWordWrap(True)
        theme.make_quiet(self.sentence)
        self._lay_out()
        self._connect()

    def _lay_out(self) -> None:
        inside = QWidget()
        column = QVBoxLayout(inside)
        column.setContentsMargins(12, 4, 12, 8)
        column.setSpacing(6)
        left = QLabel("RMS left")
        theme.make_quiet(left)
        left.setToolTip(
            "How far each leaves the pairs apart: the root mean square of the misses "
            "(without pose: once its pose is put back)"
        )
        column.addLayout(_heading("Apply to the screen and to exports", left))
        column.addWidget(self.components)
        column.addLayout(_heading("Blend", self.blend_value))
        row = QHBoxLayout()
        row.setSpacing(4)
        row.addWidget(self.play)
        row.addWidget(self.blend, 1)
        column.addLayout(row)
        ends = QHBoxLayout()
        ends.setContentsMargins(self.play.sizeHint().width() + 4, 0, 0, 0)
        for label in self.ends:
            theme.make_quiet(label)
        ends.addWidget(self.ends[0])
        ends.addStretch()
        ends.addWidget(self.ends[1])
        column.addLayout(ends)
        column.addLayout(_heading("Grid", self.grid_value))
        row = QHBoxLayout()
        row.setSpacing(theme.SPACE)
        row.addWidget(self.grid)
        row.addWidget(self.grid_share, 1)
        column.addLayout(row)
        column.addLayout(_heading("The warp taken apart", self.copy))
        column.addWidget(self.sentence)
        column.addWidget(self.figures)
        column.addStretch()
        self.setWidget(inside)
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)

    def _connect(self) -> None:
        self.components.chosen.connect(self.components_requested)
        self.blend.valueChanged.connect(self._on_blend)
        self.blend.sliderReleased.connect(
            lambda: self.blend_requested.emit(self.blend.value() / 100, False)
        )
        # Qt turns the enumeration into a plain string.
        self.grid.activated.connect(
            lambda index: self.grid_requested.emit(GridKind(self.grid.itemData(index)))
        )
        self.grid_share.valueChanged.connect(
            lambda value: self.grid_share_requested.emit(value / 100)
        )
        self.copy.clicked.connect(lambda _checked=False: self.copy_requested.emit())
        self.figures.copy_requested.connect(self.copy_requested)

    def _on_blend(self, value: int) -> None:
        if self.blend.isSliderDown():
            self.blend_previewed.emit(value / 100)
        else:
            self.blend_requested.emit(value / 100, True)

    # What is shown

    def show_session(self, session: Session) -> None:
        """Show what a session applies."""
        self._session = session
        settings = session.settings
        is_rigid = settings.components is Components.RIGID
        self.components.show_choice(settings.components)
        self.blend_value.setText(f"{settings.blend:.0%}")
        self.blend.setEnabled(bool(session.pairs) and not is_rigid)
        words = COMPONENT_WORDS[settings.components]
        same = ": the same" if is_rigid else ""
        self.ends[0].setText(words.start.capitalize())
        self.ends[1].setText(words.title + same)
        if not self.blend.isSliderDown():
            _place(self.blend, round(100 * settings.blend))

    def show_ruler(self, ruler: Ruler) -> None:
        """Show all lengths in another unit."""
        self._ruler = ruler
        self.show_quality(self._quality)

    def show_quality(self, quality: Quality | None) -> None:
        """Show what the warp does; None where there is none."""
        self._quality = quality
        refined = quality is not None and quality.inputs.refinement is not None
        apart = REFINED_APART if refined else TAKEN_APART
        self.sentence.setText(determined_in_words(quality) or apart)
        self.figures.setVisible(quality is not None)
        self.copy.setVisible(quality is not None)
        if quality is None:
            self.components.show_remainders({})
            self.figures.show_rows(())
            return
        left = quality.rms_by_components
        largest = max(left.values()) or 1.0
        self.components.show_remainders(
            {
                # What is only rounding has no bar.
                part: Remainder(rms_text(rms, quality, self._ruler), round(rms / largest, 3))
                for part, rms in left.items()
            }
        )
        self.figures.show_rows(warp_figures(quality, self._ruler))

    def show_view(self, view: ViewState) -> None:
        """Show which grid is drawn."""
        self.grid.setCurrentIndex(self.grid.findData(view.grid))
        axis = view.grid.axis
        self.grid_share.setVisible(axis is not None)
        _place(self.grid_share, round(100 * view.grid_share))
        self.grid_value.setText(f"{view.grid_share:.0%} of {axis}" if axis is not None else "")


def _slider(name: str, tip: str, steps: int) -> QSlider:
    slider = QSlider(Qt.Orientation.Horizontal)
    slider.setRange(0, steps)
    slider.setPageStep(steps // 10)
    slider.setAccessibleName(name)
    slider.setToolTip(tip)
    return slider


def _place(slider: QSlider, value: int) -> None:
    """Put the handle somewhere without asking for anything."""
    slider.blockSignals(True)
    slider.setValue(value)
    slider.blockSignals(False)


def _heading(text: str, beside: QWidget) -> QHBoxLayout:
    """Return a title with something at the other end of its line."""
    title = QLabel(f"<b>{text}</b>")
    row = QHBoxLayout()
    row.setContentsMargins(0, 6, 0, 0)
    row.addWidget(title, 1)
    row.addWidget(beside)
    return row
