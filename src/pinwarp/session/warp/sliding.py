"""The semilandmarks of a session: brought to rest on the destination, and held while one drags.

Where they rest follows from landmarks, groups and meshes: it is no part of a session, nor of its
history. Once at rest they are pairs like others for the solver, so the penalty, the components and
all exports go on as ever.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.conditions import held
from pinwarp.core.curves import PathFinder
from pinwarp.core.errors import PinwarpError
from pinwarp.core.factor import SourceFactor, factorise
from pinwarp.core.gathering import Course, gathered
from pinwarp.core.groups import Group, Patch
from pinwarp.core.held_slide import HeldSlide
from pinwarp.core.landmarks import Position, Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.core.sliding import Slid, slide
from pinwarp.core.spline import Spline, solve
from pinwarp.core.surface import Surface
from pinwarp.io.group_record import SlidRecord
from pinwarp.session.session import Session

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class SlidingInputs:
    """All that the rest of semilandmarks follows from, and nothing that it does not."""

    source: tuple[Position, ...]
    destination: tuple[Position, ...]
    names: tuple[str, ...]
    groups: tuple[Group, ...]
    mesh: Mesh | None
    target: Mesh | None
    kept: SlidRecord | None = None

    @classmethod
    def of(cls, session: Session, kept: SlidRecord | None) -> SlidingInputs:
        """Collect the inputs from a session.

        Parameters
        ----------
        session
            What is to be warped.
        kept
            Where the points rested before, for want of a mesh.
        """
        pairs = session.pairs
        return cls(
            tuple(pair.source for pair in pairs if pair.source is not None),
            tuple(pair.destination for pair in pairs if pair.destination is not None),
            tuple(pair.name for pair in pairs),
            session.groups,
            session.mesh(Side.SOURCE),
            session.mesh(Side.DESTINATION),
            kept,
        )


@dataclass(frozen=True, eq=False)
class SlidGroup:
    """The points of one group at rest.

    Attributes
    ----------
    group
        The curve or patch.
    course
        Where a curve runs on the source; None for a patch, and without its mesh.
    numbers : (m,) int64
        Which of its points took part.
    source, positions : (m, 3) float64
        Where they are on the source, and on the destination.
    is_freed : (m,) bool
        Which have no counterpart there.
    slid : (m,)
        How far each went from where the landmarks alone carry it, in destination mesh units.
    """

    group: Group
    course: Course | None
    numbers: NDArray[np.int64]
    source: Matrix
    positions: Matrix
    is_freed: Mask
    slid: Matrix

    @property
    def points(self) -> dict[int, Position]:
        """Where its points are on the source, by number.

        Of a curve without its mesh only those that take part are known.
        """
        if isinstance(self.group, Patch):
            return dict(enumerate(self.group.points))
        if self.course is not None:
            return dict(enumerate(self.course.points))
        return dict(zip(self.numbers.tolist(), map(as_position, self.source), strict=True))

    @property
    def freed(self) -> int:
        """How many have no counterpart."""
        return int(np.count_nonzero(self.is_freed))

    @property
    def largest_slide(self) -> float:
        """How far the one went that went furthest; 0 where none takes part."""
        used = self.slid[~self.is_freed]
        return float(used.max()) if len(used) else 0.0


@dataclass(frozen=True, eq=False)
class SlidGroups:
    """All semilandmarks of a session at rest.

    Attributes
    ----------
    groups
        One by one, in the order of the session.
    slid
        All at once.
    landmarks
        How many rows of the spline's source are landmarks: the first.
    """

    groups: tuple[SlidGroup, ...]
    slid: Slid
    landmarks: int

    @cached_property
    def factor(self) -> SourceFactor:
        """What ordinary warps of landmarks and semilandmarks are solved from."""
        return factorise(self.slid.spline.source)

    @cached_property
    def targets(self) -> Matrix:
        """The (n, 3) destinations of the rows of the factor."""
        return self.slid.spline.evaluate(self.slid.spline.source)

    @property
    def freed(self) -> int:
        """How many have no counterpart."""
        return self.slid.freed

    @property
    def count(self) -> int:
        """How many take part in the warp."""
        return len(self.slid.used) - self.landmarks

    @property
    def is_kept(self) -> bool:
        """Whether they were read where they had rested, since without a mesh nothing slides."""
        return not self.slid.energies

    def places(self, targets: Matrix, spline: Spline) -> Matrix:
        """Return (k, 3) where all of them are while something moves.

        Parameters
        ----------
        targets
            The destinations of the rows of the factor by then.
        spline
            The warp by then, which carries the freed ones.
        """
        places = self.slid.positions.copy()
        freed = self.slid.is_freed
        places[~freed] = targets[self.landmarks :]
        if freed.any():
            source = np.vstack([group.source for group in self.groups])
            places[freed] = spline.evaluate(source[freed])
        return places

    def left_out(self, penalty: float = 0.0) -> Matrix:
        """Return (n, 3) how far each landmark misses, left out, while the others slide on.

        They keep planes and tangents, not their places; in destination mesh units.
        """
        return self._held.factor.leave_one_out(self.targets, np.arange(self.landmarks), penalty)

    @cached_property
    def _held(self) -> HeldSlide:
        return HeldSlide.of(self.slid)

    def following(self, source: Matrix, destination: Matrix) -> tuple[SourceFactor, Matrix]:
        """Return factor and destinations for landmarks that were moved, planes and tangents held.

        Parameters
        ----------
        source, destination
            (n, 3) the landmarks as they are now, as many as before.

        Returns
        -------
        factor, targets
            As :attr:`factor` and :attr:`targets` are at rest; nothing is measured anew on the
            surface, which takes a hundredth of a slide.
        """
        factor, held = self.factor, self._held
        if not np.array_equal(factor.source[: self.landmarks], source):
            held = held.with_source(source)
            factor = factorise(held.factor.source)
        return factor, held.warp(destination).evaluate(factor.source)


class Finders:
    """Finds ways over the meshes of both sides; those of the last meshes are kept.

    Any thread may ask: who comes while one is being made waits for it.
    """

    def __init__(self) -> None:
        self._kept: dict[Side, PathFinder] = {}
        self._lock = threading.Lock()

    def of(self, side: Side, mesh: Mesh) -> PathFinder:
        """Return what finds ways over the mesh of a side."""
        with self._lock:
            kept = next((x for x in self._kept.values() if x.surface.mesh is mesh), None)
            if kept is None:
                kept = PathFinder(Surface(mesh))
            self._kept[side] = kept
            return kept

    def keep_only(self, meshes: Iterable[Mesh | None]) -> None:
        """Let go of all other meshes: of sessions that are closed, nothing is kept."""
        wanted = [id(mesh) for mesh in meshes if mesh is not None]
        # Without the lock: nobody waits here for one that is being made.
        kept = list(self._kept.items())
        self._kept = {side: x for side, x in kept if id(x.surface.mesh) in wanted}


class Slider:
    """Brings semilandmarks to rest, keeping what the next time may share.

    For use by one thread at a time, but for the finders.

    Attributes
    ----------
    finders
        Of ways over both meshes, for whoever needs some.
    slides
        How often it was really done, for tests and for the curious.
    """

    def __init__(self) -> None:
        self.finders = Finders()
        self._last: tuple[SlidingInputs, SlidGroups] | None = None
        self.slides = 0

    def slide(self, inputs: SlidingInputs) -> SlidGroups:
        """Return the semilandmarks at rest.

        Raises
        ------
        PinwarpError
            When a mesh is missing, the landmarks cannot carry a surface, or a curve is none; the
            message says what to do.
        """
        if self._last is not None and self._last[0] == inputs:
            return self._last[1]
        for side, mesh in ((Side.SOURCE, inputs.mesh), (Side.DESTINATION, inputs.target)):
            if mesh is None and inputs.kept is not None:
                return self._found(inputs, kept_at_rest(inputs, inputs.kept))
            if mesh is None:
                raise PinwarpError(
                    f"Semilandmarks slide from bone to bone, and there is no {side.value} mesh: "
                    "open it first."
                )
        assert inputs.mesh is not None, "made sure above"
        assert inputs.target is not None, "made sure above"
        there = self.finders.of(Side.DESTINATION, inputs.target)
        found = gathered(
            inputs.groups,
            dict(zip(inputs.names, inputs.source, strict=True)),
            self.finders.of(Side.SOURCE, inputs.mesh),
            lambda: there,
        )
        surface = there.surface
        slid = slide(inputs.source, inputs.destination, found.semilandmarks, surface)
        self.slides += 1
        points = found.semilandmarks.source
        groups = _by_group(inputs.groups, found.courses, found.numbers, points, slid)
        at_rest = SlidGroups(groups, slid, len(inputs.source))
        return self._found(inputs, at_rest)

    def _found(self, inputs: SlidingInputs, at_rest: SlidGroups) -> SlidGroups:
        self._last = (inputs, at_rest)
        return at_rest

    def forget(self) -> None:
        """Let go of what slid last."""
        self._last = None


def kept_at_rest(inputs: SlidingInputs, kept: SlidRecord) -> SlidGroups:
    """Return semilandmarks where they rested before: without its mesh nothing slides.

    Raises
    ------
    PinwarpError
        When the warp of these cannot be solved for.
    """
    landmarks = len(inputs.source)
    source = np.array(kept.source, np.float64).reshape(-1, 3)
    is_freed = np.array([place is None for place in kept.destination], np.bool_)
    aims = [place or (0.0, 0.0, 0.0) for place in kept.destination]
    positions = np.array(aims, np.float64).reshape(-1, 3)
    used = np.concatenate([np.arange(landmarks), landmarks + np.flatnonzero(~is_freed)])
    places = np.vstack([np.array(inputs.source), source])[used]
    spline = solve(factorise(places), np.vstack([np.array(inputs.destination), positions])[used])
    positions[is_freed] = spline.evaluate(source[is_freed])
    slid = Slid(
        positions=positions,
        start=positions,
        is_freed=is_freed,
        slid=np.zeros(len(source)),
        energies=(),
        converged=True,
        # No plane is known: they follow the landmarks meanwhile.
        conditions=held(np.arange(landmarks)),
        used=used,
        spline=spline,
    )
    numbers = tuple(
        np.array([n for n in range(group.count) if n not in group.excluded], np.int64)
        for group in inputs.groups
    )
    courses = (None,) * len(inputs.groups)
    return SlidGroups(_by_group(inputs.groups, courses, numbers, source, slid), slid, landmarks)


def _by_group(
    groups: tuple[Group, ...],
    courses: tuple[Course | None, ...],
    numbers_of: tuple[NDArray[np.int64], ...],
    source: Matrix,
    slid: Slid,
) -> tuple[SlidGroup, ...]:
    several, first = [], 0
    for group, course, numbers in zip(groups, courses, numbers_of, strict=True):
        own = slice(first, first + len(numbers))
        several.append(
            SlidGroup(
                group,
                course,
                numbers,
                source[own],
                slid.positions[own],
                slid.is_freed[own],
                slid.slid[own],
            )
        )
        first = own.stop
    return tuple(several)
