"""The one way in which a capability enters the window."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from qtpy.QtCore import QSettings, Qt
from qtpy.QtGui import QAction
from qtpy.QtWidgets import QMenu, QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.drawables import Drawable

RIGHT = Qt.DockWidgetArea.RightDockWidgetArea
BOTTOM = Qt.DockWidgetArea.BottomDockWidgetArea


@dataclass(frozen=True)
class Panel:
    """A widget that gets a dock of its own.

    Parameters
    ----------
    key
        Its name in the program, by which the layout is remembered.
    title
        What its tab says.
    widget, area
        What it shows, and at which edge of the window.
    height_changed
        For a widget that is to have no more height than it needs: emits when it needs another.
    is_open
        Whether it is there from the start; else somebody opens it.
    """

    key: str
    title: str
    widget: QWidget
    area: Qt.DockWidgetArea = RIGHT
    height_changed: Any = None
    is_open: bool = True


class Capability:
    """What the window asks of each; whoever offers more says so, the rest is as here.

    Attributes
    ----------
    actions
        For menus, toolbar and keys; where they stand is theirs to say.
    panels
        For the docks.
    above
        Above the views, over their whole width.
    hints, notes
        In the status bar, at its left and right end.
    menus
        Of its own, by the place where actions of any capability may stand.
    """

    actions: Sequence[QAction] = ()
    panels: Sequence[Panel] = ()
    above: Sequence[QWidget] = ()
    hints: Sequence[QWidget] = ()
    notes: Sequence[QWidget] = ()
    menus: Mapping[str, QMenu] = MappingProxyType({})

    @property
    def is_settled(self) -> bool:
        """Whether everything asked of it is done and shown."""
        return True

    def drawables(self, _side: Side) -> Iterable[Drawable]:
        """Return what it adds to the scene of a side."""
        return ()

    def remember(self, settings: QSettings) -> None:
        """Note how it is looked at, for the next time."""

    def recall(self, settings: QSettings) -> None:
        """Look as it was remembered."""

    def may_close(self) -> bool:
        """Ask about what would be lost with the window; False when the user would rather stay."""
        return True

    def shut_down(self) -> None:
        """Let go of workers, graphics and the editor: the window is about to close."""
