"""Questions to the user and messages for them; handed in, so that tests can answer."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum, auto
from pathlib import Path
from typing import TypeVar

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QFileDialog, QInputDialog, QMessageBox, QWidget

from pinwarp.gui.files.lost_work_dialog import LostAnswer, LostWorkDialog
from pinwarp.gui.importing.dialog import ImportDialog
from pinwarp.session.importing.landmarks import Arriving, ImportChoice
from pinwarp.session.keeping.recovery import LostWork
from pinwarp.session.session import Session

__all__ = ["Answer", "Dialogs", "LostAnswer", "OpenTwice", "Overwrite"]

_Choice = TypeVar("_Choice")
_ACCEPT = QMessageBox.ButtonRole.AcceptRole
_OTHER = QMessageBox.ButtonRole.ActionRole
_RISK = QMessageBox.ButtonRole.DestructiveRole
_REJECT = QMessageBox.ButtonRole.RejectRole


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


class Existing(Enum):
    """What to do about files that are there already."""

    REPLACE = auto()
    KEEP = auto()
    CANCEL = auto()


class Dialogs:
    """The real dialogs, over one window."""

    def __init__(self, window: QWidget) -> None:
        self._window = window

    def ask_open(self, title: str, filters: str, folder: Path | None) -> Path | None:
        """Ask for a file to read."""
        name, _ = QFileDialog.getOpenFileName(self._window, title, str(folder or ""), filters)
        return Path(name) if name else None

    def ask_open_many(self, title: str, filters: str, folder: Path) -> list[Path]:
        """Ask for files to read; none when the user would rather not."""
        names, _ = QFileDialog.getOpenFileNames(self._window, title, str(folder), filters)
        return [Path(name) for name in names]

    def ask_folder(self, title: str, folder: Path) -> Path | None:
        """Ask for a folder to write into."""
        name = QFileDialog.getExistingDirectory(self._window, title, str(folder))
        return Path(name) if name else None

    def ask_existing(self, existing: Sequence[Path]) -> Existing:
        """Ask what to do with files that would be written and are there already."""
        box = QMessageBox(self._window)
        box.setIcon(QMessageBox.Icon.Question)
        box.setWindowTitle("Replace files?")
        many = len(existing) > 1
        there = f"{len(existing)} files are" if many else f"{existing[0].name} is"
        box.setText(f"{there} in {existing[0].parent} already.")
        box.setInformativeText("What is replaced cannot be brought back.")
        if many:
            box.setDetailedText("\n".join(path.name for path in existing))
        roles = QMessageBox.ButtonRole
        replace = box.addButton("Replace", roles.DestructiveRole)
        keep = box.addButton("Leave Them Out" if many else "Leave It Out", roles.AcceptRole)
        box.addButton("Cancel", roles.RejectRole)
        box.setDefaultButton(keep)
        box.exec()
        choices = {replace: Existing.REPLACE, keep: Existing.KEEP}
        return choices.get(box.clickedButton(), Existing.CANCEL)

    def ask_save(self, title: str, filters: str, proposal: Path) -> Path | None:
        """Ask for a file to write."""
        name, _ = QFileDialog.getSaveFileName(self._window, title, str(proposal), filters)
        return Path(name) if name else None

    def ask_unsaved(self, name: str) -> Answer:
        """Ask what to do with unsaved changes."""
        box = QMessageBox(self._window)
        box.setIcon(QMessageBox.Icon.Question)
        box.setWindowTitle("Unsaved changes")
        box.setText(f"Save the changes to {name}?")
        box.setInformativeText("Otherwise they are lost.")
        kinds = QMessageBox.StandardButton
        box.setStandardButtons(kinds.Save | kinds.Discard | kinds.Cancel)
        box.setDefaultButton(kinds.Save)
        choice = box.exec()
        if choice == kinds.Save:
            return Answer.SAVE
        return Answer.DISCARD if choice == kinds.Discard else Answer.CANCEL

    def ask_text(self, title: str, question: str, proposal: str) -> str | None:
        """Ask for a line of text; None when the user would rather not."""
        text, accepted = QInputDialog.getText(self._window, title, question, text=proposal)
        return text if accepted else None

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
        choices = [(_Missing.LOCATE, "Locate…", _ACCEPT), (_Missing.WITHOUT, "Without It", _REJECT)]
        if other is not None:
            more = (
                f"There is a {other.name} in {other.parent}, but its content is not the one that "
                "the landmarks were placed on: they may not lie on its surface.\n\n" + more
            )
            choices.insert(1, (_Missing.USE, "Use That One", _OTHER))
        answer = self._choose(
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
        return self._choose(
            f"{name} is open already",
            f"{name} has been open {where}.",
            "Two windows that save to one file overwrite each other's work. A copy is a new "
            "session, to be saved under a name of its own.",
            [
                (OpenTwice.COPY, "Open a Copy", _ACCEPT),
                (OpenTwice.ANYWAY, "Open Anyway", _RISK),
                (OpenTwice.CANCEL, "Cancel", _REJECT),
            ],
        )

    def ask_overwrite(self, name: str, reason: str) -> Overwrite:
        """Ask whether to write over a file that is not the one that was opened."""
        return self._choose(
            f"Overwrite {name}?",
            f"{name} {reason}.",
            "Overwriting replaces it by this window's session; what it holds now is kept beside "
            f"it as {name}.bak.",
            [
                (Overwrite.SAVE_AS, "Save As…", _ACCEPT),
                (Overwrite.OVERWRITE, "Overwrite", _RISK),
                (Overwrite.CANCEL, "Cancel", _REJECT),
            ],
        )

    def ask_lost_work(self, found: Sequence[LostWork]) -> tuple[LostAnswer, LostWork]:
        """Ask what to do with the unsaved work of windows that did not close properly."""
        dialog = LostWorkDialog(found, self._window)
        dialog.exec()
        dialog.deleteLater()
        return dialog.answer, dialog.chosen

    def ask_import(self, session: Session, arriving: Arriving) -> ImportChoice | None:
        """Show what a landmark file holds, and ask how to bring it in; None leaves it."""
        dialog = ImportDialog(session, arriving, self._window)
        accepted = dialog.exec()
        dialog.deleteLater()
        return dialog.choice if accepted else None

    def ask_choice(self, title: str, text: str, more: str, labels: Sequence[str]) -> int:
        """Ask for one of several; the first is the default, the last one what Escape means."""
        roles = [_ACCEPT, *[_OTHER] * (len(labels) - 2), _REJECT]
        return self._choose(
            title, text, more, list(zip(range(len(labels)), labels, roles, strict=True))
        )

    def tell_error(self, title: str, text: str) -> None:
        """Say what went wrong and what to do about it."""
        self._tell(QMessageBox.Icon.Warning, title, text)

    def tell(self, title: str, text: str, details: str = "") -> None:
        """Say something; the details are folded away."""
        self._tell(QMessageBox.Icon.Information, title, text, details)

    def _choose(
        self,
        title: str,
        text: str,
        more: str,
        choices: Sequence[tuple[_Choice, str, QMessageBox.ButtonRole]],
    ) -> _Choice:
        """Ask for one of several; the first is the default, the last one what Escape means."""
        box = QMessageBox(self._window)
        box.setIcon(QMessageBox.Icon.Question)
        box.setWindowTitle(title)
        box.setText(text)
        box.setInformativeText(more)
        buttons = [box.addButton(label, role) for _, label, role in choices]
        box.setDefaultButton(buttons[0])
        box.setEscapeButton(buttons[-1])
        box.exec()
        clicked = box.clickedButton()
        index = next((i for i, button in enumerate(buttons) if button is clicked), -1)
        return choices[index][0]

    def _tell(self, kind: QMessageBox.Icon, title: str, text: str, details: str = "") -> None:
        box = QMessageBox(self._window)
        box.setIcon(kind)
        box.setWindowTitle(title)
        box.setTextFormat(Qt.TextFormat.AutoText)
        box.setText(text)
        if details:
            box.setDetailedText(details)
        box.exec()
