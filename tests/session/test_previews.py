"""Which way a preview goes, and that every way leads to the same warp."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pinwarp.core.components import Components
from pinwarp.core.factor import factorise
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import PenaltyConvention, solve
from pinwarp.io.meshes import MeshFile
from pinwarp.session import edits
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver


@pytest.fixture
def session():
    rng = np.random.default_rng(0)
    landmarks = tuple(
        Landmark(f"p{i}", tuple(place), tuple(place * 1.1 + 0.1 * rng.normal(size=3)))
        for i, place in enumerate(rng.normal(size=(9, 3)))
    )
    vertices = rng.normal(size=(400, 3))
    mesh = Mesh(vertices, np.arange(399).reshape(-1, 3))
    file = MeshFile(Path("/m.ply"), mesh, "", ())
    return Session(file, landmarks=landmarks, settings=WarpSettings(0.2))


def exact(session):
    pairs = session.pairs
    spline = solve(
        factorise([pair.source for pair in pairs]),
        [pair.destination for pair in pairs],
        session.settings.penalty,
        session.settings.convention,
    )
    return spline.evaluate(session.mesh(Side.SOURCE).vertices)


def moved(session, side):
    place = session.landmarks[2].position(side)
    return edits.move(session, "p2", side, tuple(np.add(place, 0.3)))


MOTIONS = {
    "the penalty": lambda s: edits.set_penalty(s, 0.7),
    "the penalty to the affine fit": lambda s: edits.set_penalty(s, float("inf")),
    "a destination": lambda s: moved(s, Side.DESTINATION),
    "a source": lambda s: moved(s, Side.SOURCE),
    "a pair away": lambda s: edits.set_enabled(s, "p4", False),
    "two destinations": lambda s: edits.move(
        moved(s, Side.DESTINATION), "p3", Side.DESTINATION, (0, 0, 0)
    ),
}


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("convention", list(PenaltyConvention))
def test_a_preview_of_moving_shows_the_warp_as_it_will_be_at_rest(session, motion, convention):
    session = edits.set_convention(edits.set_penalty(session, 0.01), convention)
    solver = WarpSolver()
    solver.solve(WarpInputs.of(session))
    after = MOTIONS[motion](session)
    preview = solver.preview(WarpInputs.of(after))
    expected = exact(after)
    assert np.abs(preview.vertices - expected).max() < 5e-5 * np.linalg.norm(
        np.ptp(expected, axis=0)
    )
    at_rest = solver.solve(WarpInputs.of(after))
    assert np.abs(at_rest.vertices - preview.vertices).max() < 1e-4


IN_PART = {
    "the components": {"components": Components.AFFINE},
    "the blend": {"blend": 0.5},
    "both": {"components": Components.WITHOUT_POSE, "blend": 0.3},
}


@pytest.mark.parametrize("motion", ["the penalty", "a destination"])
@pytest.mark.parametrize("part", IN_PART)
@pytest.mark.parametrize("began_whole", [False, True])
def test_a_preview_of_a_warp_in_part_shows_that_part(session, motion, part, began_whole):
    part_of = replace(session, settings=replace(session.settings, **IN_PART[part]))
    solver = WarpSolver()
    solver.solve(WarpInputs.of(session if began_whole else part_of))
    after = WarpInputs.of(MOTIONS[motion](part_of))
    preview = solver.preview(after)
    assert np.abs(preview.vertices - WarpSolver().solve(after).vertices).max() < 1e-4


def test_sliding_evaluates_nothing_anew(session):
    solver = WarpSolver()
    solver.solve(WarpInputs.of(session))
    for penalty in (0.3, 0.4, 0.5):
        solver.preview(WarpInputs.of(edits.set_penalty(session, penalty)))
    assert (solver.factorisations, solver.evaluations) == (1, 1)


def test_dragging_a_destination_evaluates_nothing_anew(session):
    solver = WarpSolver()
    solver.solve(WarpInputs.of(session))
    for x in (0.1, 0.2, 0.3):
        solver.preview(WarpInputs.of(edits.move(session, "p1", Side.DESTINATION, (x, 0, 0))))
    assert (solver.factorisations, solver.evaluations) == (1, 1)


def test_dragging_a_source_evaluates_once_a_frame_and_comes_back_for_free(session):
    solver = WarpSolver()
    start = solver.solve(WarpInputs.of(session))
    for x in (0.1, 0.2, 0.3):
        solver.preview(WarpInputs.of(edits.move(session, "p1", Side.SOURCE, (x, 0, 0))))
    assert (solver.factorisations, solver.evaluations) == (4, 4)
    assert solver.solve(WarpInputs.of(session)) is start


def test_only_the_stand_in_is_warped_while_something_moves(session):
    stand_in = Mesh(np.eye(3), [[0, 1, 2]])
    solver = WarpSolver()
    at_rest = solver.solve(WarpInputs.of(session, stand_in))
    assert len(at_rest.vertices) == 400
    assert len(at_rest.stand_in) == 3
    sliding = solver.preview(WarpInputs.of(edits.set_penalty(session, 0.5), stand_in))
    assert sliding.vertices is None
    assert len(sliding.stand_in) == 3


def test_many_landmarks_put_the_eigenvalues_off_until_the_hand_rests():
    rng = np.random.default_rng(1)
    places = rng.normal(size=(320, 3))
    landmarks = tuple(Landmark(f"p{i}", tuple(p), tuple(p + 1)) for i, p in enumerate(places))
    solver = WarpSolver()
    result = solver.solve(WarpInputs.of(Session(landmarks=landmarks)))
    assert not result.factor.has_modes
    assert result.flexibility is None
    assert solver.refine(result).flexibility == 1.0


def test_a_landmark_is_followed_from_where_all_others_rest_now(session):
    solver = WarpSolver()
    for place in ((0, 0, 0), (1, 1, 1)):
        solver.solve(WarpInputs.of(session))
        drag = moved(session, Side.DESTINATION)
        vertices = solver.preview(WarpInputs.of(drag)).vertices
        assert np.allclose(vertices, exact(drag), atol=1e-4)
        # Another one moves before the same one is dragged again.
        session = edits.move(session, "p5", Side.DESTINATION, place)
