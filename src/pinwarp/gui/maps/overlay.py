"""Whether the warped source is seen over the destination, and how much shines through it."""

from __future__ import annotations

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QSlider

from pinwarp.gui.capability.action import Action, tool
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.maps.presenter import MapPresenter
from pinwarp.session.editor import Editor


class OverlayControls(Capability):
    """The switch and the slider of the overlay in the toolbar.

    Parameters
    ----------
    editor
        Its view state is what they change.
    maps
        With a map on it, the overlay has an opacity of its own.
    """

    def __init__(self, editor: Editor, maps: MapPresenter) -> None:
        self._editor = editor
        self._maps = maps
        self.opacity = QSlider(Qt.Orientation.Horizontal)
        self.opacity.setRange(5, 100)
        self.opacity.setFixedWidth(110)
        self.opacity.setAccessibleName("Opacity of the warped source")
        self.opacity.setToolTip("Opacity of the warped source")
        self.opacity.valueChanged.connect(self._on_slid)
        self.actions = (
            Action(
                "overlay",
                "Show &Warped Source",
                switches=lambda on: editor.look(overlay=on),
                checked=lambda: editor.view.overlay,
                at="View.11 tools.43",
                keys="W",
                icon="overlay",
                tip="Over the destination",
            ),
            tool(self.opacity, "tools.44"),
        )
        editor.view_changed.connect(self._show)
        maps.map_changed.connect(self._show)
        self._show()

    def shut_down(self) -> None:
        """Let go of the editor and the maps."""
        self._editor.view_changed.disconnect(self._show)
        self._maps.map_changed.disconnect(self._show)

    def _show(self, _changed: object = None) -> None:
        view = self._editor.view
        opacity = view.map_opacity if self._maps.is_coloured else view.opacity
        self.opacity.setEnabled(view.overlay)
        self.opacity.setValue(round(100 * opacity))

    def _on_slid(self, value: int) -> None:
        if self._maps.is_coloured:
            self._editor.look(map_opacity=value / 100)
        else:
            self._editor.look(opacity=value / 100)
