"""Questions to the user and messages for them; handed in, so that tests can answer."""

from __future__ import annotations

from enum import Enum, auto
from pathlib import Path

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QFileDialog, QInputDialog, QMessageBox, QWidget


class Answer(Enum):
    """What to do about unsaved work."""

    SAVE = auto()
    DISCARD = auto()
    CANCEL = auto()


class Dialogs:
    """The real dialogs, over one window."""

    def __init__(self, window: QWidget) -> None:
        self._window = window

    def ask_open(self, title: str, filters: str, folder: Path | None) -> Path | None:
        """Ask for a file to read."""
        name, _ = QFileDialog.getOpenFileName(self._window, title, str(folder or ""), filters)
        return Path(name) if name else None

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
