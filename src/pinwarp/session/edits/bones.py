"""The meshes on either side: opened, swapped, mirrored."""

from __future__ import annotations

from dataclasses import replace

from pinwarp.core.errors import LandmarkError
from pinwarp.core.groups import Curve, Group, Handle, Patch, moved_group
from pinwarp.core.landmarks import Side
from pinwarp.core.mirror import mirrored_mesh, mirrored_points, toggled
from pinwarp.core.words import listed
from pinwarp.io.meshes import MeshFile
from pinwarp.session.edits.settings import set_unit
from pinwarp.session.mesh_units import likely_unit
from pinwarp.session.session import Session

__all__ = [
    "mirror_source",
    "set_mesh",
    "swap_sides",
]


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

    Raises
    ------
    LandmarkError
        When there are semilandmarks that nobody placed on the destination.
    """
    one_sided = [
        group.name for group in session.groups if isinstance(group, Patch) or not group.is_drawn
    ]
    if one_sided:
        raise LandmarkError(
            f"{listed(one_sided)} cannot change sides, since the destination has no points of "
            "theirs that somebody placed: accept the ghosts of curves, and remove patches first."
        )
    return replace(
        session,
        source=session.destination,
        destination=session.source,
        landmarks=tuple(
            replace(
                landmark,
                source=landmark.destination,
                destination=landmark.source,
                source_spread=landmark.destination_spread,
                destination_spread=landmark.source_spread,
            )
            for landmark in session.landmarks
        ),
        groups=tuple(map(_swapped, session.groups)),
    )


def _swapped(group: Group) -> Group:
    assert isinstance(group, Curve), "a patch has no points on the destination"
    handles = tuple(
        Handle(handle.destination, handle.source, handle.landmark)
        for handle in group.handles
        if handle.destination is not None
    )
    return replace(group, handles=handles)


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
    groups = tuple(
        moved_group(group, Side.SOURCE, lambda places: mirrored_points(places, file.mesh, axis))
        for group in session.groups
    )
    return replace(session, source=mirrored, landmarks=tuple(landmarks), groups=groups)
