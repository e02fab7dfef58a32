"""The window's actions: one table of words, keys and icons that menus and toolbar are made of."""

from __future__ import annotations

from dataclasses import dataclass

from qtpy.QtCore import QObject
from qtpy.QtGui import QAction, QKeySequence

from pinwarp.gui.style.icons import icon


@dataclass(frozen=True)
class ActionSpec:
    """What an action is called, where its key is, and what it looks like."""

    key: str
    text: str
    shortcut: str = ""
    icon: str = ""
    tip: str = ""
    checkable: bool = False
    button: str = ""


SPECS = (
    ActionSpec("open_session", "&Open Session…", "Ctrl+O", "open", "Open a saved session"),
    ActionSpec(
        "open_source", "Open S&ource Mesh…", "Ctrl+1", "source", "Open the mesh that is warped"
    ),
    ActionSpec(
        "open_destination",
        "Open &Destination Mesh…",
        "Ctrl+2",
        "destination",
        "Open the mesh whose shape it takes",
    ),
    ActionSpec("open_sample", "Open Sample &Bones", "", "", "Two femurs to try things on"),
    ActionSpec("save", "&Save Session", "Ctrl+S", "save", "Save the session"),
    ActionSpec("save_as", "Save Session &As…", "Ctrl+Shift+S"),
    ActionSpec("restore", "Restore &Unsaved Work…", "", "", "Of windows that ended unexpectedly"),
    ActionSpec("import_source", "Source Landmarks…", "Ctrl+Shift+1", "", "From a CSV file"),
    ActionSpec("import_destination", "Destination Landmarks…", "Ctrl+Shift+2", "", "From a CSV"),
    ActionSpec("import_pairs", "Landmark Pairs…", "", "", "From a CSV file with both sides"),
    ActionSpec("export_source", "&Source Landmarks…"),
    ActionSpec("export_destination", "&Destination Landmarks…"),
    ActionSpec("export_pairs", "&Landmark Pairs…"),
    ActionSpec(
        "export_mesh", "&Export Warped Mesh…", "Ctrl+E", "export", "Save the warped source mesh"
    ),
    ActionSpec(
        "export_report",
        "Export &Report…",
        "Ctrl+Shift+E",
        "",
        "Pictures, pairs and quality, as HTML",
    ),
    ActionSpec("export_picture", "Pi&cture…", "", "", "Of the views, at any size"),
    ActionSpec("export_animation", "&Animation…", "", "", "Turned round, or warped and back"),
    ActionSpec("export_warped", "&Warped Landmarks…", "", "", "Where the warp carries the pairs"),
    ActionSpec("export_coefficients", "Coe&fficients…", "", "", "Of the warp, as JSON or .npz"),
    ActionSpec("export_script", "Scr&ipt…", "", "", "Python that warps the mesh again"),
    ActionSpec(
        "warp_files", "&Warp Files…", "", "", "Other meshes and landmarks, by the same warp"
    ),
    ActionSpec("quit", "&Quit", "Ctrl+Q"),
    ActionSpec("undo", "&Undo", "Ctrl+Z", "undo"),
    ActionSpec("redo", "&Redo", "Ctrl+Shift+Z", "redo"),
    ActionSpec("copy", "&Copy", "Ctrl+C", "", "As a table for a spreadsheet"),
    ActionSpec("paste", "&Paste", "Ctrl+V", "", "Landmarks from a spreadsheet or CSV text"),
    ActionSpec("rename", "Re&name Landmark", "F2"),
    ActionSpec(
        "rename_many", "Rename &Several…", "Ctrl+F2", "", "By a pattern, or find and replace"
    ),
    ActionSpec("note", "No&te…", "Shift+F2", "", "Write something down about a landmark"),
    ActionSpec("toggle_enabled", "&Disable", "Ctrl+D", "", "Let pairs take part, or not"),
    ActionSpec("toggle_locked", "&Lock", "Ctrl+L", "", "Protect from being moved by accident"),
    ActionSpec(
        "toggle_role", "Make &Passenger", "Ctrl+Shift+P", "", "Carried by the warp, not solved for"
    ),
    ActionSpec("move_up", "Move Row &Up", "Alt+Up"),
    ActionSpec("move_down", "Move Row Do&wn", "Alt+Down"),
    ActionSpec("next_incomplete", "Next &Incomplete Landmark", "N"),
    ActionSpec(
        "next_finding", "Next Pair to &Check", "Shift+N", "", "The next one listed below the table"
    ),
    ActionSpec("swap_destinations", "Swap Dest&inations", "", "", "Of two landmarks"),
    ActionSpec("filter", "&Filter Landmarks", "Ctrl+F"),
    ActionSpec("delete_side", "&Delete Position", "Del", "delete", "On the selected side only"),
    ActionSpec("delete_landmark", "Delete &Landmark", "Ctrl+Del", "", "On both sides"),
    ActionSpec("select_none", "Select &None", "Esc"),
    ActionSpec("overlay", "Show &Warped Source", "W", "overlay", "Over the destination", True),
    ActionSpec(
        "arrows", "Residual &Arrows", "A", "", "From warped landmarks to destinations", True
    ),
    ActionSpec(
        "show_coordinates", "Show &Coordinates", "Ctrl+Shift+C", "", "In the table, to edit", True
    ),
    ActionSpec("fit", "&Fit Both Views", "Home", "fit", "Look at both bones as a whole"),
    ActionSpec("accept_ghost", "&Accept Ghost", "Space", "", "Place it where it is expected"),
    ActionSpec(
        "place_suggested",
        "Place at &Suggested Place",
        "Shift+Space",
        "",
        "Where the uncertainty map says that the next landmark helps most",
    ),
    ActionSpec("snap", "S&nap to Surface", "S", "", "Put the selection back onto the bone"),
    ActionSpec("lock", "&Lock Landmarks", "L", "lock", "Freeze all landmarks", True),
    ActionSpec("set_nudge", "Nudge Ste&p…", "", "", "How far an arrow key moves a landmark"),
    ActionSpec("set_pattern", "Name Pa&ttern…", "", "", "What new landmarks are called"),
    ActionSpec(
        "load_template", "Load &Template…", "Ctrl+T", "", "A list of landmarks to be asked for"
    ),
    ActionSpec("guide", "&Guide", "G", "guide", "Ask for one landmark after the other", True),
    ActionSpec("export_passengers", "Warped &Passengers…", "", "", "Where the warp carries them"),
    ActionSpec("swap_sides", "S&wap Source and Destination", "", "", "Warp the other way round"),
    ActionSpec("mirror_x", "Across &X", "", "", "Left becomes right along x"),
    ActionSpec("mirror_y", "Across &Y", "", "", "Left becomes right along y"),
    ActionSpec("mirror_z", "Across &Z", "", "", "Left becomes right along z"),
    ActionSpec("focus", "F&ocus on Selection", "F", "", "Look at the selected landmarks closely"),
    ActionSpec("view_front", "&Front View", "1", "", "The side that Fit shows"),
    ActionSpec("view_back", "&Back View", "2"),
    ActionSpec("view_left", "&Left View", "3"),
    ActionSpec("view_right", "&Right View", "4"),
    ActionSpec("view_top", "&Top View", "5"),
    ActionSpec("view_bottom", "Botto&m View", "6"),
    ActionSpec("link_linked", "&Linked", "", "", "Both move, seen from the same side", True),
    ActionSpec("link_rotation", "&Rotation Only", "", "", "Pan and zoom are of their own", True),
    ActionSpec("link_free", "&Free", "", "", "Each view moves by itself", True),
    ActionSpec("apply_full", "&Full Warp", "", "", "All of it", True),
    ActionSpec(
        "apply_without_pose", "Without &Pose", "", "", "Export keeps the source's frame", True
    ),
    ActionSpec("apply_affine", "&Affine Fit Only", "", "", "Turned, moved, sized, sheared", True),
    ActionSpec("apply_similarity", "&Similarity Fit Only", "", "", "Turned, moved, sized", True),
    ActionSpec("apply_rigid", "&Rigid Fit Only", "", "", "Turned and moved", True),
    ActionSpec("play_blend", "&Play Blend", "Shift+B", "play", "From the source to the warp", True),
    ActionSpec("copy_figures", "&Copy Figures", "", "", "The warp taken apart, as a table"),
    ActionSpec("grid_none", "&None", "", "", "No grid", True),
    ActionSpec("grid_box", "&Box", "", "", "Straight on the source, bent by the warp", True),
    ActionSpec("grid_plane_x", "Plane Across &X", "", "", "Of the source's axes", True),
    ActionSpec("grid_plane_y", "Plane Across &Y", "", "", "Of the source's axes", True),
    ActionSpec("grid_plane_z", "Plane Across &Z", "", "", "Of the source's axes", True),
    ActionSpec("grid_next", "N&ext Grid", "D"),
    ActionSpec(
        "take_suggested",
        "Take &Suggested Penalty",
        "T",
        "",
        "The one with the least leave-one-out error",
    ),
    ActionSpec(
        "swap_penalty",
        # Behind the tab stands the key that is held; the action itself has none.
        "Compare with &Previous Penalty\tB (hold)",
        "",
        "",
        "Go back to the previous penalty; hold B only to look at it",
    ),
    ActionSpec(
        "snapshot",
        "Take S&napshot",
        "P",
        "",
        "A picture of the warp at this penalty",
        button="Snapshot",
    ),
    ActionSpec("sweep", "S&weep: 5 Snapshots", "", "", "From interpolation to the affine fit"),
    ActionSpec("clear_snapshots", "&Clear Snapshots"),
    ActionSpec(
        "show_curve", "Penalty C&urve", "", "", "Leave-one-out error and residual", True, "Curve"
    ),
    ActionSpec("markers_larger", "La&rger Landmarks", "]"),
    ActionSpec("markers_smaller", "S&maller Landmarks", "["),
    ActionSpec("wireframe", "W&ireframe Bones", "Shift+W", "", "Draw edges only", True),
    ActionSpec("section", "&Cross-Section", "X", "section", "Cut both bones open", True),
    ActionSpec("map_none", "&No Map", "", "", "The warped source in one colour", True),
    ActionSpec("map_distance", "&Distance to the Destination", "", "", "Where it misses", True),
    ActionSpec("map_volume", "&Volume Change", "", "", "Where it swells and shrinks", True),
    ActionSpec(
        "map_largest_stretch", "&Largest Stretch", "", "", "In the direction that grows most", True
    ),
    ActionSpec(
        "map_smallest_stretch",
        "&Smallest Stretch",
        "",
        "",
        "In the direction that grows least",
        True,
    ),
    ActionSpec("map_uncertainty", "&Uncertainty", "", "", "Where landmarks are missing", True),
    ActionSpec("map_next", "Next &Map", "M", "", "Colour the warped source by something else"),
    ActionSpec("link_next", "&Next Camera Link", "K", "link_linked"),
    ActionSpec("shortcuts", "&Shortcuts", "F1", "", "All keys and mouse gestures"),
    ActionSpec("about", "&About pinwarp"),
    ActionSpec("about_penalty", "About the Warping &Penalty"),
    ActionSpec("about_quality", "About the &Quality Figures"),
)


def make_actions(parent: QObject) -> dict[str, QAction]:
    """Return the actions by their keys, each with a tip that names its shortcut."""
    actions: dict[str, QAction] = {}
    for spec in SPECS:
        action = QAction(spec.text, parent)
        action.setObjectName(spec.key)
        action.setCheckable(spec.checkable)
        words = spec.tip or spec.text.replace("&", "").rstrip("…")
        if spec.shortcut:
            action.setShortcut(QKeySequence(spec.shortcut))
            words = f"{words} ({spec.shortcut})"
        action.setToolTip(words)
        if spec.button:
            action.setIconText(spec.button)
        if spec.icon:
            action.setIcon(icon(spec.icon))
        actions[spec.key] = action
    # A second habit for the same thing.
    actions["redo"].setShortcuts([QKeySequence("Ctrl+Shift+Z"), QKeySequence("Ctrl+Y")])
    actions["delete_side"].setShortcuts([QKeySequence("Del"), QKeySequence("Backspace")])
    actions["shortcuts"].setShortcuts([QKeySequence("F1"), QKeySequence("?")])
    return actions
