"""Files and the session: open, import, save, with every question and message about them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import PinwarpError, words_of
from pinwarp.core.landmarks import Side
from pinwarp.core.mesh import Mesh
from pinwarp.gui.dialogs import Answer
from pinwarp.gui.file_tasks import (
    LANDMARK_FILES,
    MESH_FILES,
    SESSION_FILES,
    FileTasks,
    Progress,
)
from pinwarp.gui.jobs import Cancelled
from pinwarp.gui.recent_files import RecentFiles
from pinwarp.gui.surface import Surface
from pinwarp.io.file_names import SESSION_SUFFIX, is_session
from pinwarp.io.landmark_files import LANDMARK_SUFFIXES, LandmarkReading, read_landmarks
from pinwarp.io.meshes import MESH_SUFFIXES, MeshFile, read_mesh
from pinwarp.io.session_file import MeshReference, read_session, write_session
from pinwarp.io.template import read_template
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.guide import next_incomplete, with_template
from pinwarp.session.session import Session, from_record, to_record

# Two bones of one kind never differ so much in size.
UNLIKELY_RATIO = 50.0


@dataclass(frozen=True)
class Opening:
    """What to open at the start."""

    session: Path | None = None
    source: Path | None = None
    destination: Path | None = None
    source_landmarks: Path | None = None
    destination_landmarks: Path | None = None


class Documents:
    """Carries files into the editor and out of it.

    Reading runs as a job; the session changes only once everything was read, so that a bad file
    loses nothing.

    Parameters
    ----------
    editor
        What is read and changed.
    tasks
        Runs, asks and tells.
    recent
        Remembers sessions.
    keep_surface
        Called with a mesh that was read and its surface, made ready in the job.
    """

    def __init__(
        self,
        editor: Editor,
        tasks: FileTasks,
        recent: RecentFiles,
        keep_surface: Callable[[Mesh, Surface], None],
    ) -> None:
        self._editor = editor
        self._tasks = tasks
        self._recent = recent
        self._keep_surface = keep_surface

    @property
    def name(self) -> str:
        """What the session is called."""
        path = self._editor.path
        return path.name.removesuffix(SESSION_SUFFIX) if path is not None else "Untitled"

    # Opening

    def open(self, opening: Opening) -> None:
        """Open what the command line names."""
        if opening.session is not None:
            self.open_session(opening.session)
            return
        imports = [
            (Side.SOURCE, opening.source_landmarks),
            (Side.DESTINATION, opening.destination_landmarks),
        ]
        for side, path in ((Side.SOURCE, opening.source), (Side.DESTINATION, opening.destination)):
            if path is not None:
                self.open_mesh(side, path)
        # Behind the meshes in the same queue, so that everything appears in this order.
        for side, path in imports:
            if path is not None:
                self.import_landmarks(path, side)

    def open_files(self, side: Side, paths: Sequence[Path]) -> None:
        """Open files dropped onto a viewport: a session, meshes or landmarks of that side."""
        sessions = [path for path in paths if is_session(path)]
        if sessions:
            if self.may_lose_changes():
                self.open_session(sessions[0])
            return
        meshes = [path for path in paths if path.suffix.lower() in MESH_SUFFIXES]
        # A second mesh belongs to the other side.
        for mesh_side, path in zip((side, side.other), meshes, strict=False):
            self.open_mesh(mesh_side, path)
        others = [path for path in paths if path not in meshes]
        for path in others:
            if path.name.lower().endswith(LANDMARK_SUFFIXES):
                self.import_landmarks(path, side)
            else:
                suffixes = ", ".join(MESH_SUFFIXES)
                self._tasks.dialogs.tell_error(
                    "Cannot open this file",
                    f"{path.name} is neither a mesh ({suffixes}) nor landmarks "
                    f"({', '.join(LANDMARK_SUFFIXES)}) nor a session ({SESSION_SUFFIX}).",
                )

    def ask_and_open_mesh(self, side: Side) -> None:
        """Ask for a mesh and open it."""
        path = self._tasks.dialogs.ask_open(
            f"Open the {side.value} mesh", MESH_FILES, self._tasks.folder()
        )
        if path is not None:
            self.open_mesh(side, path)

    def open_mesh(self, side: Side, path: Path) -> None:
        """Put a mesh on one side; the landmarks stay."""

        def arrived(file: MeshFile) -> None:
            session = edits.set_mesh(self._editor.committed, side, file)
            self._editor.commit(session, f"Open {side.value} mesh")
            self._tasks.said.emit(_mesh_summary(file))
            self._compare_sizes(session)

        self._tasks.run(
            f"Reading {path.name}", lambda progress: self._read_mesh(path, progress), arrived
        )

    def _compare_sizes(self, session: Session) -> None:
        """Say so when one mesh is so much larger that the two must be in different units."""
        source, destination = (session.mesh(side) for side in Side)
        if source is None or destination is None:
            return
        ratio = destination.diagonal / source.diagonal
        if 1 / UNLIKELY_RATIO < ratio < UNLIKELY_RATIO:
            return
        larger = Side.DESTINATION if ratio > 1 else Side.SOURCE
        times = max(ratio, 1 / ratio)
        self._tasks.dialogs.tell(
            "Different units?",
            f"The {larger.value} is {times:,.0f} times as large as the {larger.other.value} "
            f"({source.diagonal:.4g} and {destination.diagonal:.4g} across): one may be in metres "
            "and the other in millimetres.\n\nThe warp takes care of it, and what is exported is "
            f"in the destination's unit. Only the unit beside numbers ({session.unit}) cannot be "
            "right for both.",
        )

    def ask_and_open_session(self) -> None:
        """Ask for a session and open it."""
        if not self.may_lose_changes():
            return
        path = self._tasks.dialogs.ask_open("Open a session", SESSION_FILES, self._tasks.folder())
        if path is not None:
            self.open_session(path)

    def open_session(self, path: Path, *, as_new: bool = False) -> None:
        """Open a session with its meshes; ``as_new`` forgets where it came from."""
        try:
            record = read_session(path)
        except (PinwarpError, OSError) as error:
            self._tasks.dialogs.tell_error("Cannot open the session", words_of(error))
            return
        places = {
            Side.SOURCE: self._locate(Side.SOURCE, record.source_mesh),
            Side.DESTINATION: self._locate(Side.DESTINATION, record.destination_mesh),
        }

        def read(progress: Progress) -> dict[Side, MeshFile | PinwarpError]:
            files: dict[Side, MeshFile | PinwarpError] = {}
            for side, place in places.items():
                try:
                    if place is not None:
                        files[side] = self._read_mesh(place, progress)
                except Cancelled:
                    raise
                except PinwarpError as error:
                    files[side] = error
            return files

        def arrived(files: dict[Side, MeshFile | PinwarpError]) -> None:
            found = {side: file for side, file in files.items() if isinstance(file, MeshFile)}
            session = from_record(record, found.get(Side.SOURCE), found.get(Side.DESTINATION))
            self._editor.replace_all(session, None if as_new else path)
            if not as_new:
                self._recent.add(path)
            self._tasks.said.emit(f"Opened {path.name}: {len(session.pairs)} pairs")
            problems = [str(error) for error in files.values() if isinstance(error, PinwarpError)]
            if problems:
                self._tasks.dialogs.tell_error("Opened without a mesh", "\n".join(problems))

        self._tasks.run(f"Opening {path.name}", read, arrived)

    def _locate(self, side: Side, reference: MeshReference | None) -> Path | None:
        if reference is None:
            return None
        if reference.path.is_file():
            return reference.path
        return self._tasks.dialogs.ask_missing_mesh(side.value, reference.path)

    def ask_and_import_landmarks(self, side: Side | None) -> None:
        """Ask for a landmark file and read it; without a side it must hold pairs."""
        what = f"{side.value} landmarks" if side is not None else "landmark pairs"
        path = self._tasks.dialogs.ask_open(f"Import {what}", LANDMARK_FILES, self._tasks.folder())
        if path is not None:
            self.import_landmarks(path, side)

    def import_landmarks(self, path: Path, side: Side | None) -> None:
        """Bring in landmarks for one side, or pairs where the file holds pairs."""

        def arrived(reading: LandmarkReading) -> None:
            if side is None and not reading.is_pairs:
                self._tasks.dialogs.tell_error(
                    "These are not pairs",
                    f"{path.name} holds positions for one mesh only: import it as source or "
                    "destination landmarks.",
                )
                return
            session = self._editor.committed
            if reading.is_pairs:
                session, label = edits.import_pairs(session, reading.landmarks), "Import pairs"
            else:
                assert side is not None
                session = edits.import_side(session, side, reading.landmarks)
                label = f"Import {side.value} landmarks"
            self._editor.commit(session, label)
            self._report_import(path, reading)

        chosen = side or Side.SOURCE
        self._tasks.run(
            f"Reading {path.name}", lambda _progress: read_landmarks(path, chosen), arrived
        )

    def ask_and_load_template(self, loaded: Callable[[str | None], None]) -> None:
        """Ask for a list of names and add those that are missing, to be placed.

        Parameters
        ----------
        loaded
            Called with the first landmark that is not complete then.
        """
        path = self._tasks.dialogs.ask_open("Load a template", LANDMARK_FILES, self._tasks.folder())
        if path is None:
            return

        def arrived(names: tuple[str, ...]) -> None:
            session = with_template(self._editor.committed, names)
            self._editor.commit(session, f"Load template {path.name}")
            self._tasks.said.emit(f"{len(names)} names from {path.name}")
            loaded(next_incomplete(session, None))

        self._tasks.run(f"Reading {path.name}", lambda _progress: read_template(path), arrived)

    def _report_import(self, path: Path, reading: LandmarkReading) -> None:
        count = len(reading.landmarks)
        what = "pair" if reading.is_pairs else "landmark"
        summary = f"{count} {what}{'' if count == 1 else 's'} from {path.name} ({reading.format})"
        self._tasks.said.emit(". ".join((summary, *reading.notes)))
        if reading.skipped:
            lines = [
                f"Line {line.line}: {line.reason}\n    {line.text}" for line in reading.skipped
            ]
            number = len(lines)
            self._tasks.dialogs.tell(
                "Some lines were skipped",
                f"{count} {what}s were read from {path.name}; "
                f"{number} line{' was' if number == 1 else 's were'} skipped.",
                "\n".join(lines),
            )

    # Saving

    def may_lose_changes(self) -> bool:
        """Ask about unsaved changes; False when the user would rather stay."""
        if not self._editor.is_dirty:
            return True
        answer = self._tasks.dialogs.ask_unsaved(self.name)
        if answer is Answer.SAVE:
            return self.save()
        return answer is Answer.DISCARD

    def save(self) -> bool:
        """Save where the session came from, or ask; say whether it was saved."""
        return self._save_to(self._editor.path) if self._editor.path else self.save_as()

    def save_as(self) -> bool:
        """Ask where to save; say whether it was saved."""
        proposal = self._editor.path or (
            self._tasks.folder() / f"{self.name.lower()}{SESSION_SUFFIX}"
        )
        path = self._tasks.dialogs.ask_save("Save the session", SESSION_FILES, proposal)
        if path is None:
            return False
        if not is_session(path):
            path = path.with_name(path.name.removesuffix(".csv") + SESSION_SUFFIX)
        return self._save_to(path)

    def _save_to(self, path: Path) -> bool:
        if not self._tasks.write(
            lambda: write_session(path, to_record(self._editor.committed)), path
        ):
            return False
        self._editor.mark_saved(path)
        self._recent.add(path)
        self._tasks.said.emit(f"Saved {path.name}")
        return True

    def _read_mesh(self, path: Path, progress: Progress) -> MeshFile:
        file = read_mesh(path, progress=lambda share, stage: progress(0.7 * share, stage))
        progress(0.75, "preparing to draw")
        self._keep_surface(file.mesh, Surface(file.mesh))
        progress(1.0, "done")
        return file


def _mesh_summary(file: MeshFile) -> str:
    mesh = file.mesh
    text = f"{file.path.name}: {len(mesh.vertices):,} vertices, {len(mesh.faces):,} triangles"
    return "; ".join((text, *file.notes))
