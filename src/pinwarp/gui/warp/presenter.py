"""What of the warp is applied: asked for in the menu and the panel, said in the status bar."""

from __future__ import annotations

from collections.abc import Callable

from qtpy.QtCore import QObject
from qtpy.QtGui import QGuiApplication
from qtpy.QtWidgets import QLabel

from pinwarp.core.components import Components
from pinwarp.gui.capability.action import Action, one_of
from pinwarp.gui.capability.capability import Capability, Panel
from pinwarp.gui.style.icons import icon
from pinwarp.gui.warp.blend_player import BlendPlayer
from pinwarp.gui.warp.panel import WarpPanel
from pinwarp.gui.warp.quality import QualityPresenter
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.judging.warp_figures import figures_table
from pinwarp.session.rulers import Rulers
from pinwarp.session.warp.component_words import applied_in_words

COMPONENT_ACTIONS = {part: f"apply_{part.name.lower()}" for part in Components}
_ACTIONS = {
    Components.FULL: ("&Full Warp", "All of it", 11),
    Components.WITHOUT_POSE: ("Without &Pose", "Export keeps the source's frame", 12),
    Components.AFFINE: ("&Affine Fit Only", "Turned, moved, sized, sheared", 21),
    Components.SIMILARITY: ("&Similarity Fit Only", "Turned, moved, sized", 22),
    Components.RIGID: ("&Rigid Fit Only", "Turned and moved", 23),
}


class WarpPresenter(Capability):
    """Wires the editor to what shows and changes the applied warp.

    Parameters
    ----------
    editor
        The truth.
    quality
        Where the figures come from.
    grid_key
        Which key draws the next grid.
    say
        Says a sentence in passing.
    parent
        The window.
    """

    def __init__(
        self,
        editor: Editor,
        quality: QualityPresenter,
        grid_key: str,
        say: Callable[[str], None],
        parent: QObject,
    ) -> None:
        self._editor = editor
        self._quality = quality
        self._say = say
        self.note = QLabel()
        self.notes = (self.note,)
        self.player = BlendPlayer(editor, parent)
        self._play_action = Action(
            "play_blend",
            "&Play Blend",
            switches=self._play,
            checked=lambda: self.player.is_playing,
            at="Warp.32",
            keys="Shift+B",
            icon="play",
            tip="From the source to the warp",
            possible=self._can_play,
        )
        self._copy_action = Action(
            "copy_figures",
            "&Copy Figures",
            self._copy,
            at="Warp.51",
            tip="The warp taken apart, as a table",
            possible=lambda: quality.quality is not None,
        )
        components = one_of(map(self._action_of, Components), parent)
        self.actions = (*components, self._play_action, self._copy_action)
        self.panel = WarpPanel(self._play_action, grid_key)
        self.panels = (Panel("warp", "Warp", self.panel),)
        self._connect()
        self._on_session()
        self._on_view()
        self._on_quality()

    def _connect(self) -> None:
        editor, panel = self._editor, self.panel
        panel.components_requested.connect(self._apply)
        panel.blend_previewed.connect(self._preview)
        panel.blend_requested.connect(self._blend)
        panel.grid_requested.connect(lambda kind: editor.look(grid=kind))
        panel.grid_share_requested.connect(lambda share: editor.look(grid_share=share))
        panel.copy_requested.connect(self._copy)
        self.player.playing_changed.connect(self._on_playing)
        editor.rulers_changed.connect(self._on_rulers)
        editor.session_changed.connect(self._on_session)
        editor.view_changed.connect(self._on_view)
        self._quality.quality_changed.connect(self._on_quality)

    def shut_down(self) -> None:
        """Let go of the editor."""
        self.player.shut_down()
        self._editor.rulers_changed.disconnect(self._on_rulers)
        self._editor.session_changed.disconnect(self._on_session)
        self._editor.view_changed.disconnect(self._on_view)
        self._quality.quality_changed.disconnect(self._on_quality)

    # What changed

    def _on_session(self, _changed: object = None) -> None:
        session = self._editor.session
        self.panel.show_session(session)
        # What is not the whole warp must not be taken for it, here or in a file.
        whole = session.settings.is_whole
        if self.player.is_playing:
            self.note.setText("Playing the blend: Esc or a click stops it")
        else:
            applied = applied_in_words(session.settings)
            self.note.setText("" if whole else f"Shown and exported: {applied}")

    def _on_rulers(self, rulers: Rulers) -> None:
        self.panel.show_ruler(rulers.session)

    def _on_view(self, _changed: object = None) -> None:
        self.panel.show_view(self._editor.view)

    def _on_quality(self, _changed: object = None) -> None:
        self._copy_action.renew()
        self.panel.show_quality(self._quality.quality)

    def _on_playing(self, playing: bool) -> None:
        self._play_action.setIcon(icon("stop" if playing else "play"))
        self._play_action.renew()
        self._on_session()

    # What the user does

    def _action_of(self, part: Components) -> Action:
        text, tip, place = _ACTIONS[part]
        return Action(
            COMPONENT_ACTIONS[part],
            text,
            lambda: self._apply(part),
            checked=lambda: self._editor.session.settings.components is part,
            at=f"components.{place}",
            tip=tip,
        )

    def _can_play(self) -> bool:
        session = self._editor.session
        return bool(session.pairs) and session.settings.components is not Components.RIGID

    def _apply(self, components: Components) -> None:
        session = edits.set_components(self._editor.committed, components)
        self._editor.commit(session, f"Apply {applied_in_words(session.settings)}")
        self._editor.look(overlay=True)

    def _preview(self, blend: float) -> None:
        # What is hidden cannot be seen to change.
        self._editor.look(overlay=True)
        self._editor.preview(edits.set_blend(self._editor.committed, blend))

    def _blend(self, blend: float, is_step: bool) -> None:
        session = edits.set_blend(self._editor.committed, blend)
        # Many steps of the keyboard are one to undo.
        self._editor.commit(session, f"Blend {blend:.0%}", "blend" if is_step else None)
        self._editor.look(overlay=True)

    def _play(self, wanted: bool) -> None:
        if wanted:
            self._editor.look(overlay=True)
            self.player.play()
        else:
            self.player.stop()

    def _copy(self) -> None:
        quality = self._quality.quality
        if quality is not None:
            table = figures_table(quality, self._editor.committed.unit)
            QGuiApplication.clipboard().setText(table)
            self._say("Copied the figures for a spreadsheet.")
