"""User stories: the tour, done by mouse and keys, left, taken up again, finished."""

from __future__ import annotations

import pytest
from qtpy.QtCore import QPoint, Qt
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QPushButton
from tests.gui.conftest import Driver, ScriptedDialogs, close_window, open_window

from pinwarp.core.landmarks import Side
from pinwarp.gui.files.file_dialogs import Answer
from pinwarp.gui.tour.steps import EXCHANGED, PLACED, STEPS, is_of_tour
from pinwarp.io.samples import sample_session
from pinwarp.session.keeping.files import read_session
from pinwarp.session.session import Session

DESTINATION = Side.DESTINATION
CTRL = Qt.KeyboardModifier.ControlModifier


def click(user, button: QPushButton) -> None:
    assert button.isVisible()
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    user.settle()


def tour(user):
    return user.window.parts.tour


def asks(user) -> str:
    bar = tour(user).bar
    return bar.words.text() if bar.isVisible() else ""


def place_by_ghost(user) -> None:
    for _ in range(2):
        if not user.session.landmark(PLACED).is_complete:
            user.press(Qt.Key.Key_Space)


def move_penalty(user) -> None:
    slider = user.window.parts.penalty.panel.slider
    middle = slider.rect().center()
    user.drag(slider, QPoint(8, middle.y()), middle)


def swap_back(user) -> None:
    (button,) = (
        one
        for one in user.window.parts.findings.panel.findChildren(QPushButton)
        if one.text() == "Swap" and one.isVisible()
    )
    click(user, button)


def test_the_tour_is_done_by_mouse_and_keys_from_the_empty_window_to_the_export(user, tmp_path):
    offer = tour(user).offer
    assert offer.text() == "Take the Tour"
    click(user, offer)
    assert not offer.isVisible()
    assert "ghost" in asks(user)
    assert not user.session.landmark(PLACED).is_complete
    assert user.editor.undo_label is None, "there is nothing to undo yet"
    place_by_ghost(user)
    assert "Drag" in asks(user)
    user.drag_a_landmark()
    assert "penalty" in asks(user)
    move_penalty(user)
    assert "exchanged" in asks(user)
    sample = read_session(sample_session(), meshes=())
    places = [user.session.landmark(name).destination for name in EXCHANGED]
    assert places != [sample.landmark(name).destination for name in EXCHANGED]
    swap_back(user)
    assert "Export" in asks(user)
    path = tmp_path / "warped.stl"
    user.dialogs.saves = [path]
    user.press(Qt.Key.Key_E, CTRL)
    assert path.is_file()
    assert "That was the tour" in asks(user)
    click(user, tour(user).bar.leave)
    assert asks(user) == ""


def test_a_preview_is_no_step_and_what_is_put_right_by_undo_counts(user):
    user.trigger("tour")
    for _ in range(3):
        click(user, tour(user).bar.skip)
    assert "exchanged" in asks(user)
    user.press(Qt.Key.Key_Z, CTRL)
    assert "Export" in asks(user)


def test_the_tour_is_left_and_taken_up_again_where_it_was(user):
    user.trigger("tour")
    place_by_ghost(user)
    assert "Drag" in asks(user)
    click(user, tour(user).bar.leave)
    assert asks(user) == ""
    user.drag_a_landmark()
    assert asks(user) == "", "nobody asks any more"
    user.trigger("tour")
    assert "Drag" in asks(user)
    # Something else is opened meanwhile.
    user.editor.replace_all(Session(), None)
    user.settle()
    assert asks(user) == ""
    assert tour(user).offer.text() == "Go On With the Tour (1 of 5 done)"
    click(user, tour(user).offer)
    assert "Drag" in asks(user)
    assert is_of_tour(user.session)
    assert user.session.landmark(PLACED).is_complete


def test_unsaved_work_is_asked_about_before_the_tour_begins(user):
    user.open_sample()
    user.editor.commit(Session(landmarks=user.session.landmarks[:3]), "Something of mine")
    mine = user.session
    user.dialogs.unsaved = Answer.CANCEL
    user.trigger("tour")
    assert user.session == mine
    assert asks(user) == ""
    assert not tour(user).is_under_way


def test_another_start_goes_on_with_the_tour(nothing_leaks, qtbot, tmp_path, state_folder):
    dialogs = ScriptedDialogs()
    first = Driver(open_window(dialogs, tmp_path, state_folder), dialogs, qtbot)
    first.trigger("tour")
    for _ in range(2):
        click(first, tour(first).bar.skip)
    close_window(first.window, dialogs)
    again = open_window(dialogs, tmp_path, state_folder)
    assert again.parts.tour.offer.text() == "Go On With the Tour (2 of 5 done)"
    close_window(again, dialogs)


@pytest.mark.parametrize("step", STEPS[:-1], ids=lambda step: step.done)
def test_a_step_is_not_done_before_it_is_begun(step):
    before = read_session(sample_session(), meshes=())
    begun = step.prepare(before)
    assert is_of_tour(begun)
    assert not step.is_done(before, begun, begun)
