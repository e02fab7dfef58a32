"""User stories: the curve above the slider."""

from __future__ import annotations

import math

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QStyle, QStyleOptionSlider
from tests.gui.pairs import give_pairs, noisy, scattered

from pinwarp.core.spline import PenaltyConvention
from pinwarp.session import edits


@pytest.fixture
def panel(user):
    user.open_sample()
    return user.window.parts.penalty.panel


@pytest.fixture
def noisy_panel(user, panel):
    source = scattered()
    give_pairs(user, source, noisy(source))
    return panel


def handle_centre(panel) -> float:
    """Where the style paints the handle's centre, on the plot's axis."""
    slider, option = panel.slider, QStyleOptionSlider()
    slider.initStyleOption(option)
    handle = slider.style().subControlRect(
        QStyle.ComplexControl.CC_Slider, option, QStyle.SubControl.SC_SliderHandle, slider
    )
    return slider.mapTo(panel, QPoint(0, 0)).x() - panel.plot.x() + handle.x() + handle.width() / 2


def painted_marker(panel) -> float:
    """Where the line of the present penalty is painted: in the columns with the most ink."""
    image = panel.plot.grab().toImage()
    rows = range(panel.plot.fontMetrics().height() + 4, image.height())
    ink = [
        sum(255 - image.pixelColor(x, y).lightness() for y in rows) for x in range(image.width())
    ]
    most = np.flatnonzero(np.array(ink) > 0.9 * max(ink))
    return float(most.mean() + 0.5) / image.devicePixelRatio()


def click_plot(user, x: float, y: float) -> None:
    QTest.mouseClick(
        user.window.parts.penalty.panel.plot,
        Qt.MouseButton.LeftButton,
        Qt.KeyboardModifier.NoModifier,
        QPoint(round(x), round(y)),
    )
    user.settle()


@pytest.mark.parametrize("width", [1280, 1700])
@pytest.mark.parametrize("penalty", [0.0, 0.5, 12.0, 60.0, 400.0, math.inf])
def test_the_marker_stands_above_the_centre_of_the_handle(user, panel, penalty, width):
    user.window.resize(width, 800)
    user.editor.commit(edits.set_penalty(user.session, penalty), "Change penalty")
    user.settle()
    assert abs(painted_marker(panel) - handle_centre(panel)) <= 2


def test_the_marker_follows_while_the_slider_is_held(user, panel):
    slider = panel.slider
    y = slider.height() // 2
    drawn = panel.plot.plotted.curve
    user.drag(slider, QPoint(8, y), QPoint(slider.width() // 3, y), release=False)
    assert user.editor.is_previewing
    assert slider.value() > 200
    assert abs(painted_marker(panel) - handle_centre(panel)) <= 2
    assert np.array_equal(panel.plot.plotted.curve.penalties, drawn.penalties)
    QTest.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=QPoint(slider.width() // 3, y))
    user.settle()


def test_a_click_on_the_curve_takes_the_penalty_there(user, panel):
    plot = panel.plot
    x = plot.place_of(0.4)
    click_plot(user, x, plot.height() / 2)
    flexibility = panel.plot.plotted.factor.flexibility(user.session.settings.penalty)
    assert flexibility == pytest.approx(0.6, abs=0.005)
    assert abs(handle_centre(panel) - x) <= 2
    user.trigger("undo")
    assert user.session.settings.penalty == 0


def test_hovering_tells_the_figures_there(user, panel):
    plot = panel.plot
    resting = plot.grab().toImage()
    QTest.mouseMove(plot, QPoint(round(plot.place_of(0.5)), plot.height() // 2))
    user.qtbot.waitUntil(lambda: plot.grab().toImage() != resting)
    reading = plot.plotted.reading(plot.share_at(plot.place_of(0.5)))
    assert "flexibility 50%" in reading
    assert "leave-one-out 4.3 mm" in reading
    assert "residual 1.51 mm" in reading
    QTest.mouseMove(user.window.parts.table.table, QPoint(5, 5))
    user.qtbot.waitUntil(lambda: plot.grab().toImage() == resting)


def test_the_suggested_penalty_is_taken_by_its_button_and_undone(user, noisy_panel):
    button, suggested = noisy_panel.suggested, noisy_panel.plot.plotted.curve.suggested
    assert suggested is not None
    assert button.text() == f"Use suggested: {suggested:.3g} mm"
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    user.settle()
    assert user.session.settings.penalty == suggested
    assert not button.isEnabled()
    user.trigger("undo")
    assert user.session.settings.penalty == 0
    user.press(Qt.Key.Key_T)
    assert user.session.settings.penalty == suggested


def test_a_click_on_its_sign_takes_exactly_the_suggested_penalty(user, noisy_panel):
    at = noisy_panel.plot.suggested_place()
    click_plot(user, at.x() + 3, at.y())
    assert user.session.settings.penalty == noisy_panel.plot.plotted.curve.suggested


def test_the_least_error_is_where_the_sign_is(user, noisy_panel):
    curve = noisy_panel.plot.plotted.curve
    left_out, _ = curve.at(noisy_panel.plot.plotted.factor.flexibility(curve.suggested))
    assert left_out == pytest.approx(curve.leave_one_out.min())
    assert "least" not in noisy_panel.warning.text()


def test_pairs_that_ask_for_no_penalty_are_said_to(user, panel):
    source = scattered()
    give_pairs(user, source, source + 12 * np.sin(source[:, [1, 2, 0]] / 60))
    assert "at no penalty: the pairs ask for none" in panel.warning.text()
    assert not panel.suggested.isEnabled()
    assert not user.window.actions_by_key["take_suggested"].isEnabled()
    assert panel.plot.suggested_place() is None


def test_pairs_of_an_affine_map_with_noise_ask_for_the_affine_fit(user, panel):
    source = scattered()
    noise = np.random.default_rng(3).normal(size=source.shape)
    give_pairs(user, source, 1.1 * source + 4 * noise)
    assert "at the affine fit: the pairs ask for no bending" in panel.warning.text()
    give_pairs(user, source, 1.1 * source)
    assert "the penalty changes nothing" in panel.warning.text()
    assert panel.plot.plotted.reading(0.5).endswith("leave-one-out 0 mm   residual 0 mm")
    assert "<b>0 mm</b>" in panel.figures.left_out.text()


def test_the_curve_is_refreshed_when_the_pairs_change(user, panel):
    before = panel.plot.plotted.curve
    user.editor.select(user.session.landmarks[3].name)
    user.trigger("toggle_enabled")
    assert not np.array_equal(panel.plot.plotted.curve.leave_one_out, before.leave_one_out)
    assert panel.plot.plotted.title == "RMS over 15 pairs"


def test_below_five_pairs_there_is_no_curve(user, panel):
    for landmark in user.session.landmarks[4:16]:
        user.editor.select(landmark.name)
        user.trigger("delete_landmark")
    assert panel.plot.plotted is None
    click_plot(user, panel.plot.width() / 2, 50)
    assert user.session.settings.penalty == 0


def test_the_published_convention_has_the_curve_but_no_suggestion(user, noisy_panel):
    noisy_panel.equation.setFocus()
    user.press(Qt.Key.Key_Down, widget=noisy_panel.equation)
    assert user.session.settings.convention is PenaltyConvention.OPYNSIM
    assert "regularising" in noisy_panel.plot.plotted.title
    assert not noisy_panel.suggested.isEnabled()
    assert len(noisy_panel.slider.poles) > 0
    user.press(Qt.Key.Key_T)
    assert user.session.settings.penalty == 0


def test_the_curve_can_be_put_away_for_the_bones(user, panel):
    from pinwarp.core.landmarks import Side

    view = user.window.viewports[Side.SOURCE]
    height = view.height()
    user.trigger("show_curve")
    assert not panel.plot.isVisible()
    assert view.height() > height + 40
    assert panel.figures.isVisible()
    user.trigger("show_curve")
    assert panel.plot.isVisible()
    assert view.height() == height
