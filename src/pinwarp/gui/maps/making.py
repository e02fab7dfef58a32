"""Surveys a warp in a worker, and makes ready what is drawn of it."""

from __future__ import annotations

import weakref
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from pinwarp.core.checkpoint import Checkpoint
from pinwarp.core.maps import MapKind
from pinwarp.core.mesh import Mesh
from pinwarp.gui.scene.drawables import FoldedSurface, MapLevels
from pinwarp.session.judging.survey import Survey, Surveyor
from pinwarp.session.warp.result import WarpResult


@dataclass(frozen=True)
class SurveyRequest:
    """Of which warp, onto what, a map is wanted."""

    result: WarpResult
    destination: Mesh | None
    kind: MapKind | None
    relative: bool


@dataclass(frozen=True, eq=False)
class Surveyed:
    """A survey made ready for the screen in the worker."""

    request: SurveyRequest
    survey: Survey
    levels: MapLevels | None
    folded: FoldedSurface | None


class MapMaker:
    """Makes what is asked for, keeping what the next map may share; for one worker."""

    def __init__(self) -> None:
        self._surveyor = Surveyor()
        self._nearest: weakref.WeakKeyDictionary[Mesh, NDArray] = weakref.WeakKeyDictionary()

    def make(self, request: SurveyRequest, checkpoint: Checkpoint) -> Surveyed:
        """Survey a warp; what the checkpoint raises ends it, and nothing is left of it."""
        result = request.result
        survey = self._surveyor.survey(
            result,
            request.destination,
            request.kind,
            relative=request.relative,
            checkpoint=checkpoint,
        )
        levels = survey.map.levels if survey.map is not None else None
        coarse = None
        stand_in, mesh = result.inputs.stand_in, result.inputs.mesh
        if levels is not None and stand_in is not None and mesh is not None:
            if stand_in not in self._nearest:
                _, rows = KDTree(mesh.vertices).query(stand_in.vertices)
                self._nearest[stand_in] = np.asarray(rows)
            coarse = levels[self._nearest[stand_in]]
        colours = MapLevels(levels, coarse) if levels is not None else None
        return Surveyed(request, survey, colours, _folded_surface(survey))


def is_of(surveyed: WarpResult, shown: WarpResult | None) -> bool:
    """Whether a warp is the one shown, or differs in its refinement only.

    From level to level the last colours stay until the next are there: else they would flicker.
    """
    if shown is None or surveyed is shown:
        return surveyed is shown
    return replace(surveyed.inputs, refinement=None) == replace(shown.inputs, refinement=None)


def _folded_surface(survey: Survey) -> FoldedSurface | None:
    result, folds = survey.result, survey.folds
    if folds is None or not folds.count or result.inputs.mesh is None or result.vertices is None:
        return None
    return FoldedSurface.of(folds, result.inputs.mesh.faces, result.vertices)
