"""One refinement, or one check of it, under way in a worker."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from qtpy.QtCore import QObject, Signal

from pinwarp.core.errors import Cancelled
from pinwarp.core.refinement import Level, Refinement
from pinwarp.gui.refining import words
from pinwarp.gui.refining.relay import LevelRelay
from pinwarp.gui.tasks.jobs import SlowJob
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session
from pinwarp.session.warp.refined import inputs_of
from pinwarp.session.warp.refining import (
    RefinementOptions,
    Verification,
    record_at,
    refined_session,
    verified,
)

Progress = Callable[[float, str], None]


@dataclass(frozen=True, eq=False)
class _Task:
    session: Session
    inputs: str
    is_check: bool


@dataclass(frozen=True, eq=False)
class Checked:
    """What a check found, and of which refinement."""

    refinement: RefinementRecord | None
    worth: Verification


class RefiningRun(QObject):
    """Refines the editor's session: nothing is changed before it is done, and then in one step.

    ``progressed`` emits words and the share done, ``level_changed`` that another level (or none)
    is to be shown, ``checked`` what a check found, ``refused`` an error that is the user's to
    mend, ``idled`` that nothing is under way any more.

    Parameters
    ----------
    editor
        The truth: an edit of what a refinement depends on cancels it.
    jobs
        The worker.
    say
        Shows a message in the status bar.
    parent
        The window.
    """

    progressed = Signal(str, float)
    level_changed = Signal()
    checked = Signal(object)
    refused = Signal(object)
    idled = Signal()

    def __init__(
        self, editor: Editor, jobs: SlowJob, say: Callable[[str], None], parent: QObject
    ) -> None:
        super().__init__(parent)
        self._editor, self._jobs, self._say = editor, jobs, say
        self._relay = LevelRelay(jobs, self)
        self._task: _Task | None = None
        self._found: RefinementRecord | None = None
        self.level: RefinementRecord | None = None
        self._relay.reached.connect(self._on_level)
        jobs.progressed.connect(self._on_progress)

    def shut_down(self) -> None:
        """Forget what is under way."""
        self._task = self._found = None

    @property
    def is_idle(self) -> bool:
        """Whether nothing is under way."""
        return self._task is None and self._jobs.is_idle

    def refine(self, options: RefinementOptions) -> None:
        """Begin to refine the session as it is."""
        session = self._editor.committed

        def work(progress: Progress) -> tuple[Session, Refinement]:
            return refined_session(session, options, told=self._relay.tell, progress=progress)

        self._begin(session, work, self._on_refined)

    def check(self) -> None:
        """Begin to find out what the refinement of the session is worth."""
        session = self._editor.committed

        def work(progress: Progress) -> Checked:
            return Checked(session.refinement, verified(session, progress=progress))

        self._begin(session, work, self._on_checked, is_check=True)

    def _begin(
        self,
        session: Session,
        work: Callable[[Progress], Any],
        done: Callable[[Any], None],
        *,
        is_check: bool = False,
    ) -> None:
        self._task = _Task(session, inputs_of(session), is_check)
        stage = words.CHECKING if is_check else words.STARTING
        self.progressed.emit(stage, 0.0)
        self._jobs.run(stage, work, done, self._on_failed)

    def cancel(self) -> None:
        """Stop at the next turn, and keep the start."""
        self._jobs.cancel()

    def follow(self, session: Session) -> None:
        """Look at a session that was committed: what does not belong to it is given up."""
        task = self._task
        if task is not None and task.inputs != inputs_of(session):
            self._task = self._found = None
            self.cancel()
            self._set_level(None)
            self._say(words.CHECK_CHANGED if task.is_check else words.CHANGED)
        self._finish()

    def drawn(self, refinement: RefinementRecord | None) -> None:
        """Say what is on the screen: the next level waits for the last."""
        if refinement is not None and refinement == self.level:
            self._relay.drawn()

    # What comes from the worker

    def _on_progress(self, share: float, stage: str) -> None:
        if self._task is not None:
            # What is said of a level stays until the next one is drawn.
            told = stage.capitalize() if self._task.is_check else ""
            self.progressed.emit(told, share)

    def _on_level(self, level: Level) -> None:
        task = self._task
        if task is None:
            return
        stage = words.level_in_words(level, self._editor.rulers.session)
        self.progressed.emit(stage, level.number / level.count)
        self._set_level(record_at(task.session, level))

    def _on_refined(self, refined: tuple[Session, Refinement]) -> None:
        if self._task is not None:
            self._found = refined[0].refinement
        self._finish()

    def _finish(self) -> None:
        """Keep what was found, once nothing is under the user's hand."""
        if self._found is None or self._editor.is_previewing:
            self._tell_idle()
            return
        found, self._found, self._task = self._found, None, None
        # First what is shown, so that the landmarks' warp does not flash up in between.
        self._set_level(found)
        session = edits.set_refinement(self._editor.committed, found)
        self._editor.commit(session, "Refine to surface")
        self._set_level(None)
        self._tell_idle()

    def _on_checked(self, checked: Checked) -> None:
        if self._task is not None:
            self._task = None
            self.checked.emit(checked)
        self._tell_idle()

    def _on_failed(self, error: Exception) -> None:
        task, self._task = self._task, None
        self._set_level(None)
        self._tell_idle()
        if task is None:
            # An edit has ended it, and said so.
            return
        if isinstance(error, Cancelled):
            self._say(words.CHECK_CANCELLED if task.is_check else words.CANCELLED)
        else:
            self.refused.emit(error)

    def _set_level(self, level: RefinementRecord | None) -> None:
        if level is not self.level:
            self.level = level
            self.level_changed.emit()

    def _tell_idle(self) -> None:
        if self.is_idle:
            self.idled.emit()
