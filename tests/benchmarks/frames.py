"""Frames and the event loop's gaps in the real window, while a hand moves things."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyvista as pv
from qtpy.QtCore import QEvent, QPointF, QSettings, Qt, QTimer
from qtpy.QtGui import QMouseEvent
from qtpy.QtWidgets import QApplication, QWidget

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.gui.app import PrintedMessages, make_application
from pinwarp.gui.window.main_window import MainWindow
from pinwarp.session import edits
from tests.benchmarks.shapes import true_warp

SECONDS = 4.0


def framing() -> Iterator[dict[str, Any]]:
    """Sweep the slider and drag a landmark over meshes of three sizes."""
    application = make_application()
    with tempfile.TemporaryDirectory() as folder:
        for triangles in (10_000, 100_000, 1_000_000):
            window = _window(Path(folder), triangles)
            try:
                for name, move in (
                    ("slider sweep", _slider_sweep(window)),
                    ("landmark drag", _landmark_drag(window)),
                ):
                    yield {"what": name, "triangles": triangles} | _watch(window, move)
            finally:
                window.editor.replace_all(window.editor.session, None)
                window.close()
                window.deleteLater()
                application.processEvents()


def refreshing() -> Iterator[dict[str, Any]]:
    """Drop a landmark and wait for the table's and the curve's new figures."""
    application = make_application()
    with tempfile.TemporaryDirectory() as folder:
        window = _window(Path(folder), 10_000, pairs=200)
        waits, gaps = [], []
        arrived: list[float] = []
        window.parts.quality.quality_changed.connect(
            lambda _quality: arrived.append(time.perf_counter())
        )
        try:
            widget, path = _landmark_drag(window)
            for turn in range(9):
                _mouse(widget, QEvent.Type.MouseButtonPress, path(0.0))
                for step in range(1, 6):
                    _mouse(widget, QEvent.Type.MouseMove, path(0.1 * step + 0.01 * turn))
                    QApplication.processEvents()
                time.sleep(0.3)
                arrived.clear()
                begin = last = time.perf_counter()
                _mouse(widget, QEvent.Type.MouseButtonRelease, path(0.5))
                longest = 0.0
                while not (arrived and window.is_settled):
                    QApplication.processEvents()
                    now = time.perf_counter()
                    longest, last = max(longest, now - last), now
                    time.sleep(0.0005)
                waits.append(arrived[-1] - begin)
                gaps.append(longest)
                window.editor.undo()
                _settle(window)
        finally:
            window.editor.replace_all(window.editor.session, None)
            window.close()
            window.deleteLater()
            application.processEvents()
    yield {
        "what": "figures after a drop",
        "pairs": 200,
        "median (ms)": float(np.median(waits)) * 1e3,
        "longest (ms)": max(waits) * 1e3,
        "longest gap, median (ms)": float(np.median(gaps)) * 1e3,
    }


def _window(folder: Path, triangles: int, pairs: int = 50) -> MainWindow:
    side = int(np.sqrt(triangles / 2)) + 1
    bone = pv.ParametricEllipsoid(30, 40, 210, u_res=side, v_res=side).clean().triangulate()
    source, destination = folder / f"s{triangles}.ply", folder / f"d{triangles}.ply"
    bone.save(source)
    other = bone.copy()
    other.points = true_warp(np.asarray(bone.points, dtype=float))
    other.save(destination)
    settings = QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)
    window = MainWindow(settings, PrintedMessages())
    window.resize(1280, 800)
    window.show()
    window.parts.documents.open_mesh(Side.SOURCE, source)
    window.parts.documents.open_mesh(Side.DESTINATION, destination)
    _settle(window)
    places = np.asarray(bone.points, dtype=float)[
        np.random.default_rng(0).choice(bone.n_points, pairs, replace=False)
    ]
    landmarks = [
        Landmark(f"landmark_{i}", tuple(u), tuple(v))
        for i, (u, v) in enumerate(zip(places.tolist(), true_warp(places).tolist(), strict=True))
    ]
    window.editor.commit(edits.import_pairs(window.editor.session, landmarks), "Import pairs")
    _settle(window)
    return window


def _settle(window: MainWindow) -> None:
    end = time.perf_counter() + 60
    while not window.is_settled and time.perf_counter() < end:
        QApplication.processEvents()
        time.sleep(0.005)
    for _ in range(20):
        QApplication.processEvents()
        time.sleep(0.01)


def _mouse(widget: QWidget, kind: QEvent.Type, at: QPointF) -> None:
    left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
    button = none if kind == QEvent.Type.MouseMove else left
    held = none if kind == QEvent.Type.MouseButtonRelease else left
    event = QMouseEvent(
        kind,
        at,
        QPointF(widget.mapToGlobal(at.toPoint())),
        button,
        held,
        Qt.KeyboardModifier.NoModifier,
    )
    QApplication.sendEvent(widget, event)


Motion = tuple[QWidget, Callable[[float], QPointF]]


def _slider_sweep(window: MainWindow) -> Motion:
    slider = window.parts.penalty.panel.slider
    reach = slider.width() - 24
    return slider, lambda t: QPointF(8 + reach * (0.5 - 0.5 * np.cos(2 * t)), slider.height() / 2)


def _landmark_drag(window: MainWindow) -> Motion:
    viewport = window.viewports[Side.DESTINATION]
    markers, hidden = viewport.layer.markers, viewport.layer.hidden()
    middle = np.array([viewport.width() / 2, viewport.height() / 2])
    places = viewport.project(np.array([marker.position for marker in markers]))
    distance = np.hypot(*(places - middle).T)
    distance[hidden] = np.inf
    x, y = places[int(np.argmin(distance))]
    return viewport, lambda t: QPointF(x + 12 * np.sin(3 * t), y + 30 * np.sin(2 * t))


def _watch(window: MainWindow, motion: Motion) -> dict[str, float]:
    """Move for some seconds at 60 events a second; return gaps and frames."""
    widget, path = motion
    viewport = window.viewports[Side.DESTINATION]
    gaps: list[float] = []
    last = begin = time.perf_counter()

    def heartbeat() -> None:
        nonlocal last
        now = time.perf_counter()
        gaps.append(now - last)
        last = now

    pulse = QTimer()
    pulse.setTimerType(Qt.TimerType.PreciseTimer)
    pulse.timeout.connect(heartbeat)
    _mouse(widget, QEvent.Type.MouseButtonPress, path(0.0))
    # The first move builds the shortcut: it belongs to the motion as the user feels it.
    pulse.start(1)
    frames, next_move = viewport.renders, begin
    while time.perf_counter() - begin < SECONDS:
        now = time.perf_counter()
        if now >= next_move:
            next_move = now + 1 / 60
            _mouse(widget, QEvent.Type.MouseMove, path(now - begin))
        QApplication.processEvents()
        time.sleep(0.0005)
    seconds = time.perf_counter() - begin
    frames = viewport.renders - frames
    pulse.stop()
    _mouse(widget, QEvent.Type.MouseButtonRelease, path(SECONDS))
    _settle(window)
    return {
        "gap 95 % (ms)": float(np.percentile(gaps, 95)) * 1e3,
        "gap max (ms)": max(gaps) * 1e3,
        "frames a second": frames / seconds,
    }
