"""A canvas's bones rendered once more, at any size, without a window.

What is seen is copied: actors, lights and camera, with the data they draw, so that the picture
stays one picture while the session goes on. A large picture is rendered tile by tile, each as the
part of the whole that it is, since graphics cards limit the size of what they render.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkCamera,
    vtkProperty,
    vtkRenderer,
    vtkRenderWindow,
)

from pinwarp.gui.views.canvas import Canvas

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


class Offscreen:
    """Renders what a canvas shows; to be closed.

    Parameters
    ----------
    canvas
        What is copied.
    tile
        The largest width and height rendered at once, in pixels.
    shown
        The names of actors that are copied even where they are hidden.
    """

    def __init__(self, canvas: Canvas, tile: int = TILE, shown: Collection[str] = ()) -> None:
        self._tile = tile
        self._view = (max(1, canvas.width()), max(1, canvas.height()))
        self._lines: list[tuple[vtkProperty, float]] = []
        self.renderer = vtkRenderer()
        # Black and transparent: colours come out premultiplied, ready to be laid over another.
        self.renderer.SetBackground(0, 0, 0)
        self.renderer.SetBackgroundAlpha(0)
        self.renderer.SetAutomaticLightCreation(False)
        for light in canvas.renderer.lights:
            self.renderer.AddLight(light.copy())
        self.actors: dict[str, vtkActor] = {}
        for name, actor in canvas.renderer.actors.items():
            if not isinstance(actor, vtkActor) or actor.GetMapper() is None:
                continue
            if actor.GetVisibility() or name in shown:
                self.actors[name] = self._copy(actor)
                self.renderer.AddActor(self.actors[name])
        self.camera = vtkCamera()
        self.camera.DeepCopy(canvas.camera)
        self._angle = self.camera.GetViewAngle()
        self._scale = self.camera.GetParallelScale()
        self.renderer.SetActiveCamera(self.camera)
        self._window: vtkRenderWindow | None = vtkRenderWindow()
        self._window.SetOffScreenRendering(True)
        self._window.SetMultiSamples(SAMPLES)
        self._window.SetAlphaBitPlanes(True)
        self._window.AddRenderer(self.renderer)

    def _copy(self, actor: vtkActor) -> vtkActor:
        copy, look = vtkActor(), vtkProperty()
        copy.ShallowCopy(actor)
        look.DeepCopy(actor.GetProperty())
        self._lines.append((look, look.GetLineWidth()))
        mapper = actor.GetMapper().NewInstance()
        mapper.ShallowCopy(actor.GetMapper())
        # Its points are rewritten in place when the warp changes.
        mapper.SetInputDataObject(pv.wrap(actor.GetMapper().GetInputDataObject(0, 0)).copy())
        copy.SetMapper(mapper)
        copy.SetProperty(look)
        copy.SetVisibility(True)
        return copy

    def scale_for(self, width: int, height: int) -> float:
        """Return how many pixels of a picture a logical pixel of the window takes.

        All that the window shows is in the picture; one of another shape shows more beside it.
        """
        return min(width / self._view[0], height / self._view[1])

    def tiles(self, width: int, height: int) -> Iterator[Tile]:
        """Render a picture of a size, tile by tile; one may reach over the right or lower edge.

        Raises
        ------
        MemoryError
            When the graphics cannot render it.
        """
        window = self._window
        assert window is not None, "closed"
        scale = self.scale_for(width, height)
        for look, line_width in self._lines:
            look.SetLineWidth(max(1.0, line_width * scale))
        across, down = (_share(length, self._tile) for length in (width, height))
        window.SetSize(across, down)
        # In logical pixels, and so of more than the window where the picture's shape is another.
        part = down / scale / self._view[1]
        tangent = math.tan(math.radians(self._angle) / 2) * part
        self.camera.SetViewAngle(2 * math.degrees(math.atan(tangent)))
        self.camera.SetParallelScale(self._scale * part)
        # All tiles are cut at one depth.
        self.renderer.ResetCameraClippingRange()
        corners = [(x, y) for y in range(0, height, down) for x in range(0, width, across)]
        for done, (left, top) in enumerate(corners, start=1):
            self.camera.SetWindowCenter(
                (2 * left + across - width) / across, (height - 2 * top - down) / down
            )
            window.Render()
            yield Tile(left, top, _read(window, across, down), done / len(corners))

    def close(self) -> None:
        """Let go of the graphics."""
        if self._window is not None:
            self._window.Finalize()
            self._window.RemoveRenderer(self.renderer)
            self._window = None


def _share(length: int, most: int) -> int:
    """Return the length of equal parts that are no longer than allowed."""
    return math.ceil(length / math.ceil(length / most))


def _read(window: vtkRenderWindow, width: int, height: int) -> Pixels:
    colours = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, colours, 0)
    if colours.GetNumberOfTuples() != width * height:
        raise MemoryError("The graphics could not render a picture of this size.")
    # VTK begins at the lower edge.
    return np.ascontiguousarray(vtk_to_numpy(colours).reshape(height, width, 4)[::-1])
