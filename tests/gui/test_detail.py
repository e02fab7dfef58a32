"""Large meshes: a stand-in while things move, the full mesh when they rest."""

from __future__ import annotations

import threading

import numpy as np
import pytest
import pyvista as pv
from qtpy.QtCore import QPoint, QPointF, Qt
from qtpy.QtGui import QWheelEvent
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.mesh import Mesh
from pinwarp.gui.drawn.surface import STAND_IN, Surface
from pinwarp.gui.views import canvas
from pinwarp.session import edits


@pytest.fixture
def large(user, tmp_path, monkeypatch):
    """A window with a mesh of 65,000 triangles on both sides, on a machine that draws slowly."""
    sphere = pv.ParametricEllipsoid(30, 50, 150, u_res=181, v_res=181).clean().triangulate()
    path = tmp_path / "large.ply"
    sphere.save(path)
    for side in Side:
        user.window.parts.documents.open_mesh(side, path)
    user.settle()
    places = sphere.points[np.linspace(0, sphere.n_points - 1, 9).astype(int)].astype(float)
    landmarks = [
        Landmark(f"p{i}", tuple(p), tuple(p * 1.05 + np.sin(i)))
        for i, p in enumerate(places.tolist())
        for p in [np.array(p)]
    ]
    user.editor.commit(edits.import_pairs(user.session, landmarks), "Import pairs")
    user.settle()
    monkeypatch.setattr(canvas, "SLOW_FRAME", 0.0)
    return user


def drawn(viewport):
    """The names of what is visible."""
    return {name for name, actor in viewport.renderer.actors.items() if actor.GetVisibility()}


def test_the_stand_in_keeps_the_shape(large):
    surface = large.window.viewports[Side.SOURCE].surface
    assert 0.4 * STAND_IN < len(surface.stand_in.faces) < 2 * STAND_IN
    assert np.allclose(surface.stand_in.bounds, surface.mesh.bounds, atol=0.02 * surface.diagonal)


def test_a_small_mesh_needs_no_stand_in():
    assert Surface(Mesh(np.eye(3), [[0, 1, 2]])).stand_in is None


def test_the_stand_in_is_drawn_while_the_slider_moves_and_the_mesh_when_it_rests(large):
    viewport = large.window.viewports[Side.DESTINATION]
    assert drawn(viewport) == {"bone", "overlay"}
    slider = large.window.parts.penalty.panel.slider
    y = slider.height() // 2
    large.drag(slider, QPoint(8, y), QPoint(120, y), release=False)
    assert drawn(viewport) == {"bone stand-in", "overlay stand-in"}
    assert len(viewport.overlay_points) < 15_000
    coarse = viewport.overlay_points
    QTest.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=QPoint(120, y))
    large.settle()
    assert drawn(viewport) == {"bone", "overlay"}
    full = viewport.overlay_points
    assert len(full) > 30_000
    # The change-over is no jump: the stand-in lies where the mesh lies.
    assert np.allclose(coarse.min(axis=0), full.min(axis=0), atol=3)
    assert np.allclose(coarse.max(axis=0), full.max(axis=0), atol=3)


def test_a_warp_at_rest_that_comes_late_does_not_end_the_stand_in_of_the_next_drag(
    user, monkeypatch
):
    user.open_sample()
    monkeypatch.setattr(canvas, "SLOW_FRAME", 0.0)
    viewport, presenter = user.window.viewports[Side.DESTINATION], user.window.parts.warps
    solve, may_end = presenter.solver.solve, threading.Event()

    def held(inputs):
        assert may_end.wait(60)
        return solve(inputs)

    monkeypatch.setattr(presenter.solver, "solve", held)
    seen = []
    presenter.result_changed.connect(
        lambda _result, at_rest, _quality: seen.append((at_rest, viewport.is_coarse))
    )
    user.editor.commit(edits.set_penalty(user.session, 3.0), "Change penalty")
    user.editor.preview(edits.set_penalty(user.session, 5.0))
    may_end.set()
    user.qtbot.waitUntil(lambda: bool(seen), timeout=60_000)
    assert seen[0] == (True, True)
    user.editor.commit(user.session, "Change penalty")
    user.settle()
    assert not viewport.is_coarse


def test_the_stand_in_is_drawn_while_the_camera_orbits(large):
    viewport = large.window.viewports[Side.SOURCE]
    centre = viewport.rect().center()
    large.drag(viewport, centre, centre + QPoint(50, 0), release=False)
    assert drawn(viewport) == {"bone stand-in"}
    QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, pos=centre + QPoint(50, 0))
    large.settle()
    assert drawn(viewport) == {"bone"}


def test_zooming_shows_the_mesh_again_soon_after_the_last_notch(large):
    viewport = large.window.viewports[Side.SOURCE]
    at = QPointF(viewport.rect().center())
    event = QWheelEvent(
        at,
        QPointF(viewport.mapToGlobal(at.toPoint())),
        QPoint(),
        QPoint(0, 120),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(viewport, event)
    assert drawn(viewport) == {"bone stand-in"}
    large.qtbot.waitUntil(lambda: drawn(viewport) == {"bone"})


def test_escape_during_a_slow_drag_brings_the_mesh_back(large):
    viewport = large.window.viewports[Side.DESTINATION]
    marker = next(
        m
        for m, hidden in zip(viewport.layer.markers, viewport.layer.hidden(), strict=True)
        if not hidden
    )
    before = viewport.overlay_points
    start = large.place_of(Side.DESTINATION, marker.position)
    large.drag(viewport, start, start + QPoint(0, 20), release=False)
    assert viewport.is_coarse
    large.press(Qt.Key.Key_Escape, widget=viewport)
    assert drawn(viewport) == {"bone", "overlay"}
    assert np.allclose(viewport.overlay_points, before)


def test_selecting_and_hovering_render_no_bone_anew(user):
    user.open_sample()
    viewport = user.window.viewports[Side.SOURCE]
    user.qtbot.wait(50)
    before = viewport.renders
    user.editor.select(user.session.landmarks[0].name)
    user.editor.look(hovered=user.session.landmarks[1].name)
    user.qtbot.wait(50)
    assert [m.name for m in viewport.layer.markers if m.labelled] == [
        x.name for x in user.session.landmarks[:2]
    ]
    assert viewport.renders == before


def test_edges_are_smoothed_where_things_rest(user, monkeypatch):
    monkeypatch.setattr(canvas, "SMOOTH_EDGES", True)
    user.open_sample()
    viewport = user.window.viewports[Side.DESTINATION]
    assert viewport.renderer.GetUseFXAA()
    user.drag_a_landmark(release=False)
    assert not viewport.renderer.GetUseFXAA()
    before = viewport.renders
    user.press(Qt.Key.Key_Escape, widget=viewport)
    assert viewport.renderer.GetUseFXAA()
    assert viewport.renders > before
