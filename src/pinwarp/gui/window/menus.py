"""Where the actions stand: menus, toolbar, and the groups on the sheet of shortcuts."""

from __future__ import annotations

from collections.abc import Mapping

from qtpy.QtGui import QAction
from qtpy.QtWidgets import QMenu, QMenuBar, QToolBar

SEPARATOR = "-"
# A key that begins with @ is a menu inside the menu.
MENUS = {
    "&File": (
        "open_source open_destination - open_session @recent restore open_sample - save save_as - "
        "@import @export export_mesh export_report warp_files - quit"
    ),
    "&Edit": (
        "undo redo - copy paste - rename rename_many note - "
        "toggle_enabled toggle_locked toggle_role - move_up move_down - "
        "delete_side delete_landmark - swap_destinations swap_sides @mirror - select_none filter"
    ),
    "&Place": (
        "accept_ghost place_suggested next_incomplete next_finding - "
        "load_template guide set_pattern - snap set_nudge lock"
    ),
    "&Warp": (
        "take_suggested swap_penalty - snapshot sweep clear_snapshots - "
        "@components play_blend - copy_figures"
    ),
    "&View": (
        "overlay arrows @maps @grid - fit focus @sides @cameras - section wireframe - "
        "markers_larger markers_smaller - show_coordinates show_curve -"
    ),
    "&Help": "shortcuts - about_penalty about_quality about",
}
SUBMENUS = {
    "@recent": ("Open &Recent", ""),
    "@import": ("&Import", "import_source import_destination import_pairs"),
    "@mirror": ("&Mirror Source", "mirror_x mirror_y mirror_z"),
    "@components": (
        "&Apply",
        "apply_full apply_without_pose - apply_affine apply_similarity apply_rigid",
    ),
    "@grid": (
        "&Grid",
        "grid_none grid_box - grid_plane_x grid_plane_y grid_plane_z - grid_next",
    ),
    "@sides": (
        "&Look From",
        "view_front view_back - view_left view_right - view_top view_bottom",
    ),
    "@cameras": ("Ca&meras", "link_linked link_rotation link_free - link_next"),
    "@maps": (
        "Ma&ps",
        "map_none - map_distance map_volume map_largest_stretch map_smallest_stretch "
        "map_uncertainty - map_next",
    ),
    "@export": (
        "E&xport",
        "export_picture export_animation - export_source export_destination "
        "export_pairs export_warped export_passengers - export_coefficients export_script",
    ),
}
TOOLBAR = (
    "open_session open_source open_destination save export_mesh - "
    "undo redo delete_side - lock guide - fit link_next overlay"
)


def make_menus(bar: QMenuBar, actions: Mapping[str, QAction]) -> dict[str, QMenu]:
    """Fill a menu bar.

    Returns
    -------
    dict
        The menus by title, or by key for those inside others; to be kept while the bar lives.
    """
    menus: dict[str, QMenu] = {}
    for title, keys in MENUS.items():
        menus[title] = bar.addMenu(title)
        for key in keys.split():
            if key in SUBMENUS:
                name, inner = SUBMENUS[key]
                menus[key] = menus[title].addMenu(name)
                _fill(menus[key], inner, actions)
            else:
                _fill(menus[title], key, actions)
    return menus


def fill_toolbar(bar: QToolBar, actions: Mapping[str, QAction]) -> None:
    """Fill a toolbar."""
    _fill(bar, TOOLBAR, actions)


def _fill(place: QMenu | QToolBar, keys: str, actions: Mapping[str, QAction]) -> None:
    for key in keys.split():
        if key == SEPARATOR:
            place.addSeparator()
        else:
            place.addAction(actions[key])


def shortcut_groups(actions: Mapping[str, QAction]) -> list[tuple[str, list[QAction]]]:
    """Return the titles of the menus, and the actions below each in their order."""
    groups = []
    for title, keys in MENUS.items():
        inner = " ".join(SUBMENUS[key][1] if key in SUBMENUS else key for key in keys.split())
        found = [actions[key] for key in inner.split() if key != SEPARATOR]
        groups.append((title.replace("&", ""), found))
    return groups
