"""User stories: tuning the penalty."""

from __future__ import annotations

import math

import pytest
from qtpy.QtCore import QPoint, Qt

from pinwarp.core.basis import Basis
from pinwarp.core.spline import PenaltyConvention


@pytest.fixture
def panel(user):
    user.open_sample()
    return user.window.parts.penalty.panel


def type_into(user, field, text):
    field.setFocus()
    field.selectAll()
    user.qtbot.keyClicks(field, text)
    user.qtbot.keyClick(field, Qt.Key.Key_Return)
    user.settle()


def plain(label):
    return label.text().split("<b>")[1].split("</b>")[0]


def test_the_slider_goes_from_interpolation_to_the_affine_fit(user, panel):
    assert plain(panel.figures.flexibility) == "100%"
    assert plain(panel.figures.residual) == "0 mm"
    slider = panel.slider
    y = slider.height() // 2
    user.drag(slider, QPoint(8, y), QPoint(slider.width() + 20, y))
    assert math.isinf(user.session.settings.penalty)
    assert panel.value.text() == "affine"
    assert plain(panel.figures.flexibility) == "0%"
    assert float(plain(panel.figures.residual).split()[0]) > 1


def test_half_way_leaves_half_of_the_flexibility(user, panel):
    slider = panel.slider
    user.drag(slider, QPoint(8, slider.height() // 2), slider.rect().center())
    assert plain(panel.figures.flexibility) in ("49%", "50%", "51%")
    assert user.editor.undo_label == "Change penalty"
    user.trigger("undo")
    assert slider.value() == 0


def test_arrow_keys_move_the_slider(user, panel):
    panel.slider.setFocus()
    user.press(Qt.Key.Key_Right, widget=panel.slider)
    assert user.session.settings.penalty > 0


def test_an_exact_penalty_can_be_typed_and_moves_the_slider(user, panel):
    type_into(user, panel.value, "12.5")
    assert user.session.settings.penalty == 12.5
    assert 0 < panel.slider.value() < 1000
    type_into(user, panel.value, "affine")
    assert math.isinf(user.session.settings.penalty)
    assert panel.slider.value() == 1000


@pytest.mark.parametrize("text", ["-3", "much", "nan", ""])
def test_nonsense_is_refused_in_words_and_changes_nothing(user, panel, text):
    type_into(user, panel.value, "2")
    type_into(user, panel.value, text) if text else type_into(user, panel.value, " ")
    assert user.session.settings.penalty == 2
    assert "not a penalty" in panel.warning.text()
    assert panel.value.text() == "2"


def test_opynsim_shows_its_poles_and_warns(user, panel):
    assert panel.slider.poles == ()
    panel.equation.setFocus()
    user.press(Qt.Key.Key_Down, widget=panel.equation)
    assert user.session.settings.convention is PenaltyConvention.OPYNSIM
    assert len(panel.slider.poles) == 12
    assert all(0 < share < 1 for share in panel.slider.poles)
    assert "poles" in panel.warning.text()
    type_into(user, panel.value, "60")
    assert "pole at" in panel.warning.text()
    assert plain(panel.figures.flexibility) == "–"


def test_below_five_pairs_the_penalty_rests_and_says_why(user):
    user.open_sample()
    for landmark in user.session.landmarks[4:16]:
        user.editor.select(landmark.name)
        user.trigger("delete_landmark")
    assert len(user.session.pairs) == 4
    assert not user.window.parts.penalty.panel.slider.isEnabled()
    assert "five pairs" in user.window.parts.penalty.panel.warning.text()


def test_the_unit_is_chosen_beside_the_value(user, panel):
    panel.unit.setFocus()
    user.press(Qt.Key.Key_Down, widget=panel.unit)
    assert user.session.unit == "cm"
    assert "cm" in panel.figures.residual.text()
    user.trigger("undo")
    assert panel.unit.currentText() == "mm"


def test_the_overlay_can_be_hidden_and_faded(user, panel):
    from pinwarp.core.landmarks import Side

    viewport = user.window.viewports[Side.DESTINATION]
    user.press(Qt.Key.Key_W)
    assert not viewport.renderer.actors["overlay"].GetVisibility()
    assert not user.window.parts.overlay.opacity.isEnabled()
    user.press(Qt.Key.Key_W)
    slider = user.window.parts.overlay.opacity
    user.drag(slider, QPoint(slider.width() // 2, 8), QPoint(4, 8))
    assert viewport.renderer.actors["overlay"].prop.opacity < 0.3


def test_another_basis_is_chosen_beside_the_penalty_and_undone(user, panel):
    type_into(user, panel.value, "12.5")
    share = panel.slider.value()
    shown = user.window.parts.warps.result.vertices
    panel.equation.setFocus()
    for _ in range(2):
        user.press(Qt.Key.Key_Down, widget=panel.equation)
    settings = user.session.settings
    assert settings.basis is Basis.R2_LOG_R
    assert settings.convention is PenaltyConvention.REGULARISING
    assert panel.slider.poles == ()
    assert panel.unit.currentText() == "mm²"
    # As much flexibility as before, which is another figure of another kind.
    assert settings.penalty > 100
    assert abs(panel.slider.value() - share) <= 1
    assert user.window.parts.warps.result.vertices is not shown
    user.press(Qt.Key.Key_P)
    (tile,) = user.window.parts.snapshots.strip.tiles
    assert "mm²</b>" in tile.words.text()
    type_into(user, panel.value, "400 mm²")
    assert user.session.settings.penalty == 400
    for _ in range(2):
        user.trigger("undo")
    assert user.session.settings.convention is PenaltyConvention.OPYNSIM
    user.trigger("undo")
    assert panel.equation.currentText() == "Regularising"
    assert panel.unit.currentText() == "mm"
    assert user.session.settings.penalty == 12.5
    # A penalty says nothing without its basis: a snapshot brings both.
    assert "basis changed" in tile.words.text()
    user.qtbot.mouseClick(tile, Qt.MouseButton.LeftButton)
    user.settle()
    assert user.session.settings == settings
