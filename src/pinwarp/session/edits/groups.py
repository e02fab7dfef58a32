"""Curves and patches of semilandmarks: drawn, shaped, thinned, removed."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from pinwarp.core.curves import PathFinder
from pinwarp.core.errors import LandmarkError
from pinwarp.core.gathering import course_of, with_points_over
from pinwarp.core.groups import Curve, Group, Handle, Patch
from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.session.session import Session

__all__ = [
    "accept_curve",
    "add_curve",
    "add_handles",
    "add_patch",
    "exclude_points",
    "move_handle",
    "next_group_name",
    "pin_point",
    "remove_groups",
    "rename_group",
    "set_count",
    "undraw_curve",
]


def next_group_name(session: Session, kind: str) -> str:
    """Return a name that no curve or patch has yet.

    Examples
    --------
    >>> next_group_name(Session(), "curve")
    'curve_1'
    """
    taken = {group.name for group in session.groups}
    number = 1
    while f"{kind}_{number}" in taken:
        number += 1
    return f"{kind}_{number}"


def add_curve(
    session: Session,
    handles: Sequence[Handle],
    finder: PathFinder,
    *,
    is_closed: bool = False,
    count: int = 20,
    name: str | None = None,
) -> tuple[Session, str]:
    """Add a curve that was drawn over the source; return the session and its name.

    Raises
    ------
    LandmarkError
        When it goes through too few places, or the name is taken.
    MeshError
        When it leads over parts of the mesh that no surface joins.
    """
    name = next_group_name(session, "curve") if name is None else name
    curve = Curve(name, tuple(handles), is_closed, count)
    # What cannot be drawn is not begun.
    course_of(curve, finder)
    return _added(session, curve), name


def add_patch(
    session: Session,
    finder: PathFinder,
    *,
    count: int = 300,
    around: str = "",
    inside: Position | None = None,
    name: str | None = None,
) -> tuple[Session, str]:
    """Spread a patch over the source or inside a closed curve; return the session and its name.

    Raises
    ------
    LandmarkError
        When the curve is not closed or not there, the place lies on it, or the name is taken.
    MeshError
        When the curve encloses nothing.
    """
    name = next_group_name(session, "patch") if name is None else name
    patch = _spread(session, Patch(name, (), around, inside), count, finder)
    return _added(session, patch), name


def rename_group(session: Session, name: str, new_name: str) -> Session:
    """Give a curve or patch another name.

    Raises
    ------
    LandmarkError
        When there is no such group, or the new name is empty or taken.
    """
    new_name = new_name.strip()
    if new_name == name:
        return session
    _existing(session, name)
    _check_free(session, new_name)
    groups = (
        replace(group, around=new_name)
        if isinstance(group, Patch) and group.around == name
        else group
        for group in session.groups
    )
    return _with(
        session,
        (replace(group, name=new_name) if group.name == name else group for group in groups),
    )


def remove_groups(session: Session, names: Iterable[str]) -> Session:
    """Remove curves and patches; a patch inside a curve that goes stays as it is."""
    gone = set(names)
    kept = (
        replace(group, around="", inside=None)
        if isinstance(group, Patch) and group.around in gone
        else group
        for group in session.groups
    )
    return _with(session, (group for group in kept if group.name not in gone))


def set_count(session: Session, name: str, count: int, finder: PathFinder) -> Session:
    """Give a curve or patch more or fewer points; those of a patch stay where they are.

    Raises
    ------
    LandmarkError
        When there are more points than can slide.
    """
    group = _existing(session, name)
    if isinstance(group, Patch):
        return _changed(session, _spread(session, group, count, finder))
    kept = frozenset(number for number in group.excluded if number < count)
    return _changed(session, replace(group, count=count, excluded=kept))


def move_handle(
    session: Session, name: str, number: int, side: Side, place: Position, landmark: str = ""
) -> Session:
    """Put a handle of a curve somewhere, or anchor it to a landmark there.

    The first handle that is moved on the destination draws the curve there: the caller accepts
    it first; see :func:`accept_curve`.
    """
    curve = _curve(session, name)
    handle = curve.handles[number]
    if side is Side.SOURCE:
        moved = replace(handle, source=place, landmark=landmark)
    else:
        moved = replace(handle, destination=place, landmark=landmark)
    handles = (*curve.handles[:number], moved, *curve.handles[number + 1 :])
    return _changed(session, replace(curve, handles=handles))


def add_handles(session: Session, name: str, more: Mapping[int, Sequence[Handle]]) -> Session:
    """Let a curve go through more places.

    Parameters
    ----------
    session
        What is edited.
    name
        The curve.
    more
        By the number of a handle what comes behind it, in order.
    """
    curve = _curve(session, name)
    handles = itertools.chain.from_iterable(
        (handle, *more.get(number, ())) for number, handle in enumerate(curve.handles)
    )
    return _changed(session, replace(curve, handles=tuple(handles)))


def accept_curve(session: Session, name: str, places: Sequence[Position]) -> Session:
    """Draw a curve on the destination: each handle goes where it is expected.

    A handle at a landmark stays where that is, and where it has no destination yet the landmark
    is placed.

    Parameters
    ----------
    session
        What is edited.
    name
        The curve.
    places
        One for each handle; those that are drawn already stay.
    """
    curve = _curve(session, name)
    handles, landmarks = [], {landmark.name: landmark for landmark in session.landmarks}
    for handle, place in zip(curve.handles, places, strict=True):
        there = handle.destination or place
        if handle.landmark:
            landmark = landmarks[handle.landmark]
            landmarks[handle.landmark] = landmark.placed(Side.DESTINATION, there)
        handles.append(replace(handle, destination=there))
    placed = replace(session, landmarks=tuple(landmarks.values()))
    return _changed(placed, replace(curve, handles=tuple(handles), drawn=True))


def undraw_curve(session: Session, name: str) -> Session:
    """Take back what was drawn of a curve on the destination; its landmarks stay."""
    curve = _curve(session, name)
    handles = tuple(
        handle if handle.landmark else replace(handle, destination=None) for handle in curve.handles
    )
    return _changed(session, replace(curve, handles=handles, drawn=False))


def exclude_points(
    session: Session, name: str, numbers: Iterable[int], excluded: bool = True
) -> Session:
    """Let points of a curve or patch take part in the warp, or not."""
    group = _existing(session, name)
    chosen = frozenset(numbers)
    kept = group.excluded | chosen if excluded else group.excluded - chosen
    return _changed(session, replace(group, excluded=kept))


def pin_point(
    session: Session, name: str, number: int, source: Position, destination: Position
) -> tuple[Session, str]:
    """Make a landmark of a point where it is: it slides no more; return its name, too."""
    taken = {landmark.name for landmark in session.landmarks}
    pinned = f"{name}_{number + 1}"
    while pinned in taken:
        pinned += "_"
    landmark = Landmark(pinned, source, destination)
    placed = replace(session, landmarks=(*session.landmarks, landmark))
    return exclude_points(placed, name, [number]), pinned


def _spread(session: Session, patch: Patch, count: int, finder: PathFinder) -> Patch:
    taken = [x.source for x in session.landmarks if x.source is not None]
    return with_points_over(patch, count, finder, taken, session.groups)


def _added(session: Session, group: Group) -> Session:
    _check_free(session, group.name)
    return _with(session, (*session.groups, group))


def _check_free(session: Session, name: str) -> None:
    if not name:
        raise LandmarkError("A curve or patch needs a name.")
    if session.group(name) is not None:
        raise LandmarkError(f"There is already a group called {name}: choose another name.")


def _existing(session: Session, name: str) -> Group:
    group = session.group(name)
    if group is None:
        raise LandmarkError(f"There is no curve or patch called {name}.")
    return group


def _curve(session: Session, name: str) -> Curve:
    group = _existing(session, name)
    if isinstance(group, Patch):
        raise LandmarkError(f"{name} is a patch, and has no handles.")
    return group


def _changed(session: Session, group: Group) -> Session:
    return _with(session, (group if x.name == group.name else x for x in session.groups))


def _with(session: Session, groups: Iterable[Group]) -> Session:
    return replace(session, groups=tuple(groups))
