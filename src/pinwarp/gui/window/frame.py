"""The window's frame: what stands where. What it means is the main window's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType

from qtpy.QtCore import QByteArray, QEvent, QSettings, QSize, Qt, QTimer, Signal
from qtpy.QtGui import QAction, QGuiApplication, QShowEvent
from qtpy.QtWidgets import (
    QApplication,
    QDockWidget,
    QLabel,
    QMainWindow,
    QSplitter,
    QTabWidget,
    QToolBar,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.landmarks import Side
from pinwarp.gui.capability.action import placed
from pinwarp.gui.capability.capability import RIGHT, Capability, Panel
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.style.icons import icon
from pinwarp.gui.style.sheet import window_sheet
from pinwarp.gui.style.theme import with_disabled_apart
from pinwarp.gui.tasks.jobs import SlowJob
from pinwarp.gui.tasks.progress import JobProgress
from pinwarp.gui.tasks.stepped_job import SteppedJob
from pinwarp.gui.views.scenes import Scenes
from pinwarp.gui.views.viewport import Viewport
from pinwarp.gui.window.faults import Faults
from pinwarp.gui.window.menus import fill, make_menus, shortcut_groups
from pinwarp.gui.window.right_edge import RightEdge
from pinwarp.gui.window.shortcut_overlay import ShortcutOverlay

# How long a message stands in the status bar.
MESSAGE_MS = 6000
# As large as a window opens where the screen has room.
SIZE = QSize(1280, 800)
# Of the panels at the right edge, at least: all their titles are read.
RIGHT_WIDTH = 430
# When, after it was shown, it is looked at whether it is on the screen as a whole.
FRAME_KNOWN_MS = (0, 100, 500)


def _show_title(dock: QDockWidget, shown: bool) -> None:
    """Show the title bar of a dock, or leave its title to its tab."""
    own = dock.titleBarWidget()
    dock.setTitleBarWidget(None if shown else QWidget(dock))
    if own is not None:
        own.deleteLater()


class WindowFrame(QMainWindow):
    """Views, jobs and status bar; then docks, menus and toolbar, made of what capabilities offer.

    Parameters
    ----------
    state_folder
        Where the log of what went wrong is kept; None keeps none.
    """

    theme_changed = Signal()

    def __init__(self, state_folder: Path | None) -> None:
        super().__init__()
        self.faults = Faults(state_folder, self)
        self.surfaces = Surfaces()
        self.viewports = {side: Viewport(side, self.surfaces) for side in Side}
        self.scenes = Scenes(self.viewports, self)
        self.jobs = SlowJob(self)
        # Files need not wait for what takes minutes.
        self.long_jobs = SlowJob(self)
        self.stepped = SteppedJob(self)
        progress = JobProgress(self.statusBar(), (self.jobs, self.long_jobs, self.stepped))
        self.progress, self.cancel = progress.bar, progress.cancel
        self.shortcuts: ShortcutOverlay | None = None
        self._fitted: list[QDockWidget] = []
        self._actions: Sequence[QAction] = ()
        self.setWindowIcon(icon("pinwarp"))
        self.resize(SIZE)
        self._was_placed = False
        self._frame_known = [
            QTimer(self, singleShot=True, interval=delay, timeout=self.keep_on_screen)
            for delay in FRAME_KNOWN_MS
        ]
        self._dress()

    def furnish(self, capabilities: Sequence[Capability], actions: Sequence[QAction]) -> None:
        """Give each capability its places, and actions theirs.

        Parameters
        ----------
        capabilities
            In the order in which their panels and notes stand.
        actions
            All of them; where one stands is its own to say.
        """
        self._actions = actions
        self._lay_out([widget for one in capabilities for widget in one.above])
        for hint in (widget for one in capabilities for widget in one.hints):
            self.statusBar().addWidget(hint, 1)
        for note in (widget for one in capabilities for widget in one.notes):
            self.statusBar().addPermanentWidget(note)
        docks = self._make_docks([panel for one in capabilities for panel in one.panels])
        toggles = [
            placed(dock.toggleViewAction(), f"View.6{number}")
            for number, dock in enumerate(docks, 1)
        ]
        for action in actions:
            if action.parent() is None:
                # What is connected to it goes when the window goes.
                action.setParent(self)
        # Kept: Python must not let go of a menu that Qt still shows.
        self._menus = make_menus(self.menuBar(), [*actions, *toggles])
        for place, menu in (item for one in capabilities for item in one.menus.items()):
            fill(menu, actions, place)
        bar = QToolBar("Tools", self)
        bar.setObjectName("tools")
        bar.setMovable(False)
        bar.setIconSize(QSize(20, 20))
        fill(bar, actions, "tools")
        self.addToolBar(bar)
        self.shortcuts = ShortcutOverlay(self, shortcut_groups(actions))
        self._first_layout = self.saveState()

    @property
    def actions_by_key(self) -> Mapping[str, QAction]:
        """All that can be asked for."""
        named = (action for action in self._actions if action.objectName())
        return MappingProxyType({action.objectName(): action for action in named})

    def _lay_out(self, above: Sequence[QWidget]) -> None:
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.setChildrenCollapsible(False)
        for side in Side:
            splitter.addWidget(self.viewports[side])
            splitter.setStretchFactor(splitter.count() - 1, 1)
        splitter.setSizes([1000, 1000])
        centre = QWidget()
        column = QVBoxLayout(centre)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        for widget in above:
            column.addWidget(widget)
        column.addWidget(splitter, 1)
        self.setCentralWidget(centre)

    def _make_docks(self, panels: Sequence[Panel]) -> list[QDockWidget]:
        """Dock panels: those of the right edge behind one another, the first in front."""
        docks: list[QDockWidget] = []
        right: list[QDockWidget] = []
        for panel in panels:
            dock = QDockWidget(panel.title, self)
            dock.setObjectName(panel.key)
            dock.setWidget(panel.widget)
            self.addDockWidget(panel.area, dock)
            docks.append(dock)
            if panel.area == RIGHT:
                if right:
                    self.tabifyDockWidget(right[-1], dock)
                right.append(dock)
                # Its tab says its title; a window of its own has a title bar again.
                dock.setTitleBarWidget(QWidget(dock))
                dock.topLevelChanged.connect(partial(_show_title, dock))
            if panel.height_changed is not None:
                panel.height_changed.connect(lambda dock=dock: self._fit_dock(dock))
                self._fitted.append(dock)
            if not panel.is_open:
                dock.hide()
        self.setTabPosition(RIGHT, QTabWidget.TabPosition.North)
        self._front = right[0]
        below = [panel.widget for panel in panels if panel.area != RIGHT]
        self._right_edge = RightEdge(self, right, below)
        self._front.raise_()
        self._right_edge.want(self._right_width)
        self._fit_docks()
        return docks

    @property
    def _right_width(self) -> int:
        return max(RIGHT_WIDTH, self._right_edge.least)

    def _fit_docks(self) -> None:
        for dock in self._fitted:
            self._fit_dock(dock)

    def _fit_dock(self, dock: QDockWidget) -> None:
        """Give a dock no more height than it needs: the rest is the bones'."""
        # What has just appeared or gone counts now, not only at the next turn of the event loop.
        for widget in (*dock.widget().findChildren(QWidget), dock.widget(), dock):
            if widget.layout() is not None:
                widget.layout().activate()
        self.resizeDocks([dock], [1], Qt.Orientation.Vertical)

    def showEvent(self, event: QShowEvent) -> None:
        """Begin on the screen as a whole: the status bar tells what to do."""
        super().showEvent(event)
        if not self._was_placed:
            self._was_placed = True
            # What frame the system draws around it is told some time after.
            for timer in self._frame_known:
                timer.start()

    def changeEvent(self, event: QEvent) -> None:
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._dress()

    def _dress(self) -> None:
        palette = QApplication.palette()
        if (apart := with_disabled_apart(palette)) != palette:
            # Menus and dialogs, too.
            QApplication.setPalette(apart)
        sheet = window_sheet(QApplication.palette())
        # A sheet changes palettes, too.
        if sheet != self.styleSheet():
            self.setStyleSheet(sheet)
            self.theme_changed.emit()

    def keep_on_screen(self) -> None:
        """Make the window small enough for the screen, its frame counted, and move it onto it."""
        if self.isMaximized() or self.isFullScreen():
            return
        if QGuiApplication.platformName() == "offscreen":
            # A screen that nobody has sets no limits.
            return
        room, frame = self.screen().availableGeometry(), self.frameGeometry()
        around = frame.size() - self.size()
        self.resize(self.size().boundedTo(room.size() - around))
        frame = self.frameGeometry()
        self.move(
            max(room.left(), min(frame.left(), room.right() + 1 - frame.width())),
            max(room.top(), min(frame.top(), room.bottom() + 1 - frame.height())),
        )

    def toggle_shortcuts(self) -> None:
        """Show the sheet of all keys and gestures, or take it away."""
        if self.shortcuts is not None:
            self.shortcuts.toggle()

    def say(self, text: str) -> None:
        """Say something in passing."""
        self.statusBar().showMessage(text, MESSAGE_MS)

    def unsay(self, text: str) -> None:
        """Take back what was said in passing, where it is still read."""
        if self.statusBar().currentMessage() == text:
            self.statusBar().clearMessage()

    def note(self, words: str, reason: str) -> None:
        """Say something that holds until the window is closed."""
        label = QLabel(words)
        label.setToolTip(reason)
        self.statusBar().addPermanentWidget(label)
        self.say(f"{words}: {reason}")

    def restore_layout(self, settings: QSettings) -> None:
        """Put docks and window where they stood when the layout was saved."""
        for key, restore in (("geometry", self.restoreGeometry), ("layout", self.restoreState)):
            stored = settings.value(key)
            if isinstance(stored, QByteArray) and restore(stored):
                self._right_edge.want(None)
        # Snapshots that stood there are not remembered.
        self._fit_docks()

    def reset_layout(self) -> None:
        """Put docks and toolbar where they stood before anybody moved them."""
        self.restoreState(self._first_layout)
        self._front.raise_()
        self._right_edge.want(self._right_width)
        self._fit_docks()

    def take_floats_away(self) -> None:
        """Hide panels that float: they are windows of their own, and stay when theirs is closed."""
        for dock in self.findChildren(QDockWidget):
            if dock.isFloating():
                dock.hide()

    def save_layout(self, settings: QSettings) -> None:
        """Remember where docks and window stand."""
        settings.setValue("geometry", self.saveGeometry())
        settings.setValue("layout", self.saveState())
