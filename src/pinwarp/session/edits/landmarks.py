"""What landmarks are called and what they are for, and the order they stand in."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from pinwarp.core.errors import LandmarkError
from pinwarp.core.groups import Group, renamed_anchors
from pinwarp.core.landmarks import Landmark, Role
from pinwarp.session.session import Session

__all__ = [
    "rename",
    "rename_many",
    "reorder",
    "set_enabled",
    "set_locked",
    "set_note",
    "set_role",
]


def rename(session: Session, name: str, new_name: str) -> Session:
    """Give a landmark another name.

    Raises
    ------
    LandmarkError
        When the new name is empty or taken.
    """
    return rename_many(session, {name: new_name})


def rename_many(session: Session, new_names: Mapping[str, str]) -> Session:
    """Give landmarks other names, all at once: they may take each other's.

    Raises
    ------
    LandmarkError
        When a new name is empty, taken, or given twice.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("left"), Landmark("right")))
    >>> swapped = rename_many(session, {"left": "right", "right": "left"})
    >>> [landmark.name for landmark in swapped.landmarks]
    ['right', 'left']
    """
    taken = {landmark.name for landmark in session.landmarks} - set(new_names)
    given: set[str] = set()
    for new_name in map(str.strip, new_names.values()):
        if not new_name:
            raise LandmarkError("A landmark needs a name.")
        if new_name in taken:
            raise LandmarkError(
                f"There is already a landmark called {new_name}: choose another name."
            )
        if new_name in given:
            raise LandmarkError(f"Two landmarks would be called {new_name}.")
        given.add(new_name)
    # Both at once: a curve lets go of a landmark that is not there.
    anchors = {old: new.strip() for old, new in new_names.items()}
    groups = tuple(renamed_anchors(group, anchors) for group in session.groups)
    return all_changed(
        session,
        new_names,
        lambda landmark: replace(landmark, name=new_names[landmark.name].strip()),
        groups=groups,
    )


def set_enabled(session: Session, names: Iterable[str], enabled: bool) -> Session:
    """Let pairs take part in the solve, or not."""
    return all_changed(session, names, lambda landmark: replace(landmark, enabled=enabled))


def set_locked(session: Session, names: Iterable[str], locked: bool) -> Session:
    """Protect landmarks from being moved by accident, or not."""
    return all_changed(session, names, lambda landmark: replace(landmark, locked=locked))


def set_role(session: Session, names: Iterable[str], role: Role) -> Session:
    """Make landmarks pairs or passengers; the positions stay, so that there is a way back."""
    return all_changed(session, names, lambda landmark: replace(landmark, role=role))


def set_note(session: Session, name: str, note: str) -> Session:
    """Write down something about a landmark."""
    return changed(session, name, lambda landmark: replace(landmark, note=note))


def reorder(session: Session, names: Iterable[str], row: int) -> Session:
    """Move landmarks before the one in a row, keeping their order; the last row + 1 is the end.

    Examples
    --------
    >>> session = Session(landmarks=tuple(map(Landmark, "abcd")))
    >>> [landmark.name for landmark in reorder(session, ["a", "c"], 4).landmarks]
    ['b', 'd', 'a', 'c']
    """
    moving = _set_of(names)
    before, behind = session.landmarks[:row], session.landmarks[row:]
    taken = tuple(landmark for landmark in session.landmarks if landmark.name in moving)
    if missing := moving - {landmark.name for landmark in taken}:
        raise LandmarkError(f"There is no landmark called {min(missing)}.")
    return replace(
        session,
        landmarks=(
            *(landmark for landmark in before if landmark.name not in moving),
            *taken,
            *(landmark for landmark in behind if landmark.name not in moving),
        ),
    )


def existing(session: Session, name: str) -> Landmark:
    """Return a landmark by its name, or raise a LandmarkError that there is none."""
    landmark = session.landmark(name)
    if landmark is None:
        raise LandmarkError(f"There is no landmark called {name}.")
    return landmark


def changed(session: Session, name: str, change: Callable[[Landmark], Landmark]) -> Session:
    """Return the session with one landmark changed; it must be there."""
    return all_changed(session, [name], change)


def all_changed(
    session: Session,
    names: Iterable[str],
    change: Callable[[Landmark], Landmark],
    groups: tuple[Group, ...] | None = None,
) -> Session:
    """Return the session with some landmarks changed, all of which must be there.

    What of the curves and patches must change along with them is given, too.
    """
    changing = _set_of(names)
    if missing := changing - {landmark.name for landmark in session.landmarks}:
        raise LandmarkError(f"There is no landmark called {min(missing)}.")
    return replace(
        session,
        landmarks=tuple(
            change(landmark) if landmark.name in changing else landmark
            for landmark in session.landmarks
        ),
        groups=session.groups if groups is None else groups,
    )


def _set_of(names: Iterable[str]) -> set[str]:
    # One name alone is a string, whose letters are not meant.
    return {names} if isinstance(names, str) else set(names)
