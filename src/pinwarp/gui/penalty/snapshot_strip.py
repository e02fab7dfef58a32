"""The strip of snapshots: small pictures of the warp at several penalties, side by side."""

from __future__ import annotations

import math
import weakref
from collections.abc import Sequence
from dataclasses import dataclass, replace

from qtpy.QtCore import QSize, Qt, Signal
from qtpy.QtGui import (
    QAction,
    QContextMenuEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPalette,
    QPixmap,
    QResizeEvent,
    QWheelEvent,
)
from qtpy.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QMenu,
    QScrollArea,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.lengths import Ruler
from pinwarp.core.mesh import Mesh
from pinwarp.gui.style import theme
from pinwarp.session.warp.result import WarpInputs

# The largest picture, in logical pixels.
PICTURE = QSize(150, 96)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The warp at a penalty, as it looked.

    Attributes
    ----------
    picture
        Of the destination with the warped source over it.
    inputs
        What the warp was computed from, without meshes: a picture keeps none alive.
    mesh
        The source mesh, as long as somebody else holds it; None where there was none.
    flexibility, leave_one_out, residual
        Its figures; None where there is none.
    ruler
        How its lengths are told.
    """

    picture: QImage
    inputs: WarpInputs
    mesh: weakref.ref[Mesh] | None
    flexibility: float | None
    leave_one_out: float | None
    residual: float | None
    ruler: Ruler

    def what_changed(self, now: WarpInputs) -> str:
        """Say in words why the picture does not hold any more; empty where it does."""
        was = self.inputs
        if (now.mesh is None) != (self.mesh is None):
            return "mesh changed"
        if self.mesh is not None and self.mesh() is not now.mesh:
            return "mesh changed"
        before, after = was.settings, now.settings
        pairs = (was.source, was.destination, before.planar)
        if pairs != (now.source, now.destination, after.planar):
            return "pairs changed"
        if (before.components, before.blend) != (after.components, after.blend):
            return "applied part changed"
        if before.basis is not after.basis:
            return "basis changed"
        if before.convention is not after.convention:
            return "convention changed"
        if replace(before, penalty=after.penalty) != after:
            return "settings changed"
        # A refinement belongs to one penalty: elsewhere nothing can be said of it.
        refined_else = before.penalty == after.penalty and was.refinement != now.refinement
        return "refinement changed" if refined_else else ""

    @property
    def title(self) -> str:
        """The penalty in words."""
        settings = self.inputs.settings
        length = settings.penalty_ruler(self.ruler).text(settings.penalty, 3)
        return "Affine fit" if math.isinf(settings.penalty) else length

    @property
    def lines(self) -> tuple[str, ...]:
        """The figures in words."""
        figures = [] if self.flexibility is None else [f"{self.flexibility:.0%} flexible"]
        for words, length in (("LOO", self.leave_one_out), ("Resid.", self.residual)):
            if length is not None:
                figures.append(f"{words} {self.ruler.number(length, 3)}")
        return tuple(figures)


class SnapshotTile(QFrame):
    """One snapshot: a click takes its penalty, the small cross removes it."""

    taken = Signal()
    removed = Signal()

    def __init__(self, snapshot: Snapshot) -> None:
        super().__init__()
        self.snapshot = snapshot
        self.setObjectName("tile")
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        picture = QLabel()
        picture.setPixmap(QPixmap.fromImage(snapshot.picture))
        self.words = QLabel()
        self.words.setTextFormat(Qt.TextFormat.RichText)
        self.words.setMinimumWidth(self.fontMetrics().horizontalAdvance("pairs changed"))
        self.close_button = QToolButton()
        self.close_button.setText("×")
        self.close_button.setAutoRaise(True)
        self.close_button.setFixedSize(18, 18)
        self.close_button.setCursor(Qt.CursorShape.ArrowCursor)
        self.close_button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.close_button.setToolTip("Remove this snapshot")
        self.close_button.clicked.connect(self.removed)
        column = QVBoxLayout()
        column.setSpacing(0)
        column.addWidget(self.close_button, 0, Qt.AlignmentFlag.AlignRight)
        column.addWidget(self.words)
        column.addStretch(1)
        row = QHBoxLayout(self)
        row.setContentsMargins(3, 3, 3, 3)
        row.setSpacing(6)
        row.addWidget(picture)
        row.addLayout(column)

    def show_state(self, changed: str, is_present: bool) -> None:
        """Show whether the picture still holds, and whether its penalty is the present one."""
        shot = self.snapshot
        lines = [f"<b>{shot.title}</b>", *shot.lines, *([f"<i>{changed}</i>"] if changed else [])]
        colour = theme.quiet_text_colour() if changed else theme.text_colour()
        self.words.setText(f'<span style="color: {colour.name()}">{"<br>".join(lines)}</span>')
        role = QPalette.ColorRole.Highlight if is_present else QPalette.ColorRole.Mid
        base = self.palette().color(QPalette.ColorRole.Base).name()
        # Not by colour alone: the frame of the present one is twice as thick, in the same room.
        thick = 2 if is_present else 1
        self.setStyleSheet(
            f"#tile {{ background: {base}; border-radius: 4px;"
            f" border: {thick}px solid {self.palette().color(role).name()};"
            f" padding: {2 - thick}px; }}"
        )
        still = f" ({changed} since)" if changed else ""
        left_out = shot.leave_one_out
        self.setToolTip(
            f"Click to take the penalty {shot.title}{still}"
            + (f"\nRMS leave-one-out error {shot.ruler.text(left_out)}" if left_out else "")
        )
        present = ", the present penalty" if is_present else ""
        self.setAccessibleName(f"Snapshot: {shot.title}{present}")

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Ask for this penalty."""
        if event.button() == Qt.MouseButton.LeftButton and self.rect().contains(
            event.position().toPoint()
        ):
            self.taken.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Return does what a click does."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.taken.emit()
        else:
            event.ignore()


class SnapshotStrip(QScrollArea):
    """All snapshots in a row; there only when there are any.

    Parameters
    ----------
    menu_actions
        What its context menu holds.
    """

    # With it the basis: without that a penalty says nothing.
    settings_requested = Signal(object)
    removal_requested = Signal(object)
    height_changed = Signal()

    def __init__(self, menu_actions: Sequence[QAction]) -> None:
        super().__init__()
        self.setAccessibleName("Snapshots")
        self._menu = QMenu(self)
        self._menu.addActions(menu_actions)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        content = QWidget()
        self._row = QHBoxLayout(content)
        self._row.setContentsMargins(theme.SPACE, 6, theme.SPACE, 2)
        self._row.setSpacing(4)
        self._row.addStretch(1)
        self.setWidget(content)
        self.tiles: list[SnapshotTile] = []
        self._is_going_to_end = False
        self.horizontalScrollBar().rangeChanged.connect(self._on_range)
        self.hide()

    def show_snapshots(self, snapshots: Sequence[Snapshot]) -> None:
        """Show these snapshots, in this order."""
        known = {tile.snapshot: tile for tile in self.tiles}
        for gone in set(known) - set(snapshots):
            self._row.removeWidget(known[gone])
            known[gone].deleteLater()
            known[gone].hide()
        had = bool(self.tiles)
        self.tiles = [known.get(snapshot) or self._tile(snapshot) for snapshot in snapshots]
        for index, tile in enumerate(self.tiles):
            self._row.insertWidget(index, tile)
        self.setVisible(bool(self.tiles))
        self._fit_height()
        if had != bool(self.tiles):
            self.height_changed.emit()

    def show_last(self) -> None:
        """Scroll to the newest one."""
        # The row is laid out later; until then there is nothing to scroll to.
        self._is_going_to_end = True
        self._on_range(0, self.horizontalScrollBar().maximum())

    def _on_range(self, _first: int, last: int) -> None:
        if self._is_going_to_end:
            self.horizontalScrollBar().setValue(last)

    def _tile(self, snapshot: Snapshot) -> SnapshotTile:
        tile = SnapshotTile(snapshot)
        tile.taken.connect(lambda: self.settings_requested.emit(snapshot.inputs.settings))
        tile.removed.connect(lambda: self.removal_requested.emit(snapshot))
        return tile

    def _fit_height(self) -> None:
        needed = self.widget().minimumSizeHint()
        bar = self.horizontalScrollBar().sizeHint().height()
        overflows = needed.width() > self.width()
        self.setFixedHeight(needed.height() + (bar if overflows else 0))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Leave room for the scroll bar where one is needed."""
        super().resizeEvent(event)
        self._fit_height()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Scroll along the row."""
        turned = event.angleDelta().y() or event.angleDelta().x()
        bar = self.horizontalScrollBar()
        self._is_going_to_end = False
        bar.setValue(bar.value() - turned)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer what can be done with the snapshots."""
        self._menu.popup(event.globalPos())
