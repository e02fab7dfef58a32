"""Compares the penalty with the previous one: for as long as B is held, or by taking it back."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from qtpy.QtCore import Qt
from qtpy.QtGui import QKeySequence, QShortcut
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.penalty.passing_preview import PassingPreview
from pinwarp.gui.scene.drawables import Badge, Drawable
from pinwarp.gui.views.scenes import Scenes
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session

_NONE_YET = "There is no previous penalty yet: change the penalty, then hold B to compare."


class PenaltyTrail:
    """Remembers which penalty was committed before the present one, also by undo and redo.

    A penalty of another basis is another figure, and not remembered.

    Examples
    --------
    >>> editor = Editor()
    >>> trail = PenaltyTrail(editor)
    >>> for penalty in (1.0, 2.0):
    ...     editor.commit(edits.set_penalty(editor.committed, penalty), "Change penalty")
    ...     trail.follow()
    >>> trail.previous
    1.0
    >>> editor.undo()
    >>> trail.follow()
    >>> trail.previous
    2.0
    """

    def __init__(self, editor: Editor) -> None:
        self._editor = editor
        self._present = editor.committed.settings.penalty
        self._basis = editor.committed.settings.basis
        self.previous: float | None = None

    def follow(self) -> None:
        """Look at what is committed now."""
        editor, penalty = self._editor, self._editor.committed.settings.penalty
        basis = editor.committed.settings.basis
        if (editor.undo_label is None and editor.redo_label is None) or basis is not self._basis:
            # Another session: what was before it is nobody's previous penalty.
            self.previous = None
        elif penalty != self._present:
            self.previous = self._present
        self._present, self._basis = penalty, basis


class PenaltyComparison(Capability):
    """Shows the session at the previous penalty while B is held.

    Parameters
    ----------
    editor
        The truth.
    scenes
        Where it is said what is shown.
    say
        Shows a message in the status bar.
    window
        Where the key counts.
    """

    def __init__(
        self,
        editor: Editor,
        scenes: Scenes,
        say: Callable[[str], None],
        window: QWidget,
    ) -> None:
        self._editor = editor
        self._scenes = scenes
        self._badge = ""
        self._say = say
        self._trail = PenaltyTrail(editor)
        self._preview = PassingPreview(editor, window, Qt.Key.Key_B)
        self._preview.ended.connect(self._on_ended)
        self._key = QShortcut(QKeySequence(Qt.Key.Key_B), window)
        self._key.setAutoRepeat(False)
        self._key.activated.connect(self._on_held)
        self.actions = (
            Action(
                "swap_penalty",
                # Behind the tab stands the key that is held; the action itself has none.
                "Compare with &Previous Penalty\tB (hold)",
                self._swap,
                at="Warp.12",
                tip="Go back to the previous penalty; hold B only to look at it",
                possible=lambda: self._trail.previous is not None,
            ),
        )
        editor.session_changed.connect(self._on_session)
        self._on_session(editor.session)

    def shut_down(self) -> None:
        """Let go of the editor."""
        self._preview.shut_down()
        self._editor.session_changed.disconnect(self._on_session)

    def _on_session(self, _session: Session) -> None:
        self._trail.follow()
        self.actions[0].renew()

    def _on_held(self) -> None:
        previous = self._trail.previous
        if previous is None:
            self._say(_NONE_YET)
        elif not self._editor.is_previewing:
            self._preview.show(edits.set_penalty(self._editor.committed, previous))
            settings = self._editor.committed.settings
            length = settings.penalty_ruler(self._editor.rulers.session).text(previous, 3)
            self._show_badge(f"B: previous penalty {length} (hold)")

    def _on_ended(self) -> None:
        self._show_badge("")

    def _show_badge(self, words: str) -> None:
        self._badge = words
        self._scenes.renew()

    def drawables(self, side: Side) -> Iterator[Drawable]:
        """Return what says that this is not the present penalty."""
        if self._badge and side is Side.DESTINATION:
            yield Badge(self._badge)

    def _swap(self) -> None:
        if self._trail.previous is not None:
            session = edits.set_penalty(self._editor.committed, self._trail.previous)
            self._editor.commit(session, "Go back to previous penalty")
