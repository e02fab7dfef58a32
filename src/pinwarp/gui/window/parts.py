"""All capabilities of a window in one list, which reads from top to bottom."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from qtpy.QtCore import QSettings

from pinwarp.core.landmarks import Side
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.exporting.exports import Exports
from pinwarp.gui.exporting.file_warping import FileWarping
from pinwarp.gui.exporting.picture_export import PictureExport
from pinwarp.gui.exporting.report import ReportExport
from pinwarp.gui.exporting.semilandmark_export import SemilandmarkExport
from pinwarp.gui.files.documents import Documents
from pinwarp.gui.files.recent_files import RecentFiles
from pinwarp.gui.files.recovery import Recovery
from pinwarp.gui.files.saving import Saving
from pinwarp.gui.files.session_meshes import SessionMeshes
from pinwarp.gui.findings.presenter import FindingsPresenter
from pinwarp.gui.importing.imports import LandmarkImports
from pinwarp.gui.maps.overlay import OverlayControls
from pinwarp.gui.maps.presenter import MapPresenter
from pinwarp.gui.model.export import ModelExport
from pinwarp.gui.model.opened import OpenedModel
from pinwarp.gui.model.presenter import ModelPresenter
from pinwarp.gui.pages.presenter import UserGuide
from pinwarp.gui.penalty.comparison import PenaltyComparison
from pinwarp.gui.penalty.snapshots import Snapshots
from pinwarp.gui.penalty.tuning import PenaltyTuning
from pinwarp.gui.placing.bone_edits import BoneEdits
from pinwarp.gui.placing.crosshair import Crosshair
from pinwarp.gui.placing.ghosts import Ghosts
from pinwarp.gui.placing.guidance import Guidance
from pinwarp.gui.placing.hand import Hand
from pinwarp.gui.placing.reviewing import Reviewing
from pinwarp.gui.refining.presenter import RefiningPresenter
from pinwarp.gui.repeat.presenter import LandmarkPrecision
from pinwarp.gui.semilandmarks.presenter import Semilandmarks
from pinwarp.gui.suggesting.presenter import Suggesting
from pinwarp.gui.table.presenter import TablePresenter
from pinwarp.gui.tasks.file_tasks import FileTasks
from pinwarp.gui.tour.presenter import Tour
from pinwarp.gui.views.controls import ViewControls
from pinwarp.gui.views.looks import Looks
from pinwarp.gui.warp.grid import GridPresenter
from pinwarp.gui.warp.presenter import WarpPresenter
from pinwarp.gui.warp.quality import QualityPresenter
from pinwarp.gui.warp.shown_session import ShownSession
from pinwarp.gui.warp.warps import Warps
from pinwarp.gui.window.frame import WindowFrame
from pinwarp.gui.window.help import Help
from pinwarp.gui.window.menus import told
from pinwarp.gui.window.text_size import TextSize
from pinwarp.gui.window.undoing import Undoing
from pinwarp.gui.window.window_dialogs import WindowDialogs
from pinwarp.io.file_names import session_name
from pinwarp.session.editor import Editor


class Parts:
    """The capabilities, each made of those above it; they are shut down in reverse.

    A new one is a line here. Every attribute is a capability.

    Parameters
    ----------
    frame
        Views, jobs and the status bar.
    editor
        The truth.
    dialogs
        Ask and tell.
    settings, state_folder
        Where things are remembered, and where unsaved work is kept.
    """

    def __init__(
        self,
        frame: WindowFrame,
        editor: Editor,
        dialogs: WindowDialogs,
        settings: QSettings,
        state_folder: Path | None,
    ) -> None:
        views, scenes, surfaces, say = frame.viewports, frame.scenes, frame.surfaces, frame.say
        source, destination = views[Side.SOURCE], views[Side.DESTINATION]
        tasks = FileTasks(editor, frame.jobs, frame.stepped, dialogs)
        recent = RecentFiles(settings)
        meshes = SessionMeshes(tasks, surfaces.keep)

        self.undoing = Undoing(editor)
        self.warps = Warps(editor, scenes, surfaces, lambda: destination.is_slow)
        self.quality = QualityPresenter(self.warps)
        self.shown_session = ShownSession(editor, scenes, self.warps, self.quality)
        self.views = ViewControls(editor, views, scenes, say, frame)
        self.looks = Looks(editor, views, frame.theme_changed, frame)
        self.text_size = TextSize(settings, say, frame)
        self.ghosts = Ghosts(editor, self.warps, surfaces)
        self.hand = Hand(editor, views, self.ghosts, self.views)
        self.crosshair = Crosshair(editor, self.ghosts, views)
        self.bones = BoneEdits(editor, say)
        self.guidance = Guidance(editor, self.hand, self.ghosts, views, tasks)
        self.reviewing = Reviewing(editor, self.hand, destination)
        self.guidance.give_way_to(lambda: self.reviewing.words)
        self.table = TablePresenter(editor, self.warps, self.hand, dialogs, say)
        self.grid = GridPresenter(editor, self.warps, scenes, frame)
        self.warp = WarpPresenter(editor, self.quality, self.grid.following.keys, say, frame)
        self.maps = MapPresenter(
            editor, self.warps, self.hand, self.ghosts, scenes, destination, frame
        )
        self.overlay = OverlayControls(editor, self.maps)
        self.semilandmarks = Semilandmarks(
            editor,
            self.warps,
            self.hand,
            self.guidance,
            self.views,
            scenes,
            views,
            say,
            frame,
        )
        self.refining = RefiningPresenter(
            editor, self.warps, self.maps, scenes, frame.long_jobs, say, frame
        )
        self.suggesting = Suggesting(
            editor,
            self.ghosts,
            self.hand,
            self.guidance,
            self.views,
            views,
            scenes,
            surfaces,
            say,
            frame,
        )
        self.findings = FindingsPresenter(
            editor,
            self.quality,
            self.maps,
            self.table,
            self.hand,
            self.bones,
            self.reviewing,
            self.views,
            self.undoing.undo.keys,
            # What opens meshes stands on these.
            lambda side: self.documents.ask_and_open_mesh(side),
            say,
        )
        self.comparison = PenaltyComparison(editor, scenes, say, frame)
        self.snapshots = Snapshots(
            editor, self.warps, self.quality, scenes, destination, say, frame
        )
        self.penalty = PenaltyTuning(editor, self.warps, self.quality, self.snapshots)
        self.saving = Saving(editor, tasks, recent, self.warps.rested)
        self.recovery = Recovery(editor, tasks, self.saving, meshes, state_folder, frame)
        self.imports = LandmarkImports(editor, tasks)
        self.documents = Documents(
            editor, tasks, recent, self.saving, meshes, self.imports, self.recovery.window_with
        )
        opened = OpenedModel(editor, tasks, self.saving, self.recovery, meshes)
        self.model = ModelPresenter(
            editor,
            opened,
            self.warps,
            self.quality,
            scenes,
            self.views,
            tasks,
            ModelExport(opened, tasks).action,
        )
        self.documents.hand_models_to(self.model.open)
        self.precision = LandmarkPrecision(editor, tasks, frame)
        self.exports = Exports(editor, tasks)
        self.semilandmark_export = SemilandmarkExport(editor, tasks)
        self.pictures = PictureExport(editor, tasks, views, frame)
        self.report = ReportExport(
            editor,
            tasks,
            views,
            lambda: session_name(editor.path),
            lambda: (self.warps.result, self.quality.quality),
            lambda: self.model.rows,
        )
        self.file_warping = FileWarping(editor, tasks)
        self.tour = Tour(
            editor,
            self.exports,
            source,
            self.documents.open_sample,
            lambda key: told(frame.actions_by_key[key], "keys").strip("*"),
            say,
        )
        self.user_guide = UserGuide(lambda key, what: told(frame.actions_by_key[key], what), frame)
        self.help = Help(
            dialogs, frame.faults, lambda: source.graphics, say, frame.toggle_shortcuts
        )

        for said in (tasks.said, self.hand.refused, self.guidance.said, self.maps.refused):
            said.connect(say)
        self.maps.taken_back.connect(frame.unsay)
        for side, view in views.items():
            view.files_dropped.connect(
                lambda paths, side=side: self.documents.open_files(side, paths)
            )

    def __iter__(self) -> Iterator[Capability]:
        return iter(vars(self).values())
