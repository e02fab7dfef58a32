"""The memory of the program, measured so that growth is a leak and nothing else.

Measured is what the system counts as resident, which is what a user sees, at the same state each
time. Four things make it larger without a leak, and are kept out of the comparison:

- Compiled code takes 45 MB once it is loaded, and compiling it in the first place 90 MB more. The
  program does that soon after its start, and the monkey before it begins.
- The graphics keep every shader that they have linked for as long as the window lives. Looking at a
  warp in every way takes some twenty a view and, in software, 35 MB; looking again takes nothing.
  So the monkey looks at everything once.
- Pictures take memory by their size: 40 MB between a small window and a large one. So the window
  has the size that it had at the start.
- What the allocator keeps for later is handed back first.

What counts is what the program does itself: also meshes that can be brought back by undoing, some
3 MB each with all that is made of it here, and what is lost between the blocks that are in use.
"""

from __future__ import annotations

import ctypes
import gc
from collections.abc import Callable
from itertools import product

import psutil
from qtpy.QtCore import QSize

from pinwarp.core import kernel, surface_distance
from pinwarp.core.maps import MapKind
from pinwarp.gui.window.main_window import MainWindow
from pinwarp.session.view import GridKind

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
            viewport.grabFramebuffer()
    editor.look(
        map=before.map,
        section=before.section,
        wireframe=before.wireframe,
        grid=before.grid,
        opacity=before.opacity,
        map_opacity=before.map_opacity,
    )
    settle()


def megabytes_in_use(window: MainWindow, size: QSize, settle: Callable[[], None]) -> float:
    """Return how much memory the program has, with its window at a size.

    Parameters
    ----------
    window
        Has its own size again afterwards.
    size
        The same each time that is compared.
    settle
        Waits until everything is shown.
    """
    own = window.size()
    window.resize(size)
    settle()
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    resident = psutil.Process().memory_info().rss / 2**20
    window.resize(own)
    settle()
    return resident
