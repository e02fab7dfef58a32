"""The session: everything that is saved and undone, as one frozen value."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from pinwarp.core.groups import Group, anchored
from pinwarp.core.landmarks import Landmark, Role, Side, pairs_of
from pinwarp.core.mesh import Mesh
from pinwarp.core.mirror import mirrored_mesh
from pinwarp.core.settings import USUAL_SETTINGS, WarpSettings
from pinwarp.io.group_record import SlidRecord
from pinwarp.io.meshes import MeshFile
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.io.session_file import MeshReference, SessionRecord


@dataclass(frozen=True)
class Session:
    """What one works on.

    Parameters
    ----------
    source, destination
        A mesh that was read, a reference to one that could not be found (kept, so that saving
        loses nothing), or None.
    landmarks
        In the order of the table; names are unique.
    settings
        How the warp is solved and applied.
    refinement
        The warp refined to the whole surface, where somebody asked for that. It counts only while
        what it was made from is unchanged; see :mod:`pinwarp.session.warp.refined`.
    groups
        Curves and patches of semilandmarks, in the order of their list; names are unique. A
        handle of a curve that is anchored to a landmark is always where that is.
    slid
        Where the semilandmarks had come to rest when the session was saved. Where both meshes
        are there they slide anew; see :mod:`pinwarp.session.warp.sliding`.
    unit
        The unit of the meshes, for display.
    unknown
        Header lines of the session file that this version does not know.

    Examples
    --------
    >>> apex = Landmark("apex", source=(0, 0, 0), destination=(0, 0, 5))
    >>> session = Session(landmarks=(apex, Landmark("tip")), unit="mm")
    >>> [pair.name for pair in session.pairs]
    ['apex']
    """

    source: MeshFile | MeshReference | None = None
    destination: MeshFile | MeshReference | None = None
    landmarks: tuple[Landmark, ...] = ()
    settings: WarpSettings = USUAL_SETTINGS
    refinement: RefinementRecord | None = None
    groups: tuple[Group, ...] = ()
    slid: SlidRecord | None = None
    unit: str = "mm"
    unknown: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        if not self.groups:
            return
        # Here, so that no edit of landmarks can forget the curves that are anchored to them.
        by_name = {landmark.name: landmark for landmark in self.landmarks}
        groups = tuple(anchored(group, by_name) for group in self.groups)
        object.__setattr__(self, "groups", groups)

    def mesh_file(self, side: Side) -> MeshFile | MeshReference | None:
        """Return the mesh of one side with its origin, or the reference to a missing one."""
        return self.source if side is Side.SOURCE else self.destination

    def mesh(self, side: Side) -> Mesh | None:
        """Return the mesh of one side, if it is there."""
        file = self.mesh_file(side)
        return file.mesh if isinstance(file, MeshFile) else None

    def with_mesh(self, side: Side, file: MeshFile | MeshReference | None) -> Session:
        """Return the session with the mesh of one side replaced."""
        return (
            replace(self, source=file) if side is Side.SOURCE else replace(self, destination=file)
        )

    @property
    def passengers(self) -> tuple[Landmark, ...]:
        """The passengers that the warp carries, in order: those on the source."""
        return tuple(
            landmark
            for landmark in self.landmarks
            if landmark.role is Role.PASSENGER and landmark.source is not None
        )

    # Found once: a frame of a drag asks a dozen times.
    @cached_property
    def pairs(self) -> tuple[Landmark, ...]:
        """The landmarks that take part in the solve, in order."""
        return pairs_of(self.landmarks)

    def index_of(self, name: str) -> int | None:
        """Return the row of a landmark by its name, or None."""
        for index, landmark in enumerate(self.landmarks):
            if landmark.name == name:
                return index
        return None

    def group(self, name: str) -> Group | None:
        """Return a curve or patch by its name, or None."""
        return next((group for group in self.groups if group.name == name), None)

    def landmark(self, name: str) -> Landmark | None:
        """Return a landmark by its name, or None."""
        index = self.index_of(name)
        return None if index is None else self.landmarks[index]


def to_record(session: Session) -> SessionRecord:
    """Return what a session file holds of a session."""
    return SessionRecord(
        landmarks=session.landmarks,
        groups=session.groups,
        source_mesh=_reference(session.source),
        destination_mesh=_reference(session.destination),
        settings=session.settings,
        refinement=session.refinement,
        slid=session.slid,
        unit=session.unit,
        unknown=session.unknown,
    )


def from_record(
    record: SessionRecord,
    source: MeshFile | None,
    destination: MeshFile | None,
) -> Session:
    """Return the session that a file describes, with the meshes that could be read."""
    return Session(
        source=_found(source, record.source_mesh),
        destination=_found(destination, record.destination_mesh),
        landmarks=record.landmarks,
        groups=record.groups,
        settings=record.settings,
        refinement=record.refinement,
        slid=record.slid,
        unit=record.unit,
        unknown=record.unknown,
    )


def as_seen(file: MeshFile, reference: MeshReference) -> MeshFile:
    """Return a mesh as the session sees it: in another unit or in a mirror, where it says so."""
    mesh = file.mesh
    if reference.scaled != 1:
        mesh = mesh.with_vertices(reference.scaled * mesh.vertices)
    if reference.mirrored:
        mesh = mirrored_mesh(mesh, reference.mirrored)
    return replace(file, mesh=mesh, mirrored=reference.mirrored, scaled=reference.scaled)


def _found(
    file: MeshFile | None, reference: MeshReference | None
) -> MeshFile | MeshReference | None:
    return file or reference if file is None or reference is None else as_seen(file, reference)


def _reference(file: MeshFile | MeshReference | None) -> MeshReference | None:
    if isinstance(file, MeshFile):
        count = len(file.mesh.vertices)
        return MeshReference(file.path, file.sha256, count, file.mirrored, file.scaled)
    return file
