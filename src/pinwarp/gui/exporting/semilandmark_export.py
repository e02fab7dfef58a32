"""Curves and patches to the files of morphometrics programs."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from pinwarp.core.landmarks import Side
from pinwarp.core.words import counted
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.tasks.dialogs import Dialogs, Existing
from pinwarp.gui.tasks.file_tasks import FileTasks, Progress
from pinwarp.io.semilandmark_files import FORMATS, semilandmark_files, write_all
from pinwarp.session.editor import Editor
from pinwarp.session.outputs.semilandmarks import semilandmarks_on

FILTERS = ";;".join(f"{known.name} (*{known.suffix})" for known in FORMATS)


class SemilandmarkExport(Capability):
    """Asks for a file and writes landmarks, curves and patches of one side.

    Parameters
    ----------
    editor
        Whose session is written.
    tasks
        Runs, asks and tells.
    """

    def __init__(self, editor: Editor, tasks: FileTasks[Dialogs]) -> None:
        self._editor = editor
        self._tasks = tasks
        self.actions = tuple(
            Action(
                f"export_{side.value}_semilandmarks",
                words,
                partial(self.export, side),
                at=f"export.{place}",
                tip="With the landmarks, for geomorph, Morpho, Slicer and others",
                possible=self._has_groups,
            )
            for side, words, place in (
                (Side.SOURCE, "Source Se&milandmarks…", 26),
                (Side.DESTINATION, "Destin&ation Semilandmarks…", 27),
            )
        )

    def _has_groups(self) -> bool:
        return bool(self._editor.session.groups)

    def export(self, side: Side) -> None:
        """Ask for a file and write what one side has; other files of its format go beside it."""
        proposal = self._tasks.folder() / f"{side.value}{FORMATS[0].suffix}"
        title = f"Export {side.value} semilandmarks"
        path = self._tasks.dialogs.ask_save(title, FILTERS, proposal)
        if path is None:
            return
        session = self._editor.committed

        def make(progress: Progress) -> tuple[dict[Path, str], str]:
            progress(0.1, "sliding")
            points, left = semilandmarks_on(session, side)
            texts, notes = semilandmark_files(path, points)
            count = counted(len(points.places) - points.landmarks, "semilandmark")
            words = f"{counted(points.landmarks, 'landmark')} and {count}"
            return texts, " ".join((f"{words}.", *left, *notes))

        self._tasks.run(f"Exporting {path.name}", make, partial(self._write, path))

    def _write(self, path: Path, made: tuple[dict[Path, str], str]) -> None:
        texts, words = made
        # The dialog of the system asked about the first only.
        existing = [other for other in texts if other != path and other.exists()]
        if existing:
            answer = self._tasks.dialogs.ask_existing(existing)
            if answer is Existing.CANCEL:
                self._tasks.said.emit("Cancelled; nothing was written")
                return
            if answer is Existing.KEEP:
                texts = {x: text for x, text in texts.items() if x not in existing}
        if self._tasks.write(lambda: write_all(texts), path):
            names = ", ".join(x.name for x in texts)
            self._tasks.said.emit(f"Exported {names}: {words}")
