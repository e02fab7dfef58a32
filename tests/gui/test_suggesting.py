"""User stories: all landmarks that the destination lacks are suggested, and accepted one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt
from qtpy.QtTest import QTest
from tests.gui.guesses import (
    bare_place,
    bones,
    following,
    ghosts,
    opened,
    part,
    status,
    true_places,
)

from pinwarp.core.landmarks import Side
from pinwarp.core.pose import Mirror
from pinwarp.gui.scene.drawables import Counterpart, Markers, OtherGhosts
from pinwarp.gui.suggesting import words
from pinwarp.session.warp.ghost import Ghost

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
LEFT, CONTROL = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ControlModifier
SPACE, G, Z = Qt.Key.Key_Space, Qt.Key.Key_G, Qt.Key.Key_Z


@pytest.fixture
def user(user, guesser, tmp_path):
    """Has opened two small bones whose landmarks are on the source alone."""
    opened(user, bones(tmp_path))
    # Nobody waits for a rest here, but where that is the story.
    part(user).rest.setInterval(0)
    return user


@pytest.fixture
def suggested(user):
    """Has asked for ghosts by the key."""
    user.press(G, CONTROL)
    return user


def view(user):
    return user.window.viewports[DESTINATION]


def bar(user):
    return part(user).bar


def place_of_ghost(user, name):
    return user.place_of(DESTINATION, ghosts(user)[name].position)


def seen(user):
    """The names of the ghosts that the bone does not hide, the next one last."""
    names = [name for name, ghost in ghosts(user).items() if view(user).sees(ghost.position)]
    return sorted(names, key=lambda name: name == following(user).name)


def middle(user):
    """The seen ghost nearest to the middle of the view, which is not the next one."""
    names = [name for name in seen(user) if name != following(user).name]
    return min(
        names, key=lambda name: abs(place_of_ghost(user, name).y() - view(user).height() / 2)
    )


def off(user, names):
    """How far ghosts are from where their landmarks truly lie."""
    truth, found = true_places(), ghosts(user)
    return [float(np.linalg.norm(np.array(found[x].position) - truth[x])) for x in names]


def accept(user):
    """Press until the next one is accepted, and say how often that took."""
    name = following(user).name
    for presses in (1, 2):
        user.press(SPACE)
        if user.session.landmark(name).is_complete:
            return presses
    raise AssertionError(f"{name} was not accepted")


def test_all_are_suggested_by_a_key_and_none_is_a_landmark_before_it_is_accepted(suggested, user):
    assert len(ghosts(user)) == 10
    assert not any(x.is_complete for x in user.session.landmarks)
    assert not user.editor.is_dirty
    assert user.editor.undo_label is None
    first = following(user)
    assert first.name == next(iter(ghosts(user))), "the most certain first"
    drawn = view(user).drawn(Ghost), view(user).drawn(OtherGhosts)
    assert drawn[0] == first
    assert {first.name, *(ghost.name for ghost in drawn[1].ghosts)} == set(ghosts(user))
    assert all(ghost.deviation > 0 for ghost in drawn[1].ghosts)
    # One sees on the source which it is, and both bones from the same side.
    assert user.window.viewports[SOURCE].drawn(Counterpart).name == first.name
    assert f"<b>{first.name}</b>" in bar(user).words.text()
    assert bar(user).progress.text() == "0 of 10"
    assert view(user).hasFocus()


def test_by_space_alone_all_are_accepted_each_seen_first_and_undo_brings_the_last_back(
    suggested, user
):
    presses, radius = 0, following(user).deviation
    while ghosts(user):
        ghost = following(user)
        was_seen = view(user).sees(ghost.position)
        took = accept(user)
        presses += took
        assert took == (1 if was_seen else 2)
        assert ghost.deviation == radius, "what is accepted unmoved makes nothing more certain"
        assert user.session.landmark(ghost.name).destination == ghost.position
        assert user.editor.undo_label == f"Accept {ghost.name}"
    assert presses > 10, "some were hidden"
    assert all(x.is_accepted and not x.is_suggested for x in user.session.landmarks)
    told = [row.found.sentence for row in user.window.parts.findings.panel.rows]
    (sentence,) = (one for one in told if one.startswith("10 of 10 pairs are as proposed"))
    figures = user.window.parts.penalty.panel.figures
    assert all(sentence in figure.toolTip() for figure in (figures.left_out, figures.pairs))
    assert "<b>0 + 10</b>" in figures.pairs.text()
    assert status(user) == words.ALL_TAKEN
    assert not bar(user).isVisible()
    user.press(Z, CONTROL)
    assert list(ghosts(user)) == [ghost.name]
    assert bar(user).isVisible()
    user.press(Qt.Key.Key_Y, CONTROL)
    assert not ghosts(user)


def test_a_click_puts_the_next_one_elsewhere_and_the_others_learn_from_it(suggested, user):
    name = following(user).name
    others = [one for one in ghosts(user) if one != name]
    before = off(user, others)
    user.click_position(DESTINATION, true_places()[name])
    assert user.session.landmark(name).is_complete
    assert user.editor.undo_label == f"Place {name}"
    assert np.mean(off(user, others)) < 0.9 * np.mean(before)
    user.press(Z, CONTROL)
    assert off(user, others) == before
    assert following(user).name == name


def test_a_drag_of_any_ghost_places_it_and_the_others_move_along(suggested, user):
    name = middle(user)
    others = [one for one in ghosts(user) if one != name]
    before = [ghosts(user)[one].position for one in others]
    start = place_of_ghost(user, name)
    user.drag(view(user), start, start + QPoint(0, 14), release=False)
    moved = [ghosts(user)[one].position for one in others]
    assert moved != before, "they follow while it is dragged"
    assert not user.editor.committed.landmark(name).is_complete
    QTest.keyClick(view(user), Qt.Key.Key_Escape)
    user.settle()
    assert set(ghosts(user)) == {name, *others}, "Esc puts it back, and leaves nothing else"
    user.drag(view(user), start, start + QPoint(0, 14))
    assert user.session.landmark(name).is_complete
    assert user.editor.undo_label == f"Place {name}"
    assert name not in ghosts(user)


def test_a_click_on_another_ghost_or_its_row_makes_it_the_next(suggested, user):
    before, name, first = user.session, middle(user), following(user).name
    user.qtbot.mouseMove(view(user), QPoint(5, 5))
    user.qtbot.mouseMove(view(user), place_of_ghost(user, name))
    user.qtbot.waitUntil(lambda: user.editor.view.hovered == name)
    user.settle()
    # It says its name on both sides.
    assert view(user).drawn(OtherGhosts).labelled == name
    marks = user.window.viewports[SOURCE].drawn(Markers).markers
    assert next(mark for mark in marks if mark.name == name).labelled
    user.click(DESTINATION, place_of_ghost(user, name))
    assert (user.session, following(user).name) == (before, name)
    user.editor.select(first)
    user.settle()
    assert following(user).name == first
    user.click(DESTINATION, bare_place(user, DESTINATION))
    assert user.session.landmark(first).is_complete
    # What the bone hides cannot be grabbed.
    hidden = [one for one in ghosts(user) if one not in seen(user)]
    for one in hidden:
        near = view(user).layer.nearest_ghost(place_of_ghost(user, one).toPointF(), 10)
        assert near is None or near.name != one
    assert hidden


def test_leaving_keeps_what_was_accepted_and_nothing_else(suggested, user):
    for _ in range(3):
        accept(user)
    before = user.session
    for leave in (
        lambda: user.press(Qt.Key.Key_Escape, widget=view(user)),
        lambda: user.press(G, CONTROL),
        lambda: QTest.mouseClick(bar(user).leave, LEFT),
    ):
        assert len(ghosts(user)) == 7
        leave()
        user.settle()
        assert user.session == before
        assert not ghosts(user)
        assert view(user).drawn(OtherGhosts) is None
        assert not bar(user).isVisible()
        assert not part(user).action.isChecked()
        assert status(user) == words.LEFT
        # From the third pair on the warp expects the next one, as ever.
        missing = [x.name for x in user.session.landmarks if not x.is_complete]
        assert following(user).name == missing[0]
        user.press(G, CONTROL)


def put_right(user):
    """Place the next one where it truly is."""
    name = following(user).name
    place = true_places()[name]
    user.window.parts.views.show_place(DESTINATION, place)
    user.settle()
    user.click_position(DESTINATION, place)
    assert user.session.landmark(name).is_complete
    assert not user.session.landmark(name).is_accepted


def test_at_rest_it_is_warped_anew_to_what_was_placed(suggested, user, guesser):
    accept(user)
    for _ in range(2):
        put_right(user)
    assert len(guesser.asked) == 1, "with so few the pose would have to be looked for again"
    user.press(Z, CONTROL)
    user.press(Z, CONTROL)
    user.press(Z, CONTROL)
    for _ in range(2):
        put_right(user)
    guesser.off = (0.0, 0.0, 0.0)
    put_right(user)
    user.settle()
    inputs, settings = guesser.asked[-1]
    assert len(inputs.pairs[0]) == 3
    assert settings.mirror is Mirror.NO
    asked = len(guesser.asked)
    assert asked > 1
    # What is under way when one goes on is of no use any more.
    guesser.held.clear()
    part(user).rest.start()
    user.qtbot.waitUntil(lambda: len(guesser.asked) > asked, timeout=5000)
    QTest.keyClick(view(user), Qt.Key.Key_Z, CONTROL)
    guesser.held.set()
    user.settle()
    assert len(ghosts(user)) == 8


def test_what_is_missing_follows_its_source_and_new_ones_get_ghosts(suggested, user):
    name = following(user).name
    before = ghosts(user)
    source = user.session.landmark(name).source
    start = user.place_of(SOURCE, source)
    viewport = user.window.viewports[SOURCE]
    if not viewport.sees(source):
        user.window.parts.views.show_place(SOURCE, source)
        user.settle()
        start = user.place_of(SOURCE, source)
    user.drag(viewport, start, start + QPoint(0, 10))
    assert ghosts(user)[name].position != before[name].position
    user.click(SOURCE, bare_place(user, SOURCE))
    assert len(ghosts(user)) == 11


def test_a_guide_gives_way_and_asks_on_when_it_is_called(user):
    user.press(G)
    assert user.editor.view.guided
    user.press(G, CONTROL)
    assert user.editor.view.guided is None
    user.press(G)
    assert following(user).name == user.editor.view.guided


def test_locked_landmarks_are_not_placed(suggested, user):
    user.press(Qt.Key.Key_L)
    before, name = user.session, seen(user)[0]
    for press in range(2):
        user.press(SPACE)
        assert "locked" in status(user), press
    start = place_of_ghost(user, name)
    user.drag(view(user), start, start + QPoint(0, 14))
    assert user.session == before


def test_what_is_suggested_already_is_confirmed_and_gets_no_ghost(suggested, user):
    ghost = following(user)
    landmarks = tuple(
        x.suggested(ghost.position) if x.name == ghost.name else x for x in user.session.landmarks
    )
    user.editor.commit(replace(user.session, landmarks=landmarks), "Suggest")
    user.settle()
    assert ghost.name not in ghosts(user)
    user.editor.select(ghost.name)
    user.press(SPACE)
    if user.session.landmark(ghost.name).is_suggested:
        user.press(SPACE)
    assert not user.session.landmark(ghost.name).is_suggested
    assert len(ghosts(user)) == 9
