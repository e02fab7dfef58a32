"""User stories: destinations that a command has only suggested are looked at and confirmed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt
from qtpy.QtTest import QTest

from pinwarp.core.findings import FindingKind
from pinwarp.core.landmarks import LandmarkState, Side
from pinwarp.gui.painted.markers import marker_pixmap
from pinwarp.gui.scene.drawables import Markers
from pinwarp.gui.table.columns import COLUMNS

DESTINATION = Side.DESTINATION
SPACE, CONTROL = Qt.Key.Key_Space, Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def user(user):
    """Has opened the sample bones; three destinations, one of them hidden, are only suggested."""
    user.open_sample()
    view, pairs = user.window.viewports[DESTINATION], user.session.pairs
    hidden = view.behind_surface(np.array([x.destination for x in pairs])).tolist()
    seen = [x.name for x, out in zip(pairs, hidden, strict=True) if not out]
    out = [x.name for x, out in zip(pairs, hidden, strict=True) if out]
    user.names = (*seen[:2], out[-1])
    changed = tuple(
        x.suggested(x.destination) if x.name in user.names else x for x in user.session.landmarks
    )
    user.editor.replace_all(replace(user.session, landmarks=changed), None)
    user.settle()
    return user


def suggested(user):
    return [x.name for x in user.session.landmarks if x.is_suggested]


def status(user):
    return user.window.statusBar().currentMessage()


def hint(user):
    return user.window.parts.guidance.hint.text()


def rows(user):
    return user.window.parts.findings.panel.rows


def finding(user):
    kinds = [row.found.finding.kind for row in rows(user)]
    return rows(user)[kinds.index(FindingKind.SUGGESTED)]


def test_they_have_a_sign_and_a_state_of_their_own(user):
    drawn = user.window.viewports[DESTINATION].drawn(Markers).markers
    states = {marker.name: marker.state for marker in drawn}
    assert [name for name, x in states.items() if x is LandmarkState.SUGGESTED] == suggested(user)
    model = user.window.parts.table.model
    name = COLUMNS[0]
    for number, landmark in enumerate(user.session.landmarks):
        told = name.cell_tip(model.row(number)).splitlines()[0]
        is_suggested = landmark.name in user.names
        assert (told == f"{landmark.name}: suggested") == is_suggested
    # Told apart without colours.
    for state, is_half in ((LandmarkState.SUGGESTED, True), (LandmarkState.PAIRED, False)):
        sign = marker_pixmap(state, selected=False, hidden=False, ratio=1.0).toImage()
        above, below = (
            sign.pixelColor(sign.width() // 2, sign.height() // 2 + step).lightness()
            for step in (-3, 3)
        )
        assert (above - below > 100) == is_half, state


def test_space_confirms_one_after_the_other_and_turns_to_what_is_hidden(user):
    sentence = f"3 of {len(user.session.pairs)} destination landmarks are only suggested"
    assert finding(user).found.sentence.startswith(sentence)
    assert not finding(user).disable.isVisible()
    QTest.mouseClick(finding(user), Qt.MouseButton.LeftButton)
    user.settle()
    assert user.editor.selection.names == tuple(suggested(user)[:1])
    assert "Space confirms it" in hint(user)
    order, presses = suggested(user), 0
    view = user.window.viewports[DESTINATION]
    while suggested(user):
        name, before = suggested(user)[0], len(suggested(user))
        place = user.session.landmark(name).destination
        was_seen = view.sees(place)
        assert ("turns the view to it" in hint(user)) == (not was_seen)
        user.press(SPACE, widget=view)
        presses += 1
        if was_seen:
            assert len(suggested(user)) == before - 1
            assert user.editor.undo_label == f"Confirm {name}"
        else:
            assert len(suggested(user)) == before, "nothing is confirmed unseen"
            assert view.sees(place)
            assert "out of sight" in status(user)
    assert presses > 3, "the last one was hidden"
    assert FindingKind.SUGGESTED not in [row.found.finding.kind for row in rows(user)]
    user.press(Qt.Key.Key_Z, CONTROL)
    assert suggested(user) == order[-1:]


def test_many_selected_are_not_confirmed_in_one_go(user):
    user.editor.select(*suggested(user))
    before = user.session
    user.press(SPACE)
    assert user.session == before
    assert user.editor.selection.names == tuple(suggested(user)[:1])


def test_a_drag_confirms_and_undo_brings_the_doubt_back(user):
    name = user.names[0]
    start = user.place_of(DESTINATION, user.session.landmark(name).destination)
    view = user.window.viewports[DESTINATION]
    user.drag(view, start, start + QPoint(0, 12))
    assert name not in suggested(user)
    assert user.editor.undo_label == f"Move {name}"
    user.press(Qt.Key.Key_Z, CONTROL)
    assert name in suggested(user)


def test_space_without_a_selection_goes_to_the_first(user):
    user.press(SPACE)
    assert user.editor.selection.names == tuple(suggested(user)[:1])
    assert len(suggested(user)) == 3
