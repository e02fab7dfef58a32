"""User stories: maps of the warp, their legend, folds, and where the next landmark helps most."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest
from qtpy.QtCore import QPoint, QPointF, Qt
from qtpy.QtGui import QImage
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication
from tests.gui.test_detail import large

from pinwarp.core.findings import FindingKind
from pinwarp.core.landmarks import Side, as_position, positions
from pinwarp.core.maps import MapKind
from pinwarp.gui.maps.presenter import MAP_ACTIONS
from pinwarp.gui.scene.drawables import Badge, Colouring, FoldedSurface, Ghost, Star, WorkWords
from pinwarp.gui.style.colour_scale import ColourScale
from pinwarp.io.samples import assets_folder
from pinwarp.session import edits
from pinwarp.session.guide import with_template
from pinwarp.session.judging import survey as surveys
from pinwarp.session.judging.survey import Surveyor

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
SHIFT = Qt.KeyboardModifier.ShiftModifier

__all__ = ["large"]


@pytest.fixture
def sample(user):
    user.open_sample()
    return user


def there(user):
    return user.window.viewports[DESTINATION]


def choose(user, kind):
    """Choose a map from the menu View > Maps."""
    user.trigger(MAP_ACTIONS[kind])


def overlay(user, name="overlay"):
    """The actor of the warped source."""
    return there(user).renderer.actors[name]


def is_coloured(user, name="overlay"):
    """Whether the warped source shows a map: in the scene, and as it is rendered."""
    coloured = bool(overlay(user, name).mapper.GetScalarVisibility())
    assert coloured == (there(user).drawn(Colouring) is not None)
    return coloured


def levels(user, name="overlay"):
    """What the vertices of the warped source are coloured by."""
    return np.array(overlay(user, name).mapper.dataset.point_data["map"])


def folds_drawn(user):
    """Whether folds are drawn: in the scene, and as they are rendered."""
    rendered = "folds" in there(user).renderer.actors
    assert rendered == (there(user).drawn(FoldedSurface) is not None)
    return rendered


def colours_on_the_bone(user):
    """The colours of the destination's picture where no sign, label or legend lies."""
    viewport = there(user)
    user.settle()
    viewport.layer.hide()
    QApplication.processEvents()
    image = viewport.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    viewport.layer.show()
    assert image.width() == viewport.width()
    row = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), -1)
    pixels = row[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(int)
    places = [
        (x, y)
        for y in range(40, viewport.height() - 40, 6)
        for x in range(0, viewport.map_legend.x() if viewport.map_legend.isVisible() else 300, 6)
        if viewport.pick(QPointF(x, y)) is not None
    ]
    return np.array([pixels[y, x] for x, y in places])


def hues(pixels):
    """The share of pixels that are clearly yellow or green, and clearly blue."""
    r, g, b = pixels.T
    return np.mean(g > b + 25), np.mean(b > r + 25)


def test_a_map_chosen_from_the_menu_colours_the_warped_source_and_leaves_when_it_is_switched_off(
    sample,
):
    actor = overlay(sample)
    plain = colours_on_the_bone(sample)
    choose(sample, MapKind.UNCERTAINTY)
    mapped = colours_on_the_bone(sample)
    assert hues(plain)[0] < 0.02
    assert hues(mapped)[0] > 0.2
    assert overlay(sample) is actor, "written in place, not added anew"
    legend = there(sample).map_legend
    assert legend.isVisible()
    assert legend.content.title == "Uncertainty of the warp"
    choose(sample, None)
    assert not legend.isVisible()
    assert np.abs(colours_on_the_bone(sample) - plain).mean() < 1
    assert overlay(sample) is actor


def test_the_key_m_shows_one_map_after_the_other_and_then_none(sample):
    combo = sample.window.parts.maps.panel.choice
    seen = []
    for _ in range(len(MapKind) + 1):
        sample.press(Qt.Key.Key_M)
        seen.append(sample.editor.view.map)
        assert combo.currentIndex() == (list(MapKind).index(seen[-1]) + 1 if seen[-1] else 0)
        assert sample.window.actions_by_key[MAP_ACTIONS[seen[-1]]].isChecked()
    assert seen == [*MapKind, None]


def test_a_map_shows_the_warped_source_even_where_it_was_hidden(sample):
    sample.press(Qt.Key.Key_W)
    assert not sample.editor.view.overlay
    choose(sample, MapKind.VOLUME)
    assert sample.editor.view.overlay
    assert there(sample).map_legend.isVisible()
    sample.press(Qt.Key.Key_W)
    assert not there(sample).map_legend.isVisible(), "a legend without a map"


def test_the_bone_does_not_cover_what_lies_inside_it(sample):
    choose(sample, MapKind.DISTANCE)
    r, g, b = colours_on_the_bone(sample).T
    grey = (np.abs(r - b) < 22) & (np.abs(r - g) < 22)
    assert grey.mean() < 0.1


def test_the_opacity_of_a_map_is_its_own(sample):
    slider = sample.window.parts.overlay.opacity
    before = sample.editor.view.opacity
    choose(sample, MapKind.VOLUME)
    assert slider.value() == 100
    for _ in range(2):
        QTest.keyClick(slider, Qt.Key.Key_PageDown)
    sample.settle()
    assert sample.editor.view.map_opacity == 0.8
    sample.settle()
    assert overlay(sample).prop.opacity == 0.8
    choose(sample, None)
    assert sample.editor.view.opacity == before
    assert slider.value() == round(100 * before)
    assert overlay(sample).prop.opacity == before


def test_the_overlay_is_plain_while_a_landmark_is_dragged_and_coloured_when_it_rests(sample):
    choose(sample, MapKind.DISTANCE)
    before = levels(sample)
    layer = there(sample).layer
    marker = next(
        m
        for m, hidden in zip(layer.markers, layer.hidden(), strict=True)
        if not hidden and m.movable
    )
    start = sample.place_of(DESTINATION, marker.position)
    end = start + QPoint(0, 20)
    sample.drag(there(sample), start, end, release=False)
    assert not is_coloured(sample)
    assert overlay(sample).prop.opacity == sample.editor.view.opacity
    QTest.mouseRelease(
        there(sample), Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, end
    )
    sample.settle()
    assert is_coloured(sample)
    after = levels(sample)
    assert np.abs(after - before).max() > 0.01
    sample.drag(there(sample), end, end + QPoint(6, 10), release=False)
    assert not is_coloured(sample)
    QTest.keyClick(there(sample), Qt.Key.Key_Escape)
    sample.settle()
    assert is_coloured(sample), "a cancelled drag leaves the map of the warp that is back"
    assert np.array_equal(levels(sample), after)


def test_a_click_on_the_legend_fixes_its_range_while_the_penalty_changes_and_another_frees_it(
    sample,
):
    choose(sample, MapKind.DISTANCE)
    legend, panel = there(sample).map_legend, sample.window.parts.maps.panel
    before = legend.content
    assert not before.fixed
    QTest.mouseClick(legend, Qt.MouseButton.LeftButton)
    sample.settle()
    assert legend.content.fixed
    assert panel.fixed.isChecked()
    sample.editor.commit(edits.set_penalty(sample.session, float("inf")), "Change penalty")
    sample.settle()
    assert legend.content.range == before.range
    assert legend.content.clipped == (False, True), "worse than the fixed range shows"
    assert sample.window.parts.maps.survey.map.range[1] > before.range[1]
    sample.press(Qt.Key.Key_M)
    assert not legend.content.fixed, "each map has its own range"
    choose(sample, MapKind.DISTANCE)
    assert legend.content.fixed
    QTest.mouseClick(legend, Qt.MouseButton.LeftButton)
    sample.settle()
    assert not legend.content.fixed
    assert legend.content.range == sample.window.parts.maps.survey.map.range


def type_into(line, text):
    QTest.mouseClick(line, Qt.MouseButton.LeftButton)
    line.selectAll()
    QTest.keyClicks(line, text)
    QTest.keyClick(line, Qt.Key.Key_Return)


def show_panel(user):
    user.window.findChild(type(user.window.parts.maps.panel.parentWidget()), "map").raise_()
    user.settle()


def test_a_range_typed_into_the_panel_is_the_legends_and_nonsense_is_refused_in_words(sample):
    show_panel(sample)
    choose(sample, MapKind.VOLUME)
    panel, legend = sample.window.parts.maps.panel, there(sample).map_legend
    assert not panel.high.isEnabled()
    QTest.mouseClick(
        panel.fixed, Qt.MouseButton.LeftButton, pos=QPoint(8, panel.fixed.height() // 2)
    )
    type_into(panel.low, "0,5")
    type_into(panel.high, "3")
    sample.settle()
    assert (legend.content.kind, legend.content.range) == (MapKind.VOLUME, (0.5, 3.0))
    ticks = ColourScale(legend.content.kind, legend.content.range).ticks()
    assert [tick.text for tick in ticks] == ["½", "1", "2"]
    type_into(panel.low, "-1")
    sample.settle()
    assert "above 0" in panel.note.text()
    assert panel.note.isVisible()
    assert legend.content.range == (0.5, 3.0)
    assert panel.low.text() == "0.5"
    QTest.mouseClick(
        panel.automatic, Qt.MouseButton.LeftButton, pos=QPoint(8, panel.automatic.height() // 2)
    )
    assert sample.editor.view.map_range is None


def test_the_legend_gives_way_to_caption_and_scale_bar_and_labels_give_way_to_it(sample):
    choose(sample, MapKind.DISTANCE)
    viewport = there(sample)
    legend, line = viewport.map_legend.geometry(), viewport.fontMetrics().height()
    assert legend.top() > 12 + 1.9 * line
    assert legend.bottom() < viewport.height() - 14 - 7 - line
    beside = QPointF(legend.left() - 30, legend.center().y())
    assert viewport.layer.room_at(beside) == legend.left()
    assert viewport.layer.room_at(QPointF(beside.x(), viewport.height() - 20)) == viewport.width()


def test_the_overall_difference_in_size_can_be_taken_out(sample):
    show_panel(sample)
    choose(sample, MapKind.VOLUME)
    box = sample.window.parts.maps.panel.relative
    before = sample.window.parts.maps.survey.map
    assert before.overall == 1
    QTest.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(8, box.height() // 2))
    sample.settle()
    after = sample.window.parts.maps.survey.map
    assert np.allclose(after.values, before.values / after.overall**3, rtol=1e-5)
    assert 0.9 < after.median < 1.1 < 1.2 * before.median + 0.2
    assert "relative" in there(sample).map_legend.content.note


def test_the_figures_of_the_real_femur_are_read_off_the_panel(user, shared_data):
    folder = shared_data / "opensim-creator-femur"
    for side, name in ((SOURCE, "femur_r.obj"), (DESTINATION, "subject_femur_r.obj")):
        user.window.parts.documents.open_mesh(side, folder / name)
    user.settle()
    for side, name in (
        (SOURCE, "femur_r_warp.landmarks.csv"),
        (DESTINATION, "subject_femur_r.landmarks.csv"),
    ):
        user.dialogs.opens.append(folder / name)
        user.trigger(f"import_{side.value}")
    user.editor.commit(edits.set_unit(user.session, "m"), "Change unit")
    choose(user, MapKind.DISTANCE)
    figures = user.window.parts.maps.survey.map.comparison.forward_figures
    assert figures.mean == pytest.approx(2.25e-3, rel=0.02)
    assert figures.percentile_95 == pytest.approx(5.40e-3, rel=0.02)
    assert figures.maximum == pytest.approx(7.63e-3, rel=0.02)
    text = user.window.parts.maps.panel.figures.text()
    for value in ("2.25 mm", "5.40 mm", "7.63 mm"):
        assert value in text


def test_without_bones_or_pairs_the_panel_says_what_is_missing(user):
    note = user.window.parts.maps.panel.note
    choose(user, MapKind.UNCERTAINTY)
    assert "Open the source mesh" in note.text()
    assert note.text() in user.window.statusBar().currentMessage()
    user.open_sample_meshes()
    assert "Place a landmark on both bones" in note.text()
    for position in user.places_down_the_bone(SOURCE, 4)[:2]:
        user.click_position(SOURCE, position)
        user.click_position(DESTINATION, user.places_down_the_bone(DESTINATION, 4)[0])
    assert "three pairs" in note.text()
    assert not there(user).map_legend.isVisible()
    assert not user.window.parts.maps.panel.place_next.isVisible()
    # It is told no longer than it is true, nor of another map than is wanted.
    choose(user, MapKind.DISTANCE)
    choose(user, MapKind.UNCERTAINTY)
    assert "three pairs" in user.window.statusBar().currentMessage()
    for side, row in ((DESTINATION, 1), (SOURCE, 2), (DESTINATION, 2)):
        user.click_position(side, user.places_down_the_bone(side, 4)[row])
    assert user.window.parts.maps.is_coloured
    assert user.window.statusBar().currentMessage() == ""


def test_opening_another_destination_measures_the_distance_to_it(sample, tmp_path):
    choose(sample, MapKind.DISTANCE)
    before = sample.window.parts.maps.survey.map
    sample.window.parts.documents.open_mesh(DESTINATION, assets_folder() / "femur_generic.ply")
    sample.settle()
    assert sample.window.parts.maps.survey.map.median > 2 * before.median


# Folds


@pytest.fixture
def folded(sample):
    """The sample with the destinations of two neighbours exchanged."""
    pairs = sample.session.pairs
    source = positions(pairs, SOURCE)
    apart = np.linalg.norm(source[:, None] - source, axis=2) + 1e9 * np.eye(len(pairs))
    i, j = np.unravel_index(apart.argmin(), apart.shape)
    session = sample.session
    for a, b in ((i, j), (j, i)):
        session = edits.move(session, pairs[a].name, DESTINATION, pairs[b].destination)
    sample.told = []
    sample.window.parts.maps.folds_changed.connect(sample.told.append)
    sample.editor.commit(session, "Exchange")
    sample.settle()
    sample.names = {pairs[i].name, pairs[j].name}
    return sample


def test_a_fold_is_told_in_the_status_bar_and_a_click_selects_the_landmarks(folded):
    button = folded.window.parts.findings.fold_note
    assert button.isVisible()
    count = folded.window.parts.maps.survey.folds.count
    assert button.text().startswith(f"{count:,} vertices fold near ")
    assert all(name in button.text() for name in folded.names)
    (findings,) = folded.told
    assert {finding.kind for finding in findings} == {FindingKind.FOLD}
    distance = there(folded).camera.distance
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    folded.settle()
    assert set(folded.editor.selection.names) == folded.names
    assert there(folded).camera.distance < distance, "they are looked at from nearby"
    folded.trigger("undo")
    assert not button.isVisible()
    assert folded.told[-1] == ()


def test_a_fold_stands_in_the_list_behind_the_swap_that_makes_it(folded):
    kinds = [row.found.finding.kind for row in folded.window.parts.findings.panel.rows]
    assert kinds[0] is FindingKind.SWAPPED
    assert FindingKind.FOLD in kinds
    folded.trigger("undo")
    assert folded.window.parts.findings.panel.rows == []


def test_a_fold_shines_through_the_bone_with_and_without_a_map_and_goes_with_its_cause(folded):
    QTest.mouseClick(folded.window.parts.findings.fold_note, Qt.MouseButton.LeftButton)
    folded.settle()

    def loud():
        r, g, b = colours_on_the_bone(folded).T
        return np.mean((r > g + 60) & (g > b + 15))

    for kind in (None, MapKind.DISTANCE):
        choose(folded, kind)
        assert folds_drawn(folded)
        assert loud() > 0.003
        folded.press(Qt.Key.Key_2)
        # From afar the names of the selected landmarks cover so small a patch.
        folded.press(Qt.Key.Key_F)
        assert loud() > 0.0005
        folded.press(Qt.Key.Key_1)
        folded.press(Qt.Key.Key_F)
    folded.press(Qt.Key.Key_W)
    assert loud() == 0
    folded.press(Qt.Key.Key_W)
    folded.trigger("undo")
    assert not folds_drawn(folded)
    assert loud() == 0


def test_a_renamed_landmark_is_renamed_in_the_status_bar(folded):
    name = sorted(folded.names)[0]
    folded.editor.commit(edits.rename(folded.session, name, "apex"), "Rename")
    folded.settle()
    assert "apex" in folded.window.parts.findings.fold_note.text()


def test_no_actor_is_left_over_when_maps_and_folds_come_and_go(folded):
    def actors():
        return sorted(there(folded).renderer.actors)

    before = actors()
    for _ in range(2):
        for _ in range(len(MapKind) + 1):
            folded.press(Qt.Key.Key_M)
        folded.trigger("undo")
        folded.trigger("redo")
    assert actors() == before
    folded.trigger("undo")
    assert not any("fold" in name for name in actors())


# The next landmark


def test_the_suggested_place_is_far_from_landmarks_and_taken_by_a_key(sample):
    here = sample.window.viewports[SOURCE]
    assert here.drawn(Star) is None
    sample.press(Qt.Key.Key_Space, SHIFT)
    assert "uncertainty" in sample.window.statusBar().currentMessage()
    choose(sample, MapKind.UNCERTAINTY)
    assert sample.window.statusBar().currentMessage() == ""
    suggestion = here.drawn(Star).suggestion
    place = np.array(suggestion.position)
    assert here.surface.closest(place)[1] < 1e-4 * here.surface.diagonal
    taken = positions(sample.session.pairs, SOURCE)
    vertices = sample.session.mesh(SOURCE).vertices
    nearest = np.linalg.norm(vertices[:, None] - taken, axis=2).min(axis=1)
    assert np.linalg.norm(taken - place, axis=1).min() > np.percentile(nearest, 90)
    count = len(sample.session.landmarks)
    sample.press(Qt.Key.Key_Space, SHIFT)
    assert len(sample.session.landmarks) == count + 1
    new = sample.session.landmarks[-1]
    assert new.source == suggestion.position
    assert sample.editor.selection.names == (new.name,)
    assert here.drawn(Star) is None, "it is there now"
    assert there(sample).drawn(Ghost).name == new.name
    sample.press(Qt.Key.Key_Space, SHIFT)
    assert f"{new.name} is there already" in sample.window.statusBar().currentMessage()
    sample.press(Qt.Key.Key_Space)
    assert sample.session.landmark(new.name).is_complete
    following = here.drawn(Star).suggestion
    assert following.position != suggestion.position
    assert following.deviation < 1.05 * suggestion.deviation


def test_the_suggested_place_respects_locks_guide_and_waiting_landmarks(sample):
    choose(sample, MapKind.UNCERTAINTY)
    landmarks = sample.session.landmarks
    sample.press(Qt.Key.Key_L)
    sample.press(Qt.Key.Key_Space, SHIFT)
    assert sample.session.landmarks == landmarks
    assert "locked" in sample.window.statusBar().currentMessage()
    sample.press(Qt.Key.Key_L)
    sample.click(DESTINATION, sample.free_place(DESTINATION))
    waiting = sample.session.landmarks[-1]
    assert waiting.source is None
    sample.press(Qt.Key.Key_Space, SHIFT)
    assert sample.session.landmark(waiting.name).source is None
    assert waiting.name in sample.window.statusBar().currentMessage()
    sample.trigger("undo")
    sample.editor.commit(with_template(sample.session, ["apex"]), "Load template")
    sample.press(Qt.Key.Key_G)
    assert sample.editor.view.guided == "apex"
    sample.press(Qt.Key.Key_Space, SHIFT)
    assert sample.session.landmark("apex").source is not None


def test_the_panel_has_a_button_for_the_suggested_place(sample):
    show_panel(sample)
    choose(sample, MapKind.UNCERTAINTY)
    button = sample.window.parts.maps.panel.place_next
    assert button.isVisible()
    count = len(sample.session.landmarks)
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    sample.settle()
    assert len(sample.session.landmarks) == count + 1
    assert not button.isEnabled()
    name = sample.session.landmarks[-1].name
    assert sample.window.parts.maps.panel.advice.text().startswith(
        f"{name} stands where it helps most"
    )


# Large meshes


def test_a_stand_in_is_coloured_like_the_mesh_it_stands_for(large):
    choose(large, MapKind.VOLUME)
    viewport = there(large)
    coarse, all_levels = levels(large, "overlay stand-in"), levels(large)
    picked = np.linspace(0, len(coarse) - 1, 40).astype(int)
    vertices = large.session.mesh(SOURCE).vertices
    stand_in = large.window.viewports[SOURCE].surface.stand_in
    for row in picked:
        away = np.linalg.norm(vertices - stand_in.vertices[row], axis=1)
        # Of two that are as near either will do.
        assert coarse[row] in all_levels[away <= away.min() * (1 + 1e-6)]
    viewport.set_orbiting(True)
    assert is_coloured(large, "overlay stand-in")
    assert viewport.renderer.actors["overlay stand-in"].GetVisibility()
    viewport.set_orbiting(False)


def test_a_survey_that_comes_too_late_is_dropped(sample, monkeypatch):
    maps, gate, begun = sample.window.parts.maps, threading.Event(), []
    real = Surveyor.survey

    def slow(self, result, *args, **options):
        begun.append(result)
        assert gate.wait(30)
        return real(self, result, *args, **options)

    monkeypatch.setattr(Surveyor, "survey", slow)
    shown = []
    maps.map_changed.connect(shown.append)
    sample.window.actions_by_key["map_distance"].trigger()
    sample.qtbot.waitUntil(lambda: len(begun) == 1)
    late = begun[0]
    name = sample.session.pairs[0].name
    place = np.array(sample.session.pairs[0].destination) + 3.0
    session = edits.move(sample.session, name, DESTINATION, as_position(place))
    sample.editor.commit(session, "Move")
    window = sample.window
    sample.qtbot.waitUntil(
        lambda: window.parts.warps.result is not late and window.scenes.is_settled, timeout=30_000
    )
    assert not is_coloured(sample)
    gate.set()
    sample.settle()
    assert [survey.result for survey in shown] == [sample.window.parts.warps.result]
    assert is_coloured(sample)


@pytest.fixture
def endless(monkeypatch):
    """The distance takes for ever, unless it is stopped at a checkpoint: that is told."""
    ended = []

    def never(*given):
        checkpoint = given[-1]
        try:
            while True:
                checkpoint(0.5)
                time.sleep(0.002)
        finally:
            ended.append(True)

    monkeypatch.setattr(surveys, "distance_map", never)
    return ended


def wait_for_the_bar(user):
    """Choose the map that takes for ever, and wait until the panel says that it works."""
    work = user.window.parts.maps.panel.work
    user.window.actions_by_key["map_distance"].trigger()
    user.qtbot.waitUntil(lambda: there(user).drawn(WorkWords) is not None)
    assert not work.isHidden()
    user.qtbot.waitUntil(lambda: work.bar.value() > 40)
    user.qtbot.waitUntil(lambda: f"{work.bar.value()} %" in there(user).drawn(WorkWords).words)
    assert there(user).drawn(WorkWords).words.startswith("Distance to the destination: ")
    return work


def test_what_a_held_key_shows_and_what_is_being_made_are_said_at_once(sample, endless):
    sample.editor.commit(edits.set_penalty(sample.session, 40.0), "Change penalty")
    sample.settle()
    work = wait_for_the_bar(sample)
    QTest.keyPress(sample.window, Qt.Key.Key_B)
    view = there(sample)
    sample.qtbot.waitUntil(lambda: None not in (view.drawn(Badge), view.drawn(WorkWords)))
    QTest.keyRelease(sample.window, Qt.Key.Key_B)
    sample.qtbot.waitUntil(lambda: view.drawn(Badge) is None)
    sample.qtbot.waitUntil(lambda: not work.isHidden())
    QTest.mouseClick(work.stop, Qt.MouseButton.LeftButton)
    sample.settle()
    assert view.drawn(WorkWords) is None


def test_a_slow_map_says_how_far_it_is_and_is_stopped_by_esc_or_its_button(sample, endless):
    sample.editor.select(sample.session.pairs[0].name)
    work = wait_for_the_bar(sample)
    sample.press(Qt.Key.Key_Escape)
    assert sample.editor.view.map is None
    assert len(endless) == 1
    assert sample.editor.selection.names, "Esc stops what is slow before it deselects"
    assert work.isHidden()
    assert there(sample).drawn(WorkWords) is None
    sample.press(Qt.Key.Key_Escape)
    assert not sample.editor.selection.names
    wait_for_the_bar(sample)
    QTest.mouseClick(work.stop, Qt.MouseButton.LeftButton)
    sample.settle()
    assert sample.editor.view.map is None
    assert len(endless) == 2
    assert work.isHidden()


def test_a_slow_map_ends_for_another_one_for_a_drag_and_with_its_window(sample, endless):
    work = wait_for_the_bar(sample)
    choose(sample, MapKind.VOLUME)
    assert len(endless) == 1
    assert work.isHidden()
    assert is_coloured(sample)
    wait_for_the_bar(sample)
    pair = sample.session.pairs[0]
    place = as_position(np.array(pair.destination) + 1.0)
    sample.editor.preview(edits.move(sample.session, pair.name, DESTINATION, place))
    sample.qtbot.waitUntil(lambda: len(endless) == 2)
    sample.editor.cancel_preview()
    sample.qtbot.waitUntil(lambda: not work.isHidden() and work.bar.value() > 40)
    sample.window.close()
    assert len(endless) == 3
