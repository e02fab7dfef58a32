"""Turns what is asked for at the landmark table into edits."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from qtpy.QtCore import QSettings
from qtpy.QtWidgets import QInputDialog, QPlainTextEdit

from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability, Panel
from pinwarp.gui.placing.hand import Hand
from pinwarp.gui.table.columns import COLUMNS
from pinwarp.gui.table.model import LandmarkModel
from pinwarp.gui.table.panel import LandmarkPanel
from pinwarp.gui.table.rename_dialog import RenameDialog
from pinwarp.gui.table.spreadsheet import Spreadsheet
from pinwarp.gui.table.states import all_disabled, all_locked, all_passengers
from pinwarp.gui.table.table import LandmarkTable
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.gui.warp.warps import Warps
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.guide import next_incomplete
from pinwarp.session.naming import in_words
from pinwarp.session.session import Session


class TablePresenter(Capability):
    """The table of landmarks, and everything between it and the editor.

    Parameters
    ----------
    editor
        The truth.
    warps
        What stands in the table's columns.
    hand
        Whether landmarks may be moved.
    dialogs
        Tells what could not be pasted.
    say
        Says a sentence in passing.
    """

    def __init__(
        self,
        editor: Editor,
        warps: Warps,
        hand: Hand,
        dialogs: Dialogs,
        say: Callable[[str], None],
    ) -> None:
        self._editor = editor
        self._warps = warps
        self._hand = hand
        self._say = say
        self.model = LandmarkModel()
        self.table = LandmarkTable(self.model)
        self.model.setParent(self.table)
        self.panel = LandmarkPanel(self.table)
        self.panels = (Panel("landmarks", "Landmarks", self.panel),)
        self.menus = {"row": self.panel.row_menu, "header": self.panel.header_menu}
        self._spreadsheet = Spreadsheet(editor, dialogs, say)
        self._filter = Action(
            "filter", "&Filter Landmarks", self.panel.start_filtering, at="Edit.82", keys="Ctrl+F"
        )
        self.panel.filter.name_key(self._filter.keys)
        self._toggle_enabled, self._toggle_locked, self._toggle_role = self._of_states()
        self.actions = (
            *(self._toggle_enabled, self._toggle_locked, self._toggle_role),
            *self._of_words(),
            *self._of_rows(),
        )
        self._connect()
        self.model.show_rulers(editor.rulers)
        self.model.show_session(editor.session)
        self._on_change()

    def _connect(self) -> None:
        editor, model, table = self._editor, self.model, self.table
        model.edit_requested.connect(self._on_edit)
        model.enable_requested.connect(lambda name, on: self._set_enabled([name], on))
        model.reorder_requested.connect(self._on_reorder)
        table.lock_requested.connect(self._set_locked)
        table.refused.connect(self._say)
        table.selection_requested.connect(
            lambda names, side: editor.select(*names, side=Side(side) if side else None)
        )
        editor.rulers_changed.connect(model.show_rulers)
        editor.session_changed.connect(model.show_session)
        editor.session_changed.connect(self._on_change)
        editor.selection_changed.connect(self._on_change)
        self._warps.figures_changed.connect(model.show_result)

    def _of_states(self) -> tuple[Action, Action, Action]:
        return (
            Action(
                "toggle_enabled",
                "&Disable",
                self.toggle_enabled,
                at="Edit.41 row.21",
                keys="Ctrl+D",
                tip="Let pairs take part, or not",
                possible=self._is_selected,
            ),
            Action(
                "toggle_locked",
                "&Lock",
                self.toggle_locked,
                at="Edit.42 row.22",
                keys="Ctrl+L",
                tip="Protect from being moved by accident",
                possible=self._is_selected,
            ),
            Action(
                "toggle_role",
                "Make &Passenger",
                self.toggle_role,
                at="Edit.43 row.23",
                keys="Ctrl+Shift+P",
                tip="Carried by the warp, not solved for",
                possible=self._is_selected,
            ),
        )

    def _of_words(self) -> tuple[Action, ...]:
        return (
            Action(
                "copy",
                "&Copy",
                lambda: self._spreadsheet.copy(self._selected()),
                at="Edit.21 row.51",
                keys="Ctrl+C",
                tip="As a table for a spreadsheet",
                possible=self._is_selected,
            ),
            Action(
                "paste",
                "&Paste",
                self.paste,
                at="Edit.22 row.52",
                keys="Ctrl+V",
                tip="Landmarks from a spreadsheet or CSV text",
            ),
            Action(
                "rename",
                "Re&name Landmark",
                self.rename,
                at="Edit.31 row.11",
                keys="F2",
                possible=self._is_selected,
            ),
            Action(
                "rename_many",
                "Rename &Several…",
                self.rename_many,
                at="Edit.32 row.12",
                keys="Ctrl+F2",
                tip="By a pattern, or find and replace",
                possible=self._is_selected,
            ),
            Action(
                "note",
                "No&te…",
                self.edit_note,
                at="Edit.33 row.13",
                keys="Shift+F2",
                deed="Write Note",
                tip="Write something down about a landmark",
                possible=self._is_selected,
            ),
        )

    def _of_rows(self) -> tuple[Action, ...]:
        return (
            Action(
                "move_up",
                "Move Row &Up",
                lambda: self.move_rows(-1),
                at="Edit.51",
                keys="Alt+Up",
                possible=self._is_selected,
            ),
            Action(
                "move_down",
                "Move Row Do&wn",
                lambda: self.move_rows(1),
                at="Edit.52",
                keys="Alt+Down",
                possible=self._is_selected,
            ),
            self._filter,
            Action(
                "next_incomplete",
                "Next &Incomplete Landmark",
                self.next_incomplete,
                at="Place.13",
                keys="N",
                deed="Select Next Incomplete Landmark",
            ),
            Action(
                "show_coordinates",
                "Show &Coordinates",
                switches=self.table.show_coordinates,
                checked=lambda: self.table.shows_coordinates,
                at="View.51 header.12",
                keys="Ctrl+Shift+C",
                tip="In the table, to edit",
            ),
        )

    def remember(self, settings: QSettings) -> None:
        """Note how the table is looked at."""
        self.table.remember(settings)

    def recall(self, settings: QSettings) -> None:
        """Look at the table as it was remembered."""
        self.table.recall(settings)

    def shut_down(self) -> None:
        """Let go of the editor."""
        self._editor.rulers_changed.disconnect(self.model.show_rulers)
        self._editor.session_changed.disconnect(self.model.show_session)
        self._editor.session_changed.disconnect(self._on_change)
        self._editor.selection_changed.disconnect(self._on_change)
        self._warps.figures_changed.disconnect(self.model.show_result)

    # What is selected, and what can be done with it

    def _selected(self) -> list[Landmark]:
        """Return the selected landmarks, in the order the table shows them."""
        session = self._editor.committed
        names = set(self._editor.selection.names)
        chosen = [landmark for landmark in session.landmarks if landmark.name in names]
        row = {mark.name: self.table.index_of(mark.name).row() for mark in chosen}
        return sorted(chosen, key=lambda landmark: row[landmark.name])

    def _is_selected(self) -> bool:
        return bool(self._editor.selection.names)

    def _on_change(self, _changed: object = None) -> None:
        """Let the actions say what they would do to the selection."""
        self.table.show_selection(self._editor.selection)
        names = set(self._editor.selection.names)
        chosen = [mark for mark in self._editor.committed.landmarks if mark.name in names]
        self._toggle_enabled.reword("&Enable" if all_disabled(chosen) else "&Disable")
        self._toggle_locked.reword("Un&lock" if all_locked(chosen) else "&Lock")
        self._toggle_role.reword("Make &Pair" if all_passengers(chosen) else "Make &Passenger")

    # Names, notes, typed numbers

    def rename(self) -> None:
        """Type the name of the selected landmark, or a pattern for several."""
        names = self._editor.selection.names
        if len(names) > 1:
            self.rename_many()
        elif names:
            self.panel.reveal(names)
            self.table.rename(names[0])

    def rename_many(self) -> None:
        """Ask for a pattern and rename the selected landmarks by it."""
        names = [landmark.name for landmark in self._selected()]
        editor = self._editor
        dialog = RenameDialog(
            names, lambda new: edits.rename_many(editor.committed, new), self.panel.window()
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
        dialog = QInputDialog(self.panel.window())
        dialog.setOption(QInputDialog.InputDialogOption.UsePlainTextEditForTextInput)
        dialog.setWindowTitle(f"Note on {landmark.name}")
        dialog.setLabelText(f"What to remember about {landmark.name}:")
        dialog.setTextValue(landmark.note)
        for text in dialog.findChildren(QPlainTextEdit):
            text.setAccessibleName(dialog.windowTitle())
            # Else there is no way out of it but Escape.
            text.setTabChangesFocus(True)
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
            self._say(self._hand.all_locked)
        elif edit is not None:
            self._commit_renamed(
                lambda session: edit(session, name, text, self._editor.rulers), label.format(name)
            )

    def _commit_renamed(self, edit: Callable[[Session], Session], label: str) -> None:
        """Commit an edit that may change names; what was selected stays selected."""
        editor = self._editor
        names, before = set(editor.selection.names), editor.committed.landmarks
        rows = [row for row, landmark in enumerate(before) if landmark.name in names]
        if self._try(edit, label):
            editor.select(*(editor.committed.landmarks[row].name for row in rows))

    def _try(self, edit: Callable[[Session], Session], label: str) -> bool:
        problem = self._editor.attempt(edit, label)
        if problem:
            self._say(problem)
        return not problem

    # States

    def toggle_enabled(self) -> None:
        """Disable the selected pairs, or enable them where all are disabled."""
        pairs = [mark for mark in self._selected() if mark.role is not Role.PASSENGER]
        if pairs:
            self._set_enabled([mark.name for mark in pairs], all_disabled(pairs))
        elif self._editor.selection.names:
            self._say("A passenger does not take part in the solve: there is nothing to disable.")

    def toggle_locked(self) -> None:
        """Lock the selected landmarks, or unlock them where all are locked."""
        chosen = self._selected()
        self._set_locked([mark.name for mark in chosen], not all_locked(chosen))

    def toggle_role(self) -> None:
        """Make the selected landmarks passengers, or pairs where all are passengers."""
        chosen = self._selected()
        role = Role.PAIR if all_passengers(chosen) else Role.PASSENGER
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
        if not self.table.order.is_original:
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
            self.panel.reveal(names)
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
        self.panel.reveal([landmark.name])
        self._editor.select(landmark.name)
        self._say(f"{landmark.name}: {landmark.state.value}.")
