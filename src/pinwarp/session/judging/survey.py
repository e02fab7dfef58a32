"""A look at a whole warp: one map of it, and always whether it folds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pinwarp.core.checkpoint import Checkpoint, go_on, within
from pinwarp.core.errors import RangeError
from pinwarp.core.findings import Finding
from pinwarp.core.folds import Folds, folds_of
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.maps import (
    MapKind,
    SurfaceMap,
    distance_map,
    must_be_relative,
    overall_size,
    stretch_maps,
    uncertainty_map,
    volume_map,
)
from pinwarp.core.mesh import Mesh
from pinwarp.core.prediction import prediction_of
from pinwarp.core.spline import Spline
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.session.warp.ghost import FEWEST_PAIRS
from pinwarp.session.warp.result import WarpResult

# Shares of a survey's time: the look for folds, and of a distance map the two indexes.
LOOK, INDEX = 0.1, 0.3
FEW_PAIRS = (
    "The uncertainty needs three pairs: with fewer a prediction says more about them than about "
    "the bone. Place another pair."
)


@dataclass(frozen=True, eq=False)
class Survey:
    """What was found all over the source.

    Attributes
    ----------
    result
        The warp.
    kind, map
        The map that was asked for, and what it shows; None where there is none.
    missing
        Why there is no map although one was asked for, and the way out, in words for the user.
    folds
        None without a warp or a source mesh.
    size
        By how much longer the warp makes the source as a whole.
    """

    result: WarpResult
    kind: MapKind | None = None
    map: SurfaceMap | None = None
    missing: str = ""
    folds: Folds | None = None
    size: float = 1.0

    @property
    def is_fitted(self) -> bool:
        """Whether the warp was fitted to the destination's surface."""
        return self.result.is_fitted

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The folds as facts that can be put in words, the largest first."""
        return tuple(patch.finding for patch in self.folds.patches) if self.folds else ()


class Surveyor:
    """Surveys warps, keeping what the next survey may share. For use by one thread at a time.

    Attributes
    ----------
    indexes, maps
        How many were really made, for tests and for the curious.
    """

    def __init__(self) -> None:
        self._index: SurfaceIndex | None = None
        self._index_warped: SurfaceIndex | None = None
        self._result: WarpResult | None = None
        self._source: Mesh | None = None
        self._destination: Mesh | None = None
        self._determinant = np.zeros(0)
        self._folds: Folds | None = None
        self._maps: dict[MapKind, SurfaceMap] = {}
        self._size = self._taken_out = 1.0
        self.indexes = 0
        self.maps = 0

    def survey(
        self,
        result: WarpResult,
        destination: Mesh | None,
        kind: MapKind | None,
        *,
        relative: bool = False,
        checkpoint: Checkpoint = go_on,
    ) -> Survey:
        """Look at a warp.

        Parameters
        ----------
        result
            A warp at rest.
        destination
            The mesh whose shape the source takes.
        kind
            The map to make, if any.
        relative
            Whether the overall difference in size is taken out of ratios. It always is where
            it is more than twofold.
        checkpoint
            Passed often: what it raises ends the survey, and the next one begins anew.

        Examples
        --------
        >>> from pinwarp.session.warp.result import WarpInputs
        >>> from pinwarp.session.session import Session
        >>> result = WarpResult(WarpInputs.of(Session()))
        >>> Surveyor().survey(result, None, MapKind.VOLUME).missing
        'Open the source mesh: the map is drawn on it.'
        """
        missing = "" if kind is None else _missing(result, destination, kind)
        mesh, shown = result.inputs.mesh, result.shown
        self._let_go_of_others(mesh, destination)
        if mesh is None or shown is None:
            return Survey(result, kind, missing=missing)
        try:
            self._look_at(result, mesh, shown, within(checkpoint, 0.0, LOOK))
        except RangeError as error:
            return Survey(result, kind, missing="" if kind is None else str(error))
        taken_out = self._size if relative or must_be_relative(self._size) else 1.0
        if taken_out != self._taken_out:
            self._taken_out = taken_out
            self._maps = {part: made for part, made in self._maps.items() if not part.is_ratio}
        if kind is not None and not missing:
            try:
                if kind not in self._maps:
                    self._make(kind, result, mesh, shown, within(checkpoint, LOOK, 1.0))
                if kind not in self._maps:
                    missing = FEW_PAIRS
            except RangeError as error:
                missing = str(error)
        found = self._maps.get(kind) if kind is not None and not missing else None
        return Survey(result, kind, found, missing, self._folds, self._size)

    def _let_go_of_others(self, mesh: Mesh | None, destination: Mesh | None) -> None:
        """Keep nothing of meshes that are closed: an index takes ten times their memory."""
        if self._source is not mesh:
            self._source, self._index_warped = mesh, None
            self._result, self._maps, self._folds = None, {}, None
        if self._destination is not destination:
            self._destination, self._index = destination, None
            self._maps.pop(MapKind.DISTANCE, None)

    def _look_at(
        self, result: WarpResult, mesh: Mesh, shown: Spline, checkpoint: Checkpoint
    ) -> None:
        """Do what every survey of a warp needs, unless it was done for the last one."""
        if result is self._result:
            return
        self._result, self._maps = None, {}
        self._determinant = determinants(jacobians(shown, mesh.vertices, checkpoint))
        checkpoint(1.0)
        self._folds = folds_of(self._determinant, mesh, shown, len(result.inputs.source))
        assert result.factor is not None, "what is shown was solved from it"
        self._size = overall_size(shown, result.factor)
        self._result = result

    def _make(
        self,
        kind: MapKind,
        result: WarpResult,
        mesh: Mesh,
        shown: Spline,
        checkpoint: Checkpoint,
    ) -> None:
        factor, inputs = result.factor, result.inputs
        assert factor is not None, "what is shown was solved from it"
        made: tuple[SurfaceMap, ...] = ()
        match kind:
            case MapKind.DISTANCE:
                assert result.vertices is not None, "a warp at rest has its vertices"
                assert self._destination is not None, "else the map would be missing"
                warped = mesh.with_vertices(result.vertices)
                indexed, both = (within(checkpoint, 0.0, INDEX / 2), within(checkpoint, INDEX, 1.0))
                self._index_warped = SurfaceIndex(warped, self._index_warped, indexed)
                index = self._index_of(self._destination, within(checkpoint, INDEX / 2, INDEX))
                made = (distance_map(warped, self._destination, self._index_warped, index, both),)
            case MapKind.VOLUME:
                sign = -1 if self._folds is not None and self._folds.mirrors else 1
                made = (volume_map(sign * self._determinant, mesh, self._taken_out),)
            case MapKind.LARGEST_STRETCH | MapKind.SMALLEST_STRETCH:
                jacobian = jacobians(shown, mesh.vertices, checkpoint)
                made = stretch_maps(jacobian, mesh, self._taken_out)
            case MapKind.UNCERTAINTY:
                # Of the landmarks alone, whatever else was fitted to the surface.
                prediction = prediction_of(
                    factor, np.array(inputs.destination), inputs.settings.penalty, mesh.diagonal
                )
                made = (uncertainty_map(prediction, mesh, checkpoint),)
        self.maps += len(made)
        self._maps.update({part.kind: part for part in made})

    def _index_of(self, mesh: Mesh, checkpoint: Checkpoint) -> SurfaceIndex:
        if self._index is None or self._index.mesh is not mesh:
            self._index = SurfaceIndex(mesh, checkpoint=checkpoint)
            self.indexes += 1
        return self._index


def _missing(result: WarpResult, destination: Mesh | None, kind: MapKind) -> str:
    """Say what a map lacks, and the way out; nothing where it can be made."""
    inputs = result.inputs
    if inputs.mesh is None:
        return "Open the source mesh: the map is drawn on it."
    if result.shown is None:
        return result.problem or (
            "Place a landmark on both bones: without a pair there is no warp to map."
        )
    if kind is MapKind.DISTANCE and destination is None:
        return "Open the destination mesh: the distance to it is what this map shows."
    if kind is MapKind.UNCERTAINTY:
        if len(inputs.source) < FEWEST_PAIRS:
            return FEW_PAIRS
        if not inputs.settings.is_regular:
            return (
                "The uncertainty belongs to the regularising convention: "
                "choose that one, or a penalty of 0."
            )
    return ""
