"""Questions to the user and messages for them; handed in, so that tests can answer."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum, auto
from pathlib import Path

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QFileDialog, QInputDialog, QMessageBox, QWidget


class Answer(Enum):
    """What to do about unsaved work."""

    SAVE = auto()
    DISCARD = auto()
    CANCEL = auto()


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

    def ask_missing_mesh(self, side: str, path: Path) -> Path | None:
        """Ask where a mesh has gone; None opens the session without it."""
        box = QMessageBox(self._window)
        box.setIcon(QMessageBox.Icon.Question)
        box.setWindowTitle("Mesh not found")
        box.setText(f"The {side} mesh {path.name} is not where the session says.")
        box.setInformativeText(f"Looked for {path}. The landmarks are kept either way.")
        locate = box.addButton("Locate…", QMessageBox.ButtonRole.AcceptRole)
        box.addButton("Open without it", QMessageBox.ButtonRole.RejectRole)
        box.exec()
        if box.clickedButton() is not locate:
            return None
        return self.ask_open(f"Locate {path.name}", "All files (*)", path.parent)

    def tell_error(self, title: str, text: str) -> None:
        """Say what went wrong and what to do about it."""
        self._tell(QMessageBox.Icon.Warning, title, text)

    def tell(self, title: str, text: str, details: str = "") -> None:
        """Say something; the details are folded away."""
        self._tell(QMessageBox.Icon.Information, title, text, details)

    def _tell(self, kind: QMessageBox.Icon, title: str, text: str, details: str = "") -> None:
        box = QMessageBox(self._window)
        box.setIcon(kind)
        box.setWindowTitle(title)
        box.setTextFormat(Qt.TextFormat.AutoText)
        box.setText(text)
        if details:
            box.setDetailedText(details)
        box.exec()
