"""What the Edit menu does to whole bones: swapping the sides, mirroring the source."""

from __future__ import annotations

from collections.abc import Mapping

from qtpy.QtCore import QObject
from qtpy.QtGui import QAction

from pinwarp.core.landmarks import Side
from pinwarp.core.mirror import AXES
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session


class BoneEdits(QObject):
    """Wires the actions that change a whole side.

    Parameters
    ----------
    editor
        The truth.
    actions
        By their keys.
    parent
        The window.
    """

    def __init__(self, editor: Editor, actions: Mapping[str, QAction], parent: QObject) -> None:
        super().__init__(parent)
        self._editor = editor
        self._swap = actions["swap_sides"]
        self._swap.triggered.connect(lambda _checked=False: self.swap())
        self._mirrors = {axis: actions[f"mirror_{axis}"] for axis in AXES}
        for axis, action in self._mirrors.items():
            action.triggered.connect(lambda _checked=False, axis=axis: self.mirror(axis))
        editor.session_changed.connect(self._on_session)
        self._on_session(editor.session)

    def shut_down(self) -> None:
        """Let go of the editor."""
        self._editor.session_changed.disconnect(self._on_session)

    def _on_session(self, session: Session) -> None:
        self._swap.setEnabled(any(session.mesh_file(side) is not None for side in Side))
        for action in self._mirrors.values():
            action.setEnabled(session.mesh(Side.SOURCE) is not None)

    def swap(self) -> None:
        """Warp the other way round."""
        session = edits.swap_sides(self._editor.committed)
        self._editor.commit(session, "Swap source and destination")

    def mirror(self, axis: str) -> None:
        """Make a left source a right one."""
        session = edits.mirror_source(self._editor.committed, axis)
        self._editor.commit(session, f"Mirror source across {axis}")
