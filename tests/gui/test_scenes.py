"""One scene: who draws what, how often it is shown, and that only what is new is drawn."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt
from qtpy.QtTest import QTest

from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.drawables import Badge, Bone, Drawable, GridLines, Hint, Overlay
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.views.scenes import Scenes
from pinwarp.session import edits
from pinwarp.session.view import GridKind

SOURCE, DESTINATION = Side


@pytest.fixture
def sample(user):
    user.open_sample()
    return user


def moved(user, by):
    """The session with a landmark moved aside, by so many millimetres."""
    landmark = user.editor.committed.pairs[0]
    place = tuple(np.add(landmark.destination, (by, 0, 0)).tolist())
    return edits.move(user.editor.committed, landmark.name, DESTINATION, place)


def test_every_kind_of_drawable_is_drawn_by_somebody(user):
    for viewport in user.window.viewports.values():
        assert viewport.drawn_kinds == set(get_args(Drawable))


def test_a_scene_with_two_of_a_kind_is_refused():
    with pytest.raises(ValueError, match="Badge"):
        Scene(SOURCE, (Badge("one"), Hint("here"), Badge("another")))


def test_large_arrays_are_compared_by_identity():
    lines = np.zeros((2, 3, 3))
    grid = GridLines(lines)
    before = Scene(SOURCE, (grid,))
    assert not Scene(SOURCE, (grid,)).changed_since(before)
    assert Scene(SOURCE, (GridLines(lines),)).changed_since(before) == {GridLines}


def test_one_commit_shows_two_scenes_and_none_of_the_other_side(sample):
    scenes, viewports = sample.window.scenes, sample.window.viewports
    source = viewports[SOURCE].scene
    before, renders = scenes.shows, viewports[SOURCE].renders
    sample.editor.commit(moved(sample, 1.0), "Move")
    sample.settle()
    # The landmark at once; then the warp, together with the quality of the pairs.
    assert scenes.shows - before == 2
    assert viewports[SOURCE].scene is source
    assert viewports[SOURCE].renders == renders


def test_ten_previews_and_a_drop_show_no_scene_twice(sample):
    scenes, window = sample.window.scenes, sample.window
    shows, renders = scenes.shows, window.viewports[DESTINATION].renders
    for step in range(1, 11):
        sample.editor.preview(moved(sample, 0.3 * step))
        sample.qtbot.waitUntil(
            lambda: window.parts.warps.is_settled and scenes.is_settled, timeout=30_000
        )
    sample.editor.commit(moved(sample, 3.0), "Move")
    sample.settle()
    # Each landmark at once and each warp; fewer where the two arrive in one turn.
    assert 11 <= scenes.shows - shows <= 22
    assert window.viewports[DESTINATION].renders - renders <= 22


def test_what_is_said_many_times_in_one_turn_is_shown_once(sample):
    before = sample.window.scenes.shows
    sample.editor.select(sample.session.landmarks[0].name)
    sample.editor.look(grid=GridKind.BOX, overlay=False)
    sample.editor.look(opacity=0.3, section=0.2)
    sample.editor.look(wireframe=True)
    assert sample.window.scenes.shows == before, "in a turn of its own"
    sample.window.scenes.show_now()
    assert sample.window.scenes.shows == before + len(Side)
    there = sample.window.viewports[DESTINATION]
    assert not there.drawn(Overlay).visible
    assert there.drawn(Bone).wireframe


def test_an_overlay_is_written_in_place_and_only_where_it_is_another(sample):
    there = sample.window.viewports[DESTINATION]
    actor, warp = there.renderer.actors["overlay"], there.drawn(Overlay).full
    data = actor.mapper.dataset
    sample.editor.look(opacity=0.3)
    sample.settle()
    assert there.drawn(Overlay).full is warp
    written = data.GetPoints().GetMTime()
    sample.editor.look(opacity=0.4)
    sample.settle()
    assert data.GetPoints().GetMTime() == written
    sample.editor.commit(moved(sample, 2.0), "Move")
    sample.settle()
    assert there.drawn(Overlay).full is not warp
    assert there.renderer.actors["overlay"] is actor
    assert actor.mapper.dataset is data
    assert data.GetPoints().GetMTime() > written


def test_a_contributor_that_fails_is_told_and_the_others_are_still_shown(user, capture_faults):
    class Fails:
        def drawables(self, _side):
            raise RuntimeError("nothing to show")

    class Works:
        def drawables(self, _side):
            yield Badge("seen")

    scenes = Scenes(user.window.viewports, user.window)
    scenes.show_from(Fails(), Works())
    scenes.show_now()
    assert all(view.drawn(Badge) == Badge("seen") for view in user.window.viewports.values())
    assert capture_faults == ["nothing to show", "nothing to show"]
    scenes.shut_down()


@pytest.fixture
def capture_faults(monkeypatch):
    told = []
    monkeypatch.setattr("sys.excepthook", lambda _kind, error, _where: told.append(str(error)))
    return told


def test_a_drag_ends_with_the_landmark_the_warp_and_the_table_agreeing(sample):
    """All of a result is shown in one turn: no overlay without its arrows."""
    there = sample.window.viewports[DESTINATION]
    marker = next(
        m
        for m, hidden in zip(there.layer.markers, there.layer.hidden(), strict=True)
        if not hidden and m.movable
    )
    start = sample.place_of(DESTINATION, marker.position)
    sample.drag(there, start, start + QPoint(0, 15), release=False)
    QTest.mouseRelease(
        there, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, start + QPoint(0, 15)
    )
    sample.settle()
    shown = there.drawn(Overlay).full.vertices
    assert np.allclose(shown, sample.window.parts.warps.result.vertices)
    assert np.allclose(there.overlay_points, shown)
