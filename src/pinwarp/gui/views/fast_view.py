"""A PyVista view that renders exactly once per paint.

pyvistaqt renders once when VTK asks and again in ``paintGL``. Here VTK's request only schedules
a paint; however many come, one turn of the event loop renders once.
"""

from __future__ import annotations

import time
from typing import Any

from qtpy.QtGui import QGuiApplication, QOpenGLContext, QSurfaceFormat
from qtpy.QtWidgets import QWidget

from pinwarp.gui.views.without_charts import without_charts

with without_charts():
    from pyvistaqt import QtInteractor, rwi
    from pyvistaqt.rwi import _default_format


class _SettledFormat(QSurfaceFormat):
    """The format of a view, which is the application's from the start.

    Each view sets the default anew, and Qt warns each time that the shared context has one already.
    """

    @staticmethod
    def setDefaultFormat(wanted: QSurfaceFormat) -> None:
        """Set it where nobody has done so."""
        there = QGuiApplication.instance() is not None
        if not there or QOpenGLContext.globalShareContext() is None:
            QSurfaceFormat.setDefaultFormat(wanted)


rwi.QSurfaceFormat = _SettledFormat


def default_format() -> QSurfaceFormat:
    """Return the OpenGL format that views need; to be set before the application is made."""
    return _default_format()


class FastView(QtInteractor):
    """One viewport's canvas."""

    def __init__(self, parent: QWidget | None = None) -> None:
        # Multisampling costs 3-5 times the frame on software GL; markers are antialiased by Qt.
        super().__init__(parent, auto_update=False, multi_samples=0)
        # QtInteractor would add dropped meshes by itself.
        self.setAcceptDrops(False)
        interactor = self.iren.interactor
        interactor.EnableRenderOff()
        self._vtk_observers.append(
            (interactor, interactor.AddObserver("RenderEvent", self._on_render_request))
        )
        self.renders = 0
        self.frame_seconds = 0.0

    def _on_render_request(self, _caller: object, _event: str) -> None:
        if not self._in_paint:
            self.update()

    def paintGL(self) -> None:
        """Render, here and nowhere else."""
        interactor = self._Iren
        interactor.EnableRenderOn()
        self.renders += 1
        begin = time.perf_counter()
        try:
            super().paintGL()
        finally:
            interactor.EnableRenderOff()
            self.frame_seconds = time.perf_counter() - begin

    @property
    def graphics(self) -> str:
        """What draws this view, in words."""
        self.makeCurrent()
        told = dict(
            line.split(":", 1)
            for line in self.render_window.ReportCapabilities().splitlines()
            if line.startswith("OpenGL ") and ":" in line
        )
        keys = ("OpenGL vendor string", "OpenGL renderer string", "OpenGL version string")
        return ", ".join(told[key].strip() for key in keys if key in told) or "unknown"

    def render(self, *_args: Any, **_kwargs: Any) -> None:
        """Schedule a paint; PyVista calls this all over the place."""
        if not getattr(self, "_closed", False):
            self._rendered = True
            self.update()
