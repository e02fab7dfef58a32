"""The memory of the program, measured so that growth is a leak and nothing else.

Measured is what the system counts as resident, which is what a user sees, and how many meshes with
all that is made of them are alive: while the same is open each time. What a monkey happens to have
open makes 100 MB of difference: ways over a mesh of 90,000 vertices, wanted by a curve or a patch,
take 25 MB, and go with its session. So the session that it began with is opened again in the same
window before each comparison; whatever that window still holds of the others is lost.

Four more things make it larger without a leak, and are kept out of the comparison:

- Compiled code takes 45 MB once it is loaded, and compiling it in the first place 90 MB more. The
  program does that soon after its start, and the monkey before it begins.
- The graphics keep every shader that they have linked for as long as the window lives. Looking at a
  warp in every way takes some twenty a view and, in software, 35 MB; looking again takes nothing.
  So the monkey looks at everything once.
- Pictures take memory by their size: 40 MB between a small window and a large one. So the window
  has the size that it had at the start.
- What the allocator keeps for later is handed back first.

What is lost between the blocks that are in use counts.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from itertools import product

import psutil
from qtpy.QtCore import QSize
from tests.gui.living import alive

from pinwarp.core import kernel, surface_distance
from pinwarp.core.curves import PathFinder
from pinwarp.core.maps import MapKind
from pinwarp.core.mesh import Mesh
from pinwarp.gui.drawn.surface import Surface
from pinwarp.gui.window.main_window import MainWindow
from pinwarp.session.session import Session
from pinwarp.session.view import GridKind, ViewState

# The memory of the first thousand events may grow by so much.
WARM_AFTER, MOST_GROWTH = 1000, 1.10

# The ways to draw that the graphics compile something of their own for.
MAPS = (None, MapKind.DISTANCE)
SECTIONS = (None, 0.5)
GRIDS = (GridKind.NONE, GridKind.BOX)
OPACITIES = (0.5, 1.0)


def warm_up(window: MainWindow, settle: Callable[[], None]) -> None:
    """Load all that is compiled, draw a warp in every way once, and leave the view as it was.

    Parameters
    ----------
    window
        One with both bones and a warp.
    settle
        Waits until everything is shown.
    """
    kernel.warm_up()
    surface_distance.warm_up()
    editor = window.editor
    before = editor.view
    for chosen, section, wireframe, grid, opacity in product(
        MAPS, SECTIONS, (False, True), GRIDS, OPACITIES
    ):
        editor.look(
            map=chosen,
            section=section,
            wireframe=wireframe,
            grid=grid,
            opacity=opacity,
            map_opacity=opacity,
        )
        settle()
        for viewport in window.viewports.values():
            viewport.picture()
    editor.look(
        map=before.map,
        section=before.section,
        wireframe=before.wireframe,
        grid=before.grid,
        opacity=before.opacity,
        map_opacity=before.map_opacity,
    )
    settle()


@dataclass(frozen=True)
class Held:
    """What the program holds while what it began with is open.

    Attributes
    ----------
    events
        So far.
    opened_at
        How many there were when this window was opened.
    megabytes
        Of memory.
    meshes, surfaces, finders
        How many are alive.
    """

    events: int
    opened_at: int
    megabytes: float
    meshes: int
    surfaces: int
    finders: int


def leave_everything(window: MainWindow) -> None:
    """Close the session as if there were no more work in it, and look as a new window does.

    Parameters
    ----------
    window
        Nothing but its docks and its size stays.
    """
    editor, start = window.editor, ViewState()
    editor.cancel_preview()
    editor.look(**{each.name: getattr(start, each.name) for each in fields(start)})
    window.parts.snapshots.clear()
    editor.replace_all(Session(), None)


def held(
    window: MainWindow, events: int, opened_at: int, size: QSize, settle: Callable[[], None]
) -> Held:
    """Return what the program holds, with its window at a size.

    Parameters
    ----------
    window
        Has its own size again afterwards.
    events, opened_at
        How many there were so far, and when the window was opened.
    size
        The same each time that is compared.
    settle
        Waits until everything is shown.
    """
    own = window.size()
    window.resize(size)
    settle()
    counts = alive((Mesh, Surface, PathFinder))
    ctypes.CDLL(None).malloc_trim(0)
    resident = psutil.Process().memory_info().rss / 2**20
    window.resize(own)
    settle()
    numbers = (counts[kind] for kind in ("Mesh", "Surface", "PathFinder"))
    return Held(events, opened_at, resident, *numbers)


def grown(series: Sequence[Held]) -> str:
    """Say in words what has become more since the first of some looks; empty where nothing has."""
    first, last = series[0], series[-1]
    more = [
        f"{what} from {before} to {now}"
        for what in ("meshes", "surfaces", "finders")
        if (now := getattr(last, what)) > (before := getattr(first, what))
    ]
    # The program has one window in its life; the graphics of the next are others. A thousand events
    # in, everything that is used at all has been used.
    of_window = [look for look in series if look.opened_at == last.opened_at]
    warm = (look for look in of_window if look.events >= last.opened_at + WARM_AFTER)
    settled = next(warm, last)
    if last.megabytes > MOST_GROWTH * settled.megabytes:
        more.append(f"memory from {settled.megabytes:.0f} to {last.megabytes:.0f} MB")
    return ", ".join(more)
