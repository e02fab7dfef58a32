"""Surveys each warp at rest off the UI thread; shows its map, its folds and where it guesses."""

from __future__ import annotations

import math
import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from psygnal import Signal
from qtpy.QtCore import QObject
from qtpy.QtGui import QAction, QActionGroup
from scipy.spatial import KDTree

from pinwarp.core.landmarks import Side
from pinwarp.core.maps import MapKind, Range, Suggestion
from pinwarp.core.mesh import Mesh
from pinwarp.gui.drawn.folds import FoldedSurface
from pinwarp.gui.findings.fold_note import FoldNote
from pinwarp.gui.maps.panel import MapPanel
from pinwarp.gui.maps.words import TITLES, note_of
from pinwarp.gui.painted.colour_scale import ColourScale
from pinwarp.gui.painted.legend import LegendContent
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.views.viewport import Viewport
from pinwarp.gui.warp.warps import Presenter
from pinwarp.session.editor import Editor
from pinwarp.session.judging.survey import Survey, Surveyor
from pinwarp.session.session import Session
from pinwarp.session.view import ViewState
from pinwarp.session.warp.solver import WarpResult

MAP_ACTIONS = {kind: f"map_{kind.name.lower() if kind else 'none'}" for kind in (None, *MapKind)}
# Nearer to a suggested place than this share of the bone, a landmark counts as placed there.
THERE = 1e-3


@dataclass(frozen=True)
class _Request:
    result: WarpResult
    destination: Mesh | None
    kind: MapKind | None
    relative: bool


@dataclass(frozen=True, eq=False)
class _Drawable:
    """A survey made ready for the screen in the worker."""

    request: _Request
    survey: Survey
    levels: tuple[NDArray[np.float32] | None, NDArray[np.float32] | None]
    folded: FoldedSurface | None


class MapPresenter(QObject):
    """Everything between the surveys of the warp and what shows them.

    ``map_changed`` emits each survey, ``folds_changed`` the folds as findings whenever they are
    others, ``refused`` why something was not done, in words for the user.

    Parameters
    ----------
    editor
        The truth.
    presenter
        Where the warps come from, and who places landmarks.
    viewports
        One per side.
    panel
        The figures.
    actions
        The window's actions by key.
    parent
        The window.
    """

    map_changed = Signal(Survey)
    folds_changed = Signal(tuple)
    refused = Signal(str)

    def __init__(
        self,
        editor: Editor,
        presenter: Presenter,
        viewports: Mapping[Side, Viewport],
        panel: MapPanel,
        actions: Mapping[str, QAction],
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._editor = editor
        self._presenter = presenter
        self._viewports = viewports
        self._panel = panel
        self._actions = actions
        self._surveyor = Surveyor()
        self._nearest: weakref.WeakKeyDictionary[Mesh, NDArray] = weakref.WeakKeyDictionary()
        self._surveys = LatestWins(self._survey)
        self._surveys.computed.connect(self._on_survey)
        self._surveys.failed.connect(self._on_failure)
        self._resting: WarpResult | None = None
        self._drawable: _Drawable | None = None
        self._asked: _Request | None = None
        self._drawn: tuple[_Drawable | None, ColourScale | None] = (None, None)
        self.fold_note = FoldNote(editor, actions["focus"])
        self._connect()
        self._on_view()

    def _connect(self) -> None:
        editor, panel = self._editor, self._panel
        choices = QActionGroup(self)
        for kind, key in MAP_ACTIONS.items():
            choices.addAction(self._actions[key])
            self._actions[key].triggered.connect(lambda _checked=False, k=kind: self.show_map(k))
        self._actions["map_next"].triggered.connect(lambda _checked=False: self._next_map())
        self._actions["place_suggested"].triggered.connect(
            lambda _checked=False: self.place_suggested()
        )
        self._viewports[Side.DESTINATION].map_legend.clicked.connect(self._on_legend)
        panel.map_requested.connect(self.show_map)
        panel.range_requested.connect(self._fix_range)
        panel.relative_requested.connect(lambda on: editor.look(map_relative=on))
        self._presenter.result_changed.connect(self._on_result)
        editor.view_changed.connect(self._on_view)
        editor.session_changed.connect(self._on_session)

    def shut_down(self) -> None:
        """Stop the worker and let go of presenter and editor."""
        self._presenter.result_changed.disconnect(self._on_result)
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
        return self._drawable.survey if self._drawable is not None else None

    @property
    def opacity_key(self) -> str:
        """Which opacity of the view state the overlay is drawn with now."""
        found = self.survey.map if self.survey is not None else None
        return "opacity" if found is None or self._editor.view.map is None else "map_opacity"

    # What the user asks for

    def show_map(self, kind: MapKind | None) -> None:
        """Colour the warped source by something, or by nothing."""
        shown = {} if kind is None else {"overlay": True}
        self._editor.look(map=kind, **shown)

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
            self.refused.emit(
                "Show the uncertainty first (View > Maps): it finds the place where the next "
                "landmark helps most."
            )
            return
        there = self._taken_by()
        if there is not None:
            self.refused.emit(
                f"{there} is there already: place it on the destination too (Space accepts its "
                "ghost)."
            )
            return
        name = self._presenter.requests.target(Side.SOURCE)
        waiting = session.landmark(name) if name is not None else None
        if waiting is not None and waiting.destination is not None:
            # It has its place in the anatomy: the suggested one is another.
            self.refused.emit(f"Place {name} on the source first: it lacks that side.")
            return
        self._presenter.requests.place(Side.SOURCE, suggestion.position)

    def _suggestion(self) -> Suggestion | None:
        survey = self.survey
        if survey is None or survey.map is None or survey.result is not self._resting:
            return None
        return survey.map.suggestion

    def _taken_by(self) -> str | None:
        """Return the landmark that stands where the next one helps most."""
        suggestion, surface = self._suggestion(), self._viewports[Side.SOURCE].surface
        if suggestion is None or surface is None:
            return None
        reach = THERE * surface.diagonal
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
            # The overlay has moved on from under its colours.
            self._draw(None)
        else:
            self._show_or_ask()

    def _on_view(self, _view: ViewState | None = None) -> None:
        self._actions[MAP_ACTIONS[self._editor.view.map]].setChecked(True)
        self._show_or_ask()

    def _on_session(self, _session: Session) -> None:
        if not self._editor.is_previewing:
            self._show_or_ask()

    def _request(self) -> _Request | None:
        if self._resting is None:
            return None
        view, session = self._editor.view, self._editor.session
        return _Request(self._resting, session.mesh(Side.DESTINATION), view.map, view.map_relative)

    def _show_or_ask(self) -> None:
        """Show what was found last, and ask for what is wanted now if that is something else."""
        request = self._request()
        self._show()
        if request is None or request == self._asked:
            return
        self._asked = request
        self._surveys.request(request)

    def _survey(self, request: _Request) -> _Drawable:
        """Survey a warp and make ready what is drawn of it; runs in the worker."""
        result = request.result
        survey = self._surveyor.survey(
            result, request.destination, request.kind, relative=request.relative
        )
        levels = survey.map.levels if survey.map is not None else None
        coarse = None
        stand_in, mesh = result.inputs.stand_in, result.inputs.mesh
        if levels is not None and stand_in is not None and mesh is not None:
            if stand_in not in self._nearest:
                _, rows = KDTree(mesh.vertices).query(stand_in.vertices)
                self._nearest[stand_in] = np.asarray(rows)
            coarse = levels[self._nearest[stand_in]]
        return _Drawable(request, survey, (levels, coarse), _folded_surface(survey))

    def _on_survey(self, drawable: _Drawable) -> None:
        current = self._request()
        if current is None or drawable.request != current:
            return
        before = self.survey.findings if self.survey is not None else ()
        kind_before = self.survey.kind if self.survey is not None else None
        self._drawable = drawable
        self._show()
        if drawable.survey.missing and drawable.survey.kind is not kind_before:
            # The panel says so all the time; who chose from the menu may not see it.
            self.refused.emit(drawable.survey.missing)
        self.map_changed.emit(drawable.survey)
        if drawable.survey.findings != before:
            self.folds_changed.emit(drawable.survey.findings)

    def _on_failure(self, error: Exception) -> None:
        raise error

    # From the survey to the screen

    def _scale(self) -> ColourScale | None:
        """Return the colours of the map that is shown."""
        survey, view = self.survey, self._editor.view
        if survey is None or survey.map is None or survey.kind is not view.map:
            return None
        return ColourScale(survey.map.kind, view.map_range or survey.map.range)

    def _show(self) -> None:
        """Show the last survey as the view state wants it."""
        session, drawable, scale = self._editor.session, self._drawable, self._scale()
        self._panel.show_survey(
            self.survey, self._editor.view, session.unit, scale, self._taken_by()
        )
        self.fold_note.show_survey(self.survey)
        fresh = drawable is not None and drawable.request.result is self._resting
        self._draw(drawable if fresh else None)

    def _draw(self, drawable: _Drawable | None) -> None:
        """Draw a survey over the destination, or nothing of the kind while things move."""
        scale, there = self._scale(), self._viewports[Side.DESTINATION]
        # Only what changed: a hovered landmark must not upload a million colours anew.
        if (drawable, scale) != self._drawn:
            if drawable is None or scale is None:
                there.show_map((None, None), None)
            else:
                there.show_map(drawable.levels, scale.table())
            if drawable is None or self._drawn[0] is not drawable:
                there.show_folds(drawable.folded if drawable is not None else None)
            self._drawn = (drawable, scale)
        there.show_legend(self._legend(scale) if self._editor.view.overlay else None)
        marked = self._suggestion() if self._taken_by() is None else None
        self._viewports[Side.SOURCE].layer.show_suggestion(marked)

    def _legend(self, scale: ColourScale | None) -> LegendContent | None:
        survey, view = self.survey, self._editor.view
        if scale is None or survey is None or survey.map is None:
            return None
        (low, high), found = scale.range, survey.map
        return LegendContent(
            title=TITLES[found.kind],
            note=note_of(found, self._editor.session.unit),
            scale=scale,
            # What differs in the last digits only is not beyond the end.
            clipped=(found.lowest < low - 1e-6 * (high - low), found.highest > high * (1 + 1e-6)),
            fixed=view.map_range is not None,
        )


def _folded_surface(survey: Survey) -> FoldedSurface | None:
    result, folds = survey.result, survey.folds
    if folds is None or not folds.count or result.inputs.mesh is None or result.vertices is None:
        return None
    return FoldedSurface.of(folds, result.inputs.mesh.faces, result.vertices)
