"""A model in the window: opened, its bodies worked on one after the other, its elements shown."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from qtpy.QtCore import QSettings
from qtpy.QtWidgets import QDockWidget

from pinwarp.core.errors import PinwarpError
from pinwarp.core.frame_warp import BodyRules
from pinwarp.core.landmarks import Side
from pinwarp.core.model_rows import ElementRow
from pinwarp.core.words import counted
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability, Panel
from pinwarp.gui.files.file_dialogs import FileDialogs
from pinwarp.gui.model import words
from pinwarp.gui.model.opened import OpenedModel
from pinwarp.gui.model.panel import ModelPanel
from pinwarp.gui.model.pictures import picture_of, places_of
from pinwarp.gui.scene.drawables import Drawable
from pinwarp.gui.scene.model_drawables import ModelElements
from pinwarp.gui.tasks.file_tasks import MODEL_FILES, FileTasks
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.views.controls import ViewControls
from pinwarp.gui.views.scenes import Scenes
from pinwarp.gui.warp.quality import QualityPresenter
from pinwarp.gui.warp.warps import Warps
from pinwarp.io.osim.bone import Bone, bone_of
from pinwarp.session.editor import Editor
from pinwarp.session.judging.quality import Quality
from pinwarp.session.model.bench import Bench
from pinwarp.session.model.body_figures import BodyFigures, body_figures
from pinwarp.session.model.elements import Elements
from pinwarp.session.model.rules import Rule, choices, rule_of, with_rule
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpResult


@dataclass(frozen=True, eq=False)
class _Asked:
    """What becomes of which body is asked for."""

    bench: Bench
    body: str
    session: Session
    rules: BodyRules

    def is_same(self, other: _Asked | None) -> bool:
        return (
            other is not None
            and other.bench is self.bench
            and other.body == self.body
            and other.session is self.session
            and other.rules == self.rules
        )


class ModelPresenter(Capability):
    """Everything between the model that is open, its panel and the views.

    Parameters
    ----------
    editor
        The truth about the body that is worked on.
    opened
        The model.
    warps, quality
        Carry elements while things move, and tell how good the pairs are.
    scenes, views
        Where elements are shown, and who looks at them.
    tasks
        Asks which model.
    """

    def __init__(
        self,
        editor: Editor,
        opened: OpenedModel,
        warps: Warps,
        quality: QualityPresenter,
        scenes: Scenes,
        views: ViewControls,
        tasks: FileTasks[FileDialogs],
        exports: Action,
    ) -> None:
        self._editor, self._opened, self._warps, self._quality = editor, opened, warps, quality
        self._scenes, self._views, self._tasks = scenes, views, tasks
        self._worker = LatestWins(self._find)
        self._worker.computed.connect(self._on_figures)
        self._worker.failed.connect(self._on_failure)
        # The worker's: the bone that it read last.
        self._bone: tuple[Bench, str, Bone] | None = None
        self._asked: _Asked | None = None
        self._shown: tuple[_Asked, BodyFigures] | None = None
        self._problem = ""
        self._moving: tuple[WarpResult, Elements, Elements] | None = None
        self._pictures: dict[Side, tuple[Elements, frozenset[str], ModelElements]] = {}
        self._is_drawn = True
        self.actions = (*self._make_actions(), exports)
        _, save, _, shown, _ = self.actions
        self.panel = ModelPanel(exports, save, shown)
        self.panels = (Panel("model", "Model", self.panel, is_open=False),)
        self._connect()
        self._on_opened()

    def _make_actions(self) -> tuple[Action, Action, Action, Action]:
        opened = self._opened
        return (
            Action(
                "open_model",
                "Open &Model…",
                self.ask_and_open,
                at="File.25",
                keys="Ctrl+Shift+M",
                tip="Open a model of OpenSim (.osim), or a saved study of one",
            ),
            Action(
                "save_study",
                "Save S&tudy",
                opened.save,
                at="File.34",
                tip="Save the sessions of all bodies, and the study that names them",
                possible=lambda: opened.bench is not None,
            ),
            Action(
                "close_model",
                "Close Mode&l",
                opened.close,
                at="File.35",
                tip="Put the model away; what is unsaved is asked about",
                possible=lambda: opened.bench is not None,
            ),
            Action(
                "show_elements",
                "Model &Elements",
                switches=self._draw,
                at="View.15",
                tip="Draw muscles, points, wraps and frames of the body over both bones",
                possible=lambda: opened.bench is not None,
                checked=lambda: self._is_drawn,
            ),
        )

    def _connect(self) -> None:
        panel = self.panel
        panel.bodies.body_chosen.connect(self._opened.choose)
        panel.bodies.body_enabled.connect(self._enable)
        panel.rules.chosen.connect(self._on_chosen)
        panel.rules.itemClicked.connect(lambda *_clicked: self._focus())
        panel.rule_requested.connect(self._set_rule)
        self._opened.changed.connect(self._on_opened)
        self._editor.session_changed.connect(self._on_session)
        self._editor.saved.connect(self._show_bodies)
        self._editor.rulers_changed.connect(self._show_bodies)
        self._warps.result_changed.connect(self._on_result)
        self._quality.quality_changed.connect(self._on_quality)

    def shut_down(self) -> None:
        """Let go of the worker, the warps and the editor."""
        self._quality.quality_changed.disconnect(self._on_quality)
        self._warps.result_changed.disconnect(self._on_result)
        self._editor.rulers_changed.disconnect(self._show_bodies)
        self._editor.saved.disconnect(self._show_bodies)
        self._editor.session_changed.disconnect(self._on_session)
        self._opened.changed.disconnect(self._on_opened)
        self._opened.shut_down()
        self._worker.shut_down()

    def may_close(self) -> bool:
        """Ask about the bodies that are set aside, and the study."""
        return self._opened.may_put_away()

    @property
    def is_settled(self) -> bool:
        """Whether what is shown is of the session as it is."""
        return self._worker.is_idle

    def remember(self, settings: QSettings) -> None:
        """Note whether elements are drawn."""
        settings.setValue("model_elements", self._is_drawn)

    def recall(self, settings: QSettings) -> None:
        """Draw elements as it was remembered."""
        self._is_drawn = settings.value("model_elements", True, type=bool)
        self._renew_actions()

    @property
    def figures(self) -> BodyFigures | None:
        """What becomes of the body that is worked on, as far as it is known."""
        if self._shown is None or not self._opened.chosen:
            return None
        asked, figures = self._shown
        is_here = asked.bench is self._opened.bench and asked.body == self._opened.chosen
        return figures if is_here else None

    @property
    def rows(self) -> tuple[ElementRow, ...]:
        """What became of every element, where that is of the session as it is."""
        figures = self.figures
        if (
            figures is None
            or not figures.is_warped
            or figures.session is not self._editor.committed
        ):
            return ()
        return figures.rows

    def drawables(self, side: Side) -> Iterator[Drawable]:
        """Return what stands on the body."""
        figures = self.figures
        if figures is None or not self._is_drawn:
            return
        elements = figures.before if side is Side.SOURCE else self._there(figures)
        if elements is None:
            return
        chosen = self._chosen_paths()
        known = self._pictures.get(side)
        if known is None or known[0] is not elements or known[1] != chosen:
            rows = figures.rows if elements is figures.after else ()
            known = (elements, chosen, picture_of(elements, chosen, rows))
            self._pictures[side] = known
        yield known[2]

    def _there(self, figures: BodyFigures) -> Elements | None:
        """Return the elements on the destination: as they will be, or carried while things move."""
        editor, result = self._editor, self._warps.result
        if figures.session is editor.session and figures.after is not None:
            return figures.after
        if result is None or result.spline is None or figures.problem:
            return None
        if result.inputs.mesh is not editor.session.mesh(Side.SOURCE):
            # Of the body before.
            return None
        if self._moving is None or self._moving[:2] != (result, figures.before):
            carried = figures.before.mapped(result.spline.evaluate)
            self._moving = (result, figures.before, carried)
        return self._moving[2]

    # What the user asks for

    def ask_and_open(self) -> None:
        """Ask for a model and open it."""
        path = self._tasks.dialogs.ask_open("Open a model", MODEL_FILES, self._tasks.folder())
        if path is not None:
            self.open(path)

    def open(self, path: Path) -> None:
        """Open a model or a study; its tab comes to the front."""
        self._opened.open(path)
        dock = self.panel.parent()
        if isinstance(dock, QDockWidget):
            dock.show()
            dock.raise_()

    def _draw(self, on: bool) -> None:
        self._is_drawn = on
        self._scenes.renew()

    def _enable(self, body: str, on: bool) -> None:
        bench = self._opened.bench
        if bench is not None:
            bench.bodies[body].enabled = on
            self._renew_actions()

    def _set_rule(self, rule: Rule) -> None:
        figures = self.figures
        if figures is None:
            return
        paths = [row.path for row in self.panel.rules.rows]
        parts, editor = figures.bone.parts, self._editor
        rules = with_rule(parts, editor.rules, paths, rule)
        what = paths[0].rsplit("/", 1)[-1] if len(paths) == 1 else counted(len(paths), "element")
        verb = {Rule.CARRY: "Carry", Rule.TURN: "Turn", Rule.KEEP: "Keep"}[rule]
        editor.commit(editor.committed, f"{verb} {what}", rules=rules)

    def _focus(self) -> None:
        """Look at what is chosen, on both bones."""
        figures, chosen = self.figures, self._chosen_paths()
        if figures is None or not chosen:
            return
        sides = {Side.SOURCE: figures.before, Side.DESTINATION: self._there(figures)}
        targets = {}
        for side, elements in sides.items():
            if elements is None:
                continue
            places = np.concatenate([places_of(elements, path) for path in chosen])
            if len(places):
                targets[side] = places
        if targets:
            self._views.focus_on(targets)

    # What changed

    def _on_opened(self) -> None:
        self._show_bodies()
        self._ask()
        self._renew_actions()
        self._scenes.renew()

    def _on_session(self, _session: Session) -> None:
        if not self._editor.is_previewing:
            self._show_bodies()
            self._ask()

    def _on_result(self, _result: WarpResult, _at_rest: bool, _quality: Quality | None) -> None:
        self._scenes.renew()

    def _on_quality(self, quality: Quality | None) -> None:
        one = self._opened.body
        if one is None or self._editor.is_previewing:
            return
        known = None if quality is None else quality.left_out
        distances = np.zeros(0) if known is None else known.distances
        finite = distances[np.isfinite(distances)]
        one.worst = float(finite.max()) if len(finite) else math.nan
        self._show_bodies()

    def _ask(self) -> None:
        opened, editor = self._opened, self._editor
        if opened.bench is None or not opened.chosen:
            self._asked = self._shown = self._moving = None
            self._pictures.clear()
            return
        asked = _Asked(opened.bench, opened.chosen, editor.committed, editor.rules)
        if not asked.is_same(self._asked):
            self._asked = asked
            self._worker.request(asked)

    def _find(self, asked: _Asked) -> tuple[_Asked, BodyFigures | PinwarpError]:
        """Find out what becomes of a body; runs in the worker."""
        bench, body = asked.bench, asked.body
        try:
            if self._bone is None or self._bone[:2] != (bench, body):
                self._bone = (bench, body, bone_of(bench.model, body, bench.folders))
            bone = self._bone[2]
            return asked, body_figures(asked.session, bone, asked.rules, bench.muscles)
        except PinwarpError as error:
            return asked, error

    def _on_figures(self, found: tuple[_Asked, BodyFigures | PinwarpError]) -> None:
        asked, figures = found
        if not asked.is_same(self._asked):
            return
        if isinstance(figures, PinwarpError):
            self._shown = None
            self.panel.show_rows((), asked.bench.bodies[asked.body].name, (), str(figures))
        else:
            self._shown = (asked, figures)
            name = figures.bone.name
            self.panel.show_rows(figures.rows, name, figures.notes, figures.problem)
        self._on_chosen()
        self._scenes.renew()

    def _on_failure(self, error: Exception) -> None:
        self._shown = None
        raise error

    def _on_chosen(self) -> None:
        figures = self.figures
        rows = self.panel.rules.rows
        possible: tuple[Rule, ...] = ()
        rule = None
        if figures is not None and rows:
            parts, rules = figures.bone.parts, self._editor.rules
            sets = [set(found) for row in rows if (found := choices(parts, row.path))]
            common = set.intersection(*sets) if sets else set()
            possible = tuple(each for each in Rule if each in common)
            now = {rule_of(parts, rules, row.path) for row in rows if choices(parts, row.path)}
            rule = now.pop() if len(now) == 1 else None
        is_waiting = figures is not None and not figures.is_warped and not figures.problem
        hint = words.NO_PAIRS if is_waiting else words.NO_ELEMENT
        self.panel.show_chosen(rows, possible, rule, hint)
        self._scenes.renew()

    def _chosen_paths(self) -> frozenset[str]:
        return frozenset(row.path for row in self.panel.rules.rows)

    # What is shown

    def _show_bodies(self) -> None:
        opened, lengths = self._opened, self._editor.view.lengths
        self.panel.show_bench(opened.bench, opened.chosen, lengths)

    def _renew_actions(self) -> None:
        for action in self.actions:
            action.renew()
