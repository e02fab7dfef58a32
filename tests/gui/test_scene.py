"""What a viewport shows, as the pure function that says it."""

from __future__ import annotations

import numpy as np

from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.gui.scene.drawables import Markers
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.scene.session_scene import session_drawables
from pinwarp.session.session import Session
from pinwarp.session.view import Selection, ViewState
from pinwarp.session.warp.solver import WarpInputs, WarpSolver


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
