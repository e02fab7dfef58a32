"""Undo and redo, named by what they take back."""

from __future__ import annotations

from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.session.editor import Editor


class Undoing(Capability):
    """The editor's history in the Edit menu.

    Parameters
    ----------
    editor
        Whose history it is.
    """

    def __init__(self, editor: Editor) -> None:
        self._editor = editor
        self.undo = Action(
            "undo",
            "&Undo",
            editor.undo,
            at="Edit.11 tools.21",
            keys="Ctrl+Z",
            icon="undo",
            possible=lambda: editor.undo_label is not None,
        )
        self.redo = Action(
            "redo",
            "&Redo",
            editor.redo,
            at="Edit.12 tools.22",
            # A second habit for the same thing.
            keys="Ctrl+Shift+Z Ctrl+Y",
            icon="redo",
            possible=lambda: editor.redo_label is not None,
        )
        self.actions = (
            self.undo,
            self.redo,
            Action("select_none", "Select &None", editor.select, at="Edit.81", keys="Esc"),
        )
        self._signals = (editor.session_changed, editor.saved)
        for signal in self._signals:
            signal.connect(self._on_change)
        self._on_change()

    def shut_down(self) -> None:
        """Let go of the editor."""
        for signal in self._signals:
            signal.disconnect(self._on_change)

    def _on_change(self, _changed: object = None) -> None:
        editor = self._editor
        if editor.is_previewing:
            # What can be undone is about the committed session: a drag need not wait for it.
            return
        for action, verb, label in (
            (self.undo, "&Undo", editor.undo_label),
            (self.redo, "&Redo", editor.redo_label),
        ):
            action.reword(f"{verb} {label}" if label else verb)
