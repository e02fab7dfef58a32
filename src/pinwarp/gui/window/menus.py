"""Where the actions stand: menus, toolbar and the sheet of shortcuts, filled from their places."""

from __future__ import annotations

from collections.abc import Iterable

from qtpy.QtGui import QAction, QKeySequence
from qtpy.QtWidgets import QMenu, QMenuBar, QWidget

from pinwarp.gui.capability.action import PLACES, name_and_held, placed

TITLES = ("&File", "&Edit", "&Place", "&Warp", "&View", "&Help")
# The menus inside others: what each is called, and where it stands.
INNER = {
    "import": ("&Import", "File.41"),
    "export": ("E&xport", "File.42"),
    "mirror": ("&Mirror Source", "Edit.73"),
    "semilandmarks": ("&Semilandmarks", "Place.41"),
    "components": ("&Apply", "Warp.31"),
    "maps": ("Ma&ps", "View.13"),
    "grid": ("&Grid", "View.14"),
    "background": ("&Background", "View.33"),
    "text_size": ("&Text Size", "View.34"),
    "lengths": ("&Lengths", "View.35"),
    "sides": ("&Look From", "View.23"),
    "cameras": ("Ca&meras", "View.24"),
}


def standing(actions: Iterable[QAction], place: str) -> list[tuple[int, QAction]]:
    """Return the actions that stand in one place with their numbers, in their order."""
    found = []
    for action in actions:
        for one in str(action.property(PLACES) or "").split():
            name, _, number = one.partition(".")
            if name == place:
                found.append((int(number), action))
    return sorted(found, key=lambda one: one[0])


def fill(widget: QWidget, actions: Iterable[QAction], place: str) -> None:
    """Fill a menu or a toolbar with the actions that stand there, a line between their groups."""
    group = None
    for number, action in standing(actions, place):
        if group not in (None, number // 10):
            widget.addSeparator()
        group = number // 10
        widget.addAction(action)


def make_menus(bar: QMenuBar, actions: Iterable[QAction]) -> list[QMenu]:
    """Fill a menu bar, and the menus inside its menus.

    Returns
    -------
    list
        The menus; to be kept while the bar lives.
    """
    inner = {name: QMenu(title, bar) for name, (title, _) in INNER.items()}
    everything = [
        *actions,
        *(placed(menu.menuAction(), INNER[name][1]) for name, menu in inner.items()),
    ]
    for name, menu in inner.items():
        fill(menu, everything, name)
    menus = list(inner.values())
    for title in TITLES:
        menu = bar.addMenu(title)
        fill(menu, everything, title.replace("&", ""))
        menus.append(menu)
    return menus


def way_to(action: QAction) -> str:
    """Return where an action is found in the menus, such as ``"File > Export > Report"``."""
    place = str(action.property(PLACES) or "").partition(" ")[0].partition(".")[0]
    words = [name_and_held(action)[0]]
    while place in INNER:
        title, at = INNER[place]
        words.insert(0, title)
        place = at.partition(".")[0]
    return " > ".join(word.replace("&", "") for word in (place, *words))


def told(action: QAction, what: str) -> str:
    """Return what the user guide says of an action, as Markdown.

    Parameters
    ----------
    action
        The action.
    what
        ``"name"``, ``"keys"``, or nothing for the way to it and its first shortcut.
    """
    name, held = name_and_held(action)
    shortcut = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
    keys = shortcut or held.removesuffix(" (hold)")
    if what == "name":
        return name
    if what == "keys":
        return f"**{keys}**"
    return f"**{way_to(action)}**" + (f" ({keys})" if keys else "")


def shortcut_groups(actions: Iterable[QAction]) -> list[tuple[str, list[QAction]]]:
    """Return the titles of the menus, and the actions below each in their order."""
    known = list(actions)
    groups = []
    for title in TITLES:
        name = title.replace("&", "")
        found = standing(known, name)
        for inner, (_, at) in INNER.items():
            place, _, number = at.partition(".")
            if place == name:
                found += [(int(number), action) for _, action in standing(known, inner)]
        groups.append((name, [action for _, action in sorted(found, key=lambda one: one[0])]))
    return groups
