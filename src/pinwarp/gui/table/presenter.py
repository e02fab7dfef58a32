"""Turns what is asked for at the landmark table into edits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from qtpy.QtGui import QAction
from qtpy.QtWidgets import QInputDialog

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Landmark, Role
from pinwarp.gui.placing.hand import ALL_LOCKED
from pinwarp.gui.table.columns import COLUMNS
from pinwarp.gui.table.model import LandmarkModel
from pinwarp.gui.table.panel import LandmarkPanel
from pinwarp.gui.table.rename_dialog import RenameDialog
from pinwarp.gui.table.spreadsheet import Spreadsheet
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.guide import next_incomplete
from pinwarp.session.naming import in_words
from pinwarp.session.session import Session

_NEED_SELECTION = (
    *("rename", "rename_many", "note", "copy", "move_up", "move_down"),
    *("toggle_enabled", "toggle_locked", "toggle_role"),
)


class TablePresenter:
    """Everything between the editor and the table that is not drawing.

    Parameters
    ----------
    editor
        The truth.
    model, panel
        The table.
    actions
        The window's actions by key.
    dialogs
        Tells what could not be pasted.
    say
        Says a sentence in passing.
    """

    def __init__(
        self,
        editor: Editor,
        model: LandmarkModel,
        panel: LandmarkPanel,
        actions: Mapping[str, QAction],
        dialogs: Dialogs,
        say: Callable[[str], None],
    ) -> None:
        self._editor = editor
        self._panel = panel
        self._actions = actions
        self._say = say
        self._spreadsheet = Spreadsheet(editor, dialogs, say)
        model.edit_requested.connect(self._on_edit)
        model.enable_requested.connect(lambda name, on: self._set_enabled([name], on))
        model.reorder_requested.connect(self._on_reorder)
        panel.table.lock_requested.connect(self._set_locked)
        panel.table.refused.connect(say)
        does = {
            "rename": self.rename,
            "rename_many": self.rename_many,
            "note": self.edit_note,
            "toggle_enabled": self.toggle_enabled,
            "toggle_locked": self.toggle_locked,
            "toggle_role": self.toggle_role,
            "copy": lambda: self._spreadsheet.copy(self._selected()),
            "paste": self.paste,
            "move_up": lambda: self.move_rows(-1),
            "move_down": lambda: self.move_rows(1),
            "next_incomplete": self.next_incomplete,
            "filter": panel.start_filtering,
        }
        for key, function in does.items():
            actions[key].triggered.connect(lambda _checked=False, call=function: call())
        editor.session_changed.connect(self._on_change)
        editor.selection_changed.connect(self._on_change)
        self._on_change()

    def shut_down(self) -> None:
        """Let go of the editor."""
        self._editor.session_changed.disconnect(self._on_change)
        self._editor.selection_changed.disconnect(self._on_change)

    # What is selected, and what can be done with it

    def _selected(self) -> list[Landmark]:
        """Return the selected landmarks, in the order the table shows them."""
        session = self._editor.committed
        names = set(self._editor.selection.names)
        chosen = [landmark for landmark in session.landmarks if landmark.name in names]
        row = {mark.name: self._panel.table.index_of(mark.name).row() for mark in chosen}
        return sorted(chosen, key=lambda landmark: row[landmark.name])

    def _on_change(self, _changed: object = None) -> None:
        """Let the actions say what they would do to the selection."""
        names = set(self._editor.selection.names)
        chosen = [mark for mark in self._editor.committed.landmarks if mark.name in names]
        for key in _NEED_SELECTION:
            self._actions[key].setEnabled(bool(chosen))
        texts = {
            "toggle_enabled": "&Enable" if _all_disabled(chosen) else "&Disable",
            "toggle_locked": "Un&lock" if _all_locked(chosen) else "&Lock",
            "toggle_role": "Make &Pair" if _all_passengers(chosen) else "Make &Passenger",
        }
        for key, text in texts.items():
            self._actions[key].setText(text)

    # Names, notes, typed numbers

    def rename(self) -> None:
        """Type the name of the selected landmark, or a pattern for several."""
        names = self._editor.selection.names
        if len(names) > 1:
            self.rename_many()
        elif names:
            self._panel.reveal(names)
            self._panel.table.rename(names[0])

    def rename_many(self) -> None:
        """Ask for a pattern and rename the selected landmarks by it."""
        names = [landmark.name for landmark in self._selected()]
        editor = self._editor
        dialog = RenameDialog(
            names, lambda new: edits.rename_many(editor.committed, new), self._panel.window()
        )

        def accept() -> None:
            self._commit_renamed(
                lambda session: edits.rename_many(session, dialog.new_names),
                f"Rename {in_words(dialog.new_names)}",
            )

        dialog.accepted.connect(accept)
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()

    def edit_note(self) -> None:
        """Ask for the note of the first selected landmark."""
        landmark = self._selected()[0]
        dialog = QInputDialog(self._panel.window())
        dialog.setOption(QInputDialog.InputDialogOption.UsePlainTextEditForTextInput)
        dialog.setWindowTitle(f"Note on {landmark.name}")
        dialog.setLabelText(f"What to remember about {landmark.name}:")
        dialog.setTextValue(landmark.note)
        dialog.textValueSelected.connect(
            lambda text: self._try(
                lambda session: edits.set_note(session, landmark.name, text),
                f"Note on {landmark.name}",
            )
        )
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()

    def _on_edit(self, column: int, name: str, text: str) -> None:
        edit, label = COLUMNS[column].edit, COLUMNS[column].label
        if COLUMNS[column].side is not None and self._editor.view.locked:
            self._say(ALL_LOCKED)
        elif edit is not None:
            self._commit_renamed(lambda session: edit(session, name, text), label.format(name))

    def _commit_renamed(self, edit: Callable[[Session], Session], label: str) -> None:
        """Commit an edit that may change names; what was selected stays selected."""
        editor = self._editor
        names, before = set(editor.selection.names), editor.committed.landmarks
        rows = [row for row, landmark in enumerate(before) if landmark.name in names]
        if self._try(edit, label):
            editor.select(*(editor.committed.landmarks[row].name for row in rows))

    def _try(self, edit: Callable[[Session], Session], label: str) -> bool:
        try:
            session = edit(self._editor.committed)
        except PinwarpError as error:
            self._say(str(error))
            return False
        self._editor.commit(session, label)
        return True

    # States

    def toggle_enabled(self) -> None:
        """Disable the selected pairs, or enable them where all are disabled."""
        pairs = [mark for mark in self._selected() if mark.role is not Role.PASSENGER]
        if pairs:
            self._set_enabled([mark.name for mark in pairs], _all_disabled(pairs))
        elif self._editor.selection.names:
            self._say("A passenger does not take part in the solve: there is nothing to disable.")

    def toggle_locked(self) -> None:
        """Lock the selected landmarks, or unlock them where all are locked."""
        chosen = self._selected()
        self._set_locked([mark.name for mark in chosen], not _all_locked(chosen))

    def toggle_role(self) -> None:
        """Make the selected landmarks passengers, or pairs where all are passengers."""
        chosen = self._selected()
        role = Role.PAIR if _all_passengers(chosen) else Role.PASSENGER
        names = [mark.name for mark in chosen]
        kind = f"a {role.value}" if len(names) == 1 else f"{role.value}s"
        self._try(
            lambda session: edits.set_role(session, names, role), f"Make {in_words(names)} {kind}"
        )

    def _set_enabled(self, names: Sequence[str], enabled: bool) -> None:
        label = f"{'Enable' if enabled else 'Disable'} {in_words(names)}"
        self._try(lambda session: edits.set_enabled(session, names, enabled), label)

    def _set_locked(self, names: Sequence[str], locked: bool) -> None:
        label = f"{'Lock' if locked else 'Unlock'} {in_words(names)}"
        self._try(lambda session: edits.set_locked(session, names, locked), label)

    # Order

    def _on_reorder(self, names: Sequence[str], row: int) -> None:
        self._try(lambda session: edits.reorder(session, names, row), f"Reorder {in_words(names)}")

    def move_rows(self, step: int) -> None:
        """Move the selected rows one up or down in the session's order."""
        if not self._panel.table.order.is_original:
            self._say("Rows move in the original order only: clear the filter and the sorting.")
            return
        session, names = self._editor.committed, self._editor.selection.names
        rows = sorted(row for name in names if (row := session.index_of(name)) is not None)
        row = max(rows[0] - 1, 0) if step < 0 else min(rows[-1] + 2, len(session.landmarks))
        moved = edits.reorder(session, names, row)
        self._editor.commit(moved, f"Reorder {in_words(names)}", f"reorder {names}")

    def paste(self) -> None:
        """Bring in rows from the clipboard and show them."""
        names = self._spreadsheet.paste()
        if names:
            self._panel.reveal(names)
            self._editor.select(*names)

    # The next to do

    def next_incomplete(self) -> None:
        """Select the next landmark that lacks a position, going round from the selected one."""
        session, chosen = self._editor.committed, set(self._editor.selection.names)
        last = [mark.name for mark in session.landmarks if mark.name in chosen][-1:]
        name = next_incomplete(session, last[0] if last else None)
        landmark = session.landmark(name) if name is not None else None
        if landmark is None:
            self._say(
                "All landmarks are complete."
                if session.landmarks
                else "There are no landmarks yet."
            )
            return
        self._panel.reveal([landmark.name])
        self._editor.select(landmark.name)
        self._say(f"{landmark.name}: {landmark.state.value}.")


def _all_disabled(landmarks: Iterable[Landmark]) -> bool:
    pairs = [mark for mark in landmarks if mark.role is not Role.PASSENGER]
    return bool(pairs) and not any(mark.enabled for mark in pairs)


def _all_locked(landmarks: Sequence[Landmark]) -> bool:
    return bool(landmarks) and all(mark.locked for mark in landmarks)


def _all_passengers(landmarks: Sequence[Landmark]) -> bool:
    return bool(landmarks) and all(mark.role is Role.PASSENGER for mark in landmarks)
