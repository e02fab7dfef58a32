"""Landmarks in another frame or unit than their mesh: noticed by how far they lie from it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.groups import moved_group
from pinwarp.core.landmarks import Landmark, Position, Side, flipped, positions, scaled
from pinwarp.core.lengths import METRES, Ruler
from pinwarp.core.positions import LARGEST_COORDINATE
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.session.session import Session

# What looks wrong, as shares of the mesh's diagonal: landmarks are placed on bones, or near them.
CLEARLY_OFF = 0.01
FITTING = 0.03
# So far from a bone nobody places half of its landmarks: they belong to another one.
FAR = 0.25
# How many times closer another reading must bring them.
SHARPLY = 5.0
# Landmarks spread over at least, and at most, so many diagonals. Closer together any would lie
# near a bone that happens to lie where they shrink to.
LEAST_SPREAD, LARGEST_SPREAD = 0.02, 3.0
# Nobody places landmarks closer to a bone than this share of its size.
_ON_MESH = 1e-4
# So many metres are told as metres, whatever else lengths are told in.
_BEYOND = 10.0
_THOUSAND = 1000.0


@dataclass(frozen=True)
class Fit:
    """One way to read positions, and how well they lie on their mesh then.

    Parameters
    ----------
    flips
        Whether x and y are negated, as from LPS to RAS or back.
    factor
        What the coordinates are multiplied by, as 1000 from metres to millimetres.
    distance
        The median distance from the mesh then, in its unit.
    """

    flips: bool = False
    factor: float = 1.0
    distance: float = float("nan")

    @property
    def is_as_stored(self) -> bool:
        """Whether nothing is changed."""
        return not self.flips and self.factor == 1

    def applied(self, landmarks: Iterable[Landmark], side: Side) -> tuple[Landmark, ...]:
        """Return landmarks read this way.

        Raises
        ------
        LandmarkError
            When a coordinate becomes too large for a number.

        Examples
        --------
        >>> Fit(True, 1000.0).applied([Landmark("fovea", (0.5, 2, 1))], Side.SOURCE)[0].source
        (-500.0, -2000.0, 1000.0)
        """
        result = tuple(landmarks)
        if self.flips:
            result = flipped(result, side)
        return result if self.factor == 1 else scaled(result, self.factor, side)

    def moved(self, places: Sequence[Position]) -> NDArray[np.float64]:
        """Return places read this way."""
        turned = np.array(places, np.float64).reshape(-1, 3) * ([-1, -1, 1] if self.flips else 1)
        return np.asarray(self.factor * turned)

    @property
    def action(self) -> str:
        """What a button says that does it.

        Examples
        --------
        >>> Fit(True, 0.001).action
        'Negate x and y, Divide by 1,000'
        """
        ways = ["Negate x and y"] if self.flips else []
        if self.factor > 1:
            ways.append(f"Multiply by {self.factor:,.0f}")
        elif self.factor < 1:
            ways.append(f"Divide by {1 / self.factor:,.0f}")
        return ", ".join(ways) or "Leave As They Are"

    def describe(self, frame: str = "") -> str:
        """Say what is done to the positions.

        Parameters
        ----------
        frame
            The frame that the file says they are in, if it does.

        Examples
        --------
        >>> Fit(True).describe("LPS")
        'With x and y negated (LPS to RAS)'
        """
        other = {"LPS": "LPS to RAS", "RAS": "RAS to LPS"}.get(frame, "LPS to RAS or back")
        ways = [f"with x and y negated ({other})"] if self.flips else []
        if self.factor > 1:
            ways.append(f"multiplied by {self.factor:,.0f} (m to mm)")
        elif self.factor < 1:
            ways.append(f"divided by {1 / self.factor:,.0f} (mm to m)")
        words = " and ".join(ways) or "as stored"
        return words[0].upper() + words[1:]


AS_STORED = Fit()


def fits_of(landmarks: Iterable[Landmark], side: Side, index: SurfaceIndex) -> tuple[Fit, ...]:
    """Return how landmarks can be read: as they are, and what brings them sharply closer.

    Parameters
    ----------
    landmarks
        Those without a position on the side do not count.
    side
        The side of the mesh.
    index
        The surface of the mesh.

    Returns
    -------
    tuple of Fit
        As stored, then other readings, the likeliest first; only the first where nothing looks
        wrong, and none without a landmark.

    Examples
    --------
    >>> from pinwarp.core.mesh import Mesh
    >>> mesh = Mesh([[1, 1, 0], [9, 1, 0], [1, 5, 0]], [[0, 1, 2]])
    >>> marks = [Landmark("a", (-2, -2, 0)), Landmark("b", (-5, -2, 0))]
    >>> [fit.flips for fit in fits_of(marks, Side.SOURCE, SurfaceIndex(mesh))]
    [False, True]
    """
    places = positions([x for x in landmarks if x.position(side) is not None], side)
    # Times 1000 it must still be a place.
    places = places[(np.abs(places) < LARGEST_COORDINATE / _THOUSAND).all(axis=1)]
    if not len(places):
        return ()
    size = index.mesh.diagonal
    stored = replace(AS_STORED, distance=_median(index, places))
    if stored.distance <= CLEARLY_OFF * size:
        return (stored,)
    found = []
    for factor in (1.0, 1 / _THOUSAND, _THOUSAND):
        for flips in (False, True):
            if not flips and factor == 1:
                continue
            read = factor * places * ([-1, -1, 1] if flips else [1, 1, 1])
            if factor != 1 and not _spread_suits(read, size):
                continue
            distance = _median(index, read)
            if distance <= FITTING * size and SHARPLY * distance < stored.distance:
                found.append(Fit(flips, factor, distance))
    # Two changes at once must be worth it: a bone may look much the same turned by half.
    found.sort(key=lambda fit: fit.distance * (2 if fit.flips and fit.factor != 1 else 1))
    # What is as much worse than the best is no choice to be offered.
    return (stored, *(fit for fit in found if fit.distance <= SHARPLY * found[0].distance))


def is_far(landmarks: Iterable[Landmark], side: Side, distance: float, size: float) -> bool:
    """Whether landmarks can hardly belong to a mesh, however they are read.

    Parameters
    ----------
    landmarks, side
        The landmarks; those without a position on the side do not count.
    distance
        How far they lie from the mesh in the median.
    size
        How large that is.

    Examples
    --------
    >>> marks = [Landmark("a", (0, 0, 0)), Landmark("b", (0.1, 0.2, 0))]
    >>> is_far(marks, Side.SOURCE, 60.0, 200.0), is_far(marks, Side.SOURCE, 1.0, 200.0)
    (True, False)

    All in one place beside the mesh they are in another unit.

    >>> is_far(marks, Side.SOURCE, 10.0, 200.0)
    True
    """
    if distance <= CLEARLY_OFF * size:
        return False
    places = positions([x for x in landmarks if x.position(side) is not None], side)
    return distance > FAR * size or not _spread_suits(places, size)


def fitted(session: Session, side: Side, fit: Fit) -> Session:
    """Return the session with all landmarks, curves and patches of one side read in another way.

    Raises
    ------
    LandmarkError
        When a coordinate becomes too large for a number.
    """
    return replace(
        session,
        landmarks=fit.applied(session.landmarks, side),
        groups=tuple(moved_group(group, side, fit.moved) for group in session.groups),
    )


def distance_from_mesh(
    distance: float, size: float, ruler: Ruler | str, mesh: str = "the mesh"
) -> str:
    """Return how far something lies from a mesh of some size, in words.

    Parameters
    ----------
    distance, size
        In one unit.
    ruler
        How lengths are told, or only the unit put behind them.
    mesh
        What the mesh is called.

    Examples
    --------
    >>> distance_from_mesh(312.4, 480.0, "mm"), distance_from_mesh(2.5e-7, 480.0, "mm")
    ('312 mm from the mesh', 'on the mesh')

    Farther than any bone reaches, it is told in metres.

    >>> distance_from_mesh(172.013, 0.3, Ruler("mm", 1000.0), "it")
    '172 m from it'
    """
    if distance <= _ON_MESH * size:
        return f"on {mesh}"
    ruler = Ruler.of(ruler)
    metres = ruler.shown(distance) * METRES.get(ruler.unit, 0.0)
    far = Ruler("m").text(metres, 3) if metres >= _BEYOND else ruler.text(distance, 3)
    return f"{far} from {mesh}"


def _median(index: SurfaceIndex, places: NDArray[np.float64]) -> float:
    return float(np.median(index.distances(places)))


def _spread_suits(places: NDArray[np.float64], size: float) -> bool:
    """Whether landmarks reach about as far as a bone does; one alone may be anywhere."""
    if len(places) == 1:
        return True
    reach = float(np.linalg.norm(np.ptp(places, axis=0)))
    return LEAST_SPREAD * size <= reach <= LARGEST_SPREAD * size
