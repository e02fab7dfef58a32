"""User stories: applying only a part of the warp."""

from __future__ import annotations

import numpy as np
import pytest
from qtpy.QtCore import QPoint

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.landmarks import LandmarkState, Side, positions
from pinwarp.io.meshes import read_mesh

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


def fit_of(user, scaling):
    return fit_similarity(*(positions(user.session.pairs, s) for s in Side), scaling=scaling)


@pytest.mark.parametrize(("key", "scaling"), [("apply_rigid", False), ("apply_similarity", True)])
def test_a_fit_is_shown_and_exported_and_the_status_bar_says_so(user, tmp_path, key, scaling):
    user.open_sample()
    there = user.window.viewports[DESTINATION]
    warped = there.overlay_points
    user.trigger(key)
    expected = fit_of(user, scaling).apply(user.session.mesh(SOURCE).vertices)
    assert np.allclose(there.overlay_points, expected, atol=1e-3)
    note = user.window.parts.warp.note
    assert note.isVisible()
    assert note.text().startswith("Shown and exported:")
    path = tmp_path / "out.ply"
    user.dialogs.saves.append(path)
    user.trigger("export_mesh")
    assert np.allclose(read_mesh(path).mesh.vertices, expected)
    assert "fit only" in user.window.statusBar().currentMessage()
    user.trigger("undo")
    assert np.allclose(there.overlay_points, warped)
    assert note.text() == ""


def test_without_pose_is_drawn_over_the_destination_and_exported_in_the_source_frame(
    user, tmp_path
):
    user.open_sample()
    there = user.window.viewports[DESTINATION]
    warped = there.overlay_points
    user.trigger("apply_without_pose")
    assert np.allclose(there.overlay_points, warped)
    path = tmp_path / "out.ply"
    user.dialogs.saves.append(path)
    user.trigger("export_mesh")
    exported = read_mesh(path).mesh.vertices
    back = fit_of(user, scaling=False)
    assert np.allclose(back.apply(exported), warped, atol=1e-3)
    assert not np.allclose(exported, warped, atol=1.0)


def test_the_fitted_source_follows_a_drag_and_carries_its_passengers(user):
    user.open_sample()
    user.trigger("apply_rigid")
    there = user.window.viewports[DESTINATION]
    before = there.overlay_points

    def passengers():
        return np.array([m.position for m in there.layer.markers if not m.movable])

    sources = [x.source for x in user.session.landmarks if x.state is LandmarkState.PASSENGER]
    assert np.allclose(passengers(), fit_of(user, scaling=False).apply(sources))
    marker = next(
        m
        for m, hidden in zip(there.layer.markers, there.layer.hidden(), strict=True)
        if not hidden and m.movable
    )
    start = user.place_of(DESTINATION, marker.position)
    user.drag(there, start, start + QPoint(0, 25))
    assert not np.allclose(there.overlay_points, before)
    expected = fit_of(user, scaling=False).apply(user.session.mesh(SOURCE).vertices)
    assert np.allclose(there.overlay_points, expected, atol=1e-3)
