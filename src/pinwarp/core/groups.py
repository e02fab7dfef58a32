"""Groups of semilandmarks: curves drawn along crests, and patches spread over a surface.

The points of a curve follow from its handles. A patch holds its points, which stay where they are
until somebody changes the patch: a landmark that is placed later reshuffles none. How they are
found is told in :mod:`pinwarp.core.gathering`, where they come to rest on the destination in
:mod:`pinwarp.core.sliding`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.errors import LandmarkError
from pinwarp.core.landmarks import Landmark, Position, Side, as_position

Matrix = NDArray[np.float64]

MOST_POINTS = 5000
"""No group has more points: sliding them would take minutes."""
USUAL_COUNT = 20
"""How many points a curve has where nobody says."""


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
        When the name is empty, there are too few handles, or a point is excluded that is not
        there.

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
        check_group(self.name, self.count, self.excluded)
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
        When the name is empty, or a point is excluded that is not there.
    """

    name: str
    points: tuple[Position, ...] = ()
    around: str = ""
    inside: Position | None = None
    excluded: frozenset[int] = frozenset()

    def __post_init__(self) -> None:
        check_group(self.name, self.count, self.excluded)
        if self.inside is not None:
            object.__setattr__(self, "inside", as_position(self.inside))

    @property
    def count(self) -> int:
        """How many semilandmarks it has."""
        return len(self.points)


Group = Curve | Patch


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


def on_source_only(group: Group) -> Group:
    """Return a group without what was drawn of it on a destination."""
    if isinstance(group, Patch):
        return group
    handles = tuple(replace(handle, destination=None) for handle in group.handles)
    return replace(group, handles=handles, drawn=False)


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


def check_group(name: str, count: int, excluded: frozenset[int] = frozenset()) -> None:
    """Raise a LandmarkError where a group cannot be called so, or have so many points."""
    if not name.strip():
        raise LandmarkError("A curve or patch needs a name.")
    if name != " ".join(name.strip().splitlines()):
        raise LandmarkError(f"{name!r}: a name is one line, without blanks around it.")
    if not 0 <= count <= MOST_POINTS:
        raise LandmarkError(f"{name}: {count:,} points; choose from 0 to {MOST_POINTS:,}.")
    if beyond := [number for number in excluded if not 0 <= number < count]:
        raise LandmarkError(f"{name} has no point {min(beyond) + 1} that could be excluded.")
