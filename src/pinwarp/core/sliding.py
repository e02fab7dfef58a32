"""Semilandmarks: points on curves and surfaces that slide until the warp bends least.

Nobody can say which point of a smooth surface answers to which; only that it answers to one on
the other surface. So each point may slide along its curve or on its surface, and all slide
together to where the bending energy is least (Bookstein, Medical Image Analysis 1 (1997); Gunz,
Mitteroecker and Bookstein, Semilandmarks in Three Dimensions, 2005).

The warp of the landmarks alone puts the points on the destination's surface. Then, by turns:
the surface is taken for its tangent planes, and the curves for their tangents; the points slide
on these exactly (:mod:`pinwarp.core.conditions`); and they are taken back to the surface. Where
that would bend more than before, half the way is gone, so the energy never rises. A point that
has no counterpart, because the surface faces elsewhere there or ends, is freed: it takes no part.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import cho_factor, cho_solve

from pinwarp.core.conditions import (
    Conditions,
    factorise_conditions,
    held,
    held_across,
    held_along,
)
from pinwarp.core.curves import CurvePath, tangents_along
from pinwarp.core.errors import LandmarkError, MeshError
from pinwarp.core.factor import factorise
from pinwarp.core.positions import as_positions
from pinwarp.core.readiness import check_facing, starting_warp
from pinwarp.core.spline import Spline, solve
from pinwarp.core.surface import Surface, carried_normals

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]
Mask = NDArray[np.bool_]

# A point is freed where the surface faces away from what is carried there by more than this.
LARGEST_ANGLE = 60.0
# At least this share of the points must face as the destination does: else the pairs are wrong.
FACING_ALIKE = 0.8
# Along a crest a surface faces either way: where there are curves alone, these must.
FACING_ALONG = 0.5
# Sliding ends when a turn saves less than this share of the energy, or after so many.
WORTH_A_TURN = 1e-4
TURNS = 15
HALVINGS = 4
# Energies below this share of the size of the destination are rounding.
ROUNDING = 1e-13


@dataclass(frozen=True, eq=False)
class SlidingCurve:
    """A curve among the points that slide.

    Attributes
    ----------
    rows : (k,) int64
        Its points in order, as rows of landmarks followed by semilandmarks: its ends, and any
        between, may be landmarks.
    is_closed
        Whether the last point is a neighbour of the first.
    path
        The curve as drawn on the destination: the points stay on it, in order, and on the surface
        between its places. Without one they slide along their own tangents.
    """

    rows: Rows
    is_closed: bool = False
    path: CurvePath | None = None


@dataclass(frozen=True, eq=False)
class Semilandmarks:
    """Points on the source that are to slide on the destination.

    Attributes
    ----------
    source : (k, 3) float64
        In source mesh units.
    normals : (k, 3)
        Where the source's surface faces there.
    curves
        Which of them slide along curves; the others slide on the surface.
    """

    source: Matrix
    normals: Matrix
    curves: tuple[SlidingCurve, ...] = ()


@dataclass(frozen=True, eq=False)
class Slid:
    """Where semilandmarks came to rest.

    Attributes
    ----------
    positions : (k, 3) float64
        On the destination; of freed ones, where the warp carries them.
    start : (k, 3) float64
        Where the landmarks alone put them.
    is_freed : (k,) bool
        Which have no counterpart.
    slid : (k,)
        How far each went from its start, in destination mesh units.
    energies
        The bending energy, up to 8 pi and summed over the axes, of each turn: never rising.
    converged
        False where the last turn still saved something.
    conditions
        How the places of the spline's source are held at rest.
    used : (m,) int64
        Which these are, as rows of landmarks followed by semilandmarks.
    spline
        The ordinary warp of all pairs: landmarks, and what came to rest.
    """

    positions: Matrix
    start: Matrix
    is_freed: Mask
    slid: Matrix
    energies: tuple[float, ...]
    converged: bool
    conditions: Conditions
    used: Rows
    spline: Spline

    @property
    def landmarks(self) -> int:
        """How many of the places of the spline's source are landmarks: the first ones."""
        return len(self.used) - int(np.count_nonzero(~self.is_freed))

    @property
    def freed(self) -> int:
        """How many have no counterpart."""
        return int(np.count_nonzero(self.is_freed))

    def leave_one_out(self) -> Matrix:
        """Return (n, 3) how far each landmark misses, left out, while the others slide.

        They keep their curves and planes, not their places; see
        :meth:`pinwarp.core.conditions.ConditionFactor.leave_one_out`.
        """
        factor = factorise_conditions(self.spline.source, self.conditions)
        rest = self.spline.evaluate(self.spline.source)
        return factor.leave_one_out(rest, np.arange(self.landmarks))


def slide(
    source: ArrayLike,
    destination: ArrayLike,
    semilandmarks: Semilandmarks,
    surface: Surface,
    *,
    largest_angle: float = LARGEST_ANGLE,
) -> Slid:
    """Slide semilandmarks over the destination to the least bending energy.

    Always begun anew from the landmarks, so that the result depends on its inputs alone.

    Parameters
    ----------
    source, destination
        (n, 3) landmarks, row by row the same places; at least four, not in one plane.
    semilandmarks
        What slides.
    surface
        The destination's surface.
    largest_angle
        Degrees; a point is freed where the surfaces differ by more.

    Returns
    -------
    Slid

    Raises
    ------
    LandmarkError
        When the landmarks do not determine an affine map, or a row cannot be used.
    InsideOutError
        When one mesh faces inwards.
    MeshError
        When the landmarks do not lay one surface on the other, or no point has a counterpart.

    Examples
    --------
    On a plane there is nothing to bend, and a point that was put wrong slides back:

    >>> from pinwarp.core.mesh import Mesh
    >>> square = Mesh([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> source = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [3, 3, 1]])
    >>> points = Semilandmarks(np.array([[1.0, 2.0, 0.0]]), np.array([[0.0, 0.0, 1.0]]))
    >>> slide(source, 2 * source, points, Surface(square)).positions.round(9).tolist()
    [[2.0, 4.0, 0.0]]
    """
    task = _Task(source, destination, semilandmarks, surface, largest_angle)
    start = task.begun()
    here, energies, converged = start, [start.energy], False
    negligible = ROUNDING * float(np.ptp(start.positions, axis=0).max())
    for _ in range(TURNS):
        if here.energy <= negligible:
            converged = True
            break
        there = task.turn(here)
        if there is None:
            converged = True
            break
        saved, freed = here.energy - there.energy, there.bending is not here.bending
        here = there
        energies.append(here.energy)
        if saved <= WORTH_A_TURN * energies[-2] and not freed:
            converged = True
            break
    used = here.bending.rows
    spline = solve(here.bending.factor, here.positions[used])
    positions = np.where(here.is_freed[:, None], spline.evaluate(task.source), here.positions)
    own = slice(task.landmarks, None)
    return Slid(
        positions=positions[own],
        start=start.positions[own],
        is_freed=here.is_freed[own],
        slid=np.linalg.norm(positions - start.positions, axis=1)[own],
        energies=tuple(energies),
        converged=converged,
        conditions=task.conditions(here),
        used=used,
        spline=spline,
    )


class _Bending:
    """The bending energy of places of the source, whatever they are carried to."""

    def __init__(self, source: Matrix, rows: Rows) -> None:
        self.rows = rows
        self.factor = factorise(source[rows])
        if not self.factor.well_spaced:
            close = [finding.rows for finding in self.factor.findings]
            first, second, *_ = rows[list((*self.factor.duplicates, *close)[0])].tolist()
            raise LandmarkError(
                f"Points {first} and {second} of the source lie at one place, or nearly: "
                "remove one of them."
            )
        self._lower = cho_factor(self.factor.bending, lower=True, check_finite=False)

    def of(self, positions: Matrix) -> float:
        """Return the energy up to 8 pi, summed over the axes."""
        places = positions[self.rows]
        bent = self.factor.rotate(places - places.mean(axis=0))[self.factor.rank + 1 :]
        solved = cho_solve(self._lower, bent, check_finite=False)
        return float(np.sum(bent * solved)) / self.factor.scale


@dataclass(frozen=True, eq=False)
class _State:
    """Where all places are, landmarks first, and what they may do next."""

    positions: Matrix
    normals: Matrix
    on_rim: Mask
    is_freed: Mask
    bending: _Bending
    energy: float


class _Task:
    """What is given, and one turn of the sliding."""

    def __init__(
        self,
        source: ArrayLike,
        destination: ArrayLike,
        semilandmarks: Semilandmarks,
        surface: Surface,
        largest_angle: float,
    ) -> None:
        self.first = starting_warp(source, destination)
        self.landmarks = len(self.first.source)
        points = as_positions(semilandmarks.source, "semilandmark")
        self.source = np.vstack([self.first.source, points])
        self.destination = as_positions(destination, "destination landmark")
        normals = as_positions(semilandmarks.normals, "normal of a semilandmark")
        if len(normals) != len(points):
            raise LandmarkError(f"{len(points)} semilandmarks have {len(normals)} normals.")
        self.normals = np.vstack([np.zeros_like(self.destination), normals])
        self.is_landmark = np.arange(len(self.source)) < self.landmarks
        carried = self.first.evaluate(self.source)
        # A curve may have been drawn from either end.
        self.curves = [
            replace(curve, path=curve.path.along_with(carried[curve.rows])) if curve.path else curve
            for curve in semilandmarks.curves
        ]
        self.on_curve = np.zeros(len(self.source), np.bool_)
        # Where somebody drew the curve on the destination, it is there.
        self.is_drawn = self.on_curve.copy()
        for curve in self.curves:
            self.on_curve[curve.rows] = True
            self.is_drawn[curve.rows] = curve.path is not None
        self.surface = surface
        self.least_cosine = float(np.cos(np.radians(largest_angle)))

    def begun(self) -> _State:
        """Return the places as the landmarks alone carry them, laid on the surface."""
        carried = self.first.evaluate(self.source)
        carried[self.is_landmark] = self.destination
        nobody = np.zeros(len(self.source), np.bool_)
        positions, normals, on_rim = self._laid(carried, nobody)
        if not self.is_landmark.all():
            judged, least = ~self.is_landmark & ~on_rim, FACING_ALONG
            if (judged & ~self.on_curve).any():
                judged, least = judged & ~self.on_curve, FACING_ALIKE
            faces = carried_normals(self.first, self.source[judged], self.normals[judged])
            check_facing(np.sum(faces * normals[judged], axis=1), self.surface.mesh, least)
        freed = self._astray(self.first, normals, on_rim)
        if len(freed) > self.landmarks and freed[self.landmarks :].all():
            raise MeshError(
                "No point has a counterpart: the destination ends or faces elsewhere wherever the "
                "landmarks carry one. Look for wrong pairs, or spread the points elsewhere."
            )
        bending = _Bending(self.source, np.flatnonzero(~freed))
        return _State(positions, normals, on_rim, freed, bending, bending.of(positions))

    def turn(self, here: _State) -> _State | None:
        """Slide once and return to the surface; None where nothing bends less than here."""
        rows = here.bending.rows
        factor = factorise_conditions(self.source[rows], self.conditions(here))
        spline = factor.solve(here.positions[rows])
        aim = spline.evaluate(self.source)
        aim[self.is_landmark] = self.destination
        for halving in range(HALVINGS + 1):
            step = here.positions + 0.5**halving * (aim - here.positions)
            positions, normals, on_rim = self._laid(step, here.is_freed)
            energy = here.bending.of(positions)
            if energy <= here.energy:
                break
        else:
            return None
        bending = here.bending
        freed = here.is_freed | self._astray(spline, normals, on_rim)
        if (freed != here.is_freed).any():
            # Fewer points to pass through never bend more.
            bending = _Bending(self.source, np.flatnonzero(~freed))
            energy = bending.of(positions)
        return _State(positions, normals, on_rim, freed, bending, energy)

    def conditions(self, here: _State) -> Conditions:
        """Return how the places that are used are held where they are."""
        rows = here.bending.rows
        new = np.full(len(self.source), -1)
        new[rows] = np.arange(len(rows))
        free_to_slide = ~self.is_landmark & ~self.on_curve & ~here.is_freed
        surface = np.flatnonzero(free_to_slide)
        parts = [
            held(np.arange(self.landmarks)),
            held_along(new[surface], here.normals[surface]),
        ]
        for curve in self.curves:
            points = here.positions[curve.rows]
            if curve.path is None:
                tangents = tangents_along(points, curve.is_closed)
            else:
                _, tangents = curve.path.closest(points)
            mine = (new[curve.rows] >= 0) & ~self.is_landmark[curve.rows]
            # One point alone, or two of a ring, have no direction: the surface holds them.
            known = tangents.any(axis=1)
            across, along = curve.rows[mine & known], curve.rows[mine & ~known]
            parts.append(held_across(new[across], tangents[mine & known]))
            parts.append(held_along(new[along], here.normals[along]))
        return Conditions.joined(parts)

    def _laid(self, points: Matrix, is_freed: Mask) -> tuple[Matrix, Matrix, Mask]:
        """Return the places on the surface, next to their drawn curves; what is freed stays."""
        positions, normals = points.copy(), np.zeros_like(points)
        on_rim = np.zeros(len(points), np.bool_)
        sliding = ~self.is_landmark
        for curve in self.curves:
            if curve.path is not None:
                along, _ = curve.path.closest(points[curve.rows])
                positions[curve.rows] = along
        met = self.surface.closest(positions[sliding])
        positions[sliding], normals[sliding], on_rim[sliding] = (
            met.positions,
            met.normals,
            met.on_rim,
        )
        stays = self.is_landmark | is_freed
        positions[stays] = points[stays]
        return positions, normals, on_rim

    def _astray(self, spline: Spline, normals: Matrix, on_rim: Mask) -> Mask:
        """Return which places have no counterpart where they are."""
        faces = carried_normals(spline, self.source, self.normals)
        elsewhere = np.sum(faces * normals, axis=1) < self.least_cosine
        # A curve may follow a rim, and a drawn one is where it was drawn.
        ends = on_rim & ~self.on_curve
        return np.asarray((elsewhere | ends) & ~self.is_landmark & ~self.is_drawn)
