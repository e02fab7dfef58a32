"""Suggest All: ghosts for all landmarks that the destination lacks, accepted one by one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from qtpy.QtCore import Qt, QTimer
from qtpy.QtWidgets import QWidget

from pinwarp.core.errors import PinwarpError
from pinwarp.core.first_guess import Verdict
from pinwarp.core.guessed import Reading
from pinwarp.core.landmarks import Side
from pinwarp.core.pose import Mirror, PoseSettings
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.placing.ghosts import Ghosts
from pinwarp.gui.placing.guidance import Guidance
from pinwarp.gui.placing.hand import Hand
from pinwarp.gui.suggesting import words
from pinwarp.gui.suggesting.asking import Asking
from pinwarp.gui.suggesting.bar import SuggestBar
from pinwarp.gui.suggesting.expected import Expected
from pinwarp.gui.suggesting.offer import Offer
from pinwarp.gui.suggesting.run import Guessed, GuessRun
from pinwarp.gui.views.canvas import Canvas
from pinwarp.gui.views.controls import ViewControls
from pinwarp.gui.views.scenes import Scenes
from pinwarp.session.editor import Editor
from pinwarp.session.guide import step_at
from pinwarp.session.session import Session
from pinwarp.session.suggesting import mirrored_first, why_not
from pinwarp.session.suggesting.guessing import known_pairs

# Nothing was changed for so long (ms): what was guessed is warped anew, to what was accepted.
REST_MS = 1500
# So many pairs tell the pose by themselves: it is not looked for again.
FEWEST_ANEW = 3


class Suggesting(Capability):
    """Everything between the first guess and the hand that accepts it.

    Parameters
    ----------
    editor
        The truth.
    ghosts
        Show what is expected, and know which is next.
    hand, guidance
        Accepts it, and says what a click does.
    views
        Both bones are seen from the same side, as far as a reading tells it.
    viewports, scenes
        Where it is shown.
    surfaces
        Where meshes become surfaces.
    say
        Says a sentence in passing.
    window
        Asks, and has the key that leaves.
    """

    def __init__(
        self,
        editor: Editor,
        ghosts: Ghosts,
        hand: Hand,
        guidance: Guidance,
        views: ViewControls,
        viewports: Mapping[Side, Canvas],
        scenes: Scenes,
        surfaces: Surfaces,
        say: Callable[[str], None],
        window: QWidget,
    ) -> None:
        self._editor, self._ghosts, self._hand = editor, ghosts, hand
        self._guidance, self._views = guidance, views
        self._destination, self._scenes, self._say = viewports[Side.DESTINATION], scenes, say
        self._problem: tuple[str, PoseSettings] | None = None
        self._told = ""
        self._offer = Offer(editor)
        self.expected = Expected(editor)
        self.asking = Asking(viewports, window)
        self.first = GuessRun(surfaces, window)
        self.anew = GuessRun(surfaces, window)
        self.rest = QTimer(window, singleShot=True, interval=REST_MS)
        self.bar = SuggestBar(window)
        self.above = (self.bar,)
        self.action = Action(
            "suggest_all",
            "Suggest A&ll",
            switches=lambda on: self.begin() if on else self.leave(),
            checked=lambda: self.is_on,
            at="Place.12",
            keys="Ctrl+G",
            tip="Show where all landmarks that the destination lacks may lie: each is accepted or "
            "put right by itself",
        )
        self.actions = (self.action,)
        self._connect()
        self._on_session()

    def _connect(self) -> None:
        editor, bar = self._editor, self.bar
        bar.suggest_requested.connect(self.begin)
        bar.part_requested.connect(self._begin_for_part)
        bar.closed.connect(self._decline)
        bar.left.connect(self.leave)
        self.asking.chosen.connect(self._take)
        self.asking.cancelled.connect(self._on_cancelled)
        self.first.progressed.connect(self.bar.show_busy)
        self.first.found.connect(self._on_found)
        self.first.failed.connect(self._on_failed)
        self.first.ended.connect(self._show)
        self.anew.found.connect(self._on_anew)
        self.anew.failed.connect(self._on_anew_failed)
        self.rest.timeout.connect(self._warp_anew)
        self._ghosts.follow(self.expected.ghosts)
        self._views.follow(self.expected.fit)
        editor.session_changed.connect(self._on_session)
        editor.selection_changed.connect(self._on_look)
        editor.view_changed.connect(self._on_look)

    def shut_down(self) -> None:
        """Stop what is under way and let go of the editor."""
        editor = self._editor
        editor.session_changed.disconnect(self._on_session)
        editor.selection_changed.disconnect(self._on_look)
        editor.view_changed.disconnect(self._on_look)
        self.rest.stop()
        self.asking.close()
        self.first.shut_down()
        self.anew.shut_down()

    @property
    def is_settled(self) -> bool:
        """Whether nothing is under way, nor waits for a rest."""
        return self.first.is_idle and self.anew.is_idle and not self.rest.isActive()

    @property
    def is_on(self) -> bool:
        """Whether ghosts are shown or on their way."""
        return self.first.is_wanted or self.asking.is_open or bool(self.expected.ghosts())

    # What the user asks for

    def begin(self, settings: PoseSettings | None = None) -> None:
        """Look for the places of all missing landmarks."""
        self._problem = None
        session = self._editor.committed
        reason = why_not(session)
        if reason:
            self._say(reason)
        else:
            self._offer.end()
            self.first.begin(session, settings or PoseSettings())
            self.bar.show_busy(0.0, words.STARTING)
        self._show()

    def _begin_for_part(self) -> None:
        if self._problem is not None:
            self.begin(replace(self._problem[1], partial=True))

    def leave(self) -> None:
        """Cancel, or put the ghosts away; what was accepted stays."""
        if self.first.cancel():
            self._say(words.CANCELLED)
        elif self.expected.ghosts():
            self._say(words.LEFT)
        self._forget()
        self._show()

    def _decline(self) -> None:
        self._offer.decline()
        self._show()

    def _forget(self) -> None:
        self._problem = None
        self.expected.forget()
        self.rest.stop()
        self.anew.cancel()
        self.asking.close()

    # What was found

    def _on_found(self, guessed: Guessed) -> None:
        guess = guessed.guess
        match guess.verdict:
            case Verdict.NONE:
                self._problem = (guess.words, guessed.settings)
            case Verdict.ASK:
                self.asking.ask(guessed, self._editor.committed)
            case Verdict.SURE:
                self._take(guess.readings[0], guessed)

    def _take(self, reading: Reading, guessed: Guessed) -> None:
        """Show the ghosts of a reading."""
        editor, session = self._editor, self._editor.committed
        is_mirrored = reading.mirrored
        if is_mirrored:
            # Else the warp of the pairs would turn the source inside out.
            session, reading = mirrored_first(session, reading)
        self.expected.take(reading, session, replace(guessed.settings, mirror=Mirror.NO))
        if is_mirrored:
            editor.commit(session, "Mirror source to suggest all")
        # One asks at a time, and the most certain comes first.
        editor.look(guided=None)
        editor.select(side=Side.DESTINATION)
        if self.expected.ghosts():
            self._views.fit_all()
            self._destination.setFocus(Qt.FocusReason.OtherFocusReason)
        self._show()
        if is_mirrored:
            self._say(words.MIRRORED)

    def _on_cancelled(self) -> None:
        self._say(words.CANCELLED)
        self._show()

    def _on_failed(self, error: Exception) -> None:
        is_told = isinstance(error, PinwarpError)
        self._problem = (str(error) if is_told else words.FAILED, PoseSettings(partial=True))
        if not is_told:
            raise error

    # The same anew, to what was accepted meanwhile

    def _warp_anew(self) -> None:
        session, taken = self._editor.committed, self.expected.taken
        if taken is None or not self.expected.ghosts() or len(known_pairs(session)) < FEWEST_ANEW:
            return
        if self._editor.is_previewing:
            self.rest.start()
        else:
            self.anew.begin(session, taken.settings)

    def _on_anew(self, guessed: Guessed) -> None:
        # Not under the hand that is dragging one.
        if guessed.guess.verdict is not Verdict.NONE and not self._editor.is_previewing:
            self.expected.renew(guessed.guess.readings[0])
            self._show()

    def _on_anew_failed(self, error: Exception) -> None:
        # The reading that there is goes on.
        if not isinstance(error, PinwarpError):
            raise error

    # What changed

    def _on_session(self, _session: Session | None = None) -> None:
        if self._editor.is_previewing:
            return
        session, taken = self._editor.committed, self.expected.taken
        is_out_of_date = self.first.follow(session)
        if self.asking.is_open:
            # Only a mesh that was on its way can come while one is asked.
            self.asking.close()
            is_out_of_date = True
        if taken is not None and not taken.meshes.are_those_of(session):
            self._forget()
            is_out_of_date = True
        elif taken is not None:
            self.anew.cancel()
            self.rest.start()
        if is_out_of_date:
            self._say(words.MESH_CHANGED)
        # It was about meshes and landmarks as they were.
        self._problem = None
        self._show()

    def _on_look(self, _changed: object = None) -> None:
        if self.expected.ghosts():
            self._show()

    # What is shown

    def _show(self) -> None:
        """Show what there is to be said, one thing at a time."""
        session, offered = self._editor.committed, self._offer.landmarks()
        if self._problem is not None:
            text, settings = self._problem
            self.bar.show_problem(text, may_be_part=not settings.partial)
        elif self.expected.ghosts():
            step = step_at(session, None)
            self.bar.show_going(self._going(), step.complete, step.total)
        elif offered:
            self.bar.show_offer(words.offer_in_words(offered, self.action.keys))
        elif not self.first.is_wanted:
            self.bar.show_nothing()
        self._tell()
        self._scenes.renew()
        self._guidance.show()
        self.action.renew()

    def _going(self) -> str:
        ghost = self._ghosts.at(Side.DESTINATION)
        if ghost is None or ghost.deviation is None:
            # The guide asks for one that has no ghost.
            return ""
        radius = self._editor.rulers.destination.text(ghost.deviation, 2)
        return words.going_in_words(ghost.name, radius, self._hand.accept_action.keys)

    def _tell(self) -> None:
        """Say once what the ghosts do not: which landmarks have none, and that none is left."""
        told = ""
        if self.expected.taken is not None:
            told = words.unplaced_in_words(self.expected.unplaced())
            if not told and not self.expected.ghosts():
                told = words.ALL_TAKEN
        if told and told != self._told:
            self._say(told)
        self._told = told
