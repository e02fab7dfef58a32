"""What of the warp is applied: asked for in the menu, said in the status bar."""

from __future__ import annotations

from collections.abc import Mapping

from qtpy.QtCore import QObject
from qtpy.QtGui import QAction, QActionGroup
from qtpy.QtWidgets import QLabel

from pinwarp.core.components import Components
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.exports import applied_in_words

COMPONENT_ACTIONS = {part: f"apply_{part.name.lower()}" for part in Components}


class WarpPresenter(QObject):
    """Wires the editor to what shows and changes the applied warp.

    Parameters
    ----------
    editor
        The truth.
    actions
        The window's actions by key.
    parent
        The window.
    """

    def __init__(self, editor: Editor, actions: Mapping[str, QAction], parent: QObject) -> None:
        super().__init__(parent)
        self._editor = editor
        self._actions = actions
        self.note = QLabel()
        choices = QActionGroup(self)
        for part, key in COMPONENT_ACTIONS.items():
            choices.addAction(actions[key])
            actions[key].triggered.connect(lambda _checked=False, part=part: self._apply(part))
        editor.session_changed.connect(self._on_session)
        self._on_session()

    def shut_down(self) -> None:
        """Let go of the editor."""
        self._editor.session_changed.disconnect(self._on_session)

    def _on_session(self, _changed: object = None) -> None:
        session = self._editor.session
        self._actions[COMPONENT_ACTIONS[session.components]].setChecked(True)
        # What is not the whole warp must not be taken for it, here or in a file.
        whole = session.components is Components.FULL and session.blend == 1
        self.note.setText("" if whole else f"Shown and exported: {applied_in_words(session)}")

    def _apply(self, components: Components) -> None:
        session = edits.set_components(self._editor.committed, components)
        self._editor.commit(session, f"Apply {applied_in_words(session)}")
        self._editor.look(overlay=True)
