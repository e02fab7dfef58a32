"""Animations: the view turned round, or the way from the aligned source to the warp."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import Qt
from qtpy.QtGui import QColor, QImage

from pinwarp.core.components import Components, as_drawn
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.core.live import drawable
from pinwarp.gui.drawn.surface import shading_normals, triangles
from pinwarp.gui.exporting.offscreen import Offscreen, Pixels
from pinwarp.gui.exporting.picture import FORMAT, paint_signs
from pinwarp.gui.scene.drawables import FoldedSurface, GridLines, Legend, Overlay
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.style import theme
from pinwarp.gui.tasks.stepped_job import Steps
from pinwarp.gui.views.canvas import Canvas
from pinwarp.session.session import Session
from pinwarp.session.warp.solved import solved

Vertices = NDArray[np.float32]

# All frames are held until they are written: 3 bytes a pixel.
MOST_PIXELS = 120_000_000


class Format(StrEnum):
    """What kind of file an animation becomes, by its suffix."""

    GIF = "gif"
    MP4 = "mp4"


class Motion(StrEnum):
    """What moves."""

    TURN = "turn"
    BLEND = "blend"


@dataclass(frozen=True)
class AnimationOrder:
    """What an animation shows.

    Parameters
    ----------
    motion
        What moves.
    width, height
        In pixels.
    frames
        How many pictures.
    seconds
        How long they take, before they repeat.
    format
        The kind of file.
    """

    motion: Motion = Motion.TURN
    width: int = 640
    height: int = 640
    frames: int = 60
    seconds: float = 4.0
    format: Format = Format.GIF

    @property
    def pixels(self) -> int:
        """Of all frames together."""
        return self.width * self.height * self.frames


@dataclass(frozen=True, eq=False)
class Ends:
    """Where a blend begins and ends, made ready in a worker.

    Parameters
    ----------
    aligned
        The source's vertices, aligned rigidly to the destination.
    warped
        The same, warped.
    """

    aligned: Vertices
    warped: Vertices

    def at(self, share: float) -> Vertices:
        """Return the vertices on the way; the warp is linear in the blend."""
        return (1 - share) * self.aligned + np.float32(share) * self.warped


def ends_of(session: Session) -> Ends:
    """Return the ends of the blend of a session's warp.

    Raises
    ------
    PinwarpError
        When nothing would move, or there is no warp.
    """
    mesh = session.mesh(Side.SOURCE)
    if mesh is None:
        raise PinwarpError("There is no source mesh to warp: open one first.")
    if session.settings.components is Components.RIGID:
        raise PinwarpError(
            "Only the rigid fit is applied, which is where the blend begins: nothing would move. "
            "Choose another part in Warp > Apply."
        )
    warp, part = solved(session), as_drawn(session.settings.components)
    aligned, warped = (drawable(warp.part(part, blend).evaluate(mesh.vertices)) for blend in (0, 1))
    return Ends(aligned, warped)


def animation_steps(order: AnimationOrder, view: Canvas, ends: Ends | None = None) -> Steps:
    """Render an animation in small steps.

    Parameters
    ----------
    order
        What it shows.
    view
        The destination's view; copied at the first step.
    ends
        Of the blend, where that is what moves.

    Yields
    ------
    share, stage

    Returns
    -------
    list of (height, width, 3) uint8
        The frames.

    Raises
    ------
    PinwarpError
        When there is too little memory, or no warped source to be blended.
    """
    scene = view.scene
    legend = _legend(order, view)
    copy = Offscreen(view, scene)
    try:
        moves = _turns(order, copy) if ends is None else _blends(order, copy, scene, ends)
        frames = []
        for number, _moved in enumerate(moves):
            frame: Pixels = np.zeros((order.height, order.width, 4), np.uint8)
            for tile in copy.tiles(order.width, order.height):
                tile.put_into(frame)
                yield (number + tile.share) / order.frames, f"rendering {number + 1}"
            frames.append(laid_over(legend, over_background(frame)))
        return frames
    except MemoryError as error:
        raise PinwarpError(
            "There is too little memory for this animation: choose a smaller size."
        ) from error
    finally:
        copy.close()


def _turns(order: AnimationOrder, copy: Offscreen) -> Iterator[None]:
    """Turn the camera once round what it looks at, about what is up."""
    for _ in range(order.frames):
        yield
        copy.camera.Azimuth(360 / order.frames)
        copy.camera.OrthogonalizeViewUp()


def _blends(order: AnimationOrder, copy: Offscreen, scene: Scene, ends: Ends) -> Iterator[None]:
    """Warp the overlay and take it back, gently at both ends."""
    overlay = scene.of(Overlay)
    warp = overlay.full if overlay is not None else None
    if overlay is None or warp is None or len(warp.vertices) != len(ends.warped):
        raise PinwarpError("The warped source is not drawn yet: try again once it is.")
    # They are those of the whole warp, and would stand still.
    bare = scene.without(GridLines, FoldedSurface)
    for share in (1 - np.cos(2 * np.pi * np.arange(order.frames) / order.frames)) / 2:
        vertices = ends.at(float(share))
        normals = shading_normals(triangles(vertices, warp.mesh.faces))
        moved = replace(warp, vertices=vertices, normals=normals)
        copy.show(bare.with_(replace(overlay, full=moved, stand_in=None, visible=True)))
        yield


def _legend(order: AnimationOrder, view: Canvas) -> Pixels:
    """Return what stands still before all frames: a map's legend; colours say little without it.

    Returns
    -------
    (height, width, 4) uint8, premultiplied RGBA
    """
    image = QImage(order.width, order.height, FORMAT)
    image.fill(Qt.GlobalColor.transparent)
    paint_signs(image, view, view.scene.only(Legend), image.rect())
    return np.frombuffer(image.constBits(), np.uint8).reshape(order.height, order.width, 4).copy()


def laid_over(sheet: Pixels, frame: Pixels) -> Pixels:
    """Lay a premultiplied RGBA sheet over an RGB frame."""
    covered = np.flatnonzero((sheet[..., 3] > 0).any(axis=1))
    if not len(covered):
        return frame
    rows = slice(covered[0], covered[-1] + 1)
    over = sheet[rows].astype(np.float32)
    clear = 1 - over[..., 3:] / 255
    frame[rows] = (over[..., :3] + clear * frame[rows] + 0.5).clip(0, 255).astype(np.uint8)
    return frame


def over_background(frame: Pixels) -> Pixels:
    """Lay a premultiplied RGBA frame over the window's background; RGB is left."""
    top, bottom = (
        np.array(QColor(name).getRgb()[:3], dtype=np.float32)
        for name in (theme.BACKGROUND_TOP, theme.BACKGROUND_BOTTOM)
    )
    down = np.linspace(0, 1, len(frame), dtype=np.float32)[:, None, None]
    behind = (1 - down) * top + down * bottom
    clear = 1 - frame[..., 3:].astype(np.float32) / 255
    return (frame[..., :3] + clear * behind + 0.5).clip(0, 255).astype(np.uint8)
