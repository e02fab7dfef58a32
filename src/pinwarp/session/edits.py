"""Every way to change a session: Session -> Session, one function per verb, nothing else."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from pinwarp.core.components import Components
from pinwarp.core.errors import LandmarkError, PinwarpError
from pinwarp.core.landmarks import Landmark, Position, Role, Side
from pinwarp.core.mirror import mirrored_mesh, mirrored_points, toggled
from pinwarp.core.spline import PenaltyConvention, check_penalty
from pinwarp.io.clipboard_table import PastedLandmark
from pinwarp.io.meshes import MeshFile
from pinwarp.session.mesh_units import likely_unit
from pinwarp.session.naming import is_automatic
from pinwarp.session.session import Session

UNITS = ("mm", "cm", "m")
NAME_PATTERN = "landmark_{n}"
PASSENGER_PATTERN = "passenger_{n}"


def next_name(session: Session, pattern: str = NAME_PATTERN) -> str:
    """Return the name that the next new landmark gets.

    Parameters
    ----------
    pattern
        Holds ``{n}`` where the number goes.

    Examples
    --------
    >>> next_name(Session(landmarks=(Landmark("landmark_4"), Landmark("fovea"))))
    'landmark_5'
    """
    before, _, after = pattern.partition("{n}")
    numbered = re.compile(re.escape(before) + r"(\d+)" + re.escape(after))
    matches = (numbered.fullmatch(landmark.name) for landmark in session.landmarks)
    return f"{before}{max((int(m[1]) for m in matches if m), default=-1) + 1}{after}"


def next_to_place(session: Session, side: Side) -> str | None:
    """Return the first landmark that a click on this side would fill, None for a new one."""
    for landmark in session.landmarks:
        if landmark.role is Role.PAIR and landmark.enabled and landmark.position(side) is None:
            return landmark.name
    return None


def place(
    session: Session,
    side: Side,
    position: Position,
    *,
    target: str | None = None,
    pattern: str = NAME_PATTERN,
) -> tuple[Session, str]:
    """Place a landmark: the one that is asked for, else the first that lacks this side, else new.

    Parameters
    ----------
    target
        The landmark that is asked for, if any.
    pattern
        What a new one is called; see :func:`next_name`.

    Returns
    -------
    session, name
        The changed session, and which landmark was placed.
    """
    name = target or next_to_place(session, side)
    if name is not None:
        return move(session, name, side, position), name
    name = next_name(session, pattern)
    landmark = Landmark(name).placed(side, position)
    return replace(session, landmarks=(*session.landmarks, landmark)), name


def add_passenger(session: Session, position: Position) -> tuple[Session, str]:
    """Add a passenger on the source; it is carried by the warp but not solved for."""
    name = next_name(session, PASSENGER_PATTERN)
    landmark = Landmark(name, role=Role.PASSENGER).placed(Side.SOURCE, position)
    return replace(session, landmarks=(*session.landmarks, landmark)), name


def move(session: Session, name: str, side: Side, position: Position) -> Session:
    """Put one side of a landmark somewhere."""
    return _changed(session, name, lambda landmark: landmark.placed(side, position))


def swap_destinations(session: Session, name: str, other: str) -> Session:
    """Exchange the destinations of two landmarks, as when they were clicked in the wrong order.

    Examples
    --------
    >>> ends = [(1.0, 0.0, 0.0), (2.0, 0.0, 0.0)]
    >>> session = Session(landmarks=tuple(map(Landmark, "ab", [None, None], ends)))
    >>> swap_destinations(session, "a", "b").landmark("a").destination
    (2.0, 0.0, 0.0)
    """
    there = {
        name: _existing(session, other).destination,
        other: _existing(session, name).destination,
    }
    return _all_changed(
        session, there, lambda landmark: landmark.placed(Side.DESTINATION, there[landmark.name])
    )


def remove_side(session: Session, name: str, side: Side) -> Session:
    """Remove one position; a landmark that had no other goes too, unless somebody named it."""
    landmark = _existing(session, name)
    bare = landmark.placed(side, None)
    nothing_left = bare.source is None and bare.destination is None
    # Nobody chose that name: such a landmark may go with its last side.
    if nothing_left and is_automatic(name) and not landmark.note:
        return remove(session, [name])
    return _changed(session, name, lambda _: bare)


def remove(session: Session, names: Iterable[str]) -> Session:
    """Remove landmarks altogether."""
    gone = set(names)
    kept = tuple(landmark for landmark in session.landmarks if landmark.name not in gone)
    return replace(session, landmarks=kept)


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
    return _all_changed(
        session,
        new_names,
        lambda landmark: replace(landmark, name=new_names[landmark.name].strip()),
    )


def set_enabled(session: Session, names: Iterable[str], enabled: bool) -> Session:
    """Let pairs take part in the solve, or not."""
    return _all_changed(session, names, lambda landmark: replace(landmark, enabled=enabled))


def set_locked(session: Session, names: Iterable[str], locked: bool) -> Session:
    """Protect landmarks from being moved by accident, or not."""
    return _all_changed(session, names, lambda landmark: replace(landmark, locked=locked))


def set_role(session: Session, names: Iterable[str], role: Role) -> Session:
    """Make landmarks pairs or passengers; the positions stay, so that there is a way back."""
    return _all_changed(session, names, lambda landmark: replace(landmark, role=role))


def set_note(session: Session, name: str, note: str) -> Session:
    """Write down something about a landmark."""
    return _changed(session, name, lambda landmark: replace(landmark, note=note))


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


def set_penalty(session: Session, penalty: float) -> Session:
    """Set the warping penalty, in mesh units."""
    return replace(session, warping_penalty=check_penalty(penalty))


def set_convention(session: Session, convention: PenaltyConvention) -> Session:
    """Choose the equation that the penalty enters."""
    return replace(session, convention=convention)


def set_planar(session: Session, planar: bool) -> Session:
    """Treat nearly planar landmarks as planar, or not."""
    return replace(session, planar=planar)


def set_components(session: Session, components: Components) -> Session:
    """Choose what of the warp is applied, on the screen and in exports."""
    return replace(session, components=components)


def set_blend(session: Session, blend: float) -> Session:
    """Apply the components in part: 0 is the aligned source, 1 all of them.

    Raises
    ------
    PinwarpError
        When the blend is not from 0 to 1.
    """
    if not 0 <= blend <= 1:
        raise PinwarpError(f"The blend is {blend:.6g}; it must be from 0 to 1.")
    return replace(session, blend=float(blend))


def set_unit(session: Session, unit: str) -> Session:
    """Name the unit of the meshes."""
    return replace(session, unit=unit)


def set_mesh(session: Session, side: Side, file: MeshFile) -> Session:
    """Put a mesh on one side; the landmarks stay where they are.

    The first mesh of a session says which unit is meant: bones measure centimetres to metres.
    """
    if session.source is None and session.destination is None:
        session = set_unit(session, likely_unit(file.mesh))
    return session.with_mesh(side, file)


def swap_sides(session: Session) -> Session:
    """Warp the other way round: meshes and positions change sides; twice is nothing.

    Every position stays on the bone that it was placed on. A passenger goes with its bone too:
    on the destination it is kept, but nothing carries it until the sides are swapped back.
    """
    return replace(
        session,
        source=session.destination,
        destination=session.source,
        landmarks=tuple(
            replace(landmark, source=landmark.destination, destination=landmark.source)
            for landmark in session.landmarks
        ),
    )


def mirror_source(session: Session, axis: str) -> Session:
    """Mirror the source mesh and its landmarks across the middle of one axis of its frame.

    The file of the mesh is untouched: the session remembers that it is seen in a mirror.

    Raises
    ------
    LandmarkError
        Without a source mesh: nothing tells where the middle is.
    """
    file = session.source
    if not isinstance(file, MeshFile):
        raise LandmarkError("There is no source mesh to mirror: open one first.")
    mirrored = replace(
        file, mesh=mirrored_mesh(file.mesh, axis), mirrored=toggled(file.mirrored, axis)
    )
    landmarks = []
    for landmark in session.landmarks:
        if landmark.source is not None:
            (moved,) = mirrored_points([landmark.source], file.mesh, axis)
            landmark = landmark.placed(Side.SOURCE, moved)
        landmarks.append(landmark)
    return replace(session, source=mirrored, landmarks=tuple(landmarks))


def import_side(session: Session, side: Side, landmarks: Iterable[Landmark]) -> Session:
    """Bring in positions for one side: by name where the name is known, else as new landmarks.

    A landmark without a position comes as a name to be placed; it takes no position away.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("head", (1.0, 2.0, 3.0)),))
    >>> arriving = [Landmark("head"), Landmark("fovea")]
    >>> [x.source for x in import_side(session, Side.SOURCE, arriving).landmarks]
    [(1.0, 2.0, 3.0), None]
    """
    arriving = {landmark.name: landmark.position(side) for landmark in landmarks}
    known = {landmark.name for landmark in session.landmarks}
    merged = tuple(
        landmark.placed(side, arriving[landmark.name])
        if arriving.get(landmark.name) is not None
        else landmark
        for landmark in session.landmarks
    )
    new = tuple(
        Landmark(name).placed(side, position)
        for name, position in arriving.items()
        if name not in known
    )
    return replace(session, landmarks=merged + new)


def import_pairs(session: Session, landmarks: Iterable[Landmark]) -> Session:
    """Bring in pairs: known names get the positions that arrive, others become new landmarks."""
    arriving = tuple(landmarks)
    known = {landmark.name for landmark in session.landmarks}
    for side in Side:
        session = import_side(session, side, arriving)
    # A new pair may come switched off; one that is here keeps its state.
    off = {landmark.name for landmark in arriving if not landmark.enabled} - known
    return set_enabled(session, off, False)


def paste(session: Session, rows: Iterable[PastedLandmark]) -> Session:
    """Bring in rows of a table: known names are changed, others become new landmarks at the end.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("head"),))
    >>> rows = [PastedLandmark(2, "fovea"), PastedLandmark(3, "head", {"enabled": False})]
    >>> [(x.name, x.enabled) for x in paste(session, rows).landmarks]
    [('head', False), ('fovea', True)]
    """
    arriving = {row.name: row for row in rows}
    known = {landmark.name for landmark in session.landmarks}
    merged = tuple(
        arriving[landmark.name].onto(landmark) if landmark.name in arriving else landmark
        for landmark in session.landmarks
    )
    new = tuple(row.onto(Landmark(name)) for name, row in arriving.items() if name not in known)
    return replace(session, landmarks=merged + new)


def _set_of(names: Iterable[str]) -> set[str]:
    # One name alone is a string, whose letters are not meant.
    return {names} if isinstance(names, str) else set(names)


def _existing(session: Session, name: str) -> Landmark:
    landmark = session.landmark(name)
    if landmark is None:
        raise LandmarkError(f"There is no landmark called {name}.")
    return landmark


def _changed(session: Session, name: str, change: Callable[[Landmark], Landmark]) -> Session:
    return _all_changed(session, [name], change)


def _all_changed(
    session: Session, names: Iterable[str], change: Callable[[Landmark], Landmark]
) -> Session:
    changing = _set_of(names)
    if missing := changing - {landmark.name for landmark in session.landmarks}:
        raise LandmarkError(f"There is no landmark called {min(missing)}.")
    return replace(
        session,
        landmarks=tuple(
            change(landmark) if landmark.name in changing else landmark
            for landmark in session.landmarks
        ),
    )
