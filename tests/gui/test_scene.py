"""What a viewport shows, as the pure function that says it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pinwarp.core.factor import factorise
from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.core.spline import solve
from pinwarp.gui.scene.drawables import Arrows, Markers
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.scene.session_scene import MOST_LABELS, session_drawables
from pinwarp.session.judging.quality import quality_of
from pinwarp.session.session import Session
from pinwarp.session.view import Selection, ViewState
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver

NOTHING, USUAL = Selection(), ViewState()


def test_a_passenger_that_was_a_pair_is_drawn_only_where_the_warp_carries_it():
    places = np.random.default_rng(0).normal(size=(6, 3))
    pairs = tuple(Landmark(f"p{i}", tuple(x), tuple(2 * x)) for i, x in enumerate(places))
    was_a_pair = Landmark("muscle", (1, 2, 3), (50, 50, 50), role=Role.PASSENGER)
    came_with_its_bone = Landmark("nerve", None, (7, 8, 9), role=Role.PASSENGER)
    session = Session(landmarks=(*pairs, was_a_pair, came_with_its_bone))
    result = WarpSolver().solve(WarpInputs.of(session))
    for known in (None, result):
        drawn = session_drawables(Side.DESTINATION, session, Selection(), ViewState(), known)
        markers = Scene(Side.DESTINATION, tuple(drawn)).of(Markers).markers
        shown = {x.name: x.position for x in markers if not x.name.startswith("p")}
        assert shown.pop("nerve") == (7, 8, 9)
        if known is None:
            assert shown == {}
        else:
            assert np.allclose(shown.pop("muscle"), (2, 4, 6))
            assert len(markers) == len(pairs) + 2


def bent(count):
    """Pairs that no affine map explains."""
    places = np.random.default_rng(0).normal(size=(count, 3))
    ends = places + 0.1 * np.sin(3 * places)
    return tuple(
        Landmark(f"p{i}", tuple(a), tuple(b))
        for i, (a, b) in enumerate(zip(places.tolist(), ends.tolist(), strict=True))
    )


def scene(session, selection=NOTHING, view=USUAL, side=Side.DESTINATION):
    result = WarpSolver().solve(WarpInputs.of(session))
    drawn = session_drawables(side, session, selection, view, result, quality_of(result))
    return Scene(side, tuple(drawn))


def test_only_what_is_not_locked_or_carried_can_be_dragged():
    free, locked, *others = bent(6)
    carried = Landmark("muscle", (1, 2, 3), role=Role.PASSENGER)
    session = Session(landmarks=(free, replace(locked, locked=True), *others, carried))
    for side in Side:
        markers = {x.name: x.movable for x in scene(session, side=side).of(Markers).markers}
        assert (markers["p0"], markers["p1"]) == (True, False)
        assert markers["muscle"] is (side is Side.SOURCE)
        frozen = scene(session, view=ViewState(locked=True), side=side).of(Markers).markers
        assert not any(x.movable for x in frozen)


def test_selected_landmarks_are_labelled_until_there_are_too_many():
    session = Session(landmarks=bent(MOST_LABELS + 1))
    names = tuple(x.name for x in session.landmarks)
    for count, labelled in ((MOST_LABELS, MOST_LABELS), (MOST_LABELS + 1, 0)):
        markers = scene(session, Selection(names[:count])).of(Markers).markers
        assert sum(x.labelled for x in markers) == labelled


def test_a_selected_landmark_gets_an_arrow_from_where_the_others_expect_it():
    session = Session(landmarks=bent(9))
    chosen, *others = session.pairs
    (arrow,) = scene(session, Selection((chosen.name,))).of(Arrows).arrows
    without = solve(factorise([x.source for x in others]), [x.destination for x in others])
    assert arrow.left_out
    assert np.allclose(arrow.start, without.evaluate([chosen.source])[0])
    assert arrow.end == chosen.destination
