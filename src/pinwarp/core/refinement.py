"""Refine a warp to the whole surface: many places are drawn to the destination, level by level.

Places spread over the source are held along the normal of the destination's closest place, softly
(:mod:`pinwarp.core.conditions`): they go to the surface and slide on it, while every landmark is
met. It is the sliding of :mod:`pinwarp.core.sliding` with a penalty for each place, solved as
iterated closest points are (Besl and McKay, IEEE PAMI 14 (1992)). The levels go from half the
size of the bone to the smallest feature asked for. At the wavelength l the penalty

    s = (places / area) l^3 / (2 pi)^2

halves a ripple of that length whatever the unit and the number of places are: large features are
bent first, while what is nearest is not yet what answers. A place counts the less the more the
surfaces differ in direction there and the further it lies off compared with the others, and not
at all where its closest place is on a rim, beyond which the destination may simply not have been
scanned.

Where a vertex of the source would fold, or be crushed more than the landmarks crush it, the
places around get stiffer until none is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import KDTree

from pinwarp.core.conditions import (
    ConditionFactor,
    Conditions,
    factorise_conditions,
    held,
    held_across,
    held_along,
)
from pinwarp.core.features import FEWEST_PLACES, levels_to, places_for
from pinwarp.core.fold_control import FoldControl
from pinwarp.core.mesh import Mesh
from pinwarp.core.positions import as_positions
from pinwarp.core.readiness import check_facing, starting_warp
from pinwarp.core.refinement_inputs import DrawnPoints, RefinementSettings, Start
from pinwarp.core.sampling import spread_places, triangle_areas
from pinwarp.core.spline import Spline
from pinwarp.core.surface import Places, Surface, carried_normals

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Turns at the last level, unless the largest move falls below this share of the spacing.
TURNS = 8
SETTLED = 0.02
# Places count fully where the surfaces face alike, and not from this cosine down.
LEAST_COSINE = 0.5
# A place this many medians off counts a quarter; the median is at least this share of the size.
OUTLYING = 4.0
SMALLEST_MEDIAN = 0.002
WORTH_KEEPING = 1e-3
# At least this share of the places must face as the destination does, rims aside.
FACING_ALIKE = 0.5
# Stiffening around folds: by how much, to what, how far around, wider each time, how often.
STIFFEN, STIFFEST = 4.0, 1e4
REACH, WIDEN = 1.5, 1.35
STIFFENINGS = 8


@dataclass(frozen=True, eq=False)
class Level:
    """Where a refinement stands after one of its levels.

    Attributes
    ----------
    number, count
        Which level of how many, from 1.
    feature : float
        What is larger than this has been bent, in source mesh units.
    spline : Spline
        A valid warp: the last one without a new fold.
    kept, places : int
        How many places the destination draws, of how many that were tried.
    folding : int
        How many vertices still folded in the last try; the levels to come undo that.
    move : float
        The largest move of a place in the last turn, in destination mesh units.
    """

    number: int
    count: int
    feature: float
    spline: Spline
    kept: int
    places: int
    folding: int
    move: float


@dataclass(frozen=True, eq=False)
class Refinement:
    """A refined warp.

    Attributes
    ----------
    spline : Spline
        An ordinary spline of penalty 0: its source are the landmarks, then the fitted places.
    landmarks : int
        How many rows of its source are landmarks.
    places : int
        How many places were spread over the source.
    smallest_feature : float
        In source mesh units.
    levels : tuple of Level
        How it came about.
    folding : int
        Vertices that folded at the end, so that an earlier step was kept; else 0.
    """

    spline: Spline
    landmarks: int
    places: int
    smallest_feature: float
    levels: tuple[Level, ...]
    folding: int

    @property
    def fitted(self) -> int:
        """How many places were fitted; 0 where the warp is still that of the landmarks."""
        return len(self.spline.source) - self.landmarks

    @property
    def pairs(self) -> tuple[Matrix, Matrix]:
        """Where the spline's places are on the source and where it takes them: all it takes."""
        return self.spline.source, self.spline.evaluate(self.spline.source)


def refine(
    source: Mesh,
    destination: Mesh | Surface,
    source_landmarks: ArrayLike,
    destination_landmarks: ArrayLike,
    settings: RefinementSettings | None = None,
    *,
    curves: Sequence[DrawnPoints] = (),
    start: Start | None = None,
    told: Callable[[Level], None] = lambda _level: None,
    progress: Callable[[float, str], None] = lambda _share, _words: None,
) -> Refinement:
    """Refine the warp of some landmarks to the whole surface.

    A small distance afterwards proves nothing: it is what was fitted. On one machine the result
    is the same bit for bit, whoever asks for it.

    Parameters
    ----------
    source, destination
        The surfaces; holes and rims, several parts and edges shared by three triangles do. The
        destination may have been made ready to be searched already.
    source_landmarks, destination_landmarks
        (n, 3) row by row the same places; at least four, not in one plane, unless there is a
        ``start``.
    settings
        How.
    curves
        Points of curves that somebody drew on both surfaces: they stay on their curve, within the
        tolerance of the landmarks.
    start
        Where to begin; without it with the warp of the landmarks.
    told
        Called after each level.
    progress
        Called at each turn with the share done and words; what it raises ends the refinement.

    Returns
    -------
    Refinement

    Raises
    ------
    LandmarkError
        When the landmarks are too few, lie in one plane, coincide, or mirror the source.
    InsideOutError
        When one mesh faces inwards.
    MeshError
        When the landmarks do not lay one surface on the other.

    Examples
    --------
    >>> import pyvista as pv
    >>> ball = pv.Icosphere(radius=10.0, nsub=3)
    >>> source = Mesh(ball.points, ball.regular_faces)
    >>> egg = source.with_vertices(source.vertices * (1 + 0.02 * source.vertices[:, 2:]))
    >>> rows = [0, 1, 2, 3, 4, 5, 20, 30]
    >>> refined = refine(source, egg, source.vertices[rows], egg.vertices[rows])
    >>> off = Surface(egg).index.distances(refined.spline.evaluate(source.vertices))
    >>> bool(off.max() < 0.2)
    True
    """
    settings = settings or RefinementSettings()
    surface = destination if isinstance(destination, Surface) else Surface(destination)
    if settings.turn_destination:
        surface = Surface(Mesh(surface.mesh.vertices, surface.mesh.faces[:, ::-1]))
    if start is None:
        spline = starting_warp(source_landmarks, destination_landmarks, settings.landmark_tolerance)
        start = Start(spline, np.zeros((0, 3)), 0.0)
    run = _Run(
        source,
        surface,
        as_positions(source_landmarks, "source landmark"),
        as_positions(destination_landmarks, "destination landmark"),
        settings,
        curves,
        start,
    )
    levels: list[Level] = []
    for number, feature in enumerate(run.features, 1):
        for turn in range(TURNS if feature == run.features[-1] else 1):
            words = f"level {number} of {len(run.features)}"
            progress((number - 1 + turn / TURNS) / len(run.features), words)
            if run.turn(feature, is_last=turn == TURNS - 1):
                break
        level = Level(
            number,
            len(run.features),
            feature,
            run.good,
            run.kept,
            run.tried,
            run.folding,
            run.move,
        )
        levels.append(level)
        told(level)
    return Refinement(
        spline=run.good,
        landmarks=run.landmarks,
        places=len(run.places),
        smallest_feature=run.features[-1],
        levels=tuple(levels),
        folding=run.folding,
    )


class _Run:
    """One refinement under way: what is given, and what changes from turn to turn."""

    def __init__(
        self,
        source: Mesh,
        surface: Surface,
        source_landmarks: Matrix,
        destination_landmarks: Matrix,
        settings: RefinementSettings,
        curves: Sequence[DrawnPoints],
        start: Start,
    ) -> None:
        self.curves = curves
        on_curves = [np.zeros((0, 3)), *(curve.source for curve in curves)]
        self.on_curves = np.vstack(on_curves)
        self.first, self.landmarks = start.spline, len(source_landmarks)
        self.held = np.vstack([source_landmarks, start.loose])
        self.destination = np.vstack([destination_landmarks, self.first.evaluate(start.loose)])
        self.surface, self.tolerance = surface, settings.landmark_tolerance
        counts = 3 * self.landmarks, 3 * len(start.loose)
        self.penalties = np.repeat([self.tolerance, start.penalty], counts)
        self.area = float(triangle_areas(source).sum())
        count = places_for(self.area, settings.smallest_feature)
        taken = np.vstack([source_landmarks, self.on_curves])
        positions, triangles = spread_places(source, count, taken)
        self.places = Surface(source).at(triangles, positions)
        self.spacing = float(np.sqrt(self.area / count))
        self.features = levels_to(settings.smallest_feature or self.spacing, source.diagonal)
        self.growth = abs(float(np.linalg.det(self.first.affine[1:]))) ** (1 / 3)
        self.size = self.growth * source.diagonal
        self.folds = FoldControl(
            self.first, np.vstack([source.vertices[source.on_surface], positions])
        )
        met = surface.closest(self.first.evaluate(positions))
        judged = ~met.on_rim
        check_facing(self._cosines(self.first, met)[judged], surface.mesh, FACING_ALIKE)

        self.stiffness = np.ones(count)
        self.spline = self.good = self.first
        self.feature = np.inf
        self.kept = self.tried = self.folding = 0
        self.move = np.inf

    def turn(self, feature: float, *, is_last: bool) -> bool:
        """Fit once; return whether nothing is left to do at this wavelength."""
        if feature < self.feature:
            self.stiffness = np.maximum(self.stiffness / STIFFEN, 1.0)
            self.move = np.inf
        self.feature = feature
        self.tried = min(
            len(self.places), max(FEWEST_PLACES, int(np.ceil(self.area * (2 / feature) ** 2)))
        )
        tried = slice(0, self.tried)
        now = self.spline.evaluate(self.places.positions[tried])
        met = self.surface.closest(now)
        weights = self._weights(now, met)
        kept = np.flatnonzero(weights > WORTH_KEEPING)
        self.kept = len(kept)
        along, tangents = self._along()
        first, second = len(self.destination), len(self.destination) + len(along)
        conditions = [
            held(np.arange(first)),
            held_across(np.arange(first, second), tangents),
            held_along(second + np.arange(self.kept), met.normals[kept]),
        ]
        factor = factorise_conditions(
            np.vstack([self.held, self.on_curves, self.places.positions[kept]]),
            Conditions.joined(conditions),
        )
        aims = np.vstack([self.destination, along, met.positions[kept]])
        softness = len(kept) / self.area * feature**3 / (2 * np.pi) ** 2 / weights[kept]
        is_final = is_last or (
            feature == self.features[-1] and self.move < SETTLED * self.growth * self.spacing
        )
        for attempt in range(STIFFENINGS + 1 if is_final else 1):
            trial = self._solved(factor, aims, softness * self.stiffness[kept])
            bad = self.folds.bad(trial)
            if not len(bad):
                break
            near = REACH * self.spacing * np.sqrt(len(self.places) / self.tried) * WIDEN**attempt
            reached = np.asarray(KDTree(bad).query(self.places.positions[tried])[0]) < near
            stiffer = np.minimum(self.stiffness[tried] * STIFFEN, STIFFEST)
            self.stiffness[tried] = np.where(reached, stiffer, self.stiffness[tried])
        self.folding = len(bad)
        moved = trial.evaluate(self.places.positions[tried]) - now
        self.move = float(np.linalg.norm(moved, axis=1).max())
        self.spline = trial
        if not len(bad):
            self.good = trial
        return is_final

    def _solved(self, factor: ConditionFactor, aims: Matrix, softness: Matrix) -> Spline:
        # Landmarks and what is on curves come first.
        count = len(factor.conditions.rows) - len(softness) - len(self.penalties)
        on_curves = np.full(count, self.tolerance)
        return factor.solve(aims, np.concatenate([self.penalties, on_curves, softness]))

    def _along(self) -> tuple[Matrix, Matrix]:
        """Return where the points of curves belong now, and the tangents there."""
        now = self.spline.evaluate(self.on_curves)
        ends = np.cumsum([len(curve.source) for curve in self.curves])[:-1]
        met = [
            curve.path.closest(part)
            for curve, part in zip(self.curves, np.split(now, ends), strict=False)
        ]
        none = np.zeros((0, 3))
        return (
            np.vstack([none, *(positions for positions, _ in met)]),
            np.vstack([none, *(tangents for _, tangents in met)]),
        )

    def _weights(self, now: Matrix, met: Places) -> Matrix:
        """Return how much each place counts, from 0 to 1."""
        cosines = self._cosines(self.spline, met)
        alike = np.clip((cosines - LEAST_COSINE) / (1 - LEAST_COSINE), 0.0, 1.0)
        off = np.linalg.norm(met.positions - now, axis=1)
        counted = off[(alike > 0) & ~met.on_rim]
        usual = float(np.median(counted)) if len(counted) else 0.0
        far = off / max(OUTLYING * usual, SMALLEST_MEDIAN * self.size)
        return np.asarray(np.where(met.on_rim, 0.0, alike / (1 + far**2) ** 2))

    def _cosines(self, spline: Spline, met: Places) -> Matrix:
        """Return the cosines between the carried normals of the places and those they met."""
        part = slice(0, len(met))
        carried = carried_normals(spline, self.places.positions[part], self.places.normals[part])
        return np.asarray(np.sum(carried * met.normals, axis=1))
