"""A monkey at a real window, and what must hold after each step and every hundred steps."""

from __future__ import annotations

import gc
import os
import random
import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from qtpy.QtCore import QEvent, QObject
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication
from tests.gui.monkey.answers import Answers
from tests.gui.monkey.files import Files
from tests.gui.monkey.hands import Hands
from tests.gui.monkey.memory import WARM_AFTER, Held, grown, held, leave_everything, warm_up
from tests.gui.monkey.watch import Events, Watch
from vtkmodules.vtkCommonCore import vtkObjectBase

from pinwarp.gui.window.main_window import MainWindow
from pinwarp.io.work_file import read_work
from pinwarp.session.keeping.journal import WORK
from pinwarp.session.session import Session, to_record

CHECK_EVERY = 100
# Events after which what it began with is opened again, to see what is held of all the rest.
REOPEN_EVERY = 1000
LAST = 30
# Long: these machines are busy.
SETTLE_SECONDS = 120
JOURNAL_SECONDS = 30
# More than at the start; what is open differs, but nothing may add up.
MOST_MORE = {"top_level": 20, "objects": 300, "vtk": 40}


@dataclass(frozen=True)
class Figures:
    """What is counted at a check."""

    step: int
    events: int
    top_level: int
    objects: int
    vtk: int
    undo_steps: int
    landmarks: int


class Broken(AssertionError):
    """Something did not hold; the message says how to see it again."""


class Monkey:
    """Plays with a window, watched.

    Parameters
    ----------
    open_window
        Opens an empty window; called again when the monkey has closed it.
    begin
        Opens the bones in it.
    state_folder
        Where that window keeps its unsaved work.
    folder
        Where the monkey's files are made.
    seed
        Of all that is random.
    reopen_every
        So many events.
    """

    def __init__(
        self,
        open_window: Callable[[], MainWindow],
        begin: Callable[[MainWindow], None],
        state_folder: Path,
        folder: Path,
        seed: int,
        reopen_every: int = REOPEN_EVERY,
    ) -> None:
        self._open_window = open_window
        self._begin = begin
        self._reopen_every = reopen_every
        self._windows = state_folder / "windows"
        self._seed = seed
        self._rng = random.Random(seed)
        self._steps: deque[str] = deque(maxlen=LAST)
        self._log = folder / "vtk.log"
        self._watch = Watch(str(self._log))
        self.files = Files(folder / "files", random.Random(seed))
        self.answers = Answers(self.files, lambda: self._rng)
        self._hands = Hands(lambda: self.window, self.files, self.answers)
        self._events = Events()
        self._start: Session | None = None
        self.figures: list[Figures] = []
        self.held: list[Held] = []
        self._next_look = reopen_every
        self._is_long = False
        self._open_anew()
        self._size = self.window.size()

    def play(self, events: int) -> None:
        """Do random things, until so many events; raise :class:`Broken` at the first that breaks.

        A step is a gesture of one event or many, such as a drag.
        """
        with self._watch:
            QApplication.instance().installEventFilter(self._events)
            try:
                self._is_long = events > WARM_AFTER
                self._warm_up()
                self._size = self.window.size()
                self._look()
                start = self._count(0, 0)
                print(start, flush=True)
                number = 0
                while self._events.count < events:
                    number += 1
                    self._step(number)
                    if number % CHECK_EVERY == 0 or self._events.count >= events:
                        self._check(number, start)
                    if self._events.count >= min(events, self._next_look):
                        self._look()
                        self._nothing_seen(number)
            finally:
                QApplication.instance().removeEventFilter(self._events)
                self.answers.stop()

    def _step(self, number: int) -> None:
        # Of its own for each step: what one of them draws does not shift those after it.
        self._rng = random.Random(f"{self._seed} {number}")
        self.answers.given.clear()
        self._steps.append(f"{number}: …")
        try:
            said = self._hands.act(self._rng)
            self._steps[-1] = f"{number}: {said}"
        except Exception as error:  # a virtual method of a widget may hand it through
            self._watch.note(error)
        for _ in range(2):
            QApplication.processEvents()
        # Most users wait a moment; some do not.
        if self._rng.random() < 0.6:
            self._settle()
        self._steps[-1] = "; ".join((self._steps[-1], *self.answers.given))
        self._nothing_seen(number)
        if not self.window.isVisible():
            self.window.deleteLater()
            self._delete_deferred()
            self._open_anew()
            self._warm_up()
            self._steps.append("   opened anew")

    def _open_anew(self) -> None:
        self._opened_at = self._events.count
        self.window = self._open_window()
        self.window.editor.saved.connect(self._on_saved)
        self._open_bones()

    def _open_bones(self) -> None:
        editor = self.window.editor
        self._begin(self.window)
        self._settle()
        # What was opened step by step is where the monkey begins.
        editor.replace_all(editor.committed, None)
        self._settle()

    def _warm_up(self) -> None:
        if self._is_long:
            warm_up(self.window, self._settle)

    def _on_saved(self) -> None:
        editor = self.window.editor
        if editor.undo_label is None and editor.redo_label is None:
            self._start = editor.committed

    # What must hold

    def _require(self, holds: bool, words: str) -> None:
        if not holds:
            last = "\n  ".join(self._steps)
            raise Broken(f"{words}\nPINWARP_MONKEY_SEED={self._seed}, the last steps:\n  {last}")

    def _nothing_seen(self, number: int) -> None:
        seen = self._watch.take()
        if self._log.exists() and self._log.stat().st_size:
            seen.append(f"VTK says: {self._log.read_text()}")
        self._require(not seen, f"step {number}: " + "\n".join(seen))

    def _settle(self) -> None:
        self._wait(
            lambda: self.window.is_settled and not self.answers.is_asked(),
            SETTLE_SECONDS,
            lambda: f"the window does not settle: {self._unsettled()}",
        )

    def _unsettled(self) -> str:
        window = self.window
        busy = [name for name, part in vars(window.parts).items() if not part.is_settled]
        busy += [name for name in ("jobs", "stepped") if not getattr(window, name).is_idle]
        asking = QApplication.activePopupWidget() or QApplication.activeModalWidget()
        return f"{busy}, asked by {asking}"

    def _wait(
        self, condition: Callable[[], bool], seconds: float, words: Callable[[], str]
    ) -> None:
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                self._require(False, f"{words()}, for {seconds} s")
            QTest.qWait(2)

    def _check(self, number: int, start: Figures) -> None:
        self._settle()
        steps = self._history_holds()
        self._settle()
        self._journal_holds()
        figures = self._count(number, steps)
        self.figures.append(figures)
        print(figures, flush=True)
        self._nothing_seen(number)
        for what, more in MOST_MORE.items():
            before, now = getattr(start, what), getattr(figures, what)
            self._require(now <= before + more, f"{what} grew from {before} to {now}")

    def _look(self) -> None:
        """Open what it began with again, and see what is still held of all the rest."""
        self._settle()
        leave_everything(self.window)
        self._settle()
        self._open_bones()
        self._delete_deferred()
        self.held.append(
            held(self.window, self._events.count, self._opened_at, self._size, self._settle)
        )
        print(self.held[-1], flush=True)
        words = grown(self.held)
        self._require(not words, f"with the same open as in the beginning grew: {words}")
        self._next_look = self._events.count + self._reopen_every

    def _history_holds(self) -> int:
        """Undo all, redo all; return how many steps there were to undo."""
        editor = self.window.editor
        editor.cancel_preview()
        end, after = editor.committed, 0
        while editor.redo_label is not None:
            after += 1
            editor.redo()
        top, steps = editor.committed, 0
        while editor.undo_label is not None:
            steps += 1
            editor.undo()
        self._require(editor.committed == self._start, "undoing all leads elsewhere than the start")
        while editor.redo_label is not None:
            editor.redo()
        self._require(editor.committed == top, "redoing all leads elsewhere than the end")
        for _ in range(after):
            editor.undo()
        self._require(editor.committed == end, "undo and redo lead elsewhere")
        return steps

    def _journal_holds(self) -> None:
        editor = self.window.editor
        wanted = to_record(editor.committed) if editor.is_dirty else None

        def kept() -> bool:
            works = list(self._windows.glob(f"*/{WORK}"))
            if wanted is None or len(works) != 1:
                return wanted is None and not works
            return read_work(works[0]).record == wanted

        self._wait(kept, JOURNAL_SECONDS, lambda: "the disk does not hold the session")

    def _count(self, number: int, undo_steps: int) -> Figures:
        self._delete_deferred()
        gc.collect()
        things = Counter(type(t).__name__ for t in gc.get_objects() if isinstance(t, vtkObjectBase))
        tops = QApplication.topLevelWidgets()
        if os.environ.get("PINWARP_MONKEY_KINDS"):
            kinds = Counter(type(o).__name__ for t in tops for o in (t, *t.findChildren(QObject)))
            print(kinds.most_common(25), things.most_common(12), [type(t).__name__ for t in tops])
        return Figures(
            step=number,
            events=self._events.count,
            top_level=len(tops),
            objects=sum(1 + len(top.findChildren(QObject)) for top in tops if top.parent() is None),
            vtk=sum(things.values()),
            undo_steps=undo_steps,
            landmarks=len(self.window.editor.committed.landmarks),
        )

    @staticmethod
    def _delete_deferred() -> None:
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        QApplication.processEvents()
