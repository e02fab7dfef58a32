"""Files into the session: open and import, with every question and message about them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import PinwarpError, words_of
from pinwarp.core.landmarks import Side
from pinwarp.gui.dialogs import OpenTwice
from pinwarp.gui.file_tasks import (
    LANDMARK_FILES,
    MESH_FILES,
    SESSION_FILES,
    FileTasks,
)
from pinwarp.gui.recent_files import RecentFiles
from pinwarp.gui.recovery import where_open
from pinwarp.gui.saving import Saving
from pinwarp.gui.session_meshes import SessionMeshes
from pinwarp.io.file_names import SESSION_SUFFIX, is_backup, is_session, session_name
from pinwarp.io.landmark_files import LANDMARK_SUFFIXES, LandmarkReading, read_landmarks
from pinwarp.io.meshes import MESH_SUFFIXES, MeshFile
from pinwarp.io.reading import hash_of
from pinwarp.io.session_file import read_session
from pinwarp.io.template import read_template
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.guide import next_incomplete, with_template
from pinwarp.session.recovery import OtherWindow
from pinwarp.session.session import Session

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

    @property
    def paths(self) -> list[Path]:
        """All of them."""
        files = (self.session, self.source, self.destination)
        landmarks = (self.source_landmarks, self.destination_landmarks)
        return [path for path in (*files, *landmarks) if path is not None]


class Documents:
    """Carries files into the editor.

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
    saving
        Asks about unsaved work before something else takes its place.
    meshes
        Reads meshes, and finds those of a session.
    window_with
        Returns another living window that has a session open.
    """

    def __init__(
        self,
        editor: Editor,
        tasks: FileTasks,
        recent: RecentFiles,
        saving: Saving,
        meshes: SessionMeshes,
        window_with: Callable[[Path], OtherWindow | None],
    ) -> None:
        self._editor = editor
        self._tasks = tasks
        self._recent = recent
        self._saving = saving
        self._meshes = meshes
        self._window_with = window_with

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
            if self._saving.may_lose_changes():
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
            f"Reading {path.name}", lambda progress: self._meshes.read(path, progress), arrived
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
        if not self._saving.may_lose_changes():
            return
        path = self._tasks.dialogs.ask_open("Open a session", SESSION_FILES, self._tasks.folder())
        if path is not None:
            self.open_session(path)

    def open_session(self, path: Path, *, as_new: bool = False) -> None:
        """Open a session with its meshes; ``as_new`` forgets where it came from."""
        # Saving to a backup would lose what it is kept for.
        as_new = as_new or is_backup(path)
        if not as_new and (other := self._window_with(path)) is not None:
            name = session_name(path)
            match self._tasks.dialogs.ask_open_twice(name, where_open(other)):
                case OpenTwice.CANCEL:
                    return
                case OpenTwice.COPY:
                    as_new = True
        # Before the reading: what is written in between is then noticed when saving.
        sha256 = hash_of(path)
        try:
            record = read_session(path)
        except (PinwarpError, OSError) as error:
            self._tasks.dialogs.tell_error("Cannot open the session", words_of(error))
            return

        def arrived(session: Session) -> None:
            if as_new:
                self._editor.replace_all(session, None)
            else:
                self._editor.replace_all(session, path, sha256=sha256)
                self._recent.add(path)
            self._tasks.said.emit(f"Opened {path.name}: {len(session.pairs)} pairs")

        self._meshes.open(record, path.parent, f"Opening {path.name}", arrived)

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


def _mesh_summary(file: MeshFile) -> str:
    mesh = file.mesh
    text = f"{file.path.name}: {len(mesh.vertices):,} vertices, {len(mesh.faces):,} triangles"
    return "; ".join((text, *file.notes))
