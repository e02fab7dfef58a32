"""What is closed is let go of: meshes, surfaces, sessions and what was computed from them."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace

import numpy as np
from qtpy.QtCore import Qt
from qtpy.QtTest import QTest
from tests.gui.drawing import LEFT, PLAIN, SHIFT, SOURCE
from tests.gui.living import alive
from tests.two_spheres import pairs, two_spheres

from pinwarp.core.components import Components
from pinwarp.core.landmarks import Side
from pinwarp.core.maps import MapKind
from pinwarp.core.mesh import Mesh
from pinwarp.gui.drawn.surface import Surface
from pinwarp.gui.scene.drawables import Overlay, Paths
from pinwarp.io.samples import sample_session
from pinwarp.session import edits
from pinwarp.session.judging.quality import Quality
from pinwarp.session.session import Session
from pinwarp.session.view import GridKind
from pinwarp.session.warp.result import WarpInputs, WarpResult
from pinwarp.session.warp.solver import WarpSolver

KINDS = (Mesh, Surface, Session, WarpResult, Quality)


def work(user) -> None:
    """Do a little of everything that remembers a mesh or a warp."""
    editor = user.editor
    editor.look(map=MapKind.DISTANCE)
    user.settle()
    name = editor.session.pairs[0].name
    editor.preview(edits.move(editor.committed, name, Side.DESTINATION, (1.0, 2.0, 3.0)))
    user.settle()
    editor.commit(edits.move(editor.committed, name, Side.DESTINATION, (1.0, 2.0, 3.0)), "Move")
    user.settle()
    editor.preview(edits.set_penalty(editor.committed, 3.0))
    user.settle()
    editor.commit(edits.set_components(editor.committed, Components.AFFINE), "Apply")
    user.settle()
    user.trigger("undo")
    user.trigger("undo")
    editor.look(map=None, grid=GridKind.BOX)
    user.settle()
    editor.look(grid=GridKind.NONE)
    # A surface covered with semilandmarks, whose slides are looked at and pictured.
    user.press(Qt.Key.Key_C, SHIFT)
    editor.look(slides=True)
    user.settle()
    user.trigger("snapshot")
    editor.look(slides=False)
    user.trigger("undo")
    begin_a_curve(user)
    user.trigger("mirror_x")
    user.trigger("undo")


def begin_a_curve(user) -> None:
    """Click two places, and leave it."""
    view = user.window.viewports[SOURCE]
    user.press(Qt.Key.Key_C)
    for pair in user.session.pairs[:2]:
        at = user.place_of(SOURCE, pair.source)
        QTest.mouseMove(view, at)
        QTest.mouseClick(view, LEFT, PLAIN, at)
        user.settle()
    assert user.window.viewports[SOURCE].drawn(Paths).lines
    user.press(Qt.Key.Key_Escape)


def reopen(user) -> None:
    user.window.parts.documents.open_session(sample_session(), as_new=True)
    user.settle()


def test_sessions_that_were_closed_leave_nothing_behind(user):
    reopen(user)
    before = alive(KINDS)
    reopen(user)
    work(user)
    reopen(user)
    after = alive(KINDS)
    assert after == before
    # The two bones, and what is warped of the one.
    assert after["Surface"] == 2
    assert after["Mesh"] <= 4


def test_meshes_that_take_one_another_s_place_stay_only_while_they_can_be_undone(user):
    user.open_sample()
    before = alive(KINDS)["Surface"]
    path = user.session.mesh_file(Side.SOURCE).path
    for _ in range(3):
        user.window.parts.documents.open_mesh(Side.SOURCE, path)
        user.settle()
    assert alive(KINDS)["Surface"] == before + 3, "undo brings each back at once"
    reopen(user)
    # A worker lets go of what it did last when it does the next.
    user.qtbot.waitUntil(lambda: alive(KINDS)["Surface"] == before, timeout=30_000)


def test_the_stand_in_of_a_large_mesh_goes_with_its_session(user, monkeypatch):
    user.open_sample()
    mesh = user.session.mesh(SOURCE)
    stand_in = mesh.with_vertices(mesh.vertices + 0.1)
    user.window.surfaces.of(mesh).stand_in = stand_in
    monkeypatch.setattr(user.window.parts.warps, "_is_slow", lambda: True)
    editor = user.editor
    editor.commit(edits.set_penalty(editor.committed, 3.0), "Change penalty")
    user.settle()
    assert user.window.viewports[Side.DESTINATION].drawn(Overlay).stand_in.mesh is stand_in
    gone = weakref.ref(stand_in)
    del mesh, stand_in
    reopen(user)
    gc.collect()
    assert gone() is None


def test_a_sweep_is_not_taken_for_that_of_a_mesh_gone_by():
    """A place in memory tells objects apart only while both are alive."""
    solver, ball = WarpSolver(), two_spheres()
    for i in range(20):
        mesh = ball.with_vertices(ball.vertices * (1 + 0.01 * i))
        session = Session(landmarks=pairs())
        rest = replace(WarpInputs.of(session), mesh=mesh)
        swept = replace(rest, settings=replace(rest.settings, penalty=5.0))
        solver.solve(rest)
        vertices = solver.preview(swept).vertices
        assert np.abs(vertices - WarpSolver().solve(swept).vertices).max() < 1e-2
        del mesh, rest, swept
        gc.collect()
