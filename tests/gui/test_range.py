"""User stories: numbers beyond what can be drawn, typed or read by mistake."""

from __future__ import annotations

import numpy as np
from tests.session.study import bone

from pinwarp.core.landmarks import Side
from pinwarp.core.maps import MapKind
from pinwarp.io.meshes import write_mesh
from pinwarp.session import edits
from pinwarp.session.view import GridKind


def test_a_landmark_beyond_all_numbers_is_said_and_undone(user):
    user.open_sample()
    editor, window = user.editor, user.window
    before = window.parts.warps.result.vertices
    name = editor.committed.pairs[3].name
    editor.look(grid=GridKind.BOX, overlay=True)
    # Each map of what can just be drawn; of what cannot there is none, whatever its kind.
    asked = [*((kind, 1e20) for kind in MapKind), (MapKind.DISTANCE, 1e60), (MapKind.VOLUME, 1e149)]
    for kind, far in asked:
        editor.look(map=kind)
        moved = edits.move(editor.committed, name, Side.DESTINATION, (far, 0.0, 0.0))
        editor.preview(moved)
        user.settle()
        editor.commit(moved, "Move")
        user.settle()
        if far > 1e37:
            assert "range of numbers" in window.parts.warps.result.problem
            assert "range of numbers" in window.parts.penalty.panel.warning.text()
        editor.undo()
        user.settle()
    assert np.array_equal(window.parts.warps.result.vertices, before)
    assert window.parts.warps.result.problem is None


def test_a_mesh_that_cannot_be_drawn_is_refused_in_words(user, dialogs, tmp_path):
    user.open_sample()
    file = tmp_path / "far.ply"
    write_mesh(file, bone().with_vertices(1e60 * bone().vertices))
    kept = user.session.source
    dialogs.opens.append(file)
    user.window.actions_by_key["open_source"].trigger()
    user.settle()
    assert any("cannot be drawn" in " ".join(map(str, said)) for said in dialogs.errors)
    assert user.session.source is kept
