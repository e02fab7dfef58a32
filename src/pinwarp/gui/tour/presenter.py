"""The tour of the sample bones: begun, noticed step by step, left and taken up again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from qtpy.QtCore import QSettings
from qtpy.QtWidgets import QWidget

from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.exporting.exports import Exports
from pinwarp.gui.tour.bar import TourBar, TourOffer
from pinwarp.gui.tour.steps import STEPS, is_of_tour
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session

_REMEMBERED = "tour"
_END = (
    "<b>That was the tour.</b> The bones are yours to try things on. {user_guide} opens the user "
    "guide, {shortcuts} shows all keys."
)


class Tour(Capability):
    """Asks for one step after the other, and notices when it is done.

    Parameters
    ----------
    editor
        In whose session the steps are done.
    exports
        Where the last one is.
    view
        What is empty at first.
    open_sample
        Opens the sample bones, and calls back once they are there.
    keys
        Returns the shortcut of an action, by its key.
    say
        Says a sentence in passing.
    """

    def __init__(
        self,
        editor: Editor,
        exports: Exports,
        view: QWidget,
        open_sample: Callable[[Callable[[], None]], None],
        keys: Callable[[str], str],
        say: Callable[[str], None],
    ) -> None:
        self._editor = editor
        self._exports = exports
        self._open_sample = open_sample
        self._keys = keys
        self._say = say
        # How many steps are done, and the sessions before the step and as it began.
        self._done = 0
        self._begun: tuple[Session, Session] | None = None
        self.bar = TourBar()
        self.above = (self.bar,)
        self.offer = TourOffer(view)
        self.action = Action(
            "tour",
            "Take the &Tour",
            self.take,
            at="Help.13",
            tip="Five steps on the sample bones that you do, not read",
        )
        self.actions = (self.action,)
        self.bar.skip_requested.connect(self._skip)
        self.bar.left.connect(self.leave)
        self.offer.clicked.connect(lambda _checked: self.take())
        editor.session_changed.connect(self._on_session)
        exports.exported.connect(self._on_exported)
        self._show_offer()

    def shut_down(self) -> None:
        """Let go of the editor."""
        self._editor.session_changed.disconnect(self._on_session)
        self._exports.exported.disconnect(self._on_exported)

    def remember(self, settings: QSettings) -> None:
        """Note how many steps are done."""
        settings.setValue(_REMEMBERED, self._done)

    def recall(self, settings: QSettings) -> None:
        """Go on where it was left."""
        stored = str(settings.value(_REMEMBERED, 0))
        self._done = min(int(stored), len(STEPS)) if stored.isdecimal() else 0
        self._show_offer()

    @property
    def is_under_way(self) -> bool:
        """Whether a step is asked for."""
        return self._begun is not None

    def take(self) -> None:
        """Begin, or go on where it was left; the sample bones are opened where they are not."""
        if self._done == len(STEPS):
            self._done = 0
        if is_of_tour(self._editor.committed):
            self._begin_step(fresh=False)
        else:
            self._open_sample(lambda: self._begin_step(fresh=True))

    def leave(self) -> None:
        """Stop asking; what was done stays."""
        self._begun = None
        self.bar.hide()

    def _begin_step(self, *, fresh: bool) -> None:
        """Ask for the next step; in a session that was just opened nothing is to be undone."""
        if self._done == len(STEPS):
            self._begun = None
            self.bar.show_step(self._words(_END), self._done, self._done)
            return
        editor, step = self._editor, STEPS[self._done]
        before = editor.committed
        prepared = step.prepare(before)
        self._begun = (before, prepared)
        self.bar.show_step(self._words(step.words), self._done, len(STEPS))
        if prepared != before and fresh:
            editor.replace_all(prepared, None)
        elif prepared != before:
            editor.commit(prepared, "Prepare the tour's step")

    def _words(self, words: str) -> str:
        names = ("accept_ghost", "undo", "export_mesh", "user_guide", "shortcuts")
        return words.format(**{name: self._keys(name) for name in names if f"{{{name}}}" in words})

    def _on_session(self, session: Session) -> None:
        self._show_offer()
        if self._begun is None or self._editor.is_previewing:
            return
        if not is_of_tour(session):
            # Something else was opened: it is taken up again by its action.
            self.leave()
        elif STEPS[self._done].is_done(*self._begun, session):
            self._finish_step()

    def _on_exported(self, _path: Path) -> None:
        if self._begun is not None and self._done == len(STEPS) - 1:
            self._finish_step()

    def _finish_step(self) -> None:
        # Before the next one is prepared, which changes the session.
        self._begun = None
        self._say(f"Done: {STEPS[self._done].done}")
        self._done += 1
        self._begin_step(fresh=False)

    def _skip(self) -> None:
        if self._begun is not None:
            self._begun = None
            self._done += 1
            self._begin_step(fresh=False)

    def _show_offer(self) -> None:
        session = self._editor.session
        is_empty = session.source is None and session.destination is None and not session.landmarks
        begun = 0 < self._done < len(STEPS)
        words = f"Go On With the Tour ({self._done} of {len(STEPS)} done)" if begun else ""
        wanted = is_empty and self._done < len(STEPS)
        self.offer.offer((words or "Take the Tour") if wanted else "")
