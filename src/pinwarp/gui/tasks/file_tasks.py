"""What reading and writing files have in common: jobs, messages, and where to look first."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Generic, TypeVar

from pinwarp.core.errors import Cancelled, PinwarpError, words_of
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.gui.tasks.jobs import SlowJob
from pinwarp.gui.tasks.stepped_job import SteppedJob, Steps
from pinwarp.io.file_names import MODEL_SUFFIX, SESSION_SUFFIX, STUDY_SUFFIX
from pinwarp.io.landmark_files import LANDMARK_SUFFIXES
from pinwarp.io.meshes import MESH_SUFFIXES
from pinwarp.io.osim.bone import split_bone_path
from pinwarp.session.editor import Editor
from pinwarp.session.signals import isolated

MESH_FILES = "Meshes ({});;All files (*)".format(" ".join(f"*{suffix}" for suffix in MESH_SUFFIXES))
SESSION_FILES = f"Sessions (*{SESSION_SUFFIX});;All files (*)"
MODEL_FILES = f"Models (*{MODEL_SUFFIX} *{STUDY_SUFFIX});;All files (*)"
STUDY_FILES = f"Studies of models (*{STUDY_SUFFIX});;All files (*)"
LANDMARK_FILES = "Landmarks ({});;All files (*)".format(
    " ".join(f"*{suffix}" for suffix in LANDMARK_SUFFIXES)
)

Progress = Callable[[float, str], None]


# Tasks over all that the window may ask serve a capability that asks only some of it.
Asking = TypeVar("Asking", bound=Dialogs, covariant=True)


class FileTasks(Generic[Asking]):
    """Runs what reads and writes files, and says how it went; ``said`` emits short messages.

    Parameters
    ----------
    editor
        Whose session is read and written.
    jobs
        Runs the slow parts.
    stepped
        Runs those that must be on the UI thread.
    dialogs
        Asks and tells.
    """

    said = isolated(str)

    def __init__(self, editor: Editor, jobs: SlowJob, stepped: SteppedJob, dialogs: Asking) -> None:
        self._editor = editor
        self._jobs = jobs
        self._stepped = stepped
        self.dialogs = dialogs

    def run(
        self, title: str, function: Callable[[Progress], Any], arrived: Callable[[Any], None]
    ) -> None:
        """Run a job; ``arrived`` takes its result, an error is told."""
        self._jobs.run(title, function, arrived, lambda error: self._tell(title, error))

    def run_steps(self, title: str, steps: Steps, arrived: Callable[[Any], None]) -> None:
        """Run a job on the UI thread, step by step."""
        self._stepped.run(title, steps, arrived, lambda error: self._tell(title, error))

    def _tell(self, title: str, error: Exception) -> None:
        if isinstance(error, Cancelled):
            self.said.emit("Cancelled; nothing was changed")
        elif isinstance(error, (PinwarpError, OSError)):
            self.dialogs.tell_error(f"{title} failed", words_of(error))
        else:
            raise error

    def ask_save(self, title: str, name: str, suffixes: Sequence[str], kind: str) -> Path | None:
        """Ask for a file of some formats; a name without a suffix gets the first one.

        Parameters
        ----------
        title
            Of the dialog.
        name
            The proposal.
        suffixes
            Those of the formats, the usual one first.
        kind
            What such files are called, such as "Pictures".
        """
        patterns = " ".join(f"*{suffix}" for suffix in suffixes)
        filters = f"{kind} ({patterns});;All files (*)"
        path = self.dialogs.ask_save(title, filters, self.folder() / name)
        if path is None or path.suffix.lower() in suffixes:
            return path
        if path.suffix:
            known = ", ".join(suffixes)
            self.dialogs.tell_error(
                f"Cannot write {path.name}", f"{kind} are written as {known}: choose such a name."
            )
            return None
        whole = path.with_name(path.name + suffixes[0])
        if whole.exists():
            # Asked about by nobody: the dialog saw the name without its suffix.
            self.dialogs.tell_error(
                f"{whole.name} is there already",
                "Choose it by its whole name to replace it, or choose another name.",
            )
            return None
        return whole

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
            _file_of(file.path)
            for file in (session.destination, session.source)
            if file is not None
        ]
        path = self._editor.path or (files[0] if files else None)
        # Unlike Path.home, this never fails where nobody knows the home folder.
        return path.parent if path is not None else Path(os.path.expanduser("~"))


def _file_of(path: Path) -> Path:
    """Return the file of a mesh, or the model of a bone."""
    named = split_bone_path(path)
    return path if named is None else named[0]
