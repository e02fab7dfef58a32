"""What reading and writing files have in common: jobs, messages, and where to look first."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from psygnal import Signal

from pinwarp.core.errors import PinwarpError, words_of
from pinwarp.gui.dialogs import Dialogs
from pinwarp.gui.jobs import Cancelled, SlowJob
from pinwarp.io.file_names import SESSION_SUFFIX
from pinwarp.io.landmark_files import LANDMARK_SUFFIXES
from pinwarp.io.meshes import MESH_SUFFIXES
from pinwarp.session.editor import Editor

MESH_FILES = "Meshes ({});;All files (*)".format(" ".join(f"*{suffix}" for suffix in MESH_SUFFIXES))
SESSION_FILES = f"Sessions (*{SESSION_SUFFIX});;All files (*)"
LANDMARK_FILES = "Landmarks ({});;All files (*)".format(
    " ".join(f"*{suffix}" for suffix in LANDMARK_SUFFIXES)
)

Progress = Callable[[float, str], None]


class FileTasks:
    """Runs what reads and writes files, and says how it went; ``said`` emits short messages.

    Parameters
    ----------
    editor
        Whose session is read and written.
    jobs
        Runs the slow parts.
    dialogs
        Asks and tells.
    """

    said = Signal(str)

    def __init__(self, editor: Editor, jobs: SlowJob, dialogs: Dialogs) -> None:
        self._editor = editor
        self._jobs = jobs
        self.dialogs = dialogs

    def run(
        self, title: str, function: Callable[[Progress], Any], arrived: Callable[[Any], None]
    ) -> None:
        """Run a job; ``arrived`` takes its result, an error is told."""

        def failed(error: Exception) -> None:
            if isinstance(error, Cancelled):
                self.said.emit("Cancelled; nothing was changed")
            elif isinstance(error, (PinwarpError, OSError)):
                self.dialogs.tell_error(f"{title} failed", words_of(error))
            else:
                raise error

        self._jobs.run(title, function, arrived, failed)

    def write(self, write: Callable[[], None], path: Path) -> bool:
        """Write a small file at once; say whether it was written."""
        try:
            write()
        except (PinwarpError, OSError) as error:
            # Our own errors say the way out themselves.
            text = words_of(error)
            if isinstance(error, OSError):
                text += "\nNothing was lost: try another folder."
            self.dialogs.tell_error(f"Cannot write {path.name}", text)
            return False
        return True

    def folder(self) -> Path:
        """Return the folder to look in first: the session's, or that of a mesh."""
        session = self._editor.committed
        files: list[Path] = [
            file.path for file in (session.destination, session.source) if file is not None
        ]
        path = self._editor.path or (files[0] if files else None)
        return path.parent if path is not None else Path.home()
