"""File > Warp Files: other meshes and landmarks carried through the session's warp."""

from __future__ import annotations

from pathlib import Path

from pinwarp.core.errors import Cancelled, PinwarpError
from pinwarp.core.words import counted
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.tasks.dialogs import Dialogs, Existing
from pinwarp.gui.tasks.file_tasks import FileTasks, Progress
from pinwarp.io.landmark_files import LANDMARK_SUFFIXES
from pinwarp.io.meshes import MESH_SUFFIXES
from pinwarp.session.editor import Editor
from pinwarp.session.outputs.warp_files import FileWarper, WarpedFile, outputs_of, warp_each
from pinwarp.session.warp.refined import warp_in_words
from pinwarp.session.warp.slid_words import not_sliding_note
from pinwarp.session.warp.solved import solved

FILES = "Meshes and landmarks ({});;All files (*)".format(
    " ".join(f"*{suffix}" for suffix in (*MESH_SUFFIXES, *LANDMARK_SUFFIXES))
)


class FileWarping(Capability):
    """Asks for files and a folder, warps them, and sums up.

    Parameters
    ----------
    editor
        Whose warp it is.
    tasks
        Runs, asks and tells.
    """

    def __init__(self, editor: Editor, tasks: FileTasks[Dialogs]) -> None:
        self._editor = editor
        self._tasks = tasks
        self.actions = (
            Action(
                "warp_files",
                "&Warp Files…",
                self.ask_and_warp,
                at="File.45",
                tip="Other meshes and landmarks, by the same warp",
                possible=lambda: editor.session.pairs,
            ),
        )

    def ask_and_warp(self) -> None:
        """Ask which files are warped into which folder."""
        dialogs = self._tasks.dialogs
        inputs = dialogs.ask_open_many("Warp files", FILES, self._tasks.folder())
        if not inputs:
            return
        folder = dialogs.ask_folder("Write the warped files into", inputs[0].parent)
        if folder is None:
            return
        try:
            outputs = outputs_of(inputs, folder, kept=self._kept())
        except PinwarpError as error:
            dialogs.tell_error("Cannot warp these files", str(error))
            return
        pairs = list(zip(inputs, outputs, strict=True))
        existing = [path for path in outputs if path.exists()]
        if existing:
            answer = dialogs.ask_existing(existing)
            if answer is Existing.CANCEL:
                return
            if answer is Existing.KEEP:
                pairs = [pair for pair in pairs if not pair[1].exists()]
        if pairs:
            self._warp(pairs, folder)

    def _kept(self) -> list[Path]:
        """Return the files that the session is made of, which must not be replaced."""
        session = self._editor.committed
        files = [x.path for x in (session.source, session.destination) if x is not None]
        return [*files, *([self._editor.path] if self._editor.path is not None else [])]

    def _warp(self, pairs: list[tuple[Path, Path]], folder: Path) -> None:
        session = self._editor.committed
        told: list[str] = []

        def warp(progress: Progress) -> list[WarpedFile]:
            done: list[WarpedFile] = []
            inputs, outputs = zip(*pairs, strict=True)
            try:
                progress(0.0, inputs[0].name)
                warped = solved(session)
                told.extend(not_sliding_note(warped.result))
                for file in warp_each(FileWarper(warped), inputs, outputs):
                    done.append(file)
                    if len(done) < len(pairs):
                        progress(len(done) / len(pairs), inputs[len(done)].name)
            except Cancelled:
                # What is written is written: the summary says how far it came.
                return done
            return done

        def arrived(done: list[WarpedFile]) -> None:
            self._sum_up(done, len(pairs), folder, warp_in_words(session), told)

        self._tasks.run("Warping files", warp, arrived)

    def _sum_up(
        self, done: list[WarpedFile], total: int, folder: Path, what: str, told: list[str]
    ) -> None:
        failed = sum(bool(file.error) for file in done)
        written = len(done) - failed
        words = [f"{counted(written, 'file')} written to {folder}: {what}.", *told]
        if failed:
            words.append(f"{counted(failed, 'file')} could not be warped.")
        if len(done) < total:
            words.append(f"Cancelled before the other {counted(total - len(done), 'file')}.")
        details = "\n".join(line for file in done for line in _lines(file))
        self._tasks.said.emit(words[0])
        noted = any(file.notes for file in done)
        if failed or noted or told or len(done) < total or total > 1:
            self._tasks.dialogs.tell("Warped files", " ".join(words), details)


def _lines(file: WarpedFile) -> list[str]:
    if file.error:
        return [f"{file.source.name}: failed. {file.error}"]
    return [f"{file.source.name} → {file.output.name}", *(f"    {note}" for note in file.notes)]
