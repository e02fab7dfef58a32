"""Files into the session: open and import, with every question and message about them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from qtpy.QtWidgets import QMenu

from pinwarp.core.errors import PinwarpError, words_of
from pinwarp.core.landmarks import Side
from pinwarp.core.words import counted
from pinwarp.gui.capability.action import Action, placed
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.files.file_dialogs import FileDialogs, OpenTwice
from pinwarp.gui.files.recent_files import RecentFiles
from pinwarp.gui.files.recovery import where_open
from pinwarp.gui.files.saving import Saving
from pinwarp.gui.files.session_meshes import SessionMeshes
from pinwarp.gui.importing.imports import LandmarkImports
from pinwarp.gui.tasks.file_tasks import (
    MESH_FILES,
    SESSION_FILES,
    FileTasks,
)
from pinwarp.io.file_names import (
    is_backup,
    is_model_file,
    is_session,
    session_name,
)
from pinwarp.io.landmark_files import LANDMARK_SUFFIXES
from pinwarp.io.meshes import MESH_SUFFIXES, MeshFile
from pinwarp.io.reading import hash_of
from pinwarp.io.samples import sample_session
from pinwarp.io.session_file import read_session
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.importing.landmarks import Pairing
from pinwarp.session.keeping.recovery import OtherWindow
from pinwarp.session.mesh_units import scale_side, scaling_words, scalings, size_words
from pinwarp.session.session import Session


@dataclass(frozen=True)
class Opening:
    """What to open at the start."""

    session: Path | None = None
    source: Path | None = None
    destination: Path | None = None
    source_landmarks: Path | None = None
    destination_landmarks: Path | None = None
    model: Path | None = None
    passengers: Path | None = None

    @property
    def paths(self) -> list[Path]:
        """All of them."""
        files = (self.session, self.source, self.destination, self.model)
        landmarks = (self.source_landmarks, self.destination_landmarks, self.passengers)
        return [path for path in (*files, *landmarks) if path is not None]


class Documents(Capability):
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
    imports
        Brings in landmarks.
    window_with
        Returns another living window that has a session open.
    """

    def __init__(
        self,
        editor: Editor,
        tasks: FileTasks[FileDialogs],
        recent: RecentFiles,
        saving: Saving,
        meshes: SessionMeshes,
        imports: LandmarkImports,
        window_with: Callable[[Path], OtherWindow | None],
    ) -> None:
        self._editor = editor
        self._tasks = tasks
        self._recent = recent
        self._saving = saving
        self._meshes = meshes
        self._imports = imports
        self._window_with = window_with
        self._open_model: Callable[[Path], None] | None = None
        self.recent_menu = QMenu("Open &Recent")
        self.recent_menu.aboutToShow.connect(self._fill_recent)
        self.actions = (
            Action(
                "open_source",
                "Open S&ource Mesh…",
                lambda: self.ask_and_open_mesh(Side.SOURCE),
                at="File.11 tools.12",
                keys="Ctrl+1",
                icon="source",
                tip="Open the mesh that is warped",
            ),
            Action(
                "open_destination",
                "Open &Destination Mesh…",
                lambda: self.ask_and_open_mesh(Side.DESTINATION),
                at="File.12 tools.13",
                keys="Ctrl+2",
                icon="destination",
                tip="Open the mesh whose shape it takes",
            ),
            Action(
                "open_session",
                "&Open Session…",
                self.ask_and_open_session,
                at="File.21 tools.11",
                keys="Ctrl+O",
                icon="open",
                tip="Open a saved session",
            ),
            Action(
                "new_session",
                "&New Session",
                self.close_session,
                at="File.20",
                keys="Ctrl+N",
                deed="Begin New Session",
                tip="Begin with nothing, in this window",
            ),
            placed(self.recent_menu.menuAction(), "File.22"),
            Action(
                "close_session",
                "&Close Session",
                self.close_session,
                at="File.33",
                keys="Ctrl+W",
                tip="Put everything away; what is unsaved is asked about",
                possible=lambda: editor.committed != Session() or editor.path is not None,
            ),
            Action(
                "open_sample",
                "Open Sample &Bones",
                self.open_sample,
                at="File.24",
                tip="Two femurs to try things on",
            ),
        )

    def shut_down(self) -> None:
        """Take the menu of recent files away: it holds on to this."""
        self.recent_menu.deleteLater()

    @property
    def recent(self) -> list[Path]:
        """The sessions opened last that still exist, newest first."""
        return self._recent.paths

    def open_sample(self, then: Callable[[], None] = lambda: None) -> None:
        """Open the sample bones as a new session, asking about unsaved work first; as below."""
        if self._saving.may_lose_changes():
            self.open_session(sample_session(), as_new=True, then=then)

    def close_session(self) -> None:
        """Leave an empty window, asking about unsaved work first."""
        if self._saving.may_lose_changes():
            self._editor.replace_all(Session(), None)

    def _fill_recent(self) -> None:
        self.recent_menu.clear()
        for path in self._recent.paths:
            action = self.recent_menu.addAction(path.name.replace("&", "&&"))
            action.setToolTip(str(path))
            action.triggered.connect(lambda _checked=False, path=path: self._open_recent(path))
        if self.recent_menu.isEmpty():
            self.recent_menu.addAction("Nothing yet").setEnabled(False)
        else:
            self.recent_menu.addSeparator()
            self.recent_menu.addAction("Clear").triggered.connect(self._recent.clear)

    def _open_recent(self, path: Path) -> None:
        if self._saving.may_lose_changes():
            self.open_session(path)

    # Opening

    def hand_models_to(self, open_model: Callable[[Path], None]) -> None:
        """Let models and their studies be opened by who knows them."""
        self._open_model = open_model

    def open(self, opening: Opening) -> None:
        """Open what the command line names."""
        if opening.model is not None and self._open_model is not None:
            self._open_model(opening.model)
        if opening.session is not None:
            self.open_session(opening.session)
        imports = [
            (Side.SOURCE, opening.source_landmarks, None),
            (Side.DESTINATION, opening.destination_landmarks, None),
            (Side.SOURCE, opening.passengers, Pairing.AS_PASSENGERS),
        ]
        for side, path in ((Side.SOURCE, opening.source), (Side.DESTINATION, opening.destination)):
            if path is not None:
                self.open_mesh(side, path)
        # Behind the meshes in the same queue, so that everything appears in this order.
        for side, path, pairing in imports:
            if path is not None:
                self._imports.bring_in(path, side, asking=False, pairing=pairing)

    def open_files(self, side: Side, paths: Sequence[Path]) -> None:
        """Open files dropped onto a viewport: a session, meshes or landmarks of that side.

        A model comes before all of these.
        """
        models = [path for path in paths if is_model_file(path)]
        if models and self._open_model is not None:
            self._open_model(models[0])
            return
        sessions = [path for path in paths if is_session(path)]
        if sessions:
            if self._saving.may_lose_changes():
                self.open_session(sessions[0])
            return
        landmarks = [path for path in paths if _is_landmarks(path)]
        # What is neither is told by what is in it, when it is read.
        meshes = [path for path in paths if path not in landmarks]
        # A second mesh belongs to the other side.
        for mesh_side, path in zip((side, side.other), meshes, strict=False):
            self.open_mesh(mesh_side, path)
        for path in landmarks:
            self._imports.bring_in(path, side)

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
            self._compare_sizes(side)
            self._imports.check(side)

        self._tasks.run(
            f"Reading {path.name}", lambda progress: self._meshes.read(path, progress), arrived
        )

    def _compare_sizes(self, side: Side) -> None:
        """Ask what to do where a new mesh must be in another unit than the other one."""
        session = self._editor.committed
        told, ways = size_words(session), scalings(session)
        if not told:
            return
        title, text, left = "Different units?", told[0], told[-1]
        if not ways:
            self._tasks.dialogs.tell(title, f"{text}\n\n{left}")
            return
        # The new one first: what was there before stays as it is.
        sides = (side, side.other)
        answer = self._tasks.dialogs.ask_choice(
            title,
            text,
            f"{told[1]} Scaling takes the landmarks of that side along; the file stays as it is, "
            f"and the session remembers the factor.\n\n{left}",
            [
                *(scaling_words(f"the {each.value.capitalize()}", ways[each]) for each in sides),
                "Leave Both",
            ],
        )
        if answer < len(sides):
            chosen = sides[answer]
            scaled = scale_side(self._editor.committed, chosen, ways[chosen])
            self._editor.commit(scaled, scaling_words(chosen.value, ways[chosen]))

    def ask_and_open_session(self) -> None:
        """Ask for a session and open it."""
        if not self._saving.may_lose_changes():
            return
        path = self._tasks.dialogs.ask_open("Open a session", SESSION_FILES, self._tasks.folder())
        if path is not None:
            self.open_session(path)

    def open_session(
        self, path: Path, *, as_new: bool = False, then: Callable[[], None] = lambda: None
    ) -> None:
        """Open a session with its meshes.

        Parameters
        ----------
        path
            Its file.
        as_new
            Forget where it came from.
        then
            Called once it is there.
        """
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

        before = self._editor.committed

        def arrived(session: Session) -> bool:
            if not self._saving.may_replace(before):
                return False
            if as_new:
                self._editor.replace_all(session, None)
            else:
                self._editor.replace_all(session, path, sha256=sha256)
                self._recent.add(path)
            self._tasks.said.emit(f"Opened {path.name}: {counted(len(session.pairs), 'pair')}")
            then()
            return True

        self._meshes.open(record, path.parent, f"Opening {path.name}", arrived)


def _is_landmarks(path: Path) -> bool:
    is_mesh = path.suffix.lower() in MESH_SUFFIXES
    return not is_mesh and path.name.lower().endswith(LANDMARK_SUFFIXES)


def _mesh_summary(file: MeshFile) -> str:
    vertices = counted(len(file.mesh.vertices), "vertex", "vertices")
    triangles = counted(len(file.mesh.faces), "triangle")
    text = f"{file.path.name}: {vertices}, {triangles}"
    # All of it stands by the mesh's name, too.
    return ". ".join((text, " ".join(file.notes))) if file.notes else text
