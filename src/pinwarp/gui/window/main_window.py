"""The window: puts the presenters over its frame, and wires actions to what they do."""

from __future__ import annotations

from pathlib import Path

from qtpy.QtCore import QSettings
from qtpy.QtGui import QCloseEvent
from qtpy.QtWidgets import QToolBar

from pinwarp.core.landmarks import Side
from pinwarp.gui.exporting.exports import Exports
from pinwarp.gui.exporting.file_warping import FileWarping
from pinwarp.gui.exporting.picture_export import PictureExport
from pinwarp.gui.exporting.report import ReportExport
from pinwarp.gui.files.documents import Documents
from pinwarp.gui.files.recent_files import RecentFiles
from pinwarp.gui.files.recovery import Recovery
from pinwarp.gui.files.saving import Saving
from pinwarp.gui.files.session_meshes import SessionMeshes
from pinwarp.gui.findings.presenter import FindingsPresenter
from pinwarp.gui.importing.imports import LandmarkImports
from pinwarp.gui.maps.presenter import MapPresenter
from pinwarp.gui.penalty.tuning import PenaltyTuning
from pinwarp.gui.placing.guidance import Guidance
from pinwarp.gui.table.presenter import TablePresenter
from pinwarp.gui.tasks.file_tasks import FileTasks
from pinwarp.gui.tasks.jobs import SlowJob
from pinwarp.gui.tasks.progress import JobProgress
from pinwarp.gui.tasks.stepped_job import SteppedJob
from pinwarp.gui.views.controls import ViewControls
from pinwarp.gui.warp.grid import GridPresenter
from pinwarp.gui.warp.presenter import WarpPresenter
from pinwarp.gui.warp.quality import QualityPresenter
from pinwarp.gui.warp.warps import Presenter
from pinwarp.gui.window.bone_edits import BoneEdits
from pinwarp.gui.window.frame import WindowFrame
from pinwarp.gui.window.help_text import ABOUT, ABOUT_PENALTY, ABOUT_QUALITY
from pinwarp.gui.window.window_dialogs import WindowDialogs
from pinwarp.io.file_names import session_name
from pinwarp.io.samples import sample_session
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
        Where unsaved work is kept in case the program dies; None keeps none.
    """

    def __init__(
        self,
        settings: QSettings,
        dialogs: WindowDialogs | None = None,
        state_folder: Path | None = None,
    ) -> None:
        super().__init__()
        self._settings = settings
        self.editor = Editor()
        self.jobs = SlowJob(self)
        self.stepped = SteppedJob(self)
        self._dialogs = dialogs or WindowDialogs(self)
        self._recent = RecentFiles(settings)
        progress = JobProgress(self.statusBar(), (self.jobs, self.stepped))
        self.progress, self.cancel = progress.bar, progress.cancel
        self.presenter = Presenter(self.editor, self.viewports, self.model, self.table, self.panel)
        self.quality = QualityPresenter(self.presenter)
        self.maps = MapPresenter(
            self.editor, self.presenter, self.viewports, self.map_panel, self.actions_by_key, self
        )
        self.statusBar().addPermanentWidget(self.maps.fold_note)
        self.quality.quality_changed.connect(self.presenter.show_quality)
        self.findings_presenter = FindingsPresenter(
            self.editor,
            self.quality,
            self.maps,
            self.model,
            self.landmarks,
            self.actions_by_key,
            self.presenter.requests,
            self.say,
        )
        self.tuning = PenaltyTuning(
            self.editor,
            self.presenter,
            self.quality,
            self.viewports,
            self.panel,
            self.snapshot_strip,
            self.actions_by_key,
            self.say,
            self,
        )
        self._bone_edits = BoneEdits(self.editor, self.actions_by_key, self)
        self.view_controls = ViewControls(self.editor, self.viewports, self.actions_by_key, self)
        self.view_controls.add_to(self.findChild(QToolBar, "tools"))
        self.warp_presenter = WarpPresenter(
            self.editor, self.warp_panel, self.quality, self.actions_by_key, self.say, self
        )
        self.grid = GridPresenter(
            self.editor, self.presenter, self.viewports, self.actions_by_key, self
        )
        self.statusBar().addPermanentWidget(self.warp_presenter.note)
        self._tasks = FileTasks(self.editor, self.jobs, self.stepped, self._dialogs)
        meshes = SessionMeshes(self._tasks, self.presenter.keep_surface)
        self.saving = Saving(self.editor, self._tasks, self._recent)
        self.recovery = Recovery(self.editor, self._tasks, self.saving, meshes, state_folder, self)
        self.imports = LandmarkImports(self.editor, self._tasks)
        self.documents = Documents(
            self.editor,
            self._tasks,
            self._recent,
            self.saving,
            meshes,
            self.imports,
            self.recovery.window_with,
        )
        self.exports = Exports(self.editor, self._tasks)
        self._pictures = PictureExport(self.editor, self._tasks, self.viewports, self)
        self._file_warping = FileWarping(self.editor, self._tasks)
        self._report_export = ReportExport(
            self.editor,
            self._tasks,
            self.viewports,
            lambda: session_name(self.editor.path),
            lambda: (self.presenter.result, self.quality.quality),
        )
        self.guidance = Guidance(
            self.editor, self.presenter, self._tasks, self.guide_bar, self.hint
        )
        self.table_presenter = TablePresenter(
            self.editor,
            self.model,
            self.landmarks,
            self.actions_by_key,
            self._dialogs,
            self.say,
        )
        self._connect()
        self.restore_layout(settings)
        self._on_session()

    # Wiring

    def _connect(self) -> None:
        documents, editor, actions = self.documents, self.editor, self.actions_by_key
        does = {
            "open_session": documents.ask_and_open_session,
            "open_source": lambda: documents.ask_and_open_mesh(Side.SOURCE),
            "open_destination": lambda: documents.ask_and_open_mesh(Side.DESTINATION),
            "open_sample": self.open_sample,
            "save": self.saving.save,
            "save_as": self.saving.save_as,
            "restore": self.recovery.offer_again,
            "import_source": lambda: self.imports.ask(Side.SOURCE),
            "import_destination": lambda: self.imports.ask(Side.DESTINATION),
            "import_pairs": lambda: self.imports.ask(None),
            "export_source": lambda: self.exports.export_landmarks(Side.SOURCE),
            "export_destination": lambda: self.exports.export_landmarks(Side.DESTINATION),
            "export_pairs": lambda: self.exports.export_landmarks(None),
            "export_mesh": self.exports.ask_and_export_mesh,
            "export_report": self._report_export.ask_and_export,
            "quit": self.close,
            "undo": editor.undo,
            "redo": editor.redo,
            "delete_side": self.presenter.requests.delete_side,
            "delete_landmark": self.presenter.requests.delete_landmarks,
            "accept_ghost": self.presenter.requests.accept_ghost,
            "snap": self.presenter.requests.snap,
            "set_nudge": self.guidance.ask_nudge,
            "set_pattern": self.guidance.ask_pattern,
            "load_template": self.guidance.load_template,
            "export_passengers": lambda: self.exports.export_warped(passengers=True),
            "export_warped": lambda: self.exports.export_warped(passengers=False),
            "export_coefficients": self.exports.export_coefficients,
            "export_script": self.exports.export_script,
            "export_picture": self._pictures.ask_for_picture,
            "export_animation": self._pictures.ask_for_animation,
            "warp_files": self._file_warping.ask_and_warp,
            "shortcuts": self.shortcuts.toggle,
            "select_none": editor.select,
            "about": lambda: self._dialogs.tell("About pinwarp", ABOUT),
            "about_penalty": lambda: self._dialogs.tell("About the warping penalty", ABOUT_PENALTY),
            "about_quality": lambda: self._dialogs.tell("About the quality figures", ABOUT_QUALITY),
        }
        for key, function in does.items():
            # Qt's "checked" argument is of no use to any of them.
            actions[key].triggered.connect(lambda _checked=False, call=function: call())
        self.recent_menu.aboutToShow.connect(self._fill_recent)
        actions["overlay"].toggled.connect(lambda on: editor.look(overlay=on))
        actions["lock"].toggled.connect(lambda on: editor.look(locked=on))
        actions["guide"].toggled.connect(self.guidance.switch)
        self.snapshot_strip.height_changed.connect(self.fit_penalty_dock)
        actions["show_curve"].toggled.connect(self.fit_penalty_dock)
        self.presenter.requests.refused.connect(self.say)
        self.guidance.said.connect(self.say)
        self.maps.refused.connect(self.say)
        self.maps.map_changed.connect(self._on_view)
        self.opacity.valueChanged.connect(
            lambda value: editor.look(**{self.maps.opacity_key: value / 100})
        )
        for side, viewport in self.viewports.items():
            viewport.files_dropped.connect(
                lambda paths, side=side: documents.open_files(side, paths)
            )
        self._tasks.said.connect(self.say)
        editor.session_changed.connect(self._on_session)
        editor.selection_changed.connect(self._on_session)
        editor.view_changed.connect(self._on_view)
        editor.saved.connect(self._on_session)
        self._on_view()

    def open_sample(self) -> None:
        """Open the sample bones as a new session, asking about unsaved work first."""
        if self.saving.may_lose_changes():
            self.documents.open_session(sample_session(), as_new=True)

    def _fill_recent(self) -> None:
        self.recent_menu.clear()
        for path in self._recent.paths:
            action = self.recent_menu.addAction(path.name.replace("&", "&&"))
            action.setToolTip(str(path))
            action.triggered.connect(lambda _checked=False, path=path: self._open_recent(path))
        if self.recent_menu.isEmpty():
            self.recent_menu.addAction("Nothing yet").setEnabled(False)
        else:
            self.recent_menu.addSeparator()
            self.recent_menu.addAction("Clear").triggered.connect(self._recent.clear)

    def _open_recent(self, path: Path) -> None:
        if self.saving.may_lose_changes():
            self.documents.open_session(path)

    # What changed

    def _on_session(self, changed: object = None) -> None:
        editor, actions = self.editor, self.actions_by_key
        if editor.is_previewing and isinstance(changed, Session):
            # What is said here is about the committed session: a drag need not wait for it.
            return
        self.setWindowTitle(f"{session_name(self.editor.path)}[*] – pinwarp")
        self.setWindowModified(editor.is_dirty)
        for key, verb, label in (
            ("undo", "&Undo", editor.undo_label),
            ("redo", "&Redo", editor.redo_label),
        ):
            actions[key].setText(f"{verb} {label}" if label else verb)
            actions[key].setEnabled(label is not None)
            plain = verb.replace("&", "")
            shortcut = actions[key].shortcut().toString()
            actions[key].setToolTip(f"{plain} {label or ''}".strip() + f" ({shortcut})")
        has_selection = bool(editor.selection.names)
        for key in ("delete_side", "delete_landmark", "select_none"):
            actions[key].setEnabled(has_selection)
        session = editor.session
        has_mesh = {side: session.mesh(side) is not None for side in Side}
        for key in ("export_mesh", "export_script"):
            actions[key].setEnabled(has_mesh[Side.SOURCE] and bool(session.pairs))
        for key in ("export_report", "export_warped", "export_coefficients", "warp_files"):
            actions[key].setEnabled(bool(session.pairs))
        actions["export_picture"].setEnabled(any(has_mesh.values()))
        actions["export_animation"].setEnabled(any(has_mesh.values()))
        self.guidance.show()

    def _on_view(self, _changed: object = None) -> None:
        view = self.editor.view
        self.actions_by_key["overlay"].setChecked(view.overlay)
        self.actions_by_key["lock"].setChecked(view.locked)
        self.actions_by_key["guide"].setChecked(view.guided is not None)
        self.opacity.setEnabled(view.overlay)
        self.opacity.setValue(round(getattr(view, self.maps.opacity_key) * 100))
        self.guidance.show()

    @property
    def is_settled(self) -> bool:
        """Whether everything asked for is done and shown."""
        parts = (self.presenter, self.quality, self.tuning, self.grid, self.maps)
        idle = self.jobs.is_idle and self.stepped.is_idle
        return idle and all(part.is_settled for part in parts)

    # The end

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask about unsaved work, then let go of workers and graphics in the right order."""
        if not self.saving.may_lose_changes():
            event.ignore()
            return
        self.save_layout(self._settings)
        self.recovery.shut_down()
        self.jobs.shut_down()
        self.stepped.shut_down()
        self.grid.shut_down()
        self.warp_presenter.shut_down()
        self.findings_presenter.shut_down()
        self.quality.quality_changed.disconnect(self.presenter.show_quality)
        self.tuning.shut_down()
        self.quality.shut_down()
        self.maps.shut_down()
        self.presenter.shut_down()
        self.table_presenter.shut_down()
        self._bone_edits.shut_down()
        self.view_controls.shut_down()
        for signal in (self.editor.session_changed, self.editor.selection_changed):
            signal.disconnect(self._on_session)
        self.editor.view_changed.disconnect(self._on_view)
        self.editor.saved.disconnect(self._on_session)
        for viewport in self.viewports.values():
            viewport.close()
        super().closeEvent(event)
