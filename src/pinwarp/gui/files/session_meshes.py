"""The meshes of a session: read from where it says, found again, or asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from pinwarp.core.errors import Cancelled, PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.core.live import check_drawable
from pinwarp.core.mesh import Mesh
from pinwarp.core.names import look_alike_notes
from pinwarp.gui.drawn.surface import Surface
from pinwarp.gui.files.file_dialogs import FileDialogs
from pinwarp.gui.tasks.file_tasks import FileTasks, Progress
from pinwarp.io.mesh_reference import MeshReference
from pinwarp.io.mesh_search import FoundMesh, find_mesh
from pinwarp.io.meshes import MeshFile
from pinwarp.io.osim.bone import is_mesh_there, read_any_mesh
from pinwarp.io.session_file import SessionRecord
from pinwarp.session.session import Session, from_record


@dataclass
class _Opening:
    """A session being opened, as far as its meshes have been found."""

    record: SessionRecord
    folder: Path | None
    title: str
    arrived: Callable[[Session], bool]
    references: dict[Side, MeshReference]
    places: dict[Side, Path | None] = field(default_factory=dict)
    # Sides whose mesh the user has accepted though it is another than it was.
    accepted: set[Side] = field(default_factory=set)


class SessionMeshes:
    """Reads meshes, and for a session finds out first where they are.

    Parameters
    ----------
    tasks
        Runs, asks and tells.
    keep_surface
        Called with a mesh that was read and its surface, made ready in the job.
    """

    def __init__(
        self, tasks: FileTasks[FileDialogs], keep_surface: Callable[[Mesh, Surface], None]
    ) -> None:
        self._tasks = tasks
        self._keep_surface = keep_surface
        # Where the user has found a mesh, others may be too.
        self._located: list[Path] = []

    def read(self, path: Path, progress: Progress) -> MeshFile:
        """Read a mesh and make it ready to be drawn; to be run in a job.

        RangeError where it is too large or too small to be drawn.
        """
        file = read_any_mesh(path, progress=lambda share, stage: progress(0.7 * share, stage))
        return self.ready(file, progress)

    def ready(self, file: MeshFile, progress: Progress) -> MeshFile:
        """Make a mesh that was read ready to be drawn, as :meth:`read`."""
        progress(0.75, "preparing to draw")
        check_drawable(file.mesh.vertices)
        self._keep_surface(file.mesh, Surface(file.mesh))
        progress(1.0, "done")
        return file

    def open(
        self,
        record: SessionRecord,
        folder: Path | None,
        title: str,
        arrived: Callable[[Session], bool],
    ) -> None:
        """Find and read the meshes of a session.

        Parameters
        ----------
        record
            The session.
        folder
            The folder of its file, where it has one.
        title
            What the user reads meanwhile.
        arrived
            Called with the session and the meshes that could be read; says whether it was taken.
            Problems are told after that.
        """
        references = {Side.SOURCE: record.source_mesh, Side.DESTINATION: record.destination_mesh}
        there = {side: mesh for side, mesh in references.items() if mesh is not None}
        opening = _Opening(record, folder, title, arrived, there)
        for side, reference in there.items():
            if is_mesh_there(reference.path):
                opening.places[side] = reference.path
        self._find(opening)

    def _find(self, opening: _Opening) -> None:
        """Look for the meshes that have moved, and read all once their places are known."""
        lost = {
            side: mesh for side, mesh in opening.references.items() if side not in opening.places
        }
        if not lost:
            self._read(opening)
            return
        folders = [*self._located, *filter(None, [opening.folder])]

        def look(progress: Progress) -> dict[Side, FoundMesh | None]:
            return {
                side: find_mesh(
                    reference,
                    folders,
                    progress=lambda share: progress(share, "looking for the meshes"),
                )
                for side, reference in lost.items()
            }

        def looked(found: dict[Side, FoundMesh | None]) -> None:
            same = {side: mesh.path for side, mesh in found.items() if mesh and mesh.is_same}
            opening.places.update(same)
            unsure = [side for side in lost if side not in same]
            if unsure:
                side = unsure[0]
                self._ask(opening, side, lost[side], found[side])
            # Where one was, the other may be as well.
            self._find(opening)

        self._tasks.run(opening.title, look, looked)

    def _ask(
        self, opening: _Opening, side: Side, reference: MeshReference, found: FoundMesh | None
    ) -> None:
        other = found.path if found is not None else None
        path = self._tasks.dialogs.ask_missing_mesh(side.value, reference.path, other)
        opening.places[side] = path
        if path is None:
            return
        if path == other:
            opening.accepted.add(side)
        if path.parent not in self._located:
            self._located.insert(0, path.parent)

    def _read(self, opening: _Opening) -> None:
        def read(progress: Progress) -> dict[Side, MeshFile | PinwarpError]:
            files: dict[Side, MeshFile | PinwarpError] = {}
            for side, place in opening.places.items():
                try:
                    if place is not None:
                        files[side] = self.read(place, progress)
                except Cancelled:
                    raise
                except PinwarpError as error:
                    files[side] = error
            return files

        def arrived(files: dict[Side, MeshFile | PinwarpError]) -> None:
            found = {side: file for side, file in files.items() if isinstance(file, MeshFile)}
            meshes = (found.get(Side.SOURCE), found.get(Side.DESTINATION))
            if not opening.arrived(from_record(opening.record, *meshes)):
                return
            self._report(opening, found)
            problems = [str(error) for error in files.values() if isinstance(error, PinwarpError)]
            if problems:
                self._tasks.dialogs.tell_error("Opened without a mesh", "\n".join(problems))

        self._tasks.run(opening.title, read, arrived)

    def _report(self, opening: _Opening, found: dict[Side, MeshFile]) -> None:
        """Say which meshes have moved or are not what they were, and which names look alike."""
        changes, moved = [], []
        for side, file in found.items():
            reference = opening.references[side]
            if file.path.parent != reference.path.parent:
                moved.append(f"{file.path.name} was found in {file.path.parent}")
            is_same = reference.is_of(file.sha256, len(file.mesh.vertices))
            if not is_same and side not in opening.accepted:
                changes.append(_change(side, file, reference))
        alike = look_alike_notes(landmark.name for landmark in opening.record.landmarks)
        if moved or alike:
            self._tasks.said.emit("; ".join((*moved, *alike)))
        if changes:
            self._tasks.dialogs.tell(
                "A mesh has changed" if len(changes) == 1 else "Both meshes have changed",
                "\n\n".join(changes)
                + "\n\nLandmarks may no longer lie on the surface: look at them, and snap those "
                "that are off to it (S). Saving the session takes the meshes as they are now.",
            )


def _change(side: Side, file: MeshFile, reference: MeshReference) -> str:
    now = len(file.mesh.vertices)
    if not reference.vertices:
        count = "it is another file"
    else:
        count = (
            f"it still has {now:,} vertices, though not the same file content"
            if now == reference.vertices
            else f"it had {reference.vertices:,} vertices and has {now:,} now"
        )
    return (
        f"The {side.value} mesh {file.path.name} is not as it was when the session was saved: "
        f"{count}."
    )
