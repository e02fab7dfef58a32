"""User stories: what the warp does, on the panel beside the landmarks."""

from __future__ import annotations

import numpy as np
import pytest
from qtpy.QtCore import QEvent, QPoint, Qt
from qtpy.QtGui import QHelpEvent
from qtpy.QtTest import QTest
from qtpy.QtWidgets import (
    QApplication,
    QDialog,
    QDockWidget,
    QStyle,
    QStyleOptionSlider,
    QTabBar,
    QToolTip,
)

from pinwarp.core.alignment import decompose, fit_similarity
from pinwarp.core.components import Components
from pinwarp.core.factor import factorise
from pinwarp.core.landmarks import Side, positions
from pinwarp.core.spline import solve
from pinwarp.gui.warp.blend_player import FRAMES
from pinwarp.io.meshes import read_mesh

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def panel(user):
    user.open_sample()
    show_panel(user)
    return user.window.parts.warp.panel


def show_panel(user):
    (bar,) = user.window.findChildren(QTabBar)
    tabs = {bar.tabText(i): i for i in range(bar.count())}
    QTest.mouseClick(bar, LEFT, pos=bar.tabRect(tabs["Warp"]).center())
    user.settle()


def handle_at(slider, value):
    """Where the middle of a slider's handle is at a value."""
    option = QStyleOptionSlider()
    slider.initStyleOption(option)
    option.sliderPosition = value
    return (
        slider.style()
        .subControlRect(
            QStyle.ComplexControl.CC_Slider, option, QStyle.SubControl.SC_SliderHandle, slider
        )
        .center()
    )


def slide(user, slider, value, release=True):
    user.drag(slider, handle_at(slider, slider.value()), handle_at(slider, value), release=release)


def choose(user, panel, part):
    row = panel.components.rows[part]
    # On its words, not on its button.
    QTest.mouseClick(row.meaning, LEFT)
    user.settle()


def overlay(user):
    return user.window.viewports[DESTINATION].overlay_points


def exported(user, tmp_path):
    path = tmp_path / "out.ply"
    user.dialogs.saves.append(path)
    user.trigger("export_mesh")
    return read_mesh(path).mesh.vertices


def aligned_source(user):
    fit = fit_similarity(*(positions(user.session.pairs, s) for s in Side), scaling=False)
    return fit.apply(user.session.mesh(SOURCE).vertices)


def warp_of(session):
    factor = factorise(positions(session.pairs, SOURCE))
    return factor, solve(factor, positions(session.pairs, DESTINATION), session.settings.penalty)


# The panel


def test_the_panel_stands_behind_the_landmarks(user):
    docks = {name: user.window.findChild(QDockWidget, name) for name in ("landmarks", "warp")}
    assert docks["warp"] in user.window.tabifiedDockWidgets(docks["landmarks"])
    assert not user.window.parts.table.panel.table.visibleRegion().isEmpty()
    assert user.window.parts.warp.panel.components.visibleRegion().isEmpty()
    show_panel(user)
    assert not user.window.parts.warp.panel.components.visibleRegion().isEmpty()
    assert user.window.parts.table.panel.table.visibleRegion().isEmpty()


@pytest.mark.parametrize("unit", ["mm", "m"])
def test_nothing_is_cut_off_in_a_small_window(user, panel, unit):
    user.window.resize(1280, 720)
    while user.session.unit != unit:
        user.window.parts.penalty.panel.unit.setFocus()
        user.press(Qt.Key.Key_Down, widget=user.window.parts.penalty.panel.unit)
    user.settle()
    assert not panel.horizontalScrollBar().isVisible()
    assert not panel.verticalScrollBar().isVisible()


# Components


def test_a_click_on_a_part_applies_it_to_screen_and_export_and_can_be_undone(user, panel, tmp_path):
    whole = overlay(user)
    choose(user, panel, Components.RIGID)
    assert user.session.settings.components is Components.RIGID
    expected = aligned_source(user)
    assert np.allclose(overlay(user), expected, atol=1e-3)
    assert np.allclose(exported(user, tmp_path), expected)
    assert user.window.actions_by_key["apply_rigid"].isChecked()
    assert not panel.blend.isEnabled(), "there is nothing between the aligned source and itself"
    user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert np.allclose(overlay(user), whole)
    assert panel.components.rows[Components.FULL].button.isChecked()
    assert panel.blend.isEnabled()


def test_the_menu_and_the_arrow_keys_choose_as_well(user, panel):
    user.trigger("apply_affine")
    button = panel.components.rows[Components.AFFINE].button
    assert button.isChecked()
    button.setFocus()
    user.press(Qt.Key.Key_Down, widget=button)
    assert user.session.settings.components is Components.SIMILARITY


def test_each_part_says_what_it_leaves_between_the_pairs(user, panel):
    def said():
        return [row.rms.text() for row in panel.components.rows.values()]

    affine, similarity, rigid = (f"{x:.2f} mm" for x in (4.73, 4.99, 16.81))
    assert said() == ["0 mm", "0 mm", affine, similarity, rigid]
    assert panel.components.rows[Components.RIGID].bar.share == 1
    user.window.parts.penalty.panel.slider.setFocus()
    user.press(Qt.Key.Key_End, widget=user.window.parts.penalty.panel.slider)
    assert said() == [affine, affine, affine, similarity, rigid], "at the affine end"
    user.window.parts.penalty.panel.unit.setFocus()
    user.press(Qt.Key.Key_Down, widget=user.window.parts.penalty.panel.unit)
    assert said()[-1] == "16.81 cm"


# The blend


def test_the_blend_is_seen_while_it_is_dragged_and_is_one_step_to_undo(user, panel, tmp_path):
    whole, label = overlay(user), user.editor.undo_label
    user.trigger("overlay")
    slide(user, panel.blend, 50, release=False)
    assert user.editor.view.overlay, "what is hidden cannot be seen to change"
    half_way = (whole + aligned_source(user)) / 2
    assert panel.blend_value.text() == "50%"
    assert np.allclose(overlay(user), half_way, atol=1e-3)
    assert user.editor.undo_label == label
    assert user.editor.committed.settings.blend == 1
    QTest.mouseRelease(panel.blend, LEFT, pos=handle_at(panel.blend, 50))
    user.settle()
    assert user.editor.undo_label == "Blend 50%"
    assert np.allclose(exported(user, tmp_path), overlay(user), atol=1e-3)
    assert np.allclose(overlay(user), half_way, atol=1e-3)
    assert "50% of the way" in user.window.parts.warp.note.text()
    user.trigger("undo")
    assert user.editor.undo_label == label
    assert panel.blend.value() == 100
    assert np.allclose(overlay(user), whole)


def test_steps_of_the_keyboard_are_one_step_to_undo(user, panel):
    panel.blend.setFocus()
    for _ in range(3):
        user.press(Qt.Key.Key_Left, widget=panel.blend)
    assert user.session.settings.blend == pytest.approx(0.97)
    assert user.editor.undo_label == "Blend 97%"
    user.trigger("undo")
    assert user.session.settings.blend == 1


def test_a_drag_after_the_keyboard_is_a_step_of_its_own(user, panel):
    panel.blend.setFocus()
    user.press(Qt.Key.Key_PageDown, widget=panel.blend)
    slide(user, panel.blend, 20)
    user.trigger("undo")
    assert user.session.settings.blend == pytest.approx(0.9)


def test_the_blend_goes_to_what_is_applied(user, panel):
    choose(user, panel, Components.AFFINE)
    slide(user, panel.blend, 0)
    assert np.allclose(overlay(user), aligned_source(user), atol=1e-3)
    assert panel.ends[1].text() == "Affine fit"


# Playing it


def test_playing_goes_there_and_back_and_leaves_no_trace(user, panel):
    session, label, whole = user.editor.committed, user.editor.undo_label, overlay(user)
    seen = []

    def remember(session):
        seen.append(session.settings.blend)

    user.editor.session_changed.connect(remember)
    QTest.mouseClick(panel.play, LEFT)
    assert user.window.parts.warp.player.is_playing
    assert "Esc" in user.window.parts.warp.note.text()
    user.qtbot.waitUntil(lambda: not user.window.parts.warp.player.is_playing, timeout=60_000)
    user.settle()
    user.editor.session_changed.disconnect(remember)
    there = np.linspace(0, 1, FRAMES + 1)
    assert seen == pytest.approx([*there, *there[-2::-1], 1])
    assert user.session is session
    assert user.editor.undo_label == label
    assert not user.editor.is_dirty
    assert np.allclose(overlay(user), whole)
    assert user.window.parts.warp.note.text() == ""
    assert not user.window.actions_by_key["play_blend"].isChecked()


def play(user):
    user.window.viewports[SOURCE].setFocus()
    QTest.keyClick(user.window, Qt.Key.Key_B, Qt.KeyboardModifier.ShiftModifier)
    user.qtbot.waitUntil(lambda: 0 < user.session.settings.blend < 1, timeout=10_000)
    assert user.editor.is_previewing


def test_escape_stops_playing_and_does_nothing_else(user, panel):
    user.editor.select(user.session.landmarks[0].name)
    session, selection = user.editor.committed, user.editor.selection
    play(user)
    user.press(Qt.Key.Key_Escape, widget=user.window.viewports[SOURCE])
    assert not user.window.parts.warp.player.is_playing
    assert user.session is session
    assert user.editor.selection == selection


def test_a_click_stops_playing_and_places_nothing(user, panel):
    session, at = user.editor.committed, user.free_place(SOURCE)
    play(user)
    user.click(SOURCE, at)
    assert not user.window.parts.warp.player.is_playing
    assert user.session is session


def test_the_button_stops_what_it_began(user, panel):
    session = user.editor.committed
    play(user)
    QTest.mouseClick(panel.play, LEFT)
    user.settle()
    assert not user.window.parts.warp.player.is_playing
    assert user.session is session


def test_what_is_done_meanwhile_stops_playing_and_stays(user, panel):
    play(user)
    user.trigger("apply_affine")
    assert not user.window.parts.warp.player.is_playing
    assert user.session.settings.components is Components.AFFINE
    assert user.session.settings.blend == 1


def test_a_dialog_stops_playing(user, panel):
    session = user.editor.committed
    play(user)
    dialog = QDialog(user.window)
    dialog.open()
    user.settle()
    assert not user.window.parts.warp.player.is_playing
    assert user.session is session
    dialog.close()


def test_there_is_nothing_to_play_without_pairs(user):
    assert not user.window.actions_by_key["play_blend"].isEnabled()
    user.open_sample()
    assert user.window.actions_by_key["play_blend"].isEnabled()
    user.trigger("apply_rigid")
    assert not user.window.actions_by_key["play_blend"].isEnabled()


# The figures


def figures_of(panel):
    return {row.title: [x.value for x in row.figures] for row in panel.figures.rows}


def test_the_figures_are_those_of_the_affine_fit_and_follow_a_drag(user, panel):
    def expected():
        factor, _ = warp_of(user.session)
        target = positions(user.session.pairs, DESTINATION)
        return decompose(solve(factor, target, np.inf).affine, factor.centre)

    def agree():
        shown, parts = figures_of(panel), expected()
        return (
            np.allclose(shown["Translation"][:3], parts.translation)
            and np.allclose(shown["Rotation"], parts.angle)
            and np.allclose(shown["Scale"], 100 * parts.scales)
            and np.allclose(shown["Shear"], 100 * parts.shears)
            and np.allclose(shown["Principal stretch"], 100 * parts.principal)
        )

    assert agree()
    assert f"{expected().angle:.2f}°" in panel.figures.text()
    before = figures_of(panel)
    user.drag_a_landmark()
    assert figures_of(panel) != before
    assert agree()


def test_the_figures_are_copied_as_a_table_and_no_landmark_with_them(user, panel):
    user.editor.select(user.session.landmarks[0].name)
    QTest.mouseClick(panel.copy, LEFT)
    table = QApplication.clipboard().text()
    lines = table.splitlines()
    assert lines[0] == "quantity\tpart\tvalue\tunit"
    angle = figures_of(panel)["Rotation"][0]
    assert f"Rotation\t\t{angle:.10g}\t°" in lines
    QApplication.clipboard().clear()
    panel.figures.setFocus()
    user.press(Qt.Key.Key_C, Qt.KeyboardModifier.ControlModifier, widget=panel.figures)
    assert QApplication.clipboard().text() == table


def test_selected_figures_are_copied_as_they_are_read(user, panel):
    figures = panel.figures
    text = f"{figures_of(panel)['Rotation'][0]:.2f}°"
    user.drag(figures, QPoint(2, 2), QPoint(figures.width() - 4, figures.sizeHint().height() - 4))
    assert figures.hasSelectedText()
    user.press(Qt.Key.Key_C, Qt.KeyboardModifier.ControlModifier, widget=figures)
    assert text in QApplication.clipboard().text()
    assert "quantity" not in QApplication.clipboard().text()


def test_each_line_of_the_figures_says_what_it_means(user, panel):
    figures = panel.figures
    line = figures.sizeHint().height() / 10
    for number, words in ((0, "middle of the source"), (1, "middle"), (2, "Right-handed")):
        at = QPoint(20, round((number + 0.5) * line))
        QApplication.sendEvent(
            figures, QHelpEvent(QEvent.Type.ToolTip, at, figures.mapToGlobal(at))
        )
        assert words in QToolTip.text()
    QToolTip.hideText()


def test_without_pairs_and_with_few_the_panel_says_what_is_missing(user):
    show_panel(user)
    panel = user.window.parts.warp.panel
    assert panel.sentence.text().startswith("No pair yet")
    assert not panel.figures.isVisible()
    assert not panel.copy.isVisible()
    assert not user.window.actions_by_key["copy_figures"].isEnabled()
    user.open_sample()
    for landmark in user.session.landmarks[2:16]:
        user.editor.select(landmark.name)
        user.trigger("delete_landmark")
    assert len(user.session.pairs) == 2
    assert "on one line" in panel.sentence.text()
    assert panel.figures.isVisible()
