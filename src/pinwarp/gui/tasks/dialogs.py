"""Questions to the user and messages for them; handed in, so that tests can answer."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum, auto
from pathlib import Path
from typing import TypeVar

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QFileDialog, QInputDialog, QMessageBox, QWidget

_Choice = TypeVar("_Choice")
ACCEPT = QMessageBox.ButtonRole.AcceptRole
OTHER = QMessageBox.ButtonRole.ActionRole
RISK = QMessageBox.ButtonRole.DestructiveRole
REJECT = QMessageBox.ButtonRole.RejectRole


class Existing(Enum):
    """What to do about files that are there already."""

    REPLACE = auto()
    KEEP = auto()
    CANCEL = auto()


class Dialogs:
    """What any capability asks and tells, over one window; each adds what only it asks."""

    def __init__(self, window: QWidget) -> None:
        self.window = window

    def ask_open(self, title: str, filters: str, folder: Path | None) -> Path | None:
        """Ask for a file to read."""
        name, _ = QFileDialog.getOpenFileName(self.window, title, str(folder or ""), filters)
        return Path(name) if name else None

    def ask_open_many(self, title: str, filters: str, folder: Path) -> list[Path]:
        """Ask for files to read; none when the user would rather not."""
        names, _ = QFileDialog.getOpenFileNames(self.window, title, str(folder), filters)
        return [Path(name) for name in names]

    def ask_folder(self, title: str, folder: Path) -> Path | None:
        """Ask for a folder to write into."""
        name = QFileDialog.getExistingDirectory(self.window, title, str(folder))
        return Path(name) if name else None

    def ask_existing(self, existing: Sequence[Path]) -> Existing:
        """Ask what to do with files that would be written and are there already."""
        box = QMessageBox(self.window)
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
        name, _ = QFileDialog.getSaveFileName(self.window, title, str(proposal), filters)
        return Path(name) if name else None

    def ask_text(self, title: str, question: str, proposal: str) -> str | None:
        """Ask for a line of text; None when the user would rather not."""
        text, accepted = QInputDialog.getText(self.window, title, question, text=proposal)
        return text if accepted else None

    def ask_choice(self, title: str, text: str, more: str, labels: Sequence[str]) -> int:
        """Ask for one of several; the first is the default, the last one what Escape means."""
        roles = [ACCEPT, *[OTHER] * (len(labels) - 2), REJECT]
        return self.choose(
            title, text, more, list(zip(range(len(labels)), labels, roles, strict=True))
        )

    def tell_error(self, title: str, text: str) -> None:
        """Say what went wrong and what to do about it."""
        self._tell(QMessageBox.Icon.Warning, title, text)

    def tell(self, title: str, text: str, details: str = "") -> None:
        """Say something; the details are folded away."""
        self._tell(QMessageBox.Icon.Information, title, text, details)

    def choose(
        self,
        title: str,
        text: str,
        more: str,
        choices: Sequence[tuple[_Choice, str, QMessageBox.ButtonRole]],
    ) -> _Choice:
        """Ask for one of several; the first is the default, the last one what Escape means."""
        box = QMessageBox(self.window)
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
        box = QMessageBox(self.window)
        box.setIcon(kind)
        box.setWindowTitle(title)
        box.setTextFormat(Qt.TextFormat.AutoText)
        box.setText(text)
        if details:
            box.setDetailedText(details)
        box.exec()
