"""What is closed is let go of: meshes, surfaces, sessions and what was computed from them."""

from __future__ import annotations

import gc
from dataclasses import replace

import numpy as np
from tests.two_spheres import pairs, two_spheres

from pinwarp.core.components import Components
from pinwarp.core.landmarks import Side
from pinwarp.core.maps import MapKind
from pinwarp.core.mesh import Mesh
from pinwarp.gui.drawn.surface import Surface
from pinwarp.io.samples import sample_session
from pinwarp.session import edits
from pinwarp.session.judging.quality import Quality
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs, WarpResult
from pinwarp.session.warp.solver import WarpSolver

KINDS = (Mesh, Surface, Session, WarpResult, Quality)


def alive() -> dict[str, int]:
    """How many objects of each kind that holds meshes or is as large there are."""
    gc.collect()
    counts = dict.fromkeys((kind.__name__ for kind in KINDS), 0)
    for thing in gc.get_objects():
        if type(thing) in KINDS:
            counts[type(thing).__name__] += 1
    return counts


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
    editor.commit(edits.set_components(editor.committed, Components.AFFINE), "Apply")
    user.settle()
    user.trigger("undo")
    user.trigger("undo")
    user.trigger("snapshot")
    user.trigger("mirror_x")
    user.trigger("undo")


def reopen(user) -> None:
    user.window.parts.documents.open_session(sample_session(), as_new=True)
    user.settle()


def test_sessions_that_were_closed_leave_nothing_behind(user):
    # What earlier tests in this process keep is theirs.
    others = alive()
    for _ in range(2):
        reopen(user)
        work(user)
    reopen(user)
    before = alive()
    for _ in range(2):
        reopen(user)
        work(user)
    reopen(user)
    after = alive()
    assert all(after[kind] <= before[kind] for kind in after), (before, after)
    # The two bones, and the last warp with its survey.
    assert after["Surface"] - others["Surface"] == 2
    assert after["Mesh"] - others["Mesh"] <= 8


def test_meshes_that_take_one_another_s_place_stay_only_while_they_can_be_undone(user):
    user.open_sample()
    before = alive()["Surface"]
    path = user.session.mesh_file(Side.SOURCE).path
    for _ in range(3):
        user.window.parts.documents.open_mesh(Side.SOURCE, path)
        user.settle()
    assert alive()["Surface"] == before + 3, "undo brings each back at once"
    reopen(user)
    assert alive()["Surface"] == before


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
