"""What leaves the program: the warped mesh, landmarks, coefficients, a script."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.words import counted
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.scene.key_words import with_own_keys
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.gui.tasks.file_tasks import LANDMARK_FILES, MESH_FILES, FileTasks, Progress
from pinwarp.io.atomic import write_atomically
from pinwarp.io.coefficients import COEFFICIENT_SUFFIXES, write_coefficients
from pinwarp.io.landmark_files import write_landmarks
from pinwarp.io.mesh_formats.vertex_data import NO_DATA
from pinwarp.io.meshes import MESH_SUFFIXES, NORMALS_SUFFIXES, SCALARS_SUFFIXES, write_mesh
from pinwarp.session.editor import Editor
from pinwarp.session.judging.mesh_data import warped_mesh_data
from pinwarp.session.outputs.exports import (
    session_coefficients,
    warped_landmarks,
    warped_mesh,
    warped_passengers,
)
from pinwarp.session.outputs.script import script_of
from pinwarp.session.signals import isolated
from pinwarp.session.warp.provenance import provenance
from pinwarp.session.warp.refined import warp_in_words
from pinwarp.session.warp.slid_words import not_sliding_note, semilandmarks_in_words
from pinwarp.session.warp.solved import SolvedWarp, solved


class Exports(Capability):
    """Asks for a file and writes; ``exported`` emits where a warped mesh went.

    Parameters
    ----------
    editor
        Whose session is written.
    tasks
        Runs, asks and tells.
    """

    exported = isolated(Path)

    def __init__(self, editor: Editor, tasks: FileTasks[Dialogs]) -> None:
        self._editor = editor
        self._tasks = tasks
        self.actions = (
            *self._of_landmarks(),
            Action(
                "export_mesh",
                "&Export Warped Mesh…",
                self.ask_and_export_mesh,
                at="File.43 tools.15",
                keys="Ctrl+E",
                icon="export",
                tip="Save the warped source mesh",
                possible=self._has_warped_mesh,
            ),
            Action(
                "export_coefficients",
                "Coe&fficients…",
                self.export_coefficients,
                at="export.31",
                tip="Of the warp, as JSON or .npz",
                possible=self._has_pairs,
            ),
            Action(
                "export_script",
                "Scr&ipt…",
                self.export_script,
                at="export.32",
                tip="Python that warps the mesh again",
                possible=self._has_warped_mesh,
            ),
        )

    def _of_landmarks(self) -> tuple[Action, ...]:
        return (
            Action(
                "export_source",
                "&Source Landmarks…",
                lambda: self.export_landmarks(Side.SOURCE),
                at="export.21",
            ),
            Action(
                "export_destination",
                "&Destination Landmarks…",
                lambda: self.export_landmarks(Side.DESTINATION),
                at="export.22",
            ),
            Action(
                "export_pairs",
                "&Landmark Pairs…",
                lambda: self.export_landmarks(None),
                at="export.23",
            ),
            Action(
                "export_warped",
                "&Warped Landmarks…",
                lambda: self.export_warped(passengers=False),
                at="export.24",
                tip="Where the warp carries the pairs",
                possible=self._has_pairs,
            ),
            Action(
                "export_passengers",
                "Warped &Passengers…",
                lambda: self.export_warped(passengers=True),
                at="export.25",
                tip="Where the warp carries them",
            ),
        )

    def _has_pairs(self) -> bool:
        return bool(self._editor.session.pairs)

    def _has_warped_mesh(self) -> bool:
        return self._has_pairs() and self._editor.session.mesh(Side.SOURCE) is not None

    def export_landmarks(self, side: Side | None) -> None:
        """Ask for a file and write the landmarks of one side, or the pairs."""
        what = f"{side.value}" if side is not None else "pairs"
        proposal = self._tasks.folder() / f"{what}.landmarks.csv"
        path = self._tasks.dialogs.ask_save(f"Export {what} landmarks", LANDMARK_FILES, proposal)
        if path is None:
            return
        self._write(path, lambda: self._editor.committed.landmarks, side)

    def export_warped(self, *, passengers: bool) -> None:
        """Ask for a file and write where the warp carries the passengers, or the pairs' source."""
        session = self._editor.committed
        what = "passengers" if passengers else "landmarks"
        if passengers and not session.passengers:
            self._tasks.dialogs.tell_error(
                "Cannot export passengers",
                with_own_keys("There is no passenger: Ctrl+click on the source adds one."),
            )
            return
        proposal = self._tasks.folder() / f"{what}_warped.landmarks.csv"
        path = self._tasks.dialogs.ask_save(f"Export the warped {what}", LANDMARK_FILES, proposal)
        if path is None:
            return
        carried = warped_passengers if passengers else warped_landmarks
        applied = warp_in_words(session)
        self._write(path, lambda: carried(session), Side.DESTINATION, applied)

    def _write(
        self,
        path: Path,
        landmarks: Callable[[], Sequence[Landmark]],
        side: Side | None,
        what: str = "",
    ) -> None:
        """Write landmarks and say what the format could not hold."""
        notes: tuple[str, ...] = ()

        def write() -> None:
            nonlocal notes
            session = self._editor.committed
            made = provenance(session)
            notes = write_landmarks(path, landmarks(), side, unit=session.unit, remarks=made)

        if self._tasks.write(write, path):
            done = f"Exported {path.name}" + (f": {what}" if what else "")
            self._tasks.said.emit(". ".join((done, *notes)))

    def export_coefficients(self) -> None:
        """Ask for a file and write the coefficients of the warp as applied."""
        path = self._tasks.ask_save(
            "Export the coefficients",
            f"{self._stem}_coefficients.json",
            COEFFICIENT_SUFFIXES,
            "Coefficients",
        )
        if path is not None:
            self._write_solved(
                path, lambda warp: write_coefficients(path, session_coefficients(warp))
            )

    def export_script(self) -> None:
        """Ask for a file and write a script that warps the mesh again."""
        path = self._tasks.ask_save(
            "Export a script", f"warp_{self._stem}.py", (".py",), "Python scripts"
        )
        if path is not None:
            self._write_solved(
                path, lambda warp: write_atomically(path, script_of(warp, path.parent))
            )

    def _write_solved(self, path: Path, write: Callable[[SolvedWarp], None]) -> None:
        """Write what follows from the warp, and say which warp it was."""
        session, found = self._editor.committed, []

        def solve_and_write() -> None:
            found.append(solved(session))
            write(found[0])

        if self._tasks.write(solve_and_write, path):
            self._say_exported(path, found[0])

    @property
    def _stem(self) -> str:
        source = self._editor.committed.source
        return source.path.stem if source is not None else "mesh"

    def _say_exported(self, path: Path, warp: SolvedWarp) -> None:
        session = warp.session
        count = counted(len(session.pairs), "pair")
        if points := semilandmarks_in_words(warp.result):
            count += f", {points}"
        ruler = session.settings.penalty_ruler(self._editor.rulers.session)
        penalty = f"penalty {ruler.text(session.settings.penalty, 6)}"
        what = warp_in_words(session)
        self._tasks.said.emit(f"Exported {path.name}: {what} ({count}, {penalty})")
        for note in not_sliding_note(warp.result):
            self._tasks.dialogs.tell("Without curves and patches", note)

    def ask_and_export_mesh(self) -> None:
        """Ask for a file and write the warped source mesh, in double precision."""
        source = self._editor.committed.source
        suffix = source.path.suffix if source is not None else ""
        # The name of a mesh need not say what is in it.
        suffix = suffix if suffix.lower() in MESH_SUFFIXES else ".stl"
        proposal = self._tasks.folder() / f"{self._stem}_warped{suffix}"
        path = self._tasks.dialogs.ask_save("Export the warped mesh", MESH_FILES, proposal)
        if path is not None:
            self.export_mesh(path)

    def export_mesh(self, path: Path) -> None:
        """Write the warped source mesh, with normals and figures where the format has room."""
        session, suffix = self._editor.committed, path.suffix.lower()

        def write(progress: Progress) -> SolvedWarp:
            progress(0.05, "warping")
            warp = solved(session)
            mesh, data = warped_mesh(warp), NO_DATA
            if suffix in NORMALS_SUFFIXES:
                data = warped_mesh_data(
                    warp,
                    scalars=suffix in SCALARS_SUFFIXES,
                    progress=lambda share, stage: progress(0.1 + 0.7 * share, stage),
                )
            progress(0.8, "writing")
            write_mesh(path, mesh, replace(data, remarks=provenance(session)))
            return warp

        def written(warp: SolvedWarp) -> None:
            self._say_exported(path, warp)
            self.exported.emit(path)

        self._tasks.run(f"Exporting {path.name}", write, written)
