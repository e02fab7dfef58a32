"""Rows to and from a spreadsheet by way of the clipboard."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from qtpy.QtGui import QGuiApplication

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Landmark
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.io.clipboard_table import (
    ClipboardTable,
    PastedLandmark,
    SkippedLine,
    clipboard_text,
    read_clipboard,
)
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.importing.pasting import as_passengers, halves
from pinwarp.session.naming import in_words
from pinwarp.session.session import Session


class Spreadsheet:
    """What is beyond the clipboard.

    Parameters
    ----------
    editor
        The truth.
    dialogs
        Tells which rows could not be used.
    say
        Says a sentence in passing.
    """

    def __init__(self, editor: Editor, dialogs: Dialogs, say: Callable[[str], None]) -> None:
        self._editor = editor
        self._dialogs = dialogs
        self._say = say

    def copy(self, landmarks: Sequence[Landmark]) -> None:
        """Put landmarks on the clipboard."""
        QGuiApplication.clipboard().setText(clipboard_text(landmarks))
        self._say(f"Copied {in_words([mark.name for mark in landmarks])} for a spreadsheet.")

    def paste(self) -> list[str]:
        """Bring in rows as one step, tell which could not be used, and return what came."""
        session, frozen = self._editor.committed, self._editor.view.locked
        locked = {mark.name: mark for mark in session.landmarks if mark.locked or frozen}
        try:
            table = _without_moves(locked, read_clipboard(QGuiApplication.clipboard().text()))
            rows = self._decided(session, table.rows)
            if rows is None:
                self._say("Cancelled; nothing was changed")
                return []
            pasted = edits.paste(session, rows)
        except PinwarpError as error:
            self._say(str(error))
            return []
        names = [row.name for row in rows]
        if names:
            self._editor.commit(pasted, f"Paste {in_words(names)}")
        if table.skipped:
            self._tell(names, table.skipped)
        else:
            self._say(f"Pasted {in_words(names)}.")
        return names

    def _decided(
        self, session: Session, rows: tuple[PastedLandmark, ...]
    ) -> tuple[PastedLandmark, ...] | None:
        """Ask what becomes of landmarks that would wait for ever; None brings nothing in."""
        new = halves(session, rows)
        if not new:
            return rows
        others = tuple(row for row in rows if row not in new)
        brought = tuple(as_passengers(row) if row in new else row for row in rows)
        ways: dict[str, tuple[PastedLandmark, ...]] = {"Add as New Landmarks": rows}
        if all("source" in row.values for row in new):
            ways = {"Add as Passengers": brought, **ways}
        if others:
            ways["Only the Others"] = others
        one = len(new) == 1
        who = in_words([row.name for row in new])
        answer = self._dialogs.ask_choice(
            "Names that are not here",
            f"{who} {'is' if one else 'are'} not here yet, and "
            f"{'comes' if one else 'come'} with a position on one side only.",
            f"All landmarks here are paired: {'this one' if one else 'these'} would wait for the "
            "other side. A passenger is carried by the warp and needs none.",
            [*ways, "Cancel"],
        )
        return [*ways.values(), None][answer]

    def _tell(self, names: Sequence[str], skipped: Sequence[SkippedLine]) -> None:
        count, first = len(skipped), skipped[0]
        rows = "row was" if count == 1 else "rows were"
        self._dialogs.tell(
            "Paste landmarks",
            f"Pasted {in_words(names)}. {count} {rows} not used in full, the first in line "
            f"{first.line}: {first.reason}.",
            "\n".join(f"line {x.line}: {x.reason}   ({x.text})" for x in skipped),
        )


def _without_moves(locked: Mapping[str, Landmark], table: ClipboardTable) -> ClipboardTable:
    """Leave out what would move locked landmarks, and say so."""
    rows: list[PastedLandmark] = []
    skipped = list(table.skipped)
    for row in table.rows:
        mark = locked.get(row.name)
        places = {"source", "destination"} & set(row.values)
        if mark is not None and any(row.values[side] != getattr(mark, side) for side in places):
            skipped.append(SkippedLine(row.line, row.name, "it is locked, so that it stays there"))
            kept = {key: value for key, value in row.values.items() if key not in places}
            rows.append(replace(row, values=kept))
        else:
            rows.append(row)
    return ClipboardTable(tuple(rows), tuple(sorted(skipped, key=lambda line: line.line)))
