"""Refining the warp to the whole surface: what is asked for, and what is shown of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from qtpy.QtWidgets import QDockWidget, QWidget

from pinwarp.core.errors import PinwarpError
from pinwarp.core.features import FeatureRange
from pinwarp.core.landmarks import Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.readiness import InsideOutError
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability, Panel
from pinwarp.gui.maps.presenter import MapPresenter
from pinwarp.gui.refining import words
from pinwarp.gui.refining.comparison import WithoutRefinement
from pinwarp.gui.refining.fit import Fit, fit_of
from pinwarp.gui.refining.note import RefinementNote
from pinwarp.gui.refining.panel import RefiningPanel
from pinwarp.gui.refining.run import Checked, RefiningRun
from pinwarp.gui.scene.drawables import Badge, Drawable
from pinwarp.gui.tasks.jobs import LatestWins, SlowJob
from pinwarp.gui.views.scenes import Scenes
from pinwarp.gui.warp.warps import Warps
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.judging.survey import Survey
from pinwarp.session.session import Session
from pinwarp.session.warp.refined import OUT_OF_DATE, refinement_in_use
from pinwarp.session.warp.refining import RefinementOptions, why_not
from pinwarp.session.warp.result import WarpResult


class RefiningPresenter(Capability):
    """Everything between editor, warps and the panel of the refinement.

    Parameters
    ----------
    editor
        The truth.
    warps, maps
        Show the levels, and tell what they show.
    scenes
        Where it is said that the refinement is left out.
    jobs
        Runs what takes long.
    say
        Shows a message in the status bar.
    window
        Where keys count.
    """

    def __init__(
        self,
        editor: Editor,
        warps: Warps,
        maps: MapPresenter,
        scenes: Scenes,
        jobs: SlowJob,
        say: Callable[[str], None],
        window: QWidget,
    ) -> None:
        self._editor, self._warps, self._maps, self._scenes = editor, warps, maps, scenes
        self._say = say
        self._problem: Exception | None = None
        self._shown_options: RefinementRecord | None = None
        self._features: tuple[Mesh, FeatureRange] | None = None
        self._fits = LatestWins(fit_of)
        self._fit: Fit | None = None
        self._measuring: RefinementRecord | None = None
        self._folds: tuple[RefinementRecord, int] | None = None
        self._checked: Checked | None = None
        self.run = RefiningRun(editor, jobs, say, window)
        self._without = WithoutRefinement(self._can_compare, say, window)
        self.actions = self._make_actions()
        refine, without, remove, check = self.actions
        self.panel = RefiningPanel(without, remove, check, refine.keys)
        self.panels = (Panel("refine", "Refine", self.panel),)
        self.note = RefinementNote()
        self.notes = (self.note,)
        self._connect()
        self._on_session()

    def _make_actions(self) -> tuple[Action, ...]:
        editor, is_idle = self._editor, lambda: self.run.is_idle
        return (
            Action(
                "refine",
                "&Refine to Surface",
                self.refine,
                at="Warp.41",
                keys="Ctrl+R",
                tip="Fit the warp to the whole surface of the destination",
            ),
            self._without.action,
            Action(
                "remove_refinement",
                "Remo&ve Refinement",
                self._remove,
                at="Warp.43",
                tip="Back to the warp of the landmarks alone",
                possible=lambda: editor.committed.refinement is not None and is_idle(),
            ),
            Action(
                "check_refinement",
                "Chec&k the Refinement",
                self.check,
                at="Warp.44",
                tip="Refine again without each landmark in turn: how far it is missed is what "
                "the refinement is worth",
                possible=lambda: refinement_in_use(editor.committed) is not None and is_idle(),
            ),
        )

    def _connect(self) -> None:
        panel, run = self.panel, self.run
        panel.refine_requested.connect(self.refine)
        panel.turn_requested.connect(self._turn)
        panel.cancel_requested.connect(run.cancel)
        panel.options_changed.connect(lambda: self._show_problem(None))
        self.note.again_requested.connect(self.refine)
        run.progressed.connect(panel.show_busy)
        run.level_changed.connect(self._show_warp)
        run.checked.connect(self._on_checked)
        run.refused.connect(self._on_refused)
        run.idled.connect(self._on_idle)
        self._without.changed.connect(self._show_warp)
        self._fits.computed.connect(self._on_fit)
        self._fits.failed.connect(self._on_failure)
        self._warps.result_changed.connect(self._on_result)
        self._maps.map_changed.connect(self._on_survey)
        self._editor.rulers_changed.connect(self._on_rulers)
        self._editor.session_changed.connect(self._on_session)

    def shut_down(self) -> None:
        """Let go of what is under way, of warps and editor."""
        self.run.shut_down()
        self._without.end()
        self._editor.session_changed.disconnect(self._on_session)
        self._editor.rulers_changed.disconnect(self._on_rulers)
        self._maps.map_changed.disconnect(self._on_survey)
        self._warps.result_changed.disconnect(self._on_result)
        self._fits.shut_down()

    @property
    def is_settled(self) -> bool:
        """Whether nothing is under way and all is measured."""
        return self.run.is_idle and self._fits.is_idle

    def drawables(self, side: Side) -> Iterator[Drawable]:
        """Return what says that the refinement is left out."""
        if self._without.is_on and side is Side.DESTINATION:
            yield Badge(self._without.badge)

    # What the user asks for

    def refine(self) -> None:
        """Refine as the panel says."""
        self._bring_up()
        if not self.run.is_idle:
            self._say(words.BUSY)
            return
        self._show_problem(None)
        if why_not(self._editor.committed, self.panel.options):
            # The panel says it.
            return
        self._without.end()
        # What is hidden cannot be seen to change.
        self._editor.look(overlay=True)
        self.run.refine(self.panel.options)
        self._renew_actions()

    def check(self) -> None:
        """Find out what the refinement is worth."""
        self._bring_up()
        self._show_problem(None)
        self.run.check()
        self._renew_actions()

    def _turn(self) -> None:
        self.panel.show_turned(not self.panel.options.turn_destination)
        self.refine()

    def _remove(self) -> None:
        session = edits.set_refinement(self._editor.committed, None)
        self._editor.commit(session, "Remove refinement")

    def _bring_up(self) -> None:
        dock = self.panel.parent()
        if isinstance(dock, QDockWidget):
            dock.show()
            dock.raise_()

    def _can_compare(self) -> bool:
        return self.run.level is not None or refinement_in_use(self._editor.committed) is not None

    # What changed

    def _on_rulers(self, _rulers: object) -> None:
        self._on_session()

    def _on_session(self, _session: Session | None = None) -> None:
        editor = self._editor
        self.note.show_session(editor.session)
        if editor.is_previewing:
            return
        self.run.follow(editor.committed)
        self._without.follow()
        self._show_options(editor.committed)
        self._show_problem(None)

    def _on_result(self, result: WarpResult, at_rest: bool) -> None:
        if self._editor.view.map is None:
            self.run.drawn(result.inputs.refinement)
        if at_rest and self.run.is_idle:
            self._measure()

    def _on_survey(self, survey: Survey) -> None:
        shown = survey.result.inputs.refinement
        self.run.drawn(shown)
        if shown is not None and survey.folds is not None and self.run.level is None:
            self._folds = (shown, survey.folds.count)
            self._show_state()

    def _on_checked(self, checked: Checked) -> None:
        self._checked = checked

    def _on_refused(self, error: Exception) -> None:
        if not isinstance(error, PinwarpError):
            self._show_problem(PinwarpError(words.FAILED))
            raise error
        self._show_problem(error)

    def _on_idle(self) -> None:
        self.panel.show_idle()
        self._show_warp()
        self._show_state()
        self._renew_actions()
        self._measure()

    def _measure(self) -> None:
        session = self._editor.committed
        refined = refinement_in_use(session)
        if refined is not None and refined != self._measuring:
            self._measuring = refined
            self._fits.request(session)

    def _on_fit(self, fit: Fit) -> None:
        self._fit = fit
        self._show_state()

    def _on_failure(self, error: Exception) -> None:
        raise error

    # What is shown

    def _show_warp(self) -> None:
        """Show the level that was reached, the landmarks' warp, or the session as it is."""
        # By colour they can be compared only in one range.
        self._maps.keep_ranges(self._without.is_on or not self.run.is_idle)
        if self._without.is_on:
            self._warps.show_instead(None)
        elif self.run.level is not None:
            self._warps.show_instead(self.run.level)
        else:
            self._warps.show_own()
        self._without.action.renew()
        self._scenes.renew()

    def _show_options(self, session: Session) -> None:
        mesh = session.mesh(Side.SOURCE)
        if mesh is None:
            self._features = None
        elif self._features is None or self._features[0] is not mesh:
            self._features = (mesh, FeatureRange.of(mesh))
            # What suited another bone may be miles on this one.
            self.panel.show_options(RefinementOptions())
            self._shown_options = None
        features = None if self._features is None else self._features[1]
        self.panel.show_usual(features, session.settings.penalty, self._editor.rulers.session)
        refined = session.refinement
        if refined is not None and refined != self._shown_options:
            # Refining again is then the same again.
            self.panel.show_options(RefinementOptions.of(refined))
        self._shown_options = refined

    def _show_problem(self, error: Exception | None) -> None:
        self._problem = error
        self._show_state()

    def _show_state(self) -> None:
        session, panel, error = self._editor.committed, self.panel, self._problem
        reason = why_not(session, panel.options)
        problem, remedy = reason or ("" if error is None else str(error)), ""
        if isinstance(error, InsideOutError) and not reason:
            turned = panel.options.turn_destination
            remedy = words.TURN_BACK if turned else words.TURN
            problem = words.ALREADY_TURNED if turned else problem
        panel.show_problem(problem, remedy=remedy, blocks=bool(reason))
        refined, again = refinement_in_use(session), session.refinement is not None
        state = OUT_OF_DATE if again else words.NOT_REFINED
        worth = None
        if refined is not None:
            state = self._refined_in_words(session, refined)
            if self._checked is not None and self._checked.refinement == refined:
                worth = self._checked.worth
        panel.show_state(state, again=again, is_warning=again and refined is None)
        panel.show_worth(worth, self._editor.rulers.session)

    def _refined_in_words(self, session: Session, refined: RefinementRecord) -> str:
        fit = self._fit if self._fit is not None and self._fit.refinement == refined else None
        folds = None
        # Folds are looked for in what is applied.
        if self._folds is not None and self._folds[0] == refined and session.settings.is_whole:
            folds = self._folds[1]
        return words.refined_in_words(
            refined, len(session.pairs), self._editor.rulers.session, fit, folds
        )

    def _renew_actions(self) -> None:
        for action in self.actions:
            action.renew()
