"""Questions about sessions and meshes on the disk."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum, auto
from pathlib import Path

from qtpy.QtWidgets import QMessageBox

from pinwarp.gui.files.lost_work_dialog import LostAnswer, LostWorkDialog
from pinwarp.gui.tasks.dialogs import ACCEPT, OTHER, REJECT, RISK, Dialogs
from pinwarp.session.keeping.recovery import LostWork


class Answer(Enum):
    """What to do about unsaved work."""

    SAVE = auto()
    DISCARD = auto()
    CANCEL = auto()


class OpenTwice(Enum):
    """What to do about a session that another window has open."""

    COPY = auto()
    ANYWAY = auto()
    CANCEL = auto()


class Overwrite(Enum):
    """What to do about a file that is not the one that was opened."""

    OVERWRITE = auto()
    SAVE_AS = auto()
    CANCEL = auto()


class _Missing(Enum):
    USE = auto()
    LOCATE = auto()
    WITHOUT = auto()


class FileDialogs(Dialogs):
    """The dialogs of opening, saving and recovering."""

    def ask_unsaved(self, name: str, reason: str = "") -> Answer:
        """Ask what to do with unsaved changes.

        Parameters
        ----------
        name
            What the session is called.
        reason
            Why it counts as unsaved where nothing was changed.
        """
        box = QMessageBox(self.window)
        box.setIcon(QMessageBox.Icon.Question)
        box.setWindowTitle("Unsaved changes")
        box.setText(f"{reason} Save it again?" if reason else f"Save the changes to {name}?")
        box.setInformativeText(f"Otherwise {'it is' if reason else 'they are'} lost.")
        kinds = QMessageBox.StandardButton
        box.setStandardButtons(kinds.Save | kinds.Discard | kinds.Cancel)
        box.setDefaultButton(kinds.Save)
        choice = box.exec()
        if choice == kinds.Save:
            return Answer.SAVE
        return Answer.DISCARD if choice == kinds.Discard else Answer.CANCEL

    def ask_missing_mesh(self, side: str, path: Path, other: Path | None) -> Path | None:
        """Ask where a mesh has gone; None opens the session without it.

        Parameters
        ----------
        side, path
            Which mesh, and where it should be.
        other
            A file of the same name with other content, where one was found.
        """
        more = f"Looked for {path}. The landmarks are kept either way."
        choices = [(_Missing.LOCATE, "Locate…", ACCEPT), (_Missing.WITHOUT, "Without It", REJECT)]
        if other is not None:
            more = (
                f"There is a {other.name} in {other.parent}, but its content is not the one that "
                "the landmarks were placed on: they may not lie on its surface.\n\n" + more
            )
            choices.insert(1, (_Missing.USE, "Use That One", OTHER))
        answer = self.choose(
            "Mesh not found",
            f"The {side} mesh {path.name} is not where the session says.",
            more,
            choices,
        )
        if answer is _Missing.USE:
            return other
        if answer is _Missing.WITHOUT:
            return None
        return self.ask_open(f"Locate {path.name}", "All files (*)", path.parent)

    def ask_open_twice(self, name: str, where: str) -> OpenTwice:
        """Ask what to do with a session that another window has open."""
        return self.choose(
            f"{name} is open already",
            f"{name} has been open {where}.",
            "Two windows that save to one file overwrite each other's work. A copy is a new "
            "session, to be saved under a name of its own.",
            [
                (OpenTwice.COPY, "Open a Copy", ACCEPT),
                (OpenTwice.ANYWAY, "Open Anyway", RISK),
                (OpenTwice.CANCEL, "Cancel", REJECT),
            ],
        )

    def ask_overwrite(self, name: str, reason: str) -> Overwrite:
        """Ask whether to write over a file that is not the one that was opened."""
        return self.choose(
            f"Overwrite {name}?",
            f"{name} {reason}.",
            "Overwriting replaces it by this window's session; what it holds now is kept beside "
            f"it as {name}.bak.",
            [
                (Overwrite.SAVE_AS, "Save As…", ACCEPT),
                (Overwrite.OVERWRITE, "Overwrite", RISK),
                (Overwrite.CANCEL, "Cancel", REJECT),
            ],
        )

    def ask_lost_work(self, found: Sequence[LostWork]) -> tuple[LostAnswer, LostWork]:
        """Ask what to do with the unsaved work of windows that did not close properly."""
        dialog = LostWorkDialog(found, self.window)
        dialog.exec()
        dialog.deleteLater()
        return dialog.answer, dialog.chosen
