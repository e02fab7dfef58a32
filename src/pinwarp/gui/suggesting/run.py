"""One first guess under way in a worker."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from qtpy.QtCore import QObject, Signal

from pinwarp.core.first_guess import FirstGuess, Verdict
from pinwarp.core.landmarks import Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.pose import PoseSettings
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.scene.drawables import OverlayWarp
from pinwarp.gui.suggesting.pictures import drawn_reading
from pinwarp.gui.tasks.jobs import SlowJob
from pinwarp.session.session import Session
from pinwarp.session.suggesting import SuggestInputs, suggest

Progress = Callable[[float, str], None]


@dataclass(frozen=True, eq=False)
class Meshes:
    """The two meshes that a guess is about: one of other meshes is of no use."""

    source: Mesh | None
    destination: Mesh | None

    @classmethod
    def of(cls, session: Session) -> Meshes:
        """Return those of a session."""
        return cls(session.mesh(Side.SOURCE), session.mesh(Side.DESTINATION))

    def are_those_of(self, session: Session) -> bool:
        """Whether they are the very meshes of a session."""
        return (
            session.mesh(Side.SOURCE) is self.source
            and session.mesh(Side.DESTINATION) is self.destination
        )


@dataclass(frozen=True, eq=False)
class Guessed:
    """A first guess, of which meshes and how it was asked for.

    ``drawn`` are its readings as they are pictured where one must be chosen.
    """

    guess: FirstGuess
    meshes: Meshes
    settings: PoseSettings
    drawn: tuple[OverlayWarp, ...] = ()


@dataclass(frozen=True, eq=False)
class _Task:
    session: Session
    meshes: Meshes
    settings: PoseSettings


class GuessRun(QObject):
    """Makes a first guess of a session at a time; the session is not changed.

    ``progressed`` emits the share done and words, ``found`` a :class:`Guessed`, ``failed`` an
    error; ``ended`` comes after each of them, and once what was cancelled has stopped.

    Parameters
    ----------
    surfaces
        Where meshes become surfaces.
    parent
        The window.
    """

    progressed = Signal(float, str)
    found = Signal(object)
    failed = Signal(object)
    ended = Signal()

    def __init__(self, surfaces: Surfaces, parent: QObject) -> None:
        super().__init__(parent)
        self._surfaces = surfaces
        self._jobs = SlowJob(self)
        self._jobs.progressed.connect(self._on_progress)
        self._wanted: _Task | None = None
        self._running: _Task | None = None

    def shut_down(self) -> None:
        """Cancel what is under way and wait for it."""
        self._wanted = None
        self._jobs.shut_down()

    @property
    def is_idle(self) -> bool:
        """Whether nothing is under way, nor stopping."""
        return self._wanted is None and self._jobs.is_idle

    @property
    def is_wanted(self) -> bool:
        """Whether something is under way that was not cancelled."""
        return self._wanted is not None

    def begin(self, session: Session, settings: PoseSettings) -> None:
        """Guess for a session, and no longer for any before it."""
        self._wanted = _Task(session, Meshes.of(session), settings)
        if self._running is None:
            self._start(self._wanted)
        else:
            self._jobs.cancel()

    def cancel(self) -> bool:
        """Stop; say whether there was anything to be stopped."""
        was_wanted, self._wanted = self.is_wanted, None
        self._jobs.cancel()
        return was_wanted

    def follow(self, session: Session) -> bool:
        """Stop where the meshes are others now; say whether it was stopped."""
        task = self._wanted
        return task is not None and not task.meshes.are_those_of(session) and self.cancel()

    def _start(self, task: _Task) -> None:
        self._running = task
        inputs = SuggestInputs.of(task.session)

        def work(progress: Progress) -> Guessed:
            guess = suggest(inputs, task.settings, progress=progress)
            is_asked = guess.verdict is Verdict.ASK and task.meshes.source is not None
            drawn = (
                tuple(
                    drawn_reading(reading, self._surfaces.of(task.meshes.source))
                    for reading in guess.readings
                )
                if is_asked and task.meshes.source is not None
                else ()
            )
            return Guessed(guess, task.meshes, task.settings, drawn)

        self._jobs.run(
            "",
            work,
            lambda guessed: self._on_end(task, self.found, guessed),
            lambda error: self._on_end(task, self.failed, error),
        )

    def _on_progress(self, share: float, stage: str) -> None:
        if self._wanted is self._running:
            self.progressed.emit(share, stage)

    def _on_end(self, task: _Task, signal: Signal, came: object) -> None:
        self._running = None
        if self._wanted is task:
            self._wanted = None
            signal.emit(came)
        elif self._wanted is not None:
            self._start(self._wanted)
            return
        self.ended.emit()
