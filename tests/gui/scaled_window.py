"""What the mouse meets on a screen with more pixels; run by test_high_dpi.py in its own process.

    python -m tests.gui.scaled_window

Qt reads how large a pixel is once, when the program starts.
"""

from __future__ import annotations

import json
import time

import numpy as np
from qtpy.QtCore import QPoint, QPointF, Qt
from qtpy.QtGui import QImage
from qtpy.QtTest import QTest
from tests.gui.conftest import Driver, ScriptedDialogs

from pinwarp.core.landmarks import Side
from pinwarp.gui.app import make_application, no_settings
from pinwarp.gui.views.viewport import Viewport
from pinwarp.gui.window.main_window import MainWindow


class Patient(Driver):
    """Waits without a test around it."""

    def settle(self) -> None:
        """Wait until what was asked for is done and painted."""
        deadline = time.monotonic() + 60
        while not self.window.is_settled:
            assert time.monotonic() < deadline
            QTest.qWait(5)
        QTest.qWait(20)


def seen_and_picked(view: Viewport, screen: QImage) -> list[tuple[int, int]]:
    """Return how far the outline on the screen is from that which the mouse meets, by row."""
    ratio, corner = view.devicePixelRatioF(), view.mapToGlobal(QPoint(0, 0))

    def colour(x: float, y: float) -> np.ndarray:
        at = ratio * (QPointF(corner) + QPointF(x + 0.5, y + 0.5))
        return np.array(screen.pixelColor(int(at.x()), int(at.y())).getRgb()[:3])

    off = []
    for y in range(view.height() // 3, 2 * view.height() // 3, 12):
        across = range(2, view.width() - 2)
        bare = colour(2, y)
        seen = [x for x in across if abs(colour(x, y) - bare).sum() > 40]
        met = [x for x in across if view.pick(QPointF(x + 0.5, y + 0.5)) is not None]
        off.append((seen[0] - met[0], seen[-1] - met[-1]))
    return off


def main() -> None:
    """Look, click and drag in a window, and tell what came of it as JSON."""
    application = make_application()
    dialogs = ScriptedDialogs()
    window = MainWindow(no_settings(), dialogs)
    window.resize(900, 600)
    window.show()
    user = Patient(window, dialogs, None)
    user.open_sample_meshes()
    view = window.viewports[Side.SOURCE]
    outline = seen_and_picked(view, application.primaryScreen().grabWindow(0).toImage())
    # Hover, click, and drag what was placed.
    at = user.place_of(Side.SOURCE, user.places_down_the_bone(Side.SOURCE, 5)[2])
    QTest.mouseMove(view, at)
    user.settle()
    shape = view.cursor().shape()
    user.click(Side.SOURCE, at)
    placed = user.place_of(Side.SOURCE, user.session.landmarks[0].source) - at
    user.drag(view, at, at + QPoint(1, 30))
    dropped = user.place_of(Side.SOURCE, user.session.landmarks[0].source) - at
    told = {
        "ratio": view.devicePixelRatioF(),
        "outline": outline,
        "hovers": shape == Qt.CursorShape.CrossCursor,
        "placed": placed.toTuple(),
        "dragged": dropped.toTuple(),
    }
    print(json.dumps(told), flush=True)
    window.close()


if __name__ == "__main__":
    main()
