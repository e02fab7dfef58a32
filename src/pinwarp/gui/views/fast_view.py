"""A view that shows what VTK renders beside the screen, once for each paint that needs it.

Not pyvistaqt's, which is a QOpenGLWidget: with one of those in it, Qt puts a whole window together
by OpenGL for every change of a label. Without a graphics card that took half of each turn of the
event loop (``make bench`` has the gap), and a card waits for the screen. Here a picture is read
back once, and Qt paints it like any other; Qt needs no OpenGL at all.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import Qt
from qtpy.QtGui import QImage, QMouseEvent, QPainter, QPaintEvent, QWheelEvent
from qtpy.QtWidgets import QWidget
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkRenderingCore import vtkRenderWindow

from pinwarp.gui.views.without_charts import without_charts

with without_charts():
    # Not when the first is made: by then nobody would keep the figures out.
    from pyvista import Plotter

# Of the wheel, in eighths of a degree.
_NOTCH = 120


def read_pixels(window: vtkRenderWindow, width: int, height: int) -> NDArray[np.uint8]:
    """Return what a window has rendered: (height, width, 4) premultiplied RGBA.

    Raises
    ------
    MemoryError
        When the graphics could not render it.
    """
    colours = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, colours, 0)
    if colours.GetNumberOfTuples() != width * height:
        raise MemoryError("The graphics could not render a picture of this size.")
    # VTK begins at the lower edge.
    return np.ascontiguousarray(vtk_to_numpy(colours).reshape(height, width, 4)[::-1])


class FastView(QWidget):
    """One viewport's canvas.

    Attributes
    ----------
    plotter : pyvista.Plotter
        Renders, without a window of its own.
    renderer : pyvista.Renderer
        What is in it.
    camera : pyvista.Camera
        From where it is seen.
    renders : int
        How often it was rendered.
    frame_seconds : float
        How long the last frame took.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.WheelFocus)
        plotter = Plotter(off_screen=True, lighting="none")
        # Many samples a pixel cost 3-5 times the frame in software; Qt smooths what it paints.
        plotter.disable_anti_aliasing()
        plotter.enable_trackball_style()
        self.plotter: Plotter | None = plotter
        self.renderer, self.camera = plotter.renderer, plotter.renderer.camera
        # Else PyVista would place it anew with each mesh.
        self.camera.is_set = True
        interactor = plotter.iren.interactor
        interactor.EnableRenderOff()
        interactor.Initialize()
        self._interactor = interactor
        self._observers = [
            (interactor, interactor.AddObserver("RenderEvent", lambda *_: self.update()))
        ]
        self._turned = 0
        self._picture = QImage()
        self._is_stale = True
        self.renders = 0
        self.frame_seconds = 0.0

    def update(self) -> None:
        """Schedule a frame: however many ask in one turn of the event loop, one is rendered."""
        self._is_stale = True
        super().update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Show the picture; a sheet above it that changes has it shown again as it was."""
        painter = QPainter(self)
        painter.drawImage(0, 0, self.picture())
        painter.end()

    def picture(self) -> QImage:
        """Return what is seen, without what lies above it; rendered where it is news."""
        ratio = self.devicePixelRatioF()
        width, height = (max(1, round(length * ratio)) for length in (self.width(), self.height()))
        fits = (self._picture.width(), self._picture.height()) == (width, height)
        if self.plotter is not None and (self._is_stale or not fits):
            self._is_stale = False
            self.render_frame(width, height)
            self._picture.setDevicePixelRatio(ratio)
        return self._picture

    def render_frame(self, width: int, height: int) -> None:
        """Render, here and nowhere else."""
        assert self.plotter is not None, "closed"
        self.renders += 1
        begin = time.perf_counter()
        window = self.plotter.render_window
        self._interactor.UpdateSize(width, height)
        window.Render()
        pixels = read_pixels(window, width, height)
        whole = QImage(pixels.data, width, height, 4 * width, QImage.Format.Format_RGBX8888)
        # As the screen has it: shown again, it is only copied.
        self._picture = whole.convertToFormat(QImage.Format.Format_RGB32)
        self.frame_seconds = time.perf_counter() - begin

    @property
    def graphics(self) -> str:
        """What draws this view, in words."""
        if self.plotter is None:
            return "unknown"
        self.picture()
        told = dict(
            line.split(":", 1)
            for line in self.plotter.render_window.ReportCapabilities().splitlines()
            if line.startswith("OpenGL ") and ":" in line
        )
        keys = ("OpenGL vendor string", "OpenGL renderer string", "OpenGL version string")
        return ", ".join(told[key].strip() for key in keys if key in told) or "unknown"

    def close(self) -> bool:
        """Let go of the graphics; what was seen stays."""
        plotter, self.plotter = self.plotter, None
        if plotter is not None:
            for subject, tag in self._observers:
                subject.RemoveObserver(tag)
            self._observers = []
            plotter.close()
            plotter.deep_clean()
        return super().close()

    # The hand, as VTK's camera style knows it

    def _tell(self, event: QMouseEvent | QWheelEvent) -> Any:
        """Say where the mouse is and return whom to tell what it does."""
        at, ratio, modifiers = event.position(), self.devicePixelRatioF(), event.modifiers()
        self._interactor.SetEventInformation(
            round(at.x() * ratio),
            round((self.height() - at.y() - 1) * ratio),
            int(bool(modifiers & Qt.KeyboardModifier.ControlModifier)),
            int(bool(modifiers & Qt.KeyboardModifier.ShiftModifier)),
        )
        return self._interactor

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin to turn or, by any other button than the left, to shift."""
        interactor = self._tell(event)
        if event.button() == Qt.MouseButton.LeftButton:
            interactor.LeftButtonPressEvent()
        else:
            interactor.MiddleButtonPressEvent()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End it."""
        interactor = self._tell(event)
        if event.button() == Qt.MouseButton.LeftButton:
            interactor.LeftButtonReleaseEvent()
        else:
            interactor.MiddleButtonReleaseEvent()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Turn, or shift."""
        self._tell(event).MouseMoveEvent()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom, by whole notches."""
        self._turned += event.angleDelta().y()
        if abs(self._turned) >= _NOTCH:
            interactor = self._tell(event)
            if self._turned > 0:
                interactor.MouseWheelForwardEvent()
            else:
                interactor.MouseWheelBackwardEvent()
            self._turned = 0
