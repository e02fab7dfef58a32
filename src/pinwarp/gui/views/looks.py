"""What the View menu does with looks: arrows, cut, edges, sizes and background."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from qtpy.QtCore import QObject, QSettings, Qt, SignalInstance
from qtpy.QtWidgets import QSlider

from pinwarp.core.landmarks import Side
from pinwarp.gui.capability.action import Action, one_of, tool
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.style import theme
from pinwarp.gui.views.canvas import Canvas
from pinwarp.session.editor import Editor
from pinwarp.session.view import Background, LengthUnit

# Smallest and largest landmark, in logical pixels.
MARKER_RADII = (4.0, 12.0)
_BACKGROUNDS = {
    Background.THEME: ("As the &Theme", "Light or dark, as the window is", 11),
    Background.LIGHT: ("&Light", "Whatever the window is", 12),
    Background.DARK: ("&Dark", "Whatever the window is", 13),
}

_LENGTHS = {
    LengthUnit.AUTOMATIC: ("&Automatic", "Bones in metres are shown in millimetres", 11),
    LengthUnit.FILE: ("As in the &File", "In the unit of the session", 12),
    LengthUnit.MM: ("&Millimetres", "Files keep their unit", 21),
    LengthUnit.CM: ("&Centimetres", "Files keep their unit", 22),
    LengthUnit.M: ("M&etres", "Files keep their unit", 23),
}


class Looks(Capability):
    """How bones and landmarks look; nothing here changes the session.

    Parameters
    ----------
    editor
        Its view state is what the actions change.
    views
        One per side.
    theme_changed
        A signal of the window's.
    parent
        The window.
    """

    def __init__(
        self,
        editor: Editor,
        views: Mapping[Side, Canvas],
        theme_changed: SignalInstance,
        parent: QObject,
    ) -> None:
        self._editor = editor
        self._theme_changed = theme_changed
        self._views = views
        self.section_slider = _section_slider()
        self.actions = (
            Action(
                "arrows",
                "Residual &Arrows",
                switches=lambda on: editor.look(arrows=on),
                checked=lambda: editor.view.arrows,
                at="View.12",
                keys="A",
                deed="Show Residual Arrows",
                tip="From warped landmarks to destinations",
            ),
            Action(
                "section",
                "&Cross-Section",
                switches=self._on_section,
                checked=lambda: editor.view.section is not None,
                at="View.31 tools.45",
                keys="X",
                deed="Cut Both Bones Open",
                icon="section",
                tip="Cut both bones open",
            ),
            tool(self.section_slider, "tools.46"),
            *one_of(map(self._background_action, Background), parent),
            *one_of(map(self._lengths_action, LengthUnit), parent),
            Action(
                "wireframe",
                "W&ireframe Bones",
                switches=lambda on: editor.look(wireframe=on),
                checked=lambda: editor.view.wireframe,
                at="View.32",
                keys="Shift+W",
                deed="Draw Bones as Wireframe",
                tip="Draw edges only",
            ),
            Action(
                "markers_larger",
                "La&rger Landmarks",
                lambda: self._resize_markers(1),
                at="View.41",
                keys="]",
                deed="Draw Larger Landmarks",
                possible=lambda: editor.view.marker_radius < MARKER_RADII[1],
            ),
            Action(
                "markers_smaller",
                "S&maller Landmarks",
                lambda: self._resize_markers(-1),
                at="View.42",
                keys="[",
                deed="Draw Smaller Landmarks",
                possible=lambda: editor.view.marker_radius > MARKER_RADII[0],
            ),
        )
        self.section_slider.valueChanged.connect(self._on_section_moved)
        theme_changed.connect(self._on_view)
        editor.view_changed.connect(self._on_view)
        self._on_view()

    def _background_action(self, background: Background) -> Action:
        text, tip, place = _BACKGROUNDS[background]
        return Action(
            f"background_{background.value}",
            text,
            lambda: self._editor.look(background=background),
            checked=lambda: self._editor.view.background is background,
            at=f"background.{place}",
            tip=tip,
        )

    def _lengths_action(self, unit: LengthUnit) -> Action:
        text, tip, place = _LENGTHS[unit]
        return Action(
            f"lengths_{unit.name.lower()}",
            text,
            lambda: self._editor.look(lengths=unit),
            checked=lambda: self._editor.view.lengths is unit,
            at=f"lengths.{place}",
            tip=tip,
        )

    def remember(self, settings: QSettings) -> None:
        """Note the background and the unit of lengths."""
        settings.setValue("views/lengths", self._editor.view.lengths.value)
        settings.setValue("views/background", self._editor.view.background.value)

    def recall(self, settings: QSettings) -> None:
        """Take the background and the unit that were chosen before."""
        unit = str(settings.value("views/lengths", LengthUnit.AUTOMATIC.value))
        if unit in set(LengthUnit):
            self._editor.look(lengths=LengthUnit(unit))
        stored = str(settings.value("views/background", Background.THEME.value))
        if stored in set(Background):
            self._editor.look(background=Background(stored))

    def shut_down(self) -> None:
        """Let go of the editor and the theme."""
        self._editor.view_changed.disconnect(self._on_view)
        self._theme_changed.disconnect(self._on_view)

    def _on_view(self, _changed: object = None) -> None:
        view = self._editor.view
        self.section_slider.setEnabled(view.section is not None)
        if view.section is not None:
            self.section_slider.setValue(round(view.section * self.section_slider.maximum()))
        dark = view.background is Background.DARK or (
            view.background is Background.THEME and theme.is_dark()
        )
        for canvas in self._views.values():
            canvas.set_dark(dark)

    def _resize_markers(self, by: float) -> None:
        radius = self._editor.view.marker_radius + by
        self._editor.look(marker_radius=float(np.clip(radius, *MARKER_RADII)))

    def _on_section(self, on: bool) -> None:
        slider = self.section_slider
        self._editor.look(section=slider.value() / slider.maximum() if on else None)

    def _on_section_moved(self, value: int) -> None:
        if self._editor.view.section is not None:
            self._editor.look(section=value / self.section_slider.maximum())


def _section_slider() -> QSlider:
    slider = QSlider(Qt.Orientation.Horizontal)
    slider.setRange(0, 200)
    slider.setValue(100)
    slider.setFixedWidth(110)
    slider.setAccessibleName("Depth of the cross-section")
    slider.setToolTip("Depth of the cross-section")
    return slider
