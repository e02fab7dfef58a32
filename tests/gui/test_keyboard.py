"""User stories without a mouse: everything can be reached, placed and told apart."""

from __future__ import annotations

import numpy as np
import pytest
from qtpy.QtCore import QPointF, Qt
from qtpy.QtWidgets import QApplication, QLabel, QWidget
from tests.gui.focus import nameless, not_reached

from pinwarp.core.landmarks import Role, Side
from pinwarp.gui.views.viewport import CROSSHAIR_STEP
from pinwarp.gui.window.text_size import remembered_size, write_in

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
SHIFT, CTRL = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.ControlModifier
Key = Qt.Key


def press_here(user, key, modifier=Qt.KeyboardModifier.NoModifier):
    """Press a key where the focus is, as a keyboard does."""
    user.press(key, modifier, widget=QApplication.focusWidget())


def test_pairs_and_passengers_are_placed_by_the_keyboard_alone(user):
    user.open_sample_meshes()
    here, there = user.window.viewports[SOURCE], user.window.viewports[DESTINATION]
    user.press(Key.Key_H)
    assert here.hasFocus()
    middle = QPointF(here.width() / 2, here.height() / 2)
    assert here.crosshair == middle
    for _ in range(3):
        press_here(user, Key.Key_Up)
    press_here(user, Key.Key_Down, SHIFT)
    down = 7 * CROSSHAIR_STEP
    assert here.crosshair == middle + QPointF(0, down)
    press_here(user, Key.Key_Return)
    (landmark,) = user.session.landmarks
    at = user.place_of(SOURCE, landmark.source)
    assert (at - here.crosshair.toPoint()).manhattanLength() <= 1
    press_here(user, Key.Key_Tab)
    assert here.crosshair is None
    assert there.hasFocus()
    press_here(user, Key.Key_Return)
    assert [pair.name for pair in user.session.pairs] == ["landmark_0"]
    press_here(user, Key.Key_Tab)
    press_here(user, Key.Key_Up, SHIFT)
    press_here(user, Key.Key_Return, CTRL)
    assert user.session.landmarks[1].role is Role.PASSENGER
    # The selected one goes where the crosshair is.
    user.editor.select("landmark_0", side=SOURCE)
    before = user.session.landmark("landmark_0").source
    press_here(user, Key.Key_Return, SHIFT)
    assert user.session.landmark("landmark_0").source != before
    press_here(user, Key.Key_Escape)
    assert here.crosshair is None
    assert not user.window.actions_by_key["crosshair"].isChecked()
    assert user.session.landmark("landmark_0") is not None, "Esc took the crosshair only"


def test_the_crosshair_stays_in_the_view_and_begins_at_the_ghost(user):
    from tests.gui.test_editing import without

    without(user, DESTINATION, "femoral_head_anterior")
    user.editor.select(side=DESTINATION)
    view = user.window.viewports[DESTINATION]
    user.press(Key.Key_H)
    (ghost,) = view.layer.ghosts
    assert (view.crosshair.toPoint() - user.place_of(DESTINATION, ghost.position)).isNull()
    press_here(user, Key.Key_Return)
    assert user.session.landmark("femoral_head_anterior").is_complete
    for _ in range(40):
        press_here(user, Key.Key_Left, SHIFT)
    assert view.crosshair.x() == 0
    user.press(Key.Key_H, widget=view)
    assert view.crosshair is None


def test_the_bones_are_turned_and_zoomed_by_keys(user):
    user.open_sample_meshes()
    views = list(user.window.viewports.values())
    user.press(Key.Key_H)
    press_here(user, Key.Key_Escape)

    def seen():
        return [np.array(view.camera.GetDirectionOfProjection()) for view in views]

    before = seen()
    press_here(user, Key.Key_Right, CTRL)
    for old, new in zip(before, seen(), strict=True):
        assert 14 < np.degrees(np.arccos(np.clip(old @ new, -1, 1))) < 16
    press_here(user, Key.Key_Left, CTRL)
    assert np.allclose(before, seen(), atol=1e-6)
    far = views[0].camera.GetDistance()
    press_here(user, Key.Key_PageUp)
    assert views[0].camera.GetDistance() < far
    press_here(user, Key.Key_PageDown)
    assert np.isclose(views[0].camera.GetDistance(), far)


def test_every_widget_of_the_window_says_what_it_is_and_is_reached_by_tab(user):
    user.open_sample()
    user.trigger("snapshot")
    user.trigger("tour")
    faults = []
    for name in ("landmarks", "warp", "map", "semilandmarks", "refine", "model", "penalty"):
        dock = user.window.findChild(QWidget, name)
        dock.show()
        dock.raise_()
        user.settle()
        user.window.parts.table.table.setFocus()
        faults += [f"{name}: {x}" for x in (*nameless(user.window), *not_reached(user.window))]
    user.trigger("user_guide")
    guide = QApplication.activeWindow()
    assert guide is not user.window
    faults += nameless(guide) + not_reached(guide)
    guide.close()
    assert not faults, "\n".join(dict.fromkeys(faults))


def test_every_action_can_be_reached_by_the_keyboard(user):
    """By a shortcut, or in a menu, which the keyboard opens."""
    in_menus = set()

    def gather(menu):
        for action in menu.actions():
            in_menus.add(action)
            if action.menu() is not None:
                gather(action.menu())

    for top in user.window.menuBar().actions():
        gather(top.menu())
    for key, action in user.window.actions_by_key.items():
        assert action in in_menus or action.shortcuts(), key


@pytest.fixture
def large_text(qapp):
    before = QApplication.font()
    write_in(200)
    yield
    QApplication.setFont(before)


def test_text_at_twice_its_size_still_fits_a_small_screen(large_text, user):
    user.open_sample()
    assert user.window.minimumSizeHint().width() <= 1280
    panel = user.window.parts.penalty.panel
    assert panel.value.fontMetrics().height() > 25
    for label in panel.findChildren(QLabel):
        if label.isVisible() and not label.wordWrap() and "<" not in label.text():
            words = label.fontMetrics().horizontalAdvance(label.text())
            assert label.width() >= words, label.text()
    rows = user.window.parts.table.panel.table.verticalHeader()
    assert rows.defaultSectionSize() > 30


def test_the_size_of_text_is_chosen_in_the_menu_and_holds_from_the_next_start(user):
    settings = user.window._settings
    assert remembered_size(settings) == 100
    user.trigger("text_150")
    assert user.window.actions_by_key["text_150"].isChecked()
    assert not user.window.actions_by_key["text_100"].isChecked()
    assert "150 %" in user.window.statusBar().currentMessage()
    assert remembered_size(settings) == 150
    settings.setValue("text_size", "a lot")
    assert remembered_size(settings) == 100
