"""The hand and the ghosts without a window: which landmark, which side, and how far."""

from __future__ import annotations

from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest

from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.core.mesh import Mesh
from pinwarp.gui.drawn.surface import Surface
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.placing.ghosts import Ghosts
from pinwarp.gui.placing.hand import Hand
from pinwarp.io.meshes import MeshFile
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver

SOURCE, DESTINATION = Side
TETRAHEDRON = Mesh(
    [[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
)


@pytest.fixture
def editor(tmp_path):
    """Eight pairs, two landmarks on the source alone and one on the destination alone."""
    file = MeshFile(tmp_path / "bone.ply", TETRAHEDRON, "", ())
    places = np.random.default_rng(0).uniform(0, 10, size=(8, 3))
    pairs = [Landmark(f"p{i}", tuple(a), tuple(a + np.sin(a))) for i, a in enumerate(places)]
    halves = [Landmark("a", (2, 3, 0)), Landmark("b", (5, 1, 0)), Landmark("c", None, (0, 4, 4))]
    return Editor(Session(file, file, landmarks=(*pairs, *halves)))


@pytest.fixture
def ghosts(qapp, editor):
    result = WarpSolver().solve(WarpInputs.of(editor.session))
    return Ghosts(editor, SimpleNamespace(result=result), Surfaces())


@pytest.fixture
def hand(editor, ghosts):
    across, upwards = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])
    view = Mock(surface=Surface(TETRAHEDRON), view_axes=lambda: (across, upwards))
    turning = Mock(show_place=lambda _side, _position: False)
    return Hand(editor, dict.fromkeys(Side, view), ghosts, turning)


def test_the_ghost_is_of_the_landmark_that_is_asked_for_now(editor, ghosts):
    assert ghosts.at(DESTINATION).name == "a"
    for asked in ("b", "a"):
        editor.look(guided=asked)
        assert ghosts.at(DESTINATION).name == asked
    editor.preview(editor.session)
    assert ghosts.at(DESTINATION) is None


@pytest.mark.parametrize("side", list(Side))
def test_of_two_ghosts_the_one_opposite_to_where_one_worked_is_accepted(editor, hand, side):
    names = {SOURCE: "a", DESTINATION: "c"}
    editor.select(side=side)
    hand.accept_ghost()
    assert editor.session.landmark(names[side]).is_complete
    assert not editor.session.landmark(names[side.other]).is_complete


def test_what_hangs_beside_the_bone_is_nudged_by_the_step_and_not_onto_it(editor, hand):
    editor.look(nudge=0.5)
    for place, moved in (((2.0, 3.0, -4.0), (2.5, 3.0, -4.0)), ((2.0, 3.0, 0.0), (2.5, 3.0, 0.0))):
        editor.commit(edits.move(editor.session, "a", SOURCE, place), "Move")
        editor.select("a", side=SOURCE)
        hand.nudge(SOURCE, 1, 0)
        assert editor.session.landmark("a").source == pytest.approx(moved)


def test_a_passenger_that_was_a_pair_is_swapped_with_none(editor, hand):
    (swap,) = (x for x in hand.actions if x.objectName() == "swap_destinations")

    def is_possible(*names):
        editor.select(*names)
        swap.renew()
        return swap.isEnabled()

    assert is_possible("p0", "p1")
    assert not is_possible("p0", "p1", "p2")
    assert not is_possible("p0", "a")
    editor.commit(edits.set_role(editor.session, ["p1"], Role.PASSENGER), "Make passenger")
    assert not is_possible("p0", "p1")
