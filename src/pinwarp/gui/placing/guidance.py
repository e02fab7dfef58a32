"""Says what a click would do, asks for one landmark after the other, sets how new ones are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from qtpy.QtWidgets import QLabel

from pinwarp.core.landmarks import Side
from pinwarp.core.words import counted
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.placing.ghosts import Ghosts
from pinwarp.gui.placing.guide_bar import GuideBar
from pinwarp.gui.placing.hand import Hand
from pinwarp.gui.scene.drawables import Drawable, NextClick
from pinwarp.gui.scene.key_words import with_own_keys
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.gui.tasks.file_tasks import LANDMARK_FILES, FileTasks
from pinwarp.gui.views.canvas import Canvas
from pinwarp.io.template import read_template
from pinwarp.session.editor import Editor
from pinwarp.session.guide import next_incomplete, step_at, with_template
from pinwarp.session.session import Session
from pinwarp.session.signals import isolated

# With fewer of them, where to click next may still be new.
_BEGINNER_PAIRS = 4
_BEGIN = {
    Side.SOURCE: "Click a place on this bone,",
    Side.DESTINATION: "then the same place on this one",
}
_ONLY_POINTS = {
    Side.SOURCE: "The source has no mesh: its landmarks are imported or typed. Ctrl+1 opens one.",
    Side.DESTINATION: "The destination has no mesh: its landmarks are imported or typed, and the "
    "warped source is shown. Ctrl+2 opens one.",
}


class Guidance(Capability):
    """Tells the user where things stand; ``said`` emits messages for the status bar.

    Parameters
    ----------
    editor, hand, ghosts
        Where the words come from.
    views
        Where one looks: what a key does next may follow from it.
    tasks
        Reads, asks and tells.
    """

    said = isolated(str)

    def __init__(
        self,
        editor: Editor,
        hand: Hand,
        ghosts: Ghosts,
        views: Mapping[Side, Canvas],
        tasks: FileTasks[Dialogs],
    ) -> None:
        self._editor = editor
        self._hand = hand
        self._ghosts = ghosts
        self._views = views
        self._tasks = tasks
        self._others: list[Callable[[], str]] = []
        self.bar = bar = GuideBar()
        self.above = (bar,)
        self.hint = QLabel()
        self.hints = (self.hint,)
        self.actions = (
            Action(
                "load_template",
                "Load &Template…",
                self.load_template,
                at="Place.21",
                keys="Ctrl+T",
                tip="A list of landmarks to be asked for",
            ),
            Action(
                "guide",
                "&Guide",
                switches=self.switch,
                checked=lambda: editor.view.guided is not None,
                at="Place.22 tools.32",
                keys="G",
                deed="Switch Guide On or Off",
                icon="guide",
                tip="Ask for one landmark after the other",
            ),
            Action(
                "set_pattern",
                "Name Pa&ttern…",
                self.ask_pattern,
                at="Place.23",
                tip="What new landmarks are called",
            ),
            Action(
                "set_nudge",
                "Nudge Ste&p…",
                self.ask_nudge,
                at="Place.32",
                tip="How far an arrow key moves a landmark",
            ),
        )
        bar.skip_requested.connect(lambda: self._step_guide(backwards=False))
        bar.back_requested.connect(lambda: self._step_guide(backwards=True))
        bar.end_requested.connect(lambda: editor.look(guided=None))
        editor.session_changed.connect(self._on_session)
        self._shown_on = (editor.selection_changed, editor.view_changed)
        for signal in self._shown_on:
            signal.connect(self.show)
        # A ghost comes with the warp, after the click that asked for it.
        ghosts.renewed.connect(self._on_news)
        for view in views.values():
            view.layer.looked_anew.connect(self._on_news)
        self.show()

    def shut_down(self) -> None:
        """Let go of the editor."""
        self._editor.session_changed.disconnect(self._on_session)
        for signal in self._shown_on:
            signal.disconnect(self.show)
        self._ghosts.renewed.disconnect(self._on_news)
        for view in self._views.values():
            view.layer.looked_anew.disconnect(self._on_news)

    def _on_news(self, *_result: object) -> None:
        if not self._editor.is_previewing:
            self._show_hint()

    def _on_session(self, _session: Session) -> None:
        editor = self._editor
        if editor.is_previewing:
            # What is said is about the committed session: a drag need not wait for it.
            return
        guided = editor.view.guided
        if guided is not None and editor.session.index_of(guided) is None:
            # Undone or deleted: go on with another.
            editor.look(guided=next_incomplete(editor.session, None))
        self.show()

    def show(self, _changed: object = None) -> None:
        """Show what is asked for and what a click would do, as things stand."""
        session, guided = self._editor.session, self._editor.view.guided
        is_there = guided is not None and session.index_of(guided) is not None
        self.bar.show_step(session, step_at(session, guided) if guided and is_there else None)
        self._show_hint()

    def drawables(self, side: Side) -> Iterator[Drawable]:
        """Say in the view what the next click there does, while somebody has to know."""
        if words := self.next_click(side):
            yield NextClick(words)

    def next_click(self, side: Side) -> str:
        """Return in few words what the next click on a side does; nothing where it need not."""
        editor, session = self._editor, self._editor.session
        no_mesh = any(session.mesh(one) is None for one in Side)
        if no_mesh or editor.view.locked or any(words() for words in self._others):
            return ""
        target, guided = self._ghosts.target(side), editor.view.guided
        if target is not None:
            landmark = session.landmark(target)
            is_there = landmark is not None and landmark.position(side) is not None
            return "" if guided and is_there else f"Click: {target}"
        if len(session.pairs) < _BEGINNER_PAIRS and self._ghosts.target(side.other) is None:
            return _BEGIN[side]
        return ""

    def give_way_to(self, words: Callable[[], str]) -> None:
        """Let somebody else say what a click would do, while it has words for that."""
        self._others.append(words)

    def _show_hint(self) -> None:
        """Say what a click would do right now."""
        said = next((said for words in self._others if (said := words())), "")
        if said:
            self.hint.setText(said)
            return
        editor, session = self._editor, self._editor.session
        if editor.view.hovered is not None:
            # The mouse rests on what was just placed: what the key does next is said there, too.
            self.hint.setText(f"{self._hover_words(editor.view.hovered)}{self._ghost_words()}")
            return
        missing = [side for side in Side if session.mesh(side) is None]
        if missing and session.pairs:
            self.hint.setText(with_own_keys(_ONLY_POINTS[missing[0]]))
            return
        if missing:
            self.hint.setText(f"Open the {missing[0].value} mesh to begin, or drop it on its view.")
            return
        if editor.view.locked:
            self.hint.setText(
                f"Landmarks are locked ({self._hand.lock_action.keys} unlocks): a click selects, "
                "a drag orbits."
            )
            return
        targets = [self._ghosts.target(side) or "a new landmark" for side in Side]
        on_both = "A click on either bone places a new landmark."
        on_each = f"A click on the source places {targets[0]}, on the destination {targets[1]}."
        if targets[0] == targets[1]:
            on_each = f"A click on either bone places {targets[0]}."
        says = on_each if any(map(self._ghosts.target, Side)) else on_both
        self.hint.setText(f"{says}{self._ghost_words()}")

    def _ghost_words(self) -> str:
        """Say what the key that accepts ghosts does next."""
        key = self._hand.accept_action.keys
        ghost = self._ghosts.next(self._editor.selection.side)
        if ghost is not None and self._hand.first_seen.is_out_of_sight(
            ghost.name, ghost.side, ghost.position
        ):
            return f"  {key} turns the view to the ghost, and accepts it at the second press."
        return f"  {key} accepts the ghost." if self._hand.offers_ghost else ""

    def _hover_words(self, name: str) -> str:
        landmark = self._editor.session.landmark(name)
        if landmark is None:
            return name
        words, snap = [f"{name}: {landmark.state.value}"], self._hand.snap_action.keys
        for side in Side:
            off = self._hand.distance_off(landmark, side)
            if off:
                far = self._editor.rulers.on(side).text(off, 3)
                words.append(f"{far} off the {side.value} surface ({snap} snaps)")
        if landmark.locked or self._editor.view.locked:
            words.append("locked")
        else:
            words.append("click selects, drag moves it")
        return " – ".join(words)

    # The guide, and what new landmarks are like

    def switch(self, on: bool) -> None:
        """Begin to ask for landmarks, or stop."""
        if not on:
            self._editor.look(guided=None)
        elif self._editor.view.guided is None:
            name = next_incomplete(self._editor.session, None)
            if name is None:
                self.said.emit(
                    "Every landmark has both sides: load a template of names to be asked for"
                )
            self._editor.look(guided=name)

    def _step_guide(self, *, backwards: bool) -> None:
        editor = self._editor
        name = next_incomplete(editor.session, editor.view.guided, backwards=backwards)
        editor.look(guided=name)
        if name is not None:
            editor.select(name)

    def load_template(self) -> None:
        """Ask for a list of names and begin with the first that is not placed."""
        editor, tasks = self._editor, self._tasks
        path = tasks.dialogs.ask_open("Load a template", LANDMARK_FILES, tasks.folder())
        if path is None:
            return

        def arrived(names: tuple[str, ...]) -> None:
            session = with_template(editor.committed, names)
            editor.commit(session, f"Load template {path.name}")
            self.said.emit(f"{counted(len(names), 'name')} from {path.name}")
            editor.look(guided=next_incomplete(session, None))

        tasks.run(f"Reading {path.name}", lambda _progress: read_template(path), arrived)

    def ask_nudge(self) -> None:
        """Ask how far an arrow key moves."""
        ruler, current = self._editor.rulers.session, self._editor.view.nudge
        text = self._tasks.dialogs.ask_text(
            "Nudge step",
            f"An arrow key moves a landmark by this many {ruler.unit} (empty: 1/500 of the bone):",
            "" if current is None else f"{ruler.shown(current):g}",
        )
        if text is None:
            return
        try:
            step = ruler.length(text) if text.strip() else None
        except ValueError:
            step = 0.0
        if step is not None and not 0 < step < float("inf"):
            self._tasks.dialogs.tell_error("Nudge step", f"“{text}” is not a length above 0.")
            return
        self._editor.look(nudge=step)

    def ask_pattern(self) -> None:
        """Ask what new landmarks are called."""
        text = self._tasks.dialogs.ask_text(
            "Name pattern",
            "What new landmarks are called; {n} is their number:",
            self._editor.view.name_pattern,
        )
        if text is None:
            return
        if text.count("{n}") != 1:
            self._tasks.dialogs.tell_error(
                "Name pattern", "The pattern must hold {n} once, for the number."
            )
            return
        self._editor.look(name_pattern=text.strip())
