"""What a picture or an animation is to show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from qtpy.QtCore import QSignalBlocker, Qt
from qtpy.QtGui import QIcon
from qtpy.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.landmarks import Side
from pinwarp.gui.exporting import animation, picture
from pinwarp.gui.exporting.animation import AnimationOrder, Format, Motion
from pinwarp.gui.exporting.picture import PictureOrder
from pinwarp.gui.style import theme
from pinwarp.io.animation import ENCODER_MISSING, has_encoder

# Smaller ones have no room for a label.
SMALLEST = 64

_VIEWS = (
    ("Both side by side", tuple(Side)),
    ("Source", (Side.SOURCE,)),
    ("Destination", (Side.DESTINATION,)),
)
_MOTIONS = (
    ("The destination, turned once round", Motion.TURN),
    ("From the aligned source to the warp and back", Motion.BLEND),
)
_FORMATS = (("GIF", Format.GIF), ("MP4", Format.MP4))
# GIF counts in hundredths of a second.
_GIF_RATE, _MP4_RATE = 50, 120


class _SizeDialog(QDialog):
    """What both have in common: a size, a line that says what it comes to, and the buttons."""

    def __init__(self, title: str, width: int, height: int, largest: int, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.image_width, self.image_height = QSpinBox(), QSpinBox()
        for box, value, name in (
            (self.image_width, width, "Width"),
            (self.image_height, height, "Height"),
        ):
            box.setRange(SMALLEST, largest)
            box.setSingleStep(100)
            box.setGroupSeparatorShown(True)
            box.setAccessibleName(f"{name} in pixels")
            box.setValue(value)
        size = QHBoxLayout()
        for widget in (self.image_width, QLabel("×"), self.image_height, QLabel("pixels")):
            size.addWidget(widget)
        size.addStretch(1)
        self.form = QFormLayout()
        self.form.addRow("&Size", size)
        # A layout cannot be a label's buddy.
        label = self.form.labelForField(size)
        if isinstance(label, QLabel):
            label.setBuddy(self.image_width)
        self.note = QLabel()
        self.note.setWordWrap(True)
        # Room for a reason of two lines, so that nothing jumps.
        self.note.setMinimumHeight(2 * self.note.fontMetrics().lineSpacing())
        self.note.setAlignment(Qt.AlignmentFlag.AlignTop)
        kinds = QDialogButtonBox.StandardButton
        self.buttons = QDialogButtonBox(kinds.Ok | kinds.Cancel)
        for button in self.buttons.buttons():
            button.setIcon(QIcon())
        self.export = self.buttons.button(kinds.Ok)
        self.export.setText("Export…")
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self.setMinimumWidth(400)

    def _lay_out(self) -> None:
        """Put together what was made, the form being whole: Tab goes in this order."""
        column = QVBoxLayout(self)
        column.addLayout(self.form)
        column.addSpacing(theme.SPACE)
        column.addWidget(self.note)
        column.addWidget(self.buttons)

    def _say(self, words: str, *, possible: bool) -> None:
        self.note.setText(words)
        colour = theme.quiet_text_colour() if possible else theme.warning_text_colour()
        self.note.setStyleSheet(f"color: {colour.name()};")
        self.export.setEnabled(possible)


class PictureDialog(_SizeDialog):
    """Asks what a picture is to show.

    Parameters
    ----------
    order
        What is proposed.
    parent
        The window.
    sized
        Gives an order the size that suits it, unless somebody chose one.
    """

    def __init__(
        self,
        order: PictureOrder,
        parent: QWidget,
        sized: Callable[[PictureOrder], PictureOrder],
    ) -> None:
        self._sized = sized
        self._is_sized = order.is_sized
        super().__init__("Export a picture", order.width, order.height, picture.LARGEST, parent)
        self.view = QComboBox()
        for words, sides in _VIEWS:
            self.view.addItem(words, sides)
        self.view.setCurrentIndex([sides for _, sides in _VIEWS].index(order.sides))
        self.landmarks = QCheckBox("&Landmarks")
        self.names = QCheckBox("&Names of those in front")
        self.framed = QCheckBox("&Title and scale bar")
        self.transparent = QCheckBox("Transparent &background")
        self.filled = QCheckBox("&Cut to the bones")
        self.filled.setToolTip("Else all that the views show")
        for box, on in (
            (self.landmarks, order.landmarks),
            (self.names, order.names),
            (self.framed, order.framed),
            (self.transparent, order.transparent),
            (self.filled, order.filled),
        ):
            box.setChecked(on)
        self.form.addRow("&View", self.view)
        boxes = (self.landmarks, self.names, self.framed, self.transparent, self.filled)
        for row, box in enumerate(boxes):
            self.form.addRow("Show" if not row else "", box)
        self._lay_out()
        for size in (self.image_width, self.image_height):
            size.valueChanged.connect(self._on_size_chosen)
        for box in boxes:
            box.toggled.connect(self._on_change)
        self.view.currentIndexChanged.connect(self._on_change)
        self._on_change()

    @property
    def order(self) -> PictureOrder:
        """What was asked for."""
        return PictureOrder(
            width=self.image_width.value(),
            height=self.image_height.value(),
            sides=_VIEWS[self.view.currentIndex()][1],
            landmarks=self.landmarks.isChecked(),
            names=self.names.isChecked() and self.landmarks.isChecked(),
            framed=self.framed.isChecked(),
            transparent=self.transparent.isChecked(),
            filled=self.filled.isChecked(),
            is_sized=self._is_sized,
        )

    def _on_size_chosen(self, _value: int) -> None:
        self._is_sized = True
        self._show()

    def _on_change(self, _value: object = None) -> None:
        """Follow with the size what is shown, as long as nobody chose one."""
        proposal = self._sized(self.order)
        for box, length in (
            (self.image_width, proposal.width),
            (self.image_height, proposal.height),
        ):
            with QSignalBlocker(box):
                box.setValue(length)
        self._show()

    def _show(self) -> None:
        self.names.setEnabled(self.landmarks.isChecked())
        pixels = self.order.width * self.order.height
        millions = f"{pixels / 1e6:.1f} million pixels"
        if pixels > picture.MOST_PIXELS:
            most = f"{picture.MOST_PIXELS / 1e6:.0f} million"
            self._say(f"{millions} are too many: {most} is the most.", possible=False)
        else:
            self._say(f"{millions}, rendered at this size from where you look.", possible=True)


class AnimationDialog(_SizeDialog):
    """Asks what an animation is to show.

    Parameters
    ----------
    order
        What is proposed.
    parent
        The window.
    """

    def __init__(self, order: AnimationOrder, parent: QWidget) -> None:
        super().__init__("Export an animation", order.width, order.height, 4096, parent)
        self.motion = QComboBox()
        for words, motion in _MOTIONS:
            self.motion.addItem(words, motion.value)
        self.motion.setCurrentIndex([motion for _, motion in _MOTIONS].index(order.motion))
        self.frames = QSpinBox()
        self.frames.setRange(2, 600)
        self.frames.setValue(order.frames)
        self.seconds = QDoubleSpinBox()
        self.seconds.setRange(0.2, 60)
        self.seconds.setDecimals(1)
        self.seconds.setSuffix(" s")
        self.seconds.setValue(order.seconds)
        self.format = QComboBox()
        for words, kind in _FORMATS:
            self.format.addItem(words, kind.value)
        self.format.setCurrentIndex([kind for _, kind in _FORMATS].index(order.format))
        self.form.insertRow(0, "&Show", self.motion)
        self.form.addRow("&Frames", self.frames)
        self.form.addRow("&Duration", self.seconds)
        self.form.addRow("File &type", self.format)
        self._lay_out()
        # What was put in above them comes first.
        QWidget.setTabOrder(self.motion, self.image_width)
        QWidget.setTabOrder(self.image_width, self.image_height)
        self.format.currentIndexChanged.connect(lambda _row: self._show())
        for box in (self.image_width, self.image_height, self.frames, self.seconds):
            box.valueChanged.connect(lambda _value: self._show())
        self._order = order
        self._show()

    @property
    def order(self) -> AnimationOrder:
        """What was asked for."""
        return replace(
            self._order,
            motion=_MOTIONS[self.motion.currentIndex()][1],
            width=self.image_width.value(),
            height=self.image_height.value(),
            frames=self.frames.value(),
            seconds=self.seconds.value(),
            format=_FORMATS[self.format.currentIndex()][1],
        )

    def _show(self) -> None:
        order = self.order
        rate = order.frames / order.seconds
        is_gif = order.format is Format.GIF
        fastest = _GIF_RATE if is_gif else _MP4_RATE
        if not (is_gif or has_encoder()):
            self._say(f"{ENCODER_MISSING}.", possible=False)
        elif order.pixels > animation.MOST_PIXELS:
            share = animation.MOST_PIXELS / order.pixels
            self._say(
                f"That is too much for the memory: choose at most "
                f"{max(2, int(order.frames * share))} frames of this size, or a smaller one.",
                possible=False,
            )
        elif rate > fastest:
            self._say(
                f"{order.format.name} shows at most {fastest} frames a second, and these are "
                f"{rate:.0f}: choose a longer duration or fewer frames.",
                possible=False,
            )
        else:
            how = ", repeated for ever" if is_gif else ""
            self._say(f"{rate:.0f} frames a second{how}.", possible=True)
