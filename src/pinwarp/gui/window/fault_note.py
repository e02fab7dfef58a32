"""Says in the status bar that something went wrong, and copies what there is to report."""

from __future__ import annotations

import importlib.metadata
import platform
from collections.abc import Callable

from qtpy.QtCore import qVersion
from qtpy.QtGui import QGuiApplication
from qtpy.QtWidgets import QPushButton

from pinwarp.gui.style import theme
from pinwarp.gui.window.faults import Faults
from pinwarp.version import __version__

_PACKAGES = ("numpy", "scipy", "numba", "vtk", "pyvista", "PySide6-Essentials")


class FaultNote(QPushButton):
    """Stands in the status bar from a fault until its details are copied.

    Parameters
    ----------
    faults
        What went wrong.
    graphics
        Returns in words what draws the views.
    say
        Says a sentence in passing.
    """

    def __init__(
        self,
        faults: Faults,
        graphics: Callable[[], str],
        say: Callable[[str], None],
    ) -> None:
        super().__init__("Something went wrong: Copy Details")
        self._faults = faults
        self._graphics = graphics
        self._say = say
        self.setFlat(True)
        self.setStyleSheet(f"color: {theme.warning_text_colour().name()};")
        self.setToolTip("Copies versions and what went wrong, to be pasted into a report")
        self.hide()
        faults.told.connect(self._on_told)
        self.clicked.connect(self.copy)

    def _on_told(self, sentence: str) -> None:
        self.show()
        self._say(sentence)

    def copy(self) -> None:
        """Copy versions and what went wrong, whether anything did or not."""
        try:
            graphics = self._graphics()
        except Exception as error:  # broken graphics may be what is to be reported
            graphics = f"unknown ({error})"
        QGuiApplication.clipboard().setText(details(self._faults, graphics))
        self.hide()
        self._say("Copied the details: paste them into a report.")


def details(faults: Faults, graphics: str) -> str:
    """Return what is needed to find out what went wrong.

    Parameters
    ----------
    faults
        What went wrong.
    graphics
        What draws the views.
    """
    versions = ", ".join(f"{name} {_version(name)}" for name in _PACKAGES)
    lines = [
        f"pinwarp {__version__}",
        f"Python {platform.python_version()} on {platform.platform()}",
        f"Qt {qVersion()} ({QGuiApplication.platformName()}), {versions}",
        f"Graphics: {graphics}",
        f"Faults: {faults.count}" + (", the different ones:" if faults.reports else ""),
    ]
    return "\n".join(lines + faults.reports)


def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return "?"
