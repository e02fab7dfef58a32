"""The rows of a warp find their landmarks in a session that has moved on."""

from __future__ import annotations

import pytest

from pinwarp.core.errors import LandmarkError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.session import edits
from pinwarp.session.session import Session
from pinwarp.session.warp.pair_names import pair_names
from pinwarp.session.warp.result import WarpInputs


@pytest.fixture
def session():
    return Session(
        landmarks=tuple(
            Landmark(name, (float(i), 0.0, 0.0), (float(i), 1.0, 0.0))
            for i, name in enumerate("abcde")
        )
    )


@pytest.fixture
def inputs(session):
    return WarpInputs.of(session)


def test_reordered_and_renamed_pairs_are_known_by_their_places(session, inputs):
    moved = edits.rename_many(edits.reorder(session, ["d"], 0), {"a": "b", "b": "a"})
    assert pair_names(inputs, moved) == ("b", "a", "c", "d", "e")
    assert pair_names(inputs, moved, exactly=True) == ("b", "a", "c", "d", "e")


def test_a_dragged_pair_is_known_by_its_other_side_unless_asked_exactly(session, inputs):
    for side in Side:
        moved = edits.reorder(edits.move(session, "c", side, (9.0, 9.0, 9.0)), ["c"], 5)
        assert pair_names(inputs, moved) == ("a", "b", "c", "d", "e")
        assert pair_names(inputs, moved, exactly=True) == ("a", "b", None, "d", "e")


def test_what_takes_no_part_any_more_is_nobody(session, inputs):
    fewer = edits.set_enabled(edits.remove(session, ["a"]), ["d"], False)
    assert pair_names(inputs, fewer) == (None, "b", "c", None, "e")


def test_pairs_at_one_place_are_told_apart_by_the_other_side(session):
    double = edits.move(session, "b", Side.SOURCE, (0.0, 0.0, 0.0))
    inputs = WarpInputs.of(double)
    moved = edits.move(edits.reorder(double, ["b"], 0), "b", Side.SOURCE, (5.0, 5.0, 5.0))
    assert pair_names(inputs, moved) == ("a", "b", "c", "d", "e")


def test_swapping_destinations_twice_is_nothing(session):
    once = edits.swap_destinations(session, "a", "c")
    assert once.landmark("a").destination == session.landmark("c").destination
    assert once.landmark("a").source == session.landmark("a").source
    assert edits.swap_destinations(once, "c", "a") == session
    with pytest.raises(LandmarkError, match="no landmark called x"):
        edits.swap_destinations(session, "a", "x")


def test_of_pairs_at_one_place_that_both_moved_the_first_stays_the_first(session):
    double = edits.move(session, "b", Side.SOURCE, (0.0, 0.0, 0.0))
    inputs = WarpInputs.of(double)
    for name in "ab":
        double = edits.move(double, name, Side.DESTINATION, (7.0, 7.0, ord(name)))
    assert pair_names(inputs, double)[0] == "a"
