"""Maps of the warp over the source's surface: where it misses, swells, stretches, or guesses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.checkpoint import Checkpoint, go_on
from pinwarp.core.errors import RangeError
from pinwarp.core.factor import SourceFactor
from pinwarp.core.jacobian import stretches
from pinwarp.core.landmarks import Position, as_position
from pinwarp.core.live import LARGEST_SINGLE
from pinwarp.core.mesh import Mesh
from pinwarp.core.prediction import Prediction
from pinwarp.core.spline import Spline, solve
from pinwarp.core.surface_comparison import SurfaceComparison, compare_surfaces
from pinwarp.core.surface_distance import SurfaceIndex

Matrix = NDArray[np.float64]
Range = tuple[float, float]

# Bones more different in length than this are always compared relative to their sizes: they are
# not of one unit, or all of the map would be of one colour.
SAME_SIZE = 2.0
# The automatic legend reaches as far as this share of the vertices, and for ratios at least and
# at most so many doublings either way.
SHARE_SHOWN = 99.0
LEAST_DOUBLINGS = 0.1
MOST_DOUBLINGS = 2.0
# What is turned inside out has no logarithm: it lies below all that has one.
FOLDED_LEVEL = -10.0
BINS = 48
# A range of less is none.
TINIEST = 1e-290


class MapKind(StrEnum):
    """What the warped source is coloured by."""

    DISTANCE = "distance"
    VOLUME = "volume"
    LARGEST_STRETCH = "largest stretch"
    SMALLEST_STRETCH = "smallest stretch"
    UNCERTAINTY = "uncertainty"

    @property
    def is_ratio(self) -> bool:
        """Whether it is without a unit, neutral at 1, and read in doublings and halvings."""
        return self not in (MapKind.DISTANCE, MapKind.UNCERTAINTY)

    def levels(self, values: ArrayLike) -> NDArray[np.floating]:
        """Return values on the scale they are shown on: ratios as doublings, others as they are.

        In the precision of the values.

        Examples
        --------
        >>> MapKind.VOLUME.levels([0.5, 4.0, -1.0]).tolist()
        [-1.0, 2.0, -10.0]
        """
        plain = np.asarray(values)
        if plain.dtype.kind != "f":
            plain = plain.astype(np.float64)
        if not self.is_ratio:
            return plain
        out = np.full_like(plain, FOLDED_LEVEL)
        np.log2(plain, out=out, where=plain > 0)
        np.maximum(out, FOLDED_LEVEL, out=out)
        return out


@dataclass(frozen=True, eq=False)
class Histogram:
    """How often each level occurs.

    Attributes
    ----------
    edges : (b + 1,) float64
        Of the bins, as :meth:`MapKind.levels`.
    shares : (b,) float64
        Of the vertices, per bin.
    """

    edges: Matrix
    shares: Matrix


@dataclass(frozen=True)
class Suggestion:
    """Where the next landmark helps most.

    Parameters
    ----------
    position
        On the source, in its mesh unit.
    deviation
        The warp's standard deviation there, in destination mesh units.
    """

    position: Position
    deviation: float


@dataclass(frozen=True, eq=False)
class SurfaceMap:
    """One figure for every vertex of the source.

    Attributes
    ----------
    kind
        What the figures are.
    values : (m,) float32
        Lengths in destination mesh units; ratios without a unit.
    lowest, median, highest
        Of the vertices that belong to a triangle.
    range
        What the legend shows of itself.
    histograms
        Of the values; for distances also of those from the destination to the warped source,
        in the same bins.
    comparison
        For distances, both ways: ``forward`` is from the warped source to the destination.
    suggestion
        For the uncertainty, the vertex where it is largest.
    overall
        The length ratio that was taken out; 1 where none was.
    """

    kind: MapKind
    values: NDArray[np.float32]
    lowest: float
    median: float
    highest: float
    range: Range
    histograms: tuple[Histogram, ...]
    comparison: SurfaceComparison | None = None
    suggestion: Suggestion | None = None
    overall: float = 1.0

    @property
    def levels(self) -> NDArray[np.float32]:
        """The values on the scale they are shown on."""
        return self.kind.levels(self.values).astype(np.float32, copy=False)


def distance_map(
    warped: Mesh,
    destination: Mesh,
    index_warped: SurfaceIndex | None = None,
    index_destination: SurfaceIndex | None = None,
    checkpoint: Checkpoint = go_on,
) -> SurfaceMap:
    """Map how far the warped source lies from the destination.

    Parameters
    ----------
    warped, destination
        In the destination's frame and unit.
    index_warped, index_destination
        Their indexes, where they are built already.
    checkpoint
        Passed often: what it raises ends the work.

    Examples
    --------
    >>> low = Mesh([[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    >>> high = Mesh([[0, 0, 1], [2, 0, 1], [0, 2, 1]], [[0, 1, 2]])
    >>> distance_map(low, high).values.tolist()
    [1.0, 1.0, 1.0]
    """
    compared = compare_surfaces(
        warped,
        destination,
        index_a=index_warped,
        index_b=index_destination,
        checkpoint=checkpoint,
    )
    both = (compared.forward[warped.on_surface], compared.backward[destination.on_surface])
    return _map(MapKind.DISTANCE, compared.forward, *both, comparison=compared)


def volume_map(determinant: ArrayLike, mesh: Mesh, overall: float = 1.0) -> SurfaceMap:
    """Map how much volume the warp gives to a small piece of the source.

    Parameters
    ----------
    determinant
        (m,) of the warp's derivative at the vertices, its sign turned where the warp mirrors.
    mesh
        The source.
    overall
        The length ratio to take out, from :func:`overall_size`.

    Examples
    --------
    >>> mesh = Mesh([[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    >>> volume_map([8.0, 16.0, 4.0], mesh, overall=2.0).values.tolist()
    [1.0, 2.0, 0.5]
    """
    values = np.asarray(determinant, dtype=np.float64) / overall**3
    return _map(MapKind.VOLUME, values, values[mesh.on_surface], overall=overall)


def stretch_maps(
    jacobian: Matrix, mesh: Mesh, overall: float = 1.0
) -> tuple[SurfaceMap, SurfaceMap]:
    """Map the largest and the smallest stretch of any direction.

    Parameters
    ----------
    jacobian
        (m, 3, 3), from :func:`~pinwarp.core.jacobian.jacobians`, at the vertices.
    mesh, overall
        As for :func:`volume_map`.

    Examples
    --------
    >>> mesh = Mesh([[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    >>> maps = stretch_maps(np.array([np.diag([3.0, 1.0, 0.5])] * 3), mesh)
    >>> [part.highest for part in maps]
    [3.0, 0.5]
    """
    kinds, used = (MapKind.LARGEST_STRETCH, MapKind.SMALLEST_STRETCH), mesh.on_surface
    largest, smallest = (
        _map(kind, values / overall, values[used] / overall, overall=overall)
        for kind, values in zip(kinds, stretches(jacobian), strict=True)
    )
    return largest, smallest


def uncertainty_map(
    prediction: Prediction, mesh: Mesh, checkpoint: Checkpoint = go_on
) -> SurfaceMap:
    """Map the standard deviation of one coordinate of the warp.

    Parameters
    ----------
    prediction
        Of the pairs, from :func:`~pinwarp.core.prediction.prediction_of`.
    mesh
        The source.
    checkpoint
        Passed often: what it raises ends the work.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> from pinwarp.core.prediction import prediction_of
    >>> source = np.vstack([np.eye(3), -np.eye(3)])
    >>> prediction = prediction_of(factorise(source), source + np.sin(source) ** 2, 0.0)
    >>> mesh = Mesh([[0, 0, 0], [9, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> uncertainty_map(prediction, mesh).suggestion.position
    (9.0, 0.0, 0.0)
    """
    values, used = prediction.standard_deviation(mesh.vertices, checkpoint), mesh.on_surface
    row = int(np.argmax(np.where(used, values, -1.0)))
    suggestion = Suggestion(as_position(mesh.vertices[row]), float(values[row]))
    return _map(MapKind.UNCERTAINTY, values, values[used], suggestion=suggestion)


def overall_size(shown: Spline, factor: SourceFactor) -> float:
    """Return by how much longer the warp makes the source as a whole.

    Parameters
    ----------
    shown
        The warp as it is applied.
    factor
        The pairs it was solved from.

    Returns
    -------
    float
        The cube root of the determinant of the affine fit to the warped landmarks; 1 where that
        fit flattens everything.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> source = np.random.default_rng(0).normal(size=(6, 3))
    >>> factor = factorise(source)
    >>> [round(overall_size(solve(factor, k * source), factor), 9) for k in (1.5, 1000.0)]
    [1.5, 1000.0]
    """
    fit = solve(factor, shown.evaluate(factor.source), math.inf)
    # By the logarithm: the determinant itself may be beyond all numbers.
    sign, logarithm = np.linalg.slogdet(fit.affine[1:])
    return math.exp(logarithm / 3) if sign != 0 and math.isfinite(logarithm) else 1.0


def must_be_relative(size: float) -> bool:
    """Whether bones of this ratio in length can only be compared relative to their sizes.

    Examples
    --------
    >>> must_be_relative(0.9), must_be_relative(0.001)
    (False, True)
    """
    return not 1 / SAME_SIZE <= size <= SAME_SIZE


def automatic_range(kind: MapKind, values: ArrayLike) -> Range:
    """Return a round range that shows nearly all values; for ratios as far below 1 as above.

    Examples
    --------
    >>> automatic_range(MapKind.DISTANCE, [0.0, 3.9]), automatic_range(MapKind.VOLUME, [1, 2, 9])
    ((0.0, 4.0), (0.25, 4.0))
    """
    levels = kind.levels(values)
    if kind.is_ratio:
        reach = float(np.percentile(np.abs(levels), SHARE_SHOWN))
        reach = min(max(reach, LEAST_DOUBLINGS), MOST_DOUBLINGS)
        return 2.0**-reach, 2.0**reach
    return 0.0, _round_up(float(np.percentile(levels, SHARE_SHOWN)))


def _round_up(value: float) -> float:
    """Return the next round number; 1 where there is nothing to round."""
    if not TINIEST < value < 1 / TINIEST:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    steps = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
    return next(step for step in (*steps, 20.0) if step * power >= value * (1 - 1e-9)) * power


def _map(
    kind: MapKind,
    values: Matrix,
    used: Matrix,
    *others: Matrix,
    comparison: SurfaceComparison | None = None,
    suggestion: Suggestion | None = None,
    overall: float = 1.0,
) -> SurfaceMap:
    """Put a map together from all values, and from those that count.

    RangeError where single precision, in which it is drawn, cannot hold them.
    """
    largest = max(float(np.abs(values).max()), *(float(np.abs(one).max()) for one in others), 0.0)
    if not largest <= LARGEST_SINGLE:
        raise RangeError(
            f"The map leaves the range of numbers that can be drawn: it reaches {largest:.3g}. "
            "Check the unit, and the landmarks for one that is far from all others."
        )
    return SurfaceMap(
        kind=kind,
        values=np.asarray(values, dtype=np.float32),
        lowest=float(used.min()),
        median=float(np.median(used)),
        highest=float(used.max()),
        range=automatic_range(kind, used),
        histograms=_histograms(kind, [used, *others]),
        comparison=comparison,
        suggestion=suggestion,
        overall=overall,
    )


def _histograms(kind: MapKind, samples: list[Matrix]) -> tuple[Histogram, ...]:
    levels = [kind.levels(sample) for sample in samples]
    if kind.is_ratio:
        furthest = 2 * MOST_DOUBLINGS
        levels = [np.clip(level, -furthest, furthest) for level in levels]
    low = min(float(level.min()) for level in levels) if kind.is_ratio else 0.0
    high = max(float(level.max()) for level in levels)
    if not high - low > TINIEST:
        high = low + 1.0
    edges = np.linspace(low, high, BINS + 1)
    return tuple(Histogram(edges, np.histogram(level, edges)[0] / level.size) for level in levels)
