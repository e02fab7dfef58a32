"""Where semilandmarks, curves and handles are on both bones, worked out for the screen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.errors import PinwarpError
from pinwarp.core.gathering import Course, course_of, path_of
from pinwarp.core.groups import Curve, Group
from pinwarp.core.landmarks import Position, Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.session.session import Session
from pinwarp.session.warp.expected import destination_path, expected_handles
from pinwarp.session.warp.ghost import FEWEST_PAIRS
from pinwarp.session.warp.result import WarpResult
from pinwarp.session.warp.sliding import (
    Finders,
    SlidGroup,
)

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Asked:
    """All that is seen of semilandmarks follows from this."""

    groups: tuple[Group, ...]
    source: Mesh | None
    destination: Mesh | None
    result: WarpResult | None

    @classmethod
    def of(cls, session: Session, result: WarpResult | None) -> Asked:
        """Collect it."""
        source, destination = (session.mesh(side) for side in Side)
        return cls(session.groups, source, destination, result if session.groups else None)


@dataclass(frozen=True, eq=False)
class ShownGroup:
    """One curve or patch.

    Attributes
    ----------
    group
        As it is in the session.
    source, destination : (n, 3) float64
        Its points; not a number where there is none, as of those that take no part.
    start : (n, 3) float64
        Where the landmarks alone put them.
    is_freed : (n,) bool
        Which have no counterpart.
    slid : (n,) float64
        How far each slid; not a number where it did not.
    paths
        The curve over the surface of each side where it is known.
    expected
        Where its handles are on the destination, or are expected; None where nobody can tell.
    problem
        Why it is no curve on the surface; empty where it is one.
    """

    group: Group
    source: Matrix
    destination: Matrix
    start: Matrix
    is_freed: Mask
    slid: Matrix
    paths: Mapping[Side, Matrix]
    expected: tuple[Position, ...] | None = None
    problem: str = ""

    @property
    def freed(self) -> int:
        """How many have no counterpart."""
        return int(np.count_nonzero(self.is_freed))

    @property
    def taking_part(self) -> int:
        """How many are to take part in the warp."""
        return self.group.count - len(self.group.excluded)

    @property
    def largest_slide(self) -> float | None:
        """How far the one went that went furthest; None where none slid."""
        known = self.slid[np.isfinite(self.slid) & ~self.is_freed]
        return float(known.max()) if len(known) else None


@dataclass(frozen=True, eq=False)
class Shown:
    """All curves and patches, and what they were worked out from."""

    asked: Asked
    groups: tuple[ShownGroup, ...] = ()

    def group(self, name: str) -> ShownGroup | None:
        """Return one by its name, or None."""
        return next((shown for shown in self.groups if shown.group.name == name), None)


def look_at(asked: Asked, finders: Finders) -> Shown:
    """Work out what is seen of semilandmarks; takes a while, for the sake of the paths.

    Parameters
    ----------
    asked
        Groups, bones and warp.
    finders
        Of ways over both bones.
    """
    if not asked.groups:
        return Shown(asked)
    result = asked.result
    at_rest = result.semilandmarks if result is not None else None
    slid: dict[str, tuple[SlidGroup, Matrix, Matrix]] = {}
    if result is not None and at_rest is not None:
        assert result.fit is not None, "what slid was solved from"
        assert result.spline is not None, "and there is a warp"
        places, first = at_rest.places(result.fit[1], result.spline), 0
        for one in at_rest.groups:
            own = slice(first, first + len(one.numbers))
            slid[one.group.name] = (one, places[own], at_rest.slid.start[own])
            first = own.stop
    return Shown(asked, tuple(_look_at(x, asked, finders, slid.get(x.name)) for x in asked.groups))


def _look_at(
    group: Group, asked: Asked, finders: Finders, slid: tuple[SlidGroup, Matrix, Matrix] | None
) -> ShownGroup:
    course, problem, paths, expected = None, "", {}, None
    if isinstance(group, Curve):
        if asked.source is not None:
            try:
                course = course_of(group, finders.of(Side.SOURCE, asked.source))
                paths[Side.SOURCE] = _whole(course.path.places, group)
            except PinwarpError as error:
                problem = str(error)
        if asked.destination is not None:
            try:
                path, expected = _on_destination(group, course, asked, finders)
                if path is not None:
                    paths[Side.DESTINATION] = _whole(path, group)
            except PinwarpError as error:
                problem = problem or str(error)
        points = course.points if course is not None else ()
    else:
        points = group.points
    source = np.full((group.count, 3), np.nan)
    source[: len(points)] = np.array(points).reshape(-1, 3)
    destination, start = np.full((2, group.count, 3), np.nan)
    is_freed, how_far = np.zeros(group.count, np.bool_), np.full(group.count, np.nan)
    # The warp may be of the session as it was a moment ago.
    if slid is not None and (slid[0].numbers < group.count).all():
        one, places, begun = slid
        destination[one.numbers], start[one.numbers] = places, begun
        is_freed[one.numbers], how_far[one.numbers] = one.is_freed, one.slid
    return ShownGroup(
        group, source, destination, start, is_freed, how_far, paths, expected, problem
    )


def _on_destination(
    curve: Curve, course: Course | None, asked: Asked, finders: Finders
) -> tuple[Matrix | None, tuple[Position, ...] | None]:
    """Return the way of a curve over the destination, and where its handles are there."""
    assert asked.destination is not None, "asked for where there is a mesh"
    spline = asked.result.spline if asked.result is not None else None
    if asked.result is not None and len(asked.result.inputs.source) < FEWEST_PAIRS:
        # It would say more about the pairs than about the bone.
        spline = None
    finder = finders.of(Side.DESTINATION, asked.destination)
    if curve.is_drawn:
        drawn = path_of(curve, finder, Side.DESTINATION)
        return drawn.places, curve.places(Side.DESTINATION)
    if spline is None or course is None:
        return None, None
    path = destination_path(curve, course, spline, finder)
    places = expected_handles(curve, spline, finder.surface)
    return path, tuple(map(as_position, places))


def _whole(places: Matrix, curve: Curve) -> Matrix:
    """Return the way of a curve, back to where it begins where it is closed."""
    return np.vstack([places, places[:1]]) if curve.is_closed else places
