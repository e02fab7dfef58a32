"""The window: lays out the views, and wires actions to what they do."""

from __future__ import annotations

from pathlib import Path

from qtpy.QtCore import QByteArray, QSettings, QSize, Qt
from qtpy.QtGui import QCloseEvent
from qtpy.QtWidgets import (
    QDockWidget,
    QHBoxLayout,
    QLabel,
    QMainWindow,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QSlider,
    QSplitter,
    QTabWidget,
    QToolBar,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.landmarks import Side
from pinwarp.gui.actions import icon, make_actions
from pinwarp.gui.bone_edits import BoneEdits
from pinwarp.gui.dialogs import Dialogs
from pinwarp.gui.documents import Documents
from pinwarp.gui.exports import Exports
from pinwarp.gui.file_tasks import FileTasks
from pinwarp.gui.findings_panel import FindingsPanel
from pinwarp.gui.findings_presenter import FindingsPresenter
from pinwarp.gui.grid_presenter import GridPresenter
from pinwarp.gui.guidance import Guidance
from pinwarp.gui.guide_bar import GuideBar
from pinwarp.gui.help_text import ABOUT, ABOUT_PENALTY, ABOUT_QUALITY
from pinwarp.gui.jobs import SlowJob
from pinwarp.gui.landmark_imports import LandmarkImports
from pinwarp.gui.landmark_panel import LandmarkPanel
from pinwarp.gui.landmark_table import LandmarkModel, LandmarkTable
from pinwarp.gui.map_panel import MapPanel
from pinwarp.gui.map_presenter import MapPresenter
from pinwarp.gui.menus import fill_toolbar, make_menus, shortcut_groups
from pinwarp.gui.penalty_panel import PenaltyPanel
from pinwarp.gui.penalty_tuning import PenaltyTuning
from pinwarp.gui.presenter import Presenter
from pinwarp.gui.quality_presenter import QualityPresenter
from pinwarp.gui.recent_files import RecentFiles
from pinwarp.gui.recovery import Recovery
from pinwarp.gui.report_export import ReportExport
from pinwarp.gui.saving import Saving
from pinwarp.gui.session_meshes import SessionMeshes
from pinwarp.gui.shortcut_overlay import ShortcutOverlay
from pinwarp.gui.snapshot_strip import SnapshotStrip
from pinwarp.gui.table_presenter import TablePresenter
from pinwarp.gui.view_controls import ViewControls
from pinwarp.gui.viewport import Viewport
from pinwarp.gui.warp_panel import WarpPanel
from pinwarp.gui.warp_presenter import WarpPresenter
from pinwarp.io.file_names import session_name
from pinwarp.io.samples import sample_session
from pinwarp.session.editor import Editor


class MainWindow(QMainWindow):
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
        dialogs: Dialogs | None = None,
        state_folder: Path | None = None,
    ) -> None:
        super().__init__()
        self._settings = settings
        self.editor = Editor()
        self.viewports = {side: Viewport(side) for side in Side}
        self.model = LandmarkModel(self)
        self.table = LandmarkTable(self.model)
        self.jobs = SlowJob(self)
        self.actions_by_key = make_actions(self)
        self.panel = PenaltyPanel(self.actions_by_key)
        self.snapshot_strip = SnapshotStrip(
            [self.actions_by_key[key] for key in ("snapshot", "sweep", "clear_snapshots")]
        )
        self.warp_panel = WarpPanel(self.actions_by_key)
        self.map_panel = MapPanel(self.actions_by_key["place_suggested"])
        self.findings = FindingsPanel()
        self.landmarks = LandmarkPanel(self.table, self.findings, self.actions_by_key)
        self._dialogs = dialogs or Dialogs(self)
        self._recent = RecentFiles(settings)
        self._lay_out()
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
            self.model,
            self.landmarks,
            self.actions_by_key,
            self.presenter.requests,
            self._say,
        )
        self.tuning = PenaltyTuning(
            self.editor,
            self.presenter,
            self.quality,
            self.viewports,
            self.panel,
            self.snapshot_strip,
            self.actions_by_key,
            self._say,
            self,
        )
        self._bone_edits = BoneEdits(self.editor, self.actions_by_key, self)
        self.view_controls = ViewControls(self.editor, self.viewports, self.actions_by_key, self)
        self.view_controls.add_to(self.findChild(QToolBar, "tools"))
        self.warp_presenter = WarpPresenter(
            self.editor, self.warp_panel, self.quality, self.actions_by_key, self._say, self
        )
        self.grid = GridPresenter(
            self.editor, self.presenter, self.viewports, self.actions_by_key, self
        )
        self.statusBar().addPermanentWidget(self.warp_presenter.note)
        self._tasks = FileTasks(self.editor, self.jobs, self._dialogs)
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
        self._report_export = ReportExport(
            self.editor, self._tasks, self.viewports, lambda: session_name(self.editor.path)
        )
        self.guidance = Guidance(
            self.editor, self.presenter, self.documents, self._dialogs, self.guide_bar, self.hint
        )
        self.table_presenter = TablePresenter(
            self.editor,
            self.model,
            self.landmarks,
            self.actions_by_key,
            self._dialogs,
            self._say,
        )
        self._connect()
        self._restore_layout()
        self._on_session()

    # Layout

    def _lay_out(self) -> None:
        self.setWindowIcon(icon("pinwarp"))
        self.resize(1280, 800)
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.setChildrenCollapsible(False)
        for side in Side:
            splitter.addWidget(self.viewports[side])
            splitter.setStretchFactor(splitter.count() - 1, 1)
        splitter.setSizes([1000, 1000])
        self.guide_bar = GuideBar()
        centre = QWidget()
        column = QVBoxLayout(centre)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.guide_bar)
        column.addWidget(splitter, 1)
        self.setCentralWidget(centre)
        right = Qt.DockWidgetArea.RightDockWidgetArea
        landmarks = self._add_dock("landmarks", "Landmarks", self.landmarks, right)
        warp = self._add_dock("warp", "Warp", self.warp_panel, right)
        self.tabifyDockWidget(landmarks, warp)
        self.tabifyDockWidget(warp, self._add_dock("map", "Map", self.map_panel, right))
        self.setTabPosition(right, QTabWidget.TabPosition.North)
        landmarks.raise_()
        penalty = QWidget()
        rows = QVBoxLayout(penalty)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.setSpacing(0)
        rows.addWidget(self.snapshot_strip)
        rows.addWidget(self.panel, 1)
        self._penalty_dock = self._add_dock(
            "penalty", "Warping penalty", penalty, Qt.DockWidgetArea.BottomDockWidgetArea
        )
        # The table keeps the whole height of the right edge.
        self.setCorner(Qt.Corner.BottomRightCorner, Qt.DockWidgetArea.RightDockWidgetArea)
        self.resizeDocks([landmarks], [430], Qt.Orientation.Horizontal)
        self._fit_penalty_dock()
        self._make_menus()
        self._make_toolbar()
        self._make_status_bar()

    def _fit_penalty_dock(self) -> None:
        """Give the penalty no more height than it needs: the rest is the bones'."""
        dock = self._penalty_dock
        # What has just appeared or gone counts now, not only at the next turn of the event loop.
        for widget in (self.panel, dock.widget(), dock):
            widget.layout().activate()
        self.resizeDocks([dock], [1], Qt.Orientation.Vertical)

    def _add_dock(
        self, key: str, title: str, widget: QWidget, area: Qt.DockWidgetArea
    ) -> QDockWidget:
        dock = QDockWidget(title, self)
        dock.setObjectName(key)
        dock.setWidget(widget)
        self.addDockWidget(area, dock)
        return dock

    def _make_menus(self) -> None:
        # Kept: Python must not let go of a menu that Qt still shows.
        self._menus = make_menus(self.menuBar(), self.actions_by_key)
        self._recent_menu = self._menus["@recent"]
        self._recent_menu.aboutToShow.connect(self._fill_recent)
        for dock in self.findChildren(QDockWidget):
            self._menus["&View"].addAction(dock.toggleViewAction())
        self.shortcuts = ShortcutOverlay(self, shortcut_groups(self.actions_by_key))

    def _make_toolbar(self) -> None:
        bar = QToolBar("Tools", self)
        bar.setObjectName("tools")
        bar.setMovable(False)
        bar.setIconSize(QSize(20, 20))
        fill_toolbar(bar, self.actions_by_key)
        self.opacity = QSlider(Qt.Orientation.Horizontal)
        self.opacity.setRange(5, 100)
        self.opacity.setFixedWidth(110)
        self.opacity.setAccessibleName("Opacity of the warped source")
        self.opacity.setToolTip("Opacity of the warped source")
        holder = QWidget()
        row = QHBoxLayout(holder)
        row.setContentsMargins(4, 0, 8, 0)
        row.addWidget(self.opacity)
        holder.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)
        bar.addWidget(holder)
        self.addToolBar(bar)

    def _make_status_bar(self) -> None:
        self.hint = QLabel()
        self.statusBar().addWidget(self.hint, 1)
        self.progress = QProgressBar()
        self.progress.setRange(0, 100)
        self.progress.setFixedWidth(220)
        self.progress.hide()
        self.cancel = QPushButton("Cancel")
        self.cancel.setFlat(True)
        self.cancel.hide()
        self.statusBar().addPermanentWidget(self.progress)
        self.statusBar().addPermanentWidget(self.cancel)

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
            "export_passengers": self.exports.export_passengers,
            "shortcuts": self.shortcuts.toggle,
            "select_none": editor.select,
            "about": lambda: self._dialogs.tell("About pinwarp", ABOUT),
            "about_penalty": lambda: self._dialogs.tell("About the warping penalty", ABOUT_PENALTY),
            "about_quality": lambda: self._dialogs.tell("About the quality figures", ABOUT_QUALITY),
        }
        for key, function in does.items():
            # Qt's "checked" argument is of no use to any of them.
            actions[key].triggered.connect(lambda _checked=False, call=function: call())
        actions["overlay"].toggled.connect(lambda on: editor.look(overlay=on))
        actions["lock"].toggled.connect(lambda on: editor.look(locked=on))
        actions["guide"].toggled.connect(self.guidance.switch)
        self.snapshot_strip.height_changed.connect(self._fit_penalty_dock)
        actions["show_curve"].toggled.connect(self._fit_penalty_dock)
        self.presenter.requests.refused.connect(self._say)
        self.guidance.said.connect(self._say)
        self.maps.refused.connect(self._say)
        self.maps.map_changed.connect(self._on_view)
        self.opacity.valueChanged.connect(
            lambda value: editor.look(**{self.maps.opacity_key: value / 100})
        )
        for side, viewport in self.viewports.items():
            viewport.files_dropped.connect(
                lambda paths, side=side: documents.open_files(side, paths)
            )
        self.jobs.started.connect(self._on_job_started)
        self.jobs.progressed.connect(self._on_job_progressed)
        self.jobs.ended.connect(self._on_job_ended)
        self.cancel.clicked.connect(self.jobs.cancel)
        self._tasks.said.connect(self._say)
        editor.session_changed.connect(self._on_session)
        editor.selection_changed.connect(self._on_session)
        editor.view_changed.connect(self._on_view)
        editor.saved.connect(self._on_session)
        self._on_view()

    def open_sample(self) -> None:
        """Open the sample bones as a new session, asking about unsaved work first."""
        if self.saving.may_lose_changes():
            self.documents.open_session(sample_session(), as_new=True)

    def _say(self, text: str) -> None:
        self.statusBar().showMessage(text, 6000)

    def _fill_recent(self) -> None:
        self._recent_menu.clear()
        for path in self._recent.paths:
            action = self._recent_menu.addAction(path.name.replace("&", "&&"))
            action.setToolTip(str(path))
            action.triggered.connect(lambda _checked=False, path=path: self._open_recent(path))
        if self._recent_menu.isEmpty():
            self._recent_menu.addAction("Nothing yet").setEnabled(False)
        else:
            self._recent_menu.addSeparator()
            self._recent_menu.addAction("Clear").triggered.connect(self._recent.clear)

    def _open_recent(self, path: Path) -> None:
        if self.saving.may_lose_changes():
            self.documents.open_session(path)

    # What changed

    def _on_session(self, _changed: object = None) -> None:
        editor, actions = self.editor, self.actions_by_key
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
        actions["export_mesh"].setEnabled(
            session.mesh(Side.SOURCE) is not None and bool(session.pairs)
        )
        actions["export_report"].setEnabled(bool(session.pairs))
        self.guidance.show()

    def _on_view(self, _changed: object = None) -> None:
        view = self.editor.view
        self.actions_by_key["overlay"].setChecked(view.overlay)
        self.actions_by_key["lock"].setChecked(view.locked)
        self.actions_by_key["guide"].setChecked(view.guided is not None)
        self.opacity.setEnabled(view.overlay)
        self.opacity.setValue(round(getattr(view, self.maps.opacity_key) * 100))
        self.guidance.show()

    # Slow jobs

    def _on_job_started(self, title: str) -> None:
        self.progress.setFormat(title)
        self.progress.setValue(0)
        self.progress.show()
        self.cancel.show()

    def _on_job_progressed(self, share: float, stage: str) -> None:
        self.progress.setValue(round(100 * share))
        self.progress.setFormat(f"{stage} – %p%")

    def _on_job_ended(self) -> None:
        self.progress.hide()
        self.cancel.hide()

    @property
    def is_settled(self) -> bool:
        """Whether everything asked for is done and shown."""
        parts = (self.presenter, self.quality, self.tuning, self.grid, self.maps)
        return self.jobs.is_idle and all(part.is_settled for part in parts)

    # The end

    def _restore_layout(self) -> None:
        for key, restore in (("geometry", self.restoreGeometry), ("layout", self.restoreState)):
            stored = self._settings.value(key)
            if isinstance(stored, QByteArray):
                restore(stored)
        # Snapshots that stood there are not remembered.
        self._fit_penalty_dock()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask about unsaved work, then let go of workers and graphics in the right order."""
        if not self.saving.may_lose_changes():
            event.ignore()
            return
        self._settings.setValue("geometry", self.saveGeometry())
        self._settings.setValue("layout", self.saveState())
        self.recovery.shut_down()
        self.jobs.shut_down()
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
