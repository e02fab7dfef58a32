"""Has each warp at rest surveyed; shows its map, its folds and where it guesses."""

from __future__ import annotations

import math
from collections.abc import Iterator
from types import MappingProxyType

from qtpy.QtCore import QObject

from pinwarp.core.landmarks import Side
from pinwarp.core.lengths import Ruler
from pinwarp.core.maps import MapKind, Range, Suggestion
from pinwarp.gui.capability.action import Action, one_of
from pinwarp.gui.capability.capability import Capability, Panel
from pinwarp.gui.maps.making import MapMaker, Surveyed, SurveyRequest, is_of
from pinwarp.gui.maps.panel import MapPanel
from pinwarp.gui.maps.words import MENU_WORDS, TITLES, note_of, title_of
from pinwarp.gui.placing.ghosts import Ghosts
from pinwarp.gui.placing.hand import Hand
from pinwarp.gui.scene.drawables import Colouring, Drawable, Legend, Star, WorkWords
from pinwarp.gui.style.colour_scale import ColourScale
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.views.scenes import Scenes
from pinwarp.gui.views.viewport import Viewport
from pinwarp.gui.warp.warps import Warps
from pinwarp.session.editor import Editor
from pinwarp.session.judging.survey import Survey
from pinwarp.session.session import Session
from pinwarp.session.signals import isolated
from pinwarp.session.view import ViewState
from pinwarp.session.warp.result import WarpResult

MAP_ACTIONS = {kind: f"map_{kind.name.lower() if kind else 'none'}" for kind in (None, *MapKind)}
# Nearer to a suggested place than this share of the bone, a landmark counts as placed there.
THERE = 1e-3


class MapPresenter(Capability):
    """Everything between the surveys of the warp and what shows them.

    ``map_changed`` emits each survey, ``folds_changed`` the folds as findings whenever they are
    others, ``survey_shown`` what there is to say of the last one, ``refused`` why something was
    not done, in words for the user, and ``taken_back`` those words once they are true no more.

    Parameters
    ----------
    editor
        The truth.
    warps, hand, ghosts
        Where the warps come from, who places landmarks, and which.
    scenes
        Where it is shown.
    view
        The destination's: its legend is clicked.
    parent
        The window.
    """

    map_changed = isolated(Survey)
    folds_changed = isolated(tuple)
    survey_shown = isolated(object)
    refused = isolated(str)
    taken_back = isolated(str)

    def __init__(
        self,
        editor: Editor,
        warps: Warps,
        hand: Hand,
        ghosts: Ghosts,
        scenes: Scenes,
        view: Viewport,
        parent: QObject,
    ) -> None:
        self._editor = editor
        self._warps = warps
        self._hand = hand
        self._ghosts = ghosts
        self._scenes = scenes
        maker = MapMaker()
        self._surveys = LatestWins(lambda asked: maker.make(asked, self._surveys.checkpoint))
        self._surveys.computed.connect(self._on_survey)
        self._surveys.failed.connect(self._on_failure)
        self._resting: WarpResult | None = None
        self._surveyed: Surveyed | None = None
        self._asked: SurveyRequest | None = None
        self._kept_ranges: dict[MapKind, Range] | None = None
        # Why there is no map: what was said of it, and which one was wanted then.
        self._excuse = ""
        self._wanted: MapKind | None = None
        suggest = Action(
            "place_suggested",
            "Place at &Suggested Place",
            self.place_suggested,
            at="Place.12",
            keys="Shift+Space",
            tip="Where the uncertainty map says that the next landmark helps most",
        )
        following = Action(
            "map_next",
            "Next &Map",
            self._next_map,
            at="maps.31",
            keys="M",
            deed="Show Next Map",
            tip="Colour the warped source by something else",
        )
        self.actions = (
            *one_of(map(self._action_of, (None, *MapKind)), parent),
            following,
            suggest,
        )
        self.panel = MapPanel(suggest, following.keys, hand.accept_action.keys)
        self.panels = (Panel("map", "Map", self.panel),)
        self._window = parent
        self._connect(view)
        self._on_view()

    def _connect(self, view: Viewport) -> None:
        editor, panel = self._editor, self.panel
        view.map_legend.clicked.connect(self._on_legend)
        panel.map_requested.connect(self.show_map)
        panel.range_requested.connect(self._fix_range)
        panel.relative_requested.connect(lambda on: editor.look(map_relative=on))
        panel.work.stop_requested.connect(self._stop)
        panel.work.changed.connect(self._scenes.renew)
        self._surveys.progressed.connect(panel.work.show_share)
        self._surveys.stopped.connect(self._show_work)
        self._window.installEventFilter(panel.work)
        self._warps.result_changed.connect(self._on_result)
        editor.view_changed.connect(self._on_view)
        editor.session_changed.connect(self._on_session)

    def shut_down(self) -> None:
        """Stop the worker and let go of warps and editor."""
        self._window.removeEventFilter(self.panel.work)
        self.panel.work.show_work("")
        self._warps.result_changed.disconnect(self._on_result)
        self._editor.view_changed.disconnect(self._on_view)
        self._editor.session_changed.disconnect(self._on_session)
        self._surveys.shut_down()

    @property
    def is_settled(self) -> bool:
        """Whether the last warp at rest is surveyed and shown."""
        return self._surveys.is_idle

    @property
    def survey(self) -> Survey | None:
        """What was found last."""
        return self._surveyed.survey if self._surveyed is not None else None

    @property
    def is_coloured(self) -> bool:
        """Whether the overlay wears a map, or will in a moment."""
        found = self.survey.map if self.survey is not None else None
        return found is not None and self._editor.view.map is not None

    # What the user asks for

    def _action_of(self, kind: MapKind | None) -> Action:
        text, tip, place = MENU_WORDS[kind]
        return Action(
            MAP_ACTIONS[kind],
            text,
            lambda: self.show_map(kind),
            checked=lambda: self._editor.view.map is kind,
            at=f"maps.{place}",
            tip=tip,
        )

    def show_map(self, kind: MapKind | None) -> None:
        """Colour the warped source by something, or by nothing."""
        # What is hidden cannot be seen to be coloured.
        self._editor.look(map=kind, overlay=kind is not None or self._editor.view.overlay)

    def _stop(self) -> None:
        """Show no map instead of one that takes too long."""
        self.show_map(None)
        self._excuse_with("Stopped: no map is shown.")

    def _excuse_with(self, words: str) -> None:
        """Say why there is no map, or by nothing that what was said of that is over."""
        before, self._excuse = self._excuse, words
        if words:
            self.refused.emit(words)
        elif before:
            self.taken_back.emit(before)

    def _next_map(self) -> None:
        kinds = [None, *MapKind]
        self.show_map(kinds[(kinds.index(self._editor.view.map) + 1) % len(kinds)])

    def _fix_range(self, wanted: Range | None) -> None:
        view = self._editor.view
        if view.map is None:
            return
        ranges = {kind: known for kind, known in view.map_ranges.items() if kind is not view.map}
        if wanted is not None:
            ranges[view.map] = wanted
        self._editor.look(map_ranges=MappingProxyType(ranges))

    def _on_legend(self) -> None:
        scale = self._scale()
        if scale is not None:
            self._fix_range(scale.range if self._editor.view.map_range is None else None)

    def place_suggested(self) -> None:
        """Place the next landmark on the source where it helps most."""
        suggestion, session = self._suggestion(), self._editor.committed
        if suggestion is None:
            self._excuse_with(
                "Show the uncertainty first (View > Maps): it finds the place where the next "
                "landmark helps most."
            )
            return
        there = self._taken_by()
        if there is not None:
            self.refused.emit(
                f"{there} is there already: place it on the destination too "
                f"({self._hand.accept_action.keys} accepts its ghost)."
            )
            return
        name = self._ghosts.target(Side.SOURCE)
        waiting = session.landmark(name) if name is not None else None
        if waiting is not None and waiting.destination is not None:
            # It has its place in the anatomy: the suggested one is another.
            self.refused.emit(f"Place {name} on the source first: it lacks that side.")
            return
        self._hand.place(Side.SOURCE, suggestion.position)

    def _suggestion(self) -> Suggestion | None:
        survey = self.survey
        if survey is None or survey.map is None or survey.result is not self._resting:
            return None
        return survey.map.suggestion

    def _taken_by(self) -> str | None:
        """Return the landmark that stands where the next one helps most."""
        suggestion, mesh = self._suggestion(), self._editor.session.mesh(Side.SOURCE)
        if suggestion is None or mesh is None:
            return None
        reach = THERE * mesh.diagonal
        for landmark in self._editor.session.landmarks:
            place = landmark.source
            if place is not None and math.dist(place, suggestion.position) < reach:
                return landmark.name
        return None

    # From the warp to the survey

    def _on_result(self, result: WarpResult, at_rest: bool) -> None:
        refined_later = result.factor is not None and not result.factor.has_modes
        self._resting = result if at_rest and not refined_later else None
        if self._resting is None:
            if not self._surveys.is_idle:
                # What moves has the processors to itself.
                self._asked = None
                self._surveys.stop()
                self._show_work()
            self._scenes.renew()
        else:
            self._show_or_ask()

    def _on_view(self, _view: ViewState | None = None) -> None:
        if self._editor.view.map is not self._wanted:
            self._wanted = self._editor.view.map
            self._excuse_with("")
        self._show_or_ask()

    def _on_session(self, _session: Session) -> None:
        if not self._editor.is_previewing:
            self._show_or_ask()

    def _request(self) -> SurveyRequest | None:
        if self._resting is None:
            return None
        view, session = self._editor.view, self._editor.session
        return SurveyRequest(
            self._resting, session.mesh(Side.DESTINATION), view.map, view.map_relative
        )

    def _show_or_ask(self) -> None:
        """Show what was found last, and ask for what is wanted now if that is something else."""
        request = self._request()
        self._show()
        if request is None or request == self._asked:
            return
        self._asked = request
        self._surveys.request(request)
        self._show_work()

    def _show_work(self) -> None:
        """Say which map is being made."""
        asked = None if self._surveys.is_idle else self._asked
        kind = asked.kind if asked is not None else None
        self.panel.work.show_work("" if kind is None else TITLES[kind])

    def _on_survey(self, surveyed: Surveyed) -> None:
        self._show_work()
        current = self._request()
        if current is None or surveyed.request != current:
            return
        before = self.survey.findings if self.survey is not None else ()
        kind_before = self.survey.kind if self.survey is not None else None
        self._surveyed = surveyed
        self._show()
        survey = surveyed.survey
        if survey.missing and survey.kind is not kind_before:
            # The panel says so all the time; who chose from the menu may not see it.
            self._excuse_with(survey.missing)
        elif survey.kind is not None and survey.missing != self._excuse:
            self._excuse_with("")
        self.map_changed.emit(surveyed.survey)
        if surveyed.survey.findings != before:
            self.folds_changed.emit(surveyed.survey.findings)

    def _on_failure(self, error: Exception) -> None:
        self._show_work()
        raise error

    # From the survey to the screen

    def _scale(self) -> ColourScale | None:
        """Return the colours of the map that is shown."""
        survey, view = self.survey, self._editor.view
        if survey is None or survey.map is None or survey.kind is not view.map:
            return None
        kept = None if self._kept_ranges is None else self._kept_ranges.get(survey.map.kind)
        return ColourScale(
            survey.map.kind, view.map_range or kept or survey.map.range, self._ruler.factor
        )

    @property
    def _ruler(self) -> Ruler:
        """How what is measured on the destination is told."""
        return self._editor.rulers.destination

    def keep_ranges(self, kept: bool) -> None:
        """Keep the colours' range as it is while warps are compared, or let it follow again."""
        if kept == (self._kept_ranges is not None):
            return
        found = self.survey.map if self.survey is not None else None
        self._kept_ranges = None
        if kept:
            self._kept_ranges = {} if found is None else {found.kind: found.range}
        self._show()

    def _show(self) -> None:
        """Show the last survey as the view state wants it."""
        scale = self._scale()
        self.panel.show_survey(self.survey, self._editor.view, self._ruler, scale, self._taken_by())
        self.survey_shown.emit(self.survey)
        self._scenes.renew()

    def drawables(self, side: Side) -> Iterator[Drawable]:
        """Return map, folds and legend of the warp that is shown, and where it guesses."""
        if side is Side.SOURCE:
            suggestion = self._suggestion() if self._taken_by() is None else None
            if suggestion is not None:
                yield Star(suggestion, self._ruler.text(suggestion.deviation, 2))
            return
        if self.panel.work.words:
            yield WorkWords(self.panel.work.words)
        surveyed, scale = self._surveyed, self._scale()
        # While things move the overlay has moved on from under its colours.
        if surveyed is not None and is_of(surveyed.request.result, self._resting):
            if surveyed.levels is not None and scale is not None:
                yield Colouring(surveyed.levels, scale.kind, scale.range)
            if surveyed.folded is not None and surveyed.request.result is self._resting:
                yield surveyed.folded
        legend = self._legend(scale)
        if legend is not None and self._editor.view.overlay:
            yield legend

    def _legend(self, scale: ColourScale | None) -> Legend | None:
        survey, view = self.survey, self._editor.view
        if scale is None or survey is None or survey.map is None:
            return None
        (low, high), found = scale.range, survey.map
        return Legend(
            title=title_of(found.kind, fitted=survey.is_fitted),
            note=note_of(found, self._ruler.unit),
            kind=scale.kind,
            range=scale.range,
            # What differs in the last digits only is not beyond the end.
            clipped=(found.lowest < low - 1e-6 * (high - low), found.highest > high * (1 + 1e-6)),
            fixed=view.map_range is not None,
            factor=scale.factor,
        )
