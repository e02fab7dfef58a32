"""How far two surfaces lie apart, both ways, and in figures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.checkpoint import Checkpoint, go_on, within
from pinwarp.core.lengths import rms
from pinwarp.core.mesh import Mesh
from pinwarp.core.surface_distance import SurfaceIndex

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class DistanceFigures:
    """Some distances in four figures, in mesh units.

    Examples
    --------
    >>> DistanceFigures.of([3.0, 4.0])
    DistanceFigures(mean=3.5, rms=3.5355339059327378, percentile_95=3.95, maximum=4.0)
    """

    mean: float
    rms: float
    percentile_95: float
    maximum: float

    @classmethod
    def of(cls, distances: ArrayLike) -> DistanceFigures:
        """Return the figures of at least one distance."""
        values = np.asarray(distances, dtype=np.float64)
        return cls(
            mean=float(values.mean()),
            rms=rms(values),
            percentile_95=float(np.percentile(values, 95)),
            maximum=float(values.max()),
        )


@dataclass(frozen=True, eq=False)
class SurfaceComparison:
    """How far two surfaces lie apart, sampled at their vertices.

    A finely meshed region therefore weighs more than a coarse one: nothing is weighted by area.
    The figures and the Hausdorff distance are over the vertices that belong to a triangle.

    Attributes
    ----------
    forward : (m,) float64
        Of every vertex of a: its distance from surface b, in mesh units.
    backward : (k,) float64
        Of every vertex of b: its distance from surface a.
    forward_figures, backward_figures : DistanceFigures
        Of either.
    """

    forward: Matrix
    backward: Matrix
    forward_figures: DistanceFigures
    backward_figures: DistanceFigures

    @property
    def hausdorff(self) -> float:
        """The largest distance either way."""
        return max(self.forward_figures.maximum, self.backward_figures.maximum)


def compare_surfaces(
    a: Mesh,
    b: Mesh,
    *,
    index_a: SurfaceIndex | None = None,
    index_b: SurfaceIndex | None = None,
    checkpoint: Checkpoint = go_on,
) -> SurfaceComparison:
    """Return how far two surfaces lie apart.

    Parameters
    ----------
    a, b
        In the same frame and unit, such as the warped source and the destination.
    index_a, index_b
        Their indexes, where they are built already.
    checkpoint
        Passed every few thousand vertices: what it raises ends the work.

    Returns
    -------
    SurfaceComparison
        ``forward`` from a to b, ``backward`` from b to a.

    Examples
    --------
    >>> low = Mesh([[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    >>> high = Mesh([[0, 0, 1], [4, 0, 1], [0, 4, 1]], [[0, 1, 2]])
    >>> compared = compare_surfaces(low, high)
    >>> compared.forward.tolist(), round(compared.hausdorff, 6)
    ([1.0, 1.0, 1.0], 2.236068)
    """
    middle = len(a.vertices) / (len(a.vertices) + len(b.vertices))
    index_b = index_b or SurfaceIndex(b, checkpoint=within(checkpoint, 0.0, 0.0))
    forward = index_b.distances(a.vertices, within(checkpoint, 0.0, middle))
    index_a = index_a or SurfaceIndex(a, checkpoint=within(checkpoint, middle, middle))
    backward = index_a.distances(b.vertices, within(checkpoint, middle, 1.0))
    return SurfaceComparison(
        forward,
        backward,
        DistanceFigures.of(forward[a.on_surface]),
        DistanceFigures.of(backward[b.on_surface]),
    )
