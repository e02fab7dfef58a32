"""The points of groups: spaced along curves, spread over patches, and put together to slide."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from pinwarp.core.curves import CurvePath, PathFinder
from pinwarp.core.errors import LandmarkError, MeshError
from pinwarp.core.groups import MOST_POINTS, Curve, Group, Patch, check_group
from pinwarp.core.landmarks import Position, Side, as_position
from pinwarp.core.patches import patch
from pinwarp.core.sliding import Semilandmarks, SlidingCurve

# Closer than this share of the source's size two points are at one place.
APART = 1e-5


@dataclass(frozen=True, eq=False)
class Course:
    """Where a curve runs on the source.

    Attributes
    ----------
    path
        Over the surface.
    spans
        Its points in order, those between the same two anchored handles together: before the
        first, between, after the last. A closed curve begins at its first anchor.
    """

    path: CurvePath
    spans: tuple[tuple[Position, ...], ...]

    @property
    def points(self) -> tuple[Position, ...]:
        """The semilandmarks on the source, in order."""
        return tuple(itertools.chain.from_iterable(self.spans))


def course_of(curve: Curve, finder: PathFinder) -> Course:
    """Return the way of a curve over the source, and its points at even distances along it.

    Between two anchors stand as many as their share of the way asks for. Where no anchor is an
    end of an open curve, a point is.

    Parameters
    ----------
    curve
        What was drawn.
    finder
        Of the source's surface.

    Raises
    ------
    LandmarkError
        When places of the curve coincide.
    MeshError
        When it leads over parts of the mesh that no surface joins.

    Examples
    --------
    >>> from pinwarp.core.mesh import Mesh
    >>> from pinwarp.core.groups import Handle
    >>> from pinwarp.core.surface import Surface
    >>> square = Mesh([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> ends = (Handle((0.0, 1.0, 0.0), landmark="a"), Handle((4.0, 1.0, 0.0), landmark="b"))
    >>> course = course_of(Curve("c", ends, count=3), PathFinder(Surface(square)))
    >>> [round(x, 6) for x, _, _ in course.points]
    [1.0, 2.0, 3.0]
    """
    handles = curve.handles
    rows = [row for row, handle in enumerate(handles) if handle.landmark]
    if curve.is_closed:
        # Once round from the first anchor, or from the first handle, back to it.
        begin = rows[0] if rows else 0
        handles = (*handles[begin:], *handles[:begin], handles[begin])
        stops = [0, *(row - begin for row in rows[1:]), len(handles) - 1]
    else:
        stops = sorted({0, *rows, len(handles) - 1})
    paths = [
        finder.through([handle.source for handle in handles[a : b + 1]])
        for a, b in itertools.pairwise(stops)
    ]
    numbers = _shares([path.length for path in paths], curve.count)
    spans: list[tuple[Position, ...]] = []
    for (a, b), path, number in zip(itertools.pairwise(stops), paths, numbers, strict=True):
        is_anchored = [bool(handles[a].landmark), bool(handles[b].landmark)]
        if curve.is_closed and not rows:
            # The first point is where the last one would come again.
            is_anchored = [False, True]
        places = path.points(number + sum(is_anchored))[int(is_anchored[0]) :][:number]
        # Between the places of a path it cuts corners.
        laid = finder.surface.closest(places).positions if number else places
        spans.append(tuple(map(as_position, laid)))
    if not curve.is_closed and handles[0].landmark:
        spans.insert(0, ())
    places = np.vstack([paths[0].places[:1], *(path.places[1:] for path in paths)])
    whole = CurvePath(places[:-1] if curve.is_closed else places, curve.is_closed)
    return Course(whole, tuple(spans))


def with_points_over(
    group: Patch, count: int, finder: PathFinder, taken: Iterable[Position], groups: Iterable[Group]
) -> Patch:
    """Return a patch with so many points; those that it has stay, as far as they are wanted.

    Parameters
    ----------
    group
        The patch.
    count
        How many points.
    finder
        Of the source's surface.
    taken
        Landmarks on the source, to keep away from.
    groups
        Among which the curve is that it lies inside; it keeps away from all of them.

    Returns
    -------
    Patch

    Raises
    ------
    LandmarkError
        When the number is none, or the curve is not there, not closed, or the place lies on it.
    MeshError
        When the curve encloses nothing.
    """
    check_group(group.name, count)
    if count <= group.count:
        kept = frozenset(number for number in group.excluded if number < count)
        return replace(group, points=group.points[:count], excluded=kept)
    curves = {x.name: course_of(x, finder) for x in groups if isinstance(x, Curve)}
    if group.around and group.around not in curves:
        raise LandmarkError(f"{group.name}: there is no curve called {group.around}.")
    others = [x.points for x in groups if isinstance(x, Patch) and x.name != group.name]
    found = patch(
        finder.surface,
        count - group.count,
        around=curves[group.around].path if group.around else None,
        inside=group.inside,
        away_from=list(
            itertools.chain(
                # From whole paths: other points on a curve then move none here.
                taken,
                group.points,
                *(course.path.places for course in curves.values()),
                *others,
            )
        ),
    )
    return replace(group, points=(*group.points, *map(as_position, found.source)))


def path_of(curve: Curve, finder: PathFinder, side: Side) -> CurvePath:
    """Return the path of a curve over the surface of one side.

    Raises
    ------
    LandmarkError
        When handles coincide there.
    MeshError
        When no way leads from one to the next.
    """
    return finder.through(curve.places(side), curve.is_closed)


@dataclass(frozen=True, eq=False)
class Gathered:
    """The points of some groups, ready to slide.

    Attributes
    ----------
    semilandmarks
        All that take part.
    courses
        Of each group that is a curve its course; else None.
    numbers
        For each group which of its points these are, in order; they follow one another.
    """

    semilandmarks: Semilandmarks
    courses: tuple[Course | None, ...]
    numbers: tuple[NDArray[np.int64], ...]


def gathered(
    groups: Sequence[Group],
    landmarks: Mapping[str, Position],
    source: PathFinder,
    destination: Callable[[], PathFinder],
) -> Gathered:
    """Put the points of groups together; one at the place of another takes no part.

    Parameters
    ----------
    groups
        Curves and patches.
    landmarks
        What takes part in the solve, in order: names and places on the source.
    source
        Of the source's surface.
    destination
        Gives that of the destination's, where a curve is drawn there.

    Returns
    -------
    Gathered

    Raises
    ------
    LandmarkError, MeshError
        When a curve is none on its surface; the message names it.
    """
    total = sum(group.count for group in groups)
    if total > MOST_POINTS:
        raise LandmarkError(
            f"Curves and patches have {total:,} points, and at most {MOST_POINTS:,} can slide: "
            "give them fewer."
        )
    rows = {name: row for row, name in enumerate(landmarks)}
    courses: list[Course | None] = []
    for group in groups:
        if isinstance(group, Patch):
            courses.append(None)
            continue
        with _naming(group, Side.SOURCE):
            courses.append(course_of(group, source))
    both = list(zip(groups, courses, strict=True))
    every = [course.points if course is not None else _points(x) for x, course in both]
    chosen = [
        [n for n in range(len(own)) if n not in group.excluded]
        for group, own in zip(groups, every, strict=True)
    ]
    wanted = [[own[n] for n in kept] for own, kept in zip(every, chosen, strict=True)]
    is_apart = _apart([*landmarks.values()], wanted, source.surface.mesh.diagonal)
    points: list[Position] = []
    numbers, curves = [], []
    for (group, course), own, kept, apart in zip(both, every, chosen, is_apart, strict=True):
        used = [n for n, ok in zip(kept, apart, strict=True) if ok]
        first = len(rows) + len(points)
        points += [own[n] for n in used]
        numbers.append(np.array(used, np.int64))
        if course is None or not isinstance(group, Curve) or not used:
            continue
        path = None
        if group.is_drawn:
            with _naming(group, Side.DESTINATION):
                path = path_of(group, destination(), Side.DESTINATION)
        along = rows_along(group, course, rows, {n: first + k for k, n in enumerate(used)})
        curves.append(SlidingCurve(along, group.is_closed, path))
    places = np.array(points, np.float64).reshape(-1, 3)
    normals = source.surface.closest(places).normals if len(places) else places
    return Gathered(Semilandmarks(places, normals, tuple(curves)), tuple(courses), tuple(numbers))


def _points(group: Group) -> tuple[Position, ...]:
    return group.points if isinstance(group, Patch) else ()


def _apart(
    landmarks: Sequence[Position], groups: Sequence[Sequence[Position]], size: float
) -> list[NDArray[np.bool_]]:
    """Return for each point of each group whether no landmark, and no point before it, is there."""
    places = np.array([*landmarks, *itertools.chain(*groups)], np.float64).reshape(-1, 3)
    apart = np.ones(len(places), np.bool_)
    for a, b in sorted(KDTree(places).query_pairs(APART * size)) if len(places) else ():
        # Of more than two at one place the first stays.
        if apart[a]:
            apart[b] = b < len(landmarks)
    ends = np.cumsum([len(landmarks), *map(len, groups)])
    return [apart[a:b] for a, b in itertools.pairwise(ends)]


@contextmanager
def _naming(curve: Curve, side: Side) -> Iterator[None]:
    """Name the curve in whatever is wrong with it on one side."""
    try:
        yield
    except (LandmarkError, MeshError) as error:
        raise type(error)(f"{curve.name}, on the {side.value}: {error}") from None


def rows_along(
    curve: Curve, course: Course, rows: Mapping[str, int], of_point: Mapping[int, int]
) -> NDArray[np.int64]:
    """Return the rows of anchors and points in their order; what takes no part is left out."""
    anchors = [handle.landmark for handle in curve.anchors]
    if not curve.is_closed or not anchors:
        anchors.insert(0, "")
    along, number = [], 0
    for k, anchor in enumerate(anchors):
        if anchor in rows:
            along.append(rows[anchor])
        for _ in course.spans[k] if k < len(course.spans) else ():
            if number in of_point:
                along.append(of_point[number])
            number += 1
    return np.array(along, np.int64)


def _shares(lengths: Sequence[float], count: int) -> list[int]:
    """Return how many of a number each length gets, by its share, all in all exactly these."""
    ends = np.rint(np.cumsum(lengths) / sum(lengths) * count).astype(int)
    return [int(number) for number in np.diff(ends, prepend=0)]
