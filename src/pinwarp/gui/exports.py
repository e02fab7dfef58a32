"""What leaves the program: the warped mesh, landmarks of a side, pairs, passengers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.gui.file_tasks import LANDMARK_FILES, MESH_FILES, FileTasks, Progress
from pinwarp.gui.lengths import format_length
from pinwarp.io.landmark_files import write_landmarks
from pinwarp.io.meshes import write_mesh
from pinwarp.session.editor import Editor
from pinwarp.session.exports import applied_in_words, warped_mesh, warped_passengers


class Exports:
    """Asks for a file and writes.

    Parameters
    ----------
    editor
        Whose session is written.
    tasks
        Runs, asks and tells.
    """

    def __init__(self, editor: Editor, tasks: FileTasks) -> None:
        self._editor = editor
        self._tasks = tasks

    def export_landmarks(self, side: Side | None) -> None:
        """Ask for a file and write the landmarks of one side, or the pairs."""
        what = f"{side.value}" if side is not None else "pairs"
        proposal = self._tasks.folder() / f"{what}.landmarks.csv"
        path = self._tasks.dialogs.ask_save(f"Export {what} landmarks", LANDMARK_FILES, proposal)
        if path is None:
            return
        self._write(path, lambda: self._editor.committed.landmarks, side)

    def export_passengers(self) -> None:
        """Ask for a file and write where the warp carries the passengers."""
        proposal = self._tasks.folder() / "passengers_warped.landmarks.csv"
        path = self._tasks.dialogs.ask_save(
            "Export the warped passengers", LANDMARK_FILES, proposal
        )
        if path is None:
            return
        self._write(path, lambda: warped_passengers(self._editor.committed), Side.DESTINATION)

    def _write(
        self, path: Path, landmarks: Callable[[], Sequence[Landmark]], side: Side | None
    ) -> None:
        """Write landmarks and say what the format could not hold."""
        notes: tuple[str, ...] = ()

        def write() -> None:
            nonlocal notes
            notes = write_landmarks(path, landmarks(), side, unit=self._editor.committed.unit)

        if self._tasks.write(write, path):
            self._tasks.said.emit(". ".join((f"Exported {path.name}", *notes)))

    def ask_and_export_mesh(self) -> None:
        """Ask for a file and write the warped source mesh, in double precision."""
        session = self._editor.committed
        source = session.mesh_file(Side.SOURCE)
        stem = source.path.stem if source is not None else "mesh"
        suffix = source.path.suffix if source is not None else ".stl"
        proposal = self._tasks.folder() / f"{stem}_warped{suffix}"
        path = self._tasks.dialogs.ask_save("Export the warped mesh", MESH_FILES, proposal)
        if path is not None:
            self.export_mesh(path)

    def export_mesh(self, path: Path) -> None:
        """Write the warped source mesh."""
        session = self._editor.committed

        def write(progress: Progress) -> None:
            progress(0.1, "warping")
            mesh = warped_mesh(session)
            progress(0.6, "writing")
            write_mesh(path, mesh)

        def arrived(_nothing: None) -> None:
            pairs = len(session.pairs)
            penalty = f"penalty {format_length(session.warping_penalty, session.unit, 6)}"
            what = applied_in_words(session)
            self._tasks.said.emit(f"Exported {path.name}: {what} ({pairs} pairs, {penalty})")

        self._tasks.run(f"Exporting {path.name}", write, arrived)
