"""The window: one editor, its capabilities, and what holds for all of them."""

from __future__ import annotations

from pathlib import Path

from qtpy.QtCore import QSettings
from qtpy.QtGui import QCloseEvent

from pinwarp.gui.capability.action import Action
from pinwarp.gui.window.frame import WindowFrame
from pinwarp.gui.window.parts import Parts
from pinwarp.gui.window.window_dialogs import WindowDialogs
from pinwarp.io.file_names import session_name
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session


class MainWindow(WindowFrame):
    """One window over one editor.

    Parameters
    ----------
    settings
        Where the layout and the recent files are remembered.
    dialogs
        Asks and tells; the real ones when None.
    state_folder
        Where unsaved work is kept in case the program dies, and the log of what went wrong; None
        keeps neither.
    """

    def __init__(
        self,
        settings: QSettings,
        dialogs: WindowDialogs | None = None,
        state_folder: Path | None = None,
    ) -> None:
        super().__init__(state_folder)
        self._settings = settings
        self.editor = editor = Editor()
        self.parts = Parts(self, editor, dialogs or WindowDialogs(self), settings, state_folder)
        quit_action = Action("quit", "&Quit", self.close, at="File.51", keys="Ctrl+Q")
        reset = Action(
            "reset_layout",
            "Reset La&yout",
            self.reset_layout,
            at="View.71",
            tip="Put all panels back where they were at first",
        )
        of_parts = (action for part in self.parts for action in part.actions)
        self.furnish(list(self.parts), [*of_parts, reset, quit_action])
        self.scenes.show_from(*self.parts)
        self._signals = (
            editor.session_changed,
            editor.selection_changed,
            editor.view_changed,
            editor.saved,
        )
        # Behind all capabilities, so that they know what is possible.
        for signal in self._signals:
            signal.connect(self._on_change)
        self.restore_layout(settings)
        for part in self.parts:
            part.recall(settings)
        self._on_change()

    def _on_change(self, changed: object = None) -> None:
        editor = self.editor
        if editor.is_previewing and isinstance(changed, Session):
            # What can be done is about the committed session: a drag need not wait for it.
            return
        self.setWindowTitle(f"{session_name(editor.path)}[*] – pinwarp")
        self.setWindowModified(editor.is_dirty)
        for action in self.actions_by_key.values():
            if isinstance(action, Action):
                action.renew()

    @property
    def is_settled(self) -> bool:
        """Whether everything asked for is done and shown."""
        jobs = (self.jobs, self.long_jobs, self.stepped)
        idle = all(job.is_idle for job in jobs) and self.scenes.is_settled
        return idle and all(part.is_settled for part in self.parts)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask about unsaved work, then let go of everything, what was made last first."""
        if not all(part.may_close() for part in self.parts):
            event.ignore()
            return
        self.save_layout(self._settings)
        for part in self.parts:
            part.remember(self._settings)
        self.take_floats_away()
        # Closing is felt at once: what runs is told to stop, and may take seconds to hear of it.
        self.hide()
        for job in (self.jobs, self.long_jobs, self.stepped):
            job.cancel()
        for signal in self._signals:
            signal.disconnect(self._on_change)
        self.jobs.shut_down()
        self.long_jobs.shut_down()
        self.stepped.shut_down()
        for part in reversed(list(self.parts)):
            part.shut_down()
        self.scenes.shut_down()
        for viewport in self.viewports.values():
            viewport.close()
        self.faults.shut_down()
        super().closeEvent(event)
