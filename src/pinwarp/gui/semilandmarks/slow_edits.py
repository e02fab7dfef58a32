"""Edits that take a while, made by a worker one after the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pinwarp.core.curves import PathFinder
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.core.mesh import Mesh
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session
from pinwarp.session.warp.sliding import Finders


@dataclass(frozen=True, eq=False)
class SlowEdit:
    """One of them.

    Parameters
    ----------
    edit
        Makes a session of another; called in the worker, with what finds ways over the source.
    label
        What undo calls it.
    merge_key
        Steps of one key are one to undo; and of those that wait only the last is made.
    done
        Called once it is committed.
    """

    edit: Callable[[Session, PathFinder], Session]
    label: str
    merge_key: str | None = None
    done: Callable[[], None] = lambda: None


@dataclass(frozen=True, eq=False)
class _Request:
    edit: SlowEdit
    base: Session
    mesh: Mesh


class SlowEdits:
    """Commits edits once they are made; where the session has changed meanwhile, made of that.

    Parameters
    ----------
    editor
        What is edited.
    finders
        Of ways over the source.
    say
        Says why one could not be made.
    """

    def __init__(self, editor: Editor, finders: Finders, say: Callable[[str], None]) -> None:
        self._editor = editor
        self._finders = finders
        self._say = say
        # With the bone that each was asked of.
        self._waiting: list[tuple[SlowEdit, Mesh | None]] = []
        self._worker = LatestWins(self._make)
        self._worker.computed.connect(self._on_made)
        self._worker.failed.connect(self._on_failure)
        editor.session_changed.connect(self._on_session)

    @property
    def is_idle(self) -> bool:
        """Whether nothing is under way, but for what waits until the hand lets go."""
        return self._worker.is_idle and (not self._waiting or self._editor.is_previewing)

    def ask(self, edit: SlowEdit) -> None:
        """Make an edit behind those that wait already."""
        if self._waiting:
            # The first of them is under way: it is made to its end.
            first, *others = self._waiting
            key = edit.merge_key
            kept = (x for x in others if key is None or x[0].merge_key != key)
            self._waiting = [first, *kept]
        self._waiting.append((edit, self._editor.committed.mesh(Side.SOURCE)))
        self._begin()

    def shut_down(self) -> None:
        """Forget what waits."""
        self._waiting.clear()
        self._editor.session_changed.disconnect(self._on_session)
        self._worker.shut_down()

    def _begin(self) -> None:
        """Begin the first, unless one is under way, or the hand is."""
        if not self._worker.is_idle or not self._waiting or self._editor.is_previewing:
            return
        base = self._editor.committed
        mesh = base.mesh(Side.SOURCE)
        # What was asked of another bone means nothing on this one.
        self._waiting = [x for x in self._waiting if mesh is not None and x[1] is mesh]
        if mesh is not None and self._waiting:
            self._worker.request(_Request(self._waiting[0][0], base, mesh))

    def _make(self, request: _Request) -> tuple[_Request, Session | PinwarpError]:
        """Make it; runs in the worker."""
        try:
            finder = self._finders.of(Side.SOURCE, request.mesh)
            return request, request.edit.edit(request.base, finder)
        except PinwarpError as error:
            return request, error

    def _on_made(self, made: tuple[_Request, Session | PinwarpError]) -> None:
        request, outcome = made
        if not self._waiting or self._waiting[0][0] is not request.edit:
            self._begin()
            return
        if self._editor.committed is not request.base or self._editor.is_previewing:
            # Once more, of what the session is by now.
            self._begin()
            return
        self._waiting.pop(0)
        if isinstance(outcome, PinwarpError):
            self._say(str(outcome))
        else:
            self._editor.commit(outcome, request.edit.label, request.edit.merge_key)
            request.edit.done()
        self._begin()

    def _on_session(self, _session: Session) -> None:
        self._begin()

    def _on_failure(self, error: Exception) -> None:
        self._waiting.clear()
        raise error
