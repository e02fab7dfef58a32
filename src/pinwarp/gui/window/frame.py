"""The window's frame: what stands where. What it means is the main window's."""

from __future__ import annotations

from qtpy.QtCore import QByteArray, QSettings, QSize, Qt
from qtpy.QtWidgets import (
    QDockWidget,
    QHBoxLayout,
    QLabel,
    QMainWindow,
    QSizePolicy,
    QSlider,
    QSplitter,
    QTabWidget,
    QToolBar,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.landmarks import Side
from pinwarp.gui.findings.panel import FindingsPanel
from pinwarp.gui.maps.panel import MapPanel
from pinwarp.gui.penalty.panel import PenaltyPanel
from pinwarp.gui.penalty.snapshot_strip import SnapshotStrip
from pinwarp.gui.placing.guide_bar import GuideBar
from pinwarp.gui.style.icons import icon
from pinwarp.gui.table.panel import LandmarkPanel
from pinwarp.gui.table.table import LandmarkModel, LandmarkTable
from pinwarp.gui.views.viewport import Viewport
from pinwarp.gui.warp.panel import WarpPanel
from pinwarp.gui.window.actions import make_actions
from pinwarp.gui.window.menus import fill_toolbar, make_menus, shortcut_groups
from pinwarp.gui.window.shortcut_overlay import ShortcutOverlay

# How long a message stands in the status bar.
MESSAGE_MS = 6000


class WindowFrame(QMainWindow):
    """Views, docks, menus, toolbar and status bar, all made but not yet wired."""

    def __init__(self) -> None:
        super().__init__()
        self.viewports = {side: Viewport(side) for side in Side}
        self.model = LandmarkModel(self)
        self.table = LandmarkTable(self.model)
        self.actions_by_key = make_actions(self)
        self.panel = PenaltyPanel(self.actions_by_key)
        self.snapshot_strip = SnapshotStrip(
            [self.actions_by_key[key] for key in ("snapshot", "sweep", "clear_snapshots")]
        )
        self.warp_panel = WarpPanel(self.actions_by_key)
        self.map_panel = MapPanel(self.actions_by_key["place_suggested"])
        self.findings = FindingsPanel()
        self.landmarks = LandmarkPanel(self.table, self.findings, self.actions_by_key)
        self._lay_out()

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
        self._make_docks()
        self._make_menus()
        self._make_toolbar()
        self.hint = QLabel()
        self.statusBar().addWidget(self.hint, 1)

    def _make_docks(self) -> None:
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
        self.fit_penalty_dock()

    def fit_penalty_dock(self) -> None:
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
        self.recent_menu = self._menus["@recent"]
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

    def say(self, text: str) -> None:
        """Say something in passing."""
        self.statusBar().showMessage(text, MESSAGE_MS)

    def restore_layout(self, settings: QSettings) -> None:
        """Put docks and window where they stood when the layout was saved."""
        for key, restore in (("geometry", self.restoreGeometry), ("layout", self.restoreState)):
            stored = settings.value(key)
            if isinstance(stored, QByteArray):
                restore(stored)
        # Snapshots that stood there are not remembered.
        self.fit_penalty_dock()

    def save_layout(self, settings: QSettings) -> None:
        """Remember where docks and window stand."""
        settings.setValue("geometry", self.saveGeometry())
        settings.setValue("layout", self.saveState())
