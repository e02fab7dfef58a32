"""Outlines: crests and tubercles lie there, and the hand misses the bone by a pixel or many."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from qtpy.QtCore import QPoint, QPointF, Qt

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.mesh import Mesh
from pinwarp.io.meshes import MeshFile
from pinwarp.session.session import Session

SOURCE = Side.SOURCE
RADIUS = 10.0


def show(user, shape: pv.PolyData, *landmarks: Landmark) -> None:
    shape = shape.triangulate()
    file = MeshFile(Path("bone.ply"), Mesh(shape.points, shape.regular_faces), "", ())
    user.editor.replace_all(Session(file, landmarks=landmarks), None)
    user.settle()


@pytest.fixture
def ball(user):
    """A window with a ball, and where its outline is to the right of its middle."""
    show(user, pv.Icosphere(radius=RADIUS, nsub=5))
    view = user.window.viewports[SOURCE]
    middle = user.place_of(SOURCE, (0, 0, 0))
    out = next(
        x
        for x in np.arange(middle.x(), view.width(), 0.25)
        if view.pick(QPointF(x, middle.y())) is None
    )
    return user, view, QPointF(float(out), middle.y())


@pytest.mark.parametrize(("beside", "places"), [(4, True), (12, False)])
def test_a_click_just_beside_the_outline_is_meant_for_the_bone(ball, beside, places):
    user, _, outline = ball
    user.click(SOURCE, (outline + QPointF(beside, 0)).toPoint())
    assert len(user.session.landmarks) == places
    if places:
        (landmark,) = user.session.landmarks
        assert np.linalg.norm(landmark.source) == pytest.approx(RADIUS, rel=0.005)
        assert (user.place_of(SOURCE, landmark.source) - outline.toPoint()).manhattanLength() <= 2


def test_the_cursor_tells_that_a_click_beside_the_outline_places(ball):
    _, view, outline = ball
    for beside, shape in ((4, Qt.CursorShape.CrossCursor), (12, Qt.CursorShape.ArrowCursor)):
        view._hover(outline + QPointF(beside, 0))
        assert view.cursor().shape() == shape


def test_a_landmark_dragged_past_the_outline_stays_where_the_surface_is_nearest(ball):
    user, view, outline = ball
    middle = user.place_of(SOURCE, (0, 0, 0))
    user.click(SOURCE, middle)
    # Far out to the lower right.
    away = QPoint(190, 190)
    user.drag(view, middle, middle + away)
    (landmark,) = user.session.landmarks
    there = user.place_of(SOURCE, landmark.source) - middle
    reach = outline.x() - middle.x()
    assert np.hypot(there.x(), there.y()) == pytest.approx(reach, abs=2)
    assert there.x() == pytest.approx(there.y(), abs=2)
    assert not view.behind_surface(np.array([landmark.source]))[0]


def test_on_a_box_of_twelve_triangles_the_nearest_place_of_an_edge_is_found(user):
    show(user, pv.Box(bounds=(-10, 10, -10, 10, -10, 10)))
    view = user.window.viewports[SOURCE]
    edge = user.place_of(SOURCE, (0, 0, 0))
    right = next(
        x
        for x in np.arange(edge.x(), view.width(), 0.25)
        if view.pick(QPointF(x, edge.y())) is None
    )
    met = view.pick(QPointF(right + 40, edge.y()), np.inf)
    place = view.project(met[None])[0]
    assert place == pytest.approx([right, edge.y()], abs=2)


def test_nothing_is_met_where_the_bone_is_behind_the_camera(ball):
    _, view, _ = ball
    camera = view.camera
    camera.SetFocalPoint(*(2 * np.array(camera.GetPosition())))
    assert view.pick(QPointF(20, 20), np.inf) is None
