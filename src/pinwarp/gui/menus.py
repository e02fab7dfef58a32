"""Filling menus from keys of actions."""

from __future__ import annotations

from collections.abc import Mapping

from qtpy.QtCore import Qt
from qtpy.QtGui import QAction
from qtpy.QtWidgets import QMenu

# Inner menus by their titles; "-" is a line between groups.
_VIEW: tuple[str | tuple[str, str], ...] = (
    "overlay",
    ("&Show Source", "show_warp show_rigid show_similarity"),
    "- fit focus",
    ("&Look From", "view_front view_back - view_left view_right - view_top view_bottom"),
    ("Ca&meras", "link_linked link_rotation link_free - link_next"),
    "- section wireframe - markers_larger markers_smaller -",
)


def fill(menu: QMenu, actions: Mapping[str, QAction], keys: str) -> None:
    """Append actions to a menu; ``-`` is a separator."""
    for key in keys.split():
        if key == "-":
            menu.addSeparator()
        else:
            menu.addAction(actions[key])


def fill_view(menu: QMenu, actions: Mapping[str, QAction]) -> None:
    """Fill the View menu."""
    for entry in _VIEW:
        if isinstance(entry, str):
            fill(menu, actions, entry)
        else:
            title, keys = entry
            fill(menu.addMenu(title), actions, keys)


def actions_of(menu: QMenu) -> list[QAction]:
    """Return the actions of a menu and of those inside it."""
    # Not by QAction.menu(): PySide takes what that returns for its own and deletes the menu.
    children = menu.findChildren(QMenu, options=Qt.FindChildOption.FindDirectChildrenOnly)
    inner = {child.menuAction(): child for child in children}
    found: list[QAction] = []
    for action in menu.actions():
        found.extend(actions_of(inner[action]) if action in inner else [action])
    return found
