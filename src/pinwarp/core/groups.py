"""Groups of semilandmarks: curves drawn along crests, and patches spread over a surface.

The points of a curve follow from its handles. A patch holds its points, which stay where they are
until somebody changes the patch: a landmark that is placed later reshuffles none. Where all come
to rest on the destination follows from the landmarks; see :mod:`pinwarp.core.sliding`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.curves import CurvePath, PathFinder
from pinwarp.core.errors import LandmarkError, MeshError
from pinwarp.core.landmarks import Landmark, Position, Side, as_position
from pinwarp.core.patches import patch
from pinwarp.core.sliding import Semilandmarks, SlidingCurve

Matrix = NDArray[np.float64]

MOST_POINTS = 5000
"""No group has more points: sliding them would take minutes."""


@dataclass(frozen=True, slots=True)
class Handle:
    """One place that a curve was drawn through.

    Parameters
    ----------
    source
        On the source's surface.
    destination
        On the destination's; None where nobody drew the curve there yet.
    landmark
        The landmark it is anchored to, whose positions are then its own; empty for none.
    """

    source: Position
    destination: Position | None = None
    landmark: str = ""

    def __post_init__(self) -> None:
        # Numbers of numpy are written, and hashed, otherwise.
        object.__setattr__(self, "source", as_position(self.source))
        if self.destination is not None:
            object.__setattr__(self, "destination", as_position(self.destination))

    def position(self, side: Side) -> Position | None:
        """Return the position on one side, or None."""
        return self.source if side is Side.SOURCE else self.destination


@dataclass(frozen=True, slots=True)
class Curve:
    """Semilandmarks along a curve.

    Parameters
    ----------
    name
        Unique among the groups of a session.
    handles
        What it was drawn through, in order; at least two, of a closed one three.
    is_closed
        Whether it goes on from the last handle to the first.
    count
        How many points stand along it, at even distances.
    excluded
        Which points, by number, take no part.
    drawn
        Whether somebody drew it on the destination, or accepted it there.

    Raises
    ------
    LandmarkError
        When the name is empty, or there are too few handles.

    Examples
    --------
    >>> ends = (Handle((0.0, 0.0, 0.0)), Handle((3.0, 0.0, 0.0), landmark="tip"))
    >>> crest = Curve("crest", ends, count=2)
    >>> crest.is_drawn, [handle.landmark for handle in crest.anchors]
    (False, ['tip'])
    """

    name: str
    handles: tuple[Handle, ...]
    is_closed: bool = False
    count: int = 20
    excluded: frozenset[int] = frozenset()
    drawn: bool = False

    def __post_init__(self) -> None:
        _check_group(self.name, self.count)
        least = 3 if self.is_closed else 2
        if len(self.handles) < least:
            kind = "closed curve" if self.is_closed else "curve"
            raise LandmarkError(f"{self.name}: a {kind} goes through at least {least} places.")

    @property
    def anchors(self) -> tuple[Handle, ...]:
        """The handles that are landmarks, in order."""
        return tuple(handle for handle in self.handles if handle.landmark)

    @property
    def is_drawn(self) -> bool:
        """Whether it is drawn on the destination, all of it; else it slides by its tangents."""
        return self.drawn and all(handle.destination is not None for handle in self.handles)

    def places(self, side: Side) -> tuple[Position, ...]:
        """Return where its handles are on one side; those that are not there are left out."""
        return tuple(p for handle in self.handles if (p := handle.position(side)) is not None)


@dataclass(frozen=True, slots=True)
class Patch:
    """Semilandmarks spread over a surface.

    Parameters
    ----------
    name
        Unique among the groups of a session.
    points
        On the source, each as far from the others and from landmarks as it could be: fewer are
        the first of more.
    around
        The name of the closed curve that it lies inside; empty where it is the whole surface.
    inside
        A place on the side of that curve that is meant.
    excluded
        Which points, by number, take no part.

    Raises
    ------
    LandmarkError
        When the name is empty.
    """

    name: str
    points: tuple[Position, ...] = ()
    around: str = ""
    inside: Position | None = None
    excluded: frozenset[int] = frozenset()

    def __post_init__(self) -> None:
        _check_group(self.name, self.count)
        if self.inside is not None:
            object.__setattr__(self, "inside", as_position(self.inside))

    @property
    def count(self) -> int:
        """How many semilandmarks it has."""
        return len(self.points)


Group = Curve | Patch


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
        places = path.points(number + sum(is_anchored))[int(is_anchored[0]) :]
        spans.append(tuple(map(as_position, places[:number])))
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
        Among which the curve is that it lies inside; it keeps away from the points of all.

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
    _check_group(group.name, count)
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
                taken, group.points, *(course.points for course in curves.values()), *others
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
    rows: Mapping[str, int],
    source: PathFinder,
    destination: Callable[[], PathFinder],
) -> Gathered:
    """Put the points of groups together.

    Parameters
    ----------
    groups
        Curves and patches.
    rows
        The row of each landmark that takes part in the solve, by name.
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
    points: list[Position] = []
    numbers, courses, curves = [], [], []
    for group in groups:
        used = [n for n in range(group.count) if n not in group.excluded]
        first = len(rows) + len(points)
        course = None
        if isinstance(group, Curve):
            path = None
            with _naming(group, Side.SOURCE):
                course = course_of(group, source)
            if group.is_drawn:
                with _naming(group, Side.DESTINATION):
                    path = path_of(group, destination(), Side.DESTINATION)
            along = _rows_along(group, course, rows, {n: first + k for k, n in enumerate(used)})
            if used:
                curves.append(SlidingCurve(along, group.is_closed, path))
            own = course.points
        else:
            own = group.points
        courses.append(course)
        numbers.append(np.array(used, np.int64))
        points += [own[n] for n in used]
    places = np.array(points, np.float64).reshape(-1, 3)
    normals = source.surface.closest(places).normals if len(places) else places
    return Gathered(Semilandmarks(places, normals, tuple(curves)), tuple(courses), tuple(numbers))


@contextmanager
def _naming(curve: Curve, side: Side) -> Iterator[None]:
    """Name the curve in whatever is wrong with it on one side."""
    try:
        yield
    except (LandmarkError, MeshError) as error:
        raise type(error)(f"{curve.name}, on the {side.value}: {error}") from None


def _rows_along(
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


def renamed_anchors(group: Group, new_names: Mapping[str, str]) -> Group:
    """Return a group whose handles at landmarks know these by their new names."""
    if isinstance(group, Patch):
        return group
    handles = tuple(
        replace(handle, landmark=new_names.get(handle.landmark, handle.landmark))
        for handle in group.handles
    )
    return replace(group, handles=handles)


def anchored(group: Group, landmarks: Mapping[str, Landmark]) -> Group:
    """Return a group whose handles are where their landmarks are; of those gone they let go."""
    if isinstance(group, Patch) or not group.anchors:
        return group
    handles = tuple(
        _at(handle, landmarks) if handle.landmark else handle for handle in group.handles
    )
    return group if handles == group.handles else replace(group, handles=handles)


def _at(handle: Handle, landmarks: Mapping[str, Landmark]) -> Handle:
    landmark = landmarks.get(handle.landmark)
    if landmark is None or landmark.source is None:
        return replace(handle, landmark="")
    return Handle(landmark.source, landmark.destination, landmark.name)


def moved_group(group: Group, side: Side, move: Callable[[Sequence[Position]], Matrix]) -> Group:
    """Return a group with all it has on one side moved, as when a bone is mirrored or scaled."""

    def moved(places: Sequence[Position]) -> tuple[Position, ...]:
        return tuple(map(as_position, move(places))) if places else ()

    if isinstance(group, Patch):
        if side is Side.DESTINATION:
            return group
        inside = moved([group.inside])[0] if group.inside is not None else None
        return replace(group, points=moved(group.points), inside=inside)
    if side is Side.DESTINATION:
        handles = tuple(
            replace(handle, destination=moved([handle.destination])[0])
            if handle.destination is not None
            else handle
            for handle in group.handles
        )
        return replace(group, handles=handles)
    handles = tuple(replace(h, source=moved([h.source])[0]) for h in group.handles)
    return replace(group, handles=handles)


def _check_group(name: str, count: int) -> None:
    if not name.strip():
        raise LandmarkError("A curve or patch needs a name.")
    if name != " ".join(name.strip().splitlines()):
        raise LandmarkError(f"{name!r}: a name is one line, without blanks around it.")
    if not 0 <= count <= MOST_POINTS:
        raise LandmarkError(f"{name}: {count:,} points; choose from 0 to {MOST_POINTS:,}.")


def _shares(lengths: Sequence[float], count: int) -> list[int]:
    """Return how many of a number each length gets, by its share, all in all exactly these."""
    ends = np.rint(np.cumsum(lengths) / sum(lengths) * count).astype(int)
    return [int(number) for number in np.diff(ends, prepend=0)]
