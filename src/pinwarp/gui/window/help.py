"""The Help menu, and what is said when something went wrong."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from qtpy.QtGui import QGuiApplication
from qtpy.QtWidgets import QMessageBox

from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.gui.window.fault_note import FaultNote
from pinwarp.gui.window.faults import Faults
from pinwarp.gui.window.help_text import ABOUT, BIBTEX, CITING


class Help(Capability):
    """Says what the window can do, and what it could not.

    Parameters
    ----------
    dialogs
        Tells.
    faults
        What went wrong.
    graphics
        Returns in words what draws the views.
    say
        Says a sentence in passing.
    show_shortcuts
        Shows the sheet of shortcuts, or takes it away.
    """

    def __init__(
        self,
        dialogs: Dialogs,
        faults: Faults,
        graphics: Callable[[], str],
        say: Callable[[str], None],
        show_shortcuts: Callable[[], None],
    ) -> None:
        self.fault_note = FaultNote(faults, graphics, say)
        self.notes = (self.fault_note,)
        self.actions = (
            Action(
                "shortcuts",
                "&Shortcuts",
                show_shortcuts,
                at="Help.12",
                keys="?",
                deed="Show Shortcuts",
                tip="All keys and mouse gestures",
            ),
            Action(
                "cite",
                "How to &Cite",
                partial(_cite, dialogs, say),
                at="Help.30",
                tip="The program, and what a paper says about a warp",
            ),
            Action(
                "copy_details",
                "Copy &Details",
                self.fault_note.copy,
                at="Help.31",
                tip="Versions and what went wrong, for a report",
            ),
            Action(
                "about",
                "&About pinwarp",
                lambda: dialogs.tell("About pinwarp", ABOUT),
                at="Help.32",
            ),
        )


def _cite(dialogs: Dialogs, say: Callable[[str], None]) -> None:
    is_copied = dialogs.choose(
        "How to cite",
        "How to cite pinwarp",
        CITING,
        (
            (True, "Copy BibTeX", QMessageBox.ButtonRole.AcceptRole),
            (False, "Close", QMessageBox.ButtonRole.RejectRole),
        ),
    )
    if is_copied:
        QGuiApplication.clipboard().setText(BIBTEX)
        say("BibTeX copied")
