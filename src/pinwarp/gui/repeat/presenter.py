"""Landmark precision: the dialog, what it measures, and what becomes of that in the session."""

from __future__ import annotations

import numpy as np
from qtpy.QtWidgets import QWidget

from pinwarp.core.lengths import Ruler
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.repeat.dialog import PrecisionDialog
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.gui.tasks.file_tasks import LANDMARK_FILES, FileTasks
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.session.editor import Editor
from pinwarp.session.repeat.comparing import Repeats
from pinwarp.session.repeat.level import with_penalty, with_spreads_of, without_spreads
from pinwarp.session.repeat.measuring import Asked, Measured, measured
from pinwarp.session.repeat.spreads import has_spreads
from pinwarp.session.rulers import ruler_of
from pinwarp.session.session import Session


class LandmarkPrecision(Capability):
    """Asks for repeats, and brings into the session what they say.

    Parameters
    ----------
    editor
        The truth.
    tasks
        Asks for files, and says what was done.
    window
        Over which the dialog stands.
    """

    def __init__(self, editor: Editor, tasks: FileTasks[Dialogs], window: QWidget) -> None:
        self._editor, self._tasks, self._window = editor, tasks, window
        self._measure = LatestWins(_measured)
        self._measure.computed.connect(self._on_measured)
        self._measure.failed.connect(self._on_failure)
        self._asked: Asked | None = None
        self._measured: Measured | None = None
        self.dialog: PrecisionDialog | None = None
        self.actions = (
            Action(
                "landmark_precision",
                "Landmark Prec&ision…",
                self.ask,
                at="Place.51",
                tip="How far apart landmarks come to lie when they are digitised again",
            ),
            Action(
                "remove_spreads",
                "Remove Sprea&ds",
                self.remove_spreads,
                at="Place.52",
                tip="Forget how precise the landmarks are",
                possible=lambda: has_spreads(editor.committed),
            ),
        )

    @property
    def is_settled(self) -> bool:
        """Whether what was asked for is shown."""
        return self._measure.is_idle

    def shut_down(self) -> None:
        """Close the dialog and let go of the worker."""
        if self.dialog is not None:
            self.dialog.close()
        self._measure.shut_down()

    def ask(self) -> None:
        """Open the dialog."""
        dialog = PrecisionDialog(self._window)
        dialog.asked_for.connect(self._on_asked)
        dialog.files_wanted.connect(self._on_files)
        dialog.penalty_wanted.connect(self._use_penalty)
        dialog.keep_wanted.connect(self._keep)
        dialog.finished.connect(self._on_finished)
        self.dialog, self._asked, self._measured = dialog, None, None
        self._renew()
        dialog.open()

    def remove_spreads(self) -> None:
        """Forget how precise the landmarks are."""
        self._editor.commit(without_spreads(self._editor.committed), "Remove spreads")

    def _on_finished(self) -> None:
        self.dialog = self._measured = None

    def _on_files(self) -> None:
        title = "Landmarks that were digitised again"
        paths = self._tasks.dialogs.ask_open_many(title, LANDMARK_FILES, self._tasks.folder())
        if self.dialog is not None and paths:
            self.dialog.add_files(paths)

    def _on_asked(self, asked: Asked) -> None:
        self._asked, self._measured = asked, None
        self._measure.request((self._editor.committed, asked))

    def _on_measured(self, found: Measured) -> None:
        # The dialog may have been closed meanwhile, and opened anew.
        if self.dialog is None or found.asked is not self._asked:
            return
        self._measured = found
        self.dialog.show_measured(found, self._ruler_of(found.repeats), self._editor.rulers.session)
        self._renew()

    def _ruler_of(self, repeats: Repeats | None) -> Ruler:
        """Return how the lengths of repeats are told, which may be in a unit of their own."""
        session, view = self._editor.committed, self._editor.view
        if repeats is None or repeats.unit in ("", session.unit):
            return self._editor.rulers.session
        reach = float(np.nanmax(np.abs(repeats.places), initial=0.0))
        return ruler_of(repeats.unit, reach, view.lengths)

    @staticmethod
    def _on_failure(error: Exception) -> None:
        raise error

    def _renew(self) -> None:
        """Offer what would change the session."""
        found, session = self._measured, self._editor.committed
        if self.dialog is None:
            return
        use = found is not None and found.penalty is not None
        keep = found is not None and found.repeats is not None
        self.dialog.show_possible(
            use=use and self._with_penalty(session).settings != session.settings,
            keep=keep,
        )

    def _with_penalty(self, session: Session) -> Session:
        found = self._measured
        if found is None or found.penalty is None:
            return session
        return with_penalty(session, found.penalty.penalty)

    def _use_penalty(self) -> None:
        self._editor.commit(
            self._with_penalty(self._editor.committed), "Use the penalty for the noise"
        )
        self._renew()

    def _keep(self) -> None:
        found = self._measured
        if found is None or found.repeats is None or self.dialog is None:
            return
        repeats, side = found.repeats, found.asked.side
        problem = self._editor.attempt(
            lambda session: with_spreads_of(session, side, repeats), "Keep spreads"
        )
        words = problem or f"The spreads of the {side.value} are kept with the session"
        self._tasks.said.emit(words)
        self.dialog.say(words)
        self._renew()


def _measured(request: tuple[Session, Asked]) -> Measured:
    return measured(*request)
