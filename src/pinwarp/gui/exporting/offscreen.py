"""Scenes rendered once more as a canvas shows them, at any size, without a window.

A scene is a value: the picture stays one picture while the session goes on. A large picture is
rendered tile by tile, each as the part of the whole that it is, since graphics cards limit the
size of what they render.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from qtpy.QtCore import QRectF

from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.views.canvas import Canvas
from pinwarp.gui.views.fast_view import read_pixels

# Larger tiles hold up the window, smaller ones draw every triangle more often.
TILE = 512
# Smoothed edges: as many samples a pixel, as far as the graphics allow.
SAMPLES = 8

Pixels = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Tile:
    """A rendered part of a picture.

    Parameters
    ----------
    left, top
        Where it belongs, in pixels.
    pixels
        (rows, columns, 4) premultiplied RGBA.
    share
        How much of the picture is done with it.
    """

    left: int
    top: int
    pixels: Pixels
    share: float

    def put_into(self, picture: Pixels) -> None:
        """Write it where it belongs into a (height, width, 4) picture."""
        rows, columns = self.pixels.shape[:2]
        here = picture[self.top : self.top + rows, self.left : self.left + columns]
        here[:] = self.pixels[: here.shape[0], : here.shape[1]]


def whole_of(canvas: Canvas) -> QRectF:
    """Return all of a canvas as a region of it, in logical pixels."""
    return QRectF(0, 0, max(1, canvas.width()), max(1, canvas.height()))


class Offscreen:
    """Renders scenes as a canvas shows them; to be closed.

    Parameters
    ----------
    canvas
        From where it is seen, and how it is cut.
    scene
        What is rendered first.
    tile
        The largest width and height rendered at once, in pixels.
    region
        The part of the canvas that is rendered, in its logical pixels; all of it when None.
    """

    def __init__(
        self, canvas: Canvas, scene: Scene, tile: int = TILE, region: QRectF | None = None
    ) -> None:
        self._tile = tile
        whole = whole_of(canvas)
        region = whole if region is None else region
        self._region = (region.width(), region.height())
        self._canvas_height = whole.height()
        self._beside = region.center() - whole.center()
        self._plotter: pv.Plotter | None = pv.Plotter(off_screen=True, lighting="none")
        window, renderer = self._plotter.render_window, self._plotter.renderer
        window.SetMultiSamples(SAMPLES)
        window.SetAlphaBitPlanes(True)
        # Black and transparent: colours come out premultiplied, ready to be laid over another.
        renderer.SetBackground(0, 0, 0)
        renderer.SetBackgroundAlpha(0)
        self._drawn = canvas.draw_into(self._plotter, scene)
        self._lines = [(actor.prop, actor.prop.line_width) for actor in renderer.actors.values()]
        self.camera = pv.Camera()
        self.camera.DeepCopy(canvas.camera)
        self._angle = self.camera.GetViewAngle()
        self._scale = self.camera.GetParallelScale()
        self._plotter.camera = self.camera

    def show(self, scene: Scene) -> None:
        """Render another scene from here on."""
        self._drawn.show(scene)

    def scale_for(self, width: int, height: int) -> float:
        """Return how many pixels of a picture a logical pixel of the window takes.

        All of the region is in the picture; one of another shape shows more beside it.
        """
        return min(width / self._region[0], height / self._region[1])

    def tiles(self, width: int, height: int) -> Iterator[Tile]:
        """Render a picture of a size, tile by tile; one may reach over the right or lower edge.

        Raises
        ------
        MemoryError
            When the graphics cannot render it.
        """
        assert self._plotter is not None, "closed"
        window, renderer = self._plotter.render_window, self._plotter.renderer
        scale = self.scale_for(width, height)
        for look, line_width in self._lines:
            look.SetLineWidth(max(1.0, line_width * scale))
        across, down = (_share(length, self._tile) for length in (width, height))
        window.SetSize(across, down)
        # In logical pixels, and so of more than the window where the picture's shape is another.
        part = down / scale / self._canvas_height
        tangent = math.tan(math.radians(self._angle) / 2) * part
        self.camera.SetViewAngle(2 * math.degrees(math.atan(tangent)))
        self.camera.SetParallelScale(self._scale * part)
        # All tiles are cut at one depth.
        renderer.ResetCameraClippingRange()
        corners = [(x, y) for y in range(0, height, down) for x in range(0, width, across)]
        aside, below = 2 * scale * self._beside.x(), 2 * scale * self._beside.y()
        for done, (left, top) in enumerate(corners, start=1):
            self.camera.SetWindowCenter(
                (2 * left + across - width + aside) / across,
                (height - 2 * top - down - below) / down,
            )
            window.Render()
            yield Tile(left, top, read_pixels(window, across, down), done / len(corners))

    def close(self) -> None:
        """Let go of the graphics."""
        if self._plotter is not None:
            self._plotter.close()
            self._plotter.deep_clean()
            self._plotter = None


def _share(length: int, most: int) -> int:
    """Return the length of equal parts that are no longer than allowed."""
    return math.ceil(length / math.ceil(length / most))
