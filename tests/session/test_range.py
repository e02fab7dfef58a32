"""Coordinates near the ends of what numbers can hold: refused in words, never a crash."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from tests.core.test_maps import file_of
from tests.session.study import bone

from pinwarp.core.components import Components
from pinwarp.core.errors import PinwarpError, RangeError
from pinwarp.core.factor import factorise
from pinwarp.core.jacobian import jacobians
from pinwarp.core.landmarks import Landmark, Role, Side, as_position
from pinwarp.core.live import PreviewPoints, preview
from pinwarp.core.maps import MapKind, automatic_range
from pinwarp.core.mesh import Mesh
from pinwarp.core.quality import leave_one_out, penalty_curve
from pinwarp.core.spline import solve
from pinwarp.core.surface_comparison import compare_surfaces
from pinwarp.session import edits
from pinwarp.session.judging.check import check
from pinwarp.session.judging.quality import quality_of
from pinwarp.session.judging.survey import Surveyor
from pinwarp.session.judging.warp_figures import figures_table
from pinwarp.session.outputs.exports import warped_mesh, warped_passengers
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver

SCALES = [1e-320, 1e-300, 1e-160, 1e-40, 1e-22, 1.0, 1e18, 1e20, 1e37, 1e39, 1e100, 1e149, 1e300]
BONE = Mesh(bone().vertices / 50, bone().faces)
PLACES = np.random.default_rng(0).normal(size=(8, 3))
PLACES /= np.linalg.norm(PLACES, axis=1)[:, None]
ENDS = PLACES + 0.1 * np.sin(3 * PLACES)


def session_of(source=1.0, destination=1.0, **changes):
    marks = [
        Landmark(f"p{i}", as_position(source * a), as_position(destination * b))
        for i, (a, b) in enumerate(zip(PLACES, ENDS, strict=True))
    ]
    marks.append(Landmark("muscle", as_position(1.5 * source * PLACES[0]), role=Role.PASSENGER))
    meshes = [
        file_of(BONE.with_vertices(size * scale * BONE.vertices))
        for scale, size in ((source, 1.0), (destination, 1.01))
    ]
    return Session(*meshes, landmarks=tuple(marks), **changes)


def scaled_sessions():
    for source, destination in itertools.product(SCALES, SCALES):
        try:
            yield session_of(source, destination)
        except PinwarpError:
            assert 1e300 in (source, destination)


def moved(session, side):
    mark = session.landmarks[3]
    return edits.move(session, mark.name, side, [1.1 * x for x in mark.position(side)])


def looked_at(session):
    """Everything that a window does with a warp; return the problem, if it said one."""
    solver, surveyor = WarpSolver(), Surveyor()
    result = solver.solve(WarpInputs.of(session))
    penalised = edits.set_penalty(session, abs(session.landmarks[0].source[0]))
    for other in (penalised, *(moved(session, side) for side in Side)):
        followed = solver.preview(WarpInputs.of(other))
        assert followed.problem or np.isfinite(followed.vertices).all()
    judged = quality_of(result)
    if judged is not None:
        assert "RMS" in figures_table(judged, "mm")
    for kind in (None, *MapKind):
        found = surveyor.survey(result, session.mesh(Side.DESTINATION), kind)
        assert kind is None or found.missing or np.isfinite(found.map.levels).all()
    if result.problem:
        return result.problem
    assert np.isfinite(result.vertices).all()
    assert np.isfinite(result.residuals).all()
    return None


def test_whatever_the_scales_a_warp_is_finite_or_refused_in_words():
    told = {looked_at(session) for session in scaled_sessions()}
    assert None in told
    assert any(words and "range of numbers" in words for words in told)


@pytest.mark.parametrize("components", list(Components))
def test_whatever_the_scales_what_leaves_is_finite_or_refused_in_words(components):
    left = refused = 0
    for session in scaled_sessions():
        part = edits.set_components(session, components)
        try:
            assert np.isfinite(warped_mesh(part).vertices).all()
            assert np.isfinite(warped_passengers(part)[0].destination).all()
            left += 1
        except PinwarpError:
            refused += 1
    assert left > 50
    assert refused > 10


def test_whatever_the_scales_a_check_is_finite_or_refused_in_words():
    done = 0
    for session in scaled_sessions():
        try:
            figures = check(session)
        except PinwarpError:
            continue
        assert np.isfinite([pair.residual for pair in figures.pairs]).all()
        done += 1
    assert done > 20


@pytest.mark.filterwarnings("ignore::pinwarp.core.errors.ConflictingLandmarksWarning")
@pytest.mark.parametrize("penalty", [0.0, 1.0, 1e308, np.inf])
def test_whatever_the_scales_the_figures_of_pairs_raise_nothing_but_words(penalty):
    for source, destination in itertools.product(SCALES, SCALES):
        try:
            factor = factorise(source * PLACES)
            leave_one_out(factor, destination * ENDS, penalty)
            penalty_curve(factor, destination * ENDS)
            solve(factor, destination * ENDS, penalty).evaluate(1e149 * PLACES)
        except PinwarpError:
            pass


def test_a_warp_out_of_range_says_where_and_undoing_it_brings_the_warp_back():
    session = session_of()
    solver = WarpSolver()
    before = solver.solve(WarpInputs.of(session)).vertices
    beyond = edits.move(session, "p3", Side.DESTINATION, (1e60, 0.0, 0.0))
    assert "range of numbers" in solver.preview(WarpInputs.of(beyond)).problem
    result = solver.solve(WarpInputs.of(beyond))
    assert "The warp leaves the range of numbers" in result.problem
    assert result.vertices is None
    assert "range" in Surveyor().survey(result, None, MapKind.VOLUME).missing
    assert np.array_equal(solver.solve(WarpInputs.of(session)).vertices, before)


def test_a_warp_beyond_double_precision_says_where():
    spline = solve(factorise(PLACES), 1e150 * ENDS)
    with pytest.raises(RangeError, match=r"range of numbers at \(7, 8, 9\)"):
        spline.evaluate([[0, 0, 0], [7, 8, 9]])
    with pytest.raises(RangeError, match="range of numbers"):
        jacobians(spline, PLACES)


def test_what_single_precision_cannot_square_is_drawn_by_way_of_doubles():
    far = solve(factorise(1e20 * PLACES), 2e20 * ENDS)
    points = PreviewPoints.of(1e20 * BONE.vertices)
    exact = far.evaluate(1e20 * BONE.vertices)
    assert np.abs(preview(far, points) - exact).max() < 1e-6 * np.abs(exact).max()
    small = solve(factorise(1e-24 * PLACES), 1e-24 * ENDS)
    points = PreviewPoints.of(1e-24 * BONE.vertices)
    exact = small.evaluate(1e-24 * BONE.vertices)
    assert np.abs(preview(small, points) - exact).max() < 1e-6 * np.abs(exact).max()


def test_a_mesh_that_cannot_be_drawn_or_measured_is_refused_in_words():
    for scale in (1e40, 1e-40):
        with pytest.raises(RangeError, match="cannot be drawn"):
            PreviewPoints.of(scale * BONE.vertices)
    for scale in (1e70, 1e-70):
        large = BONE.with_vertices(scale * BONE.vertices)
        with pytest.raises(RangeError, match="distances"):
            compare_surfaces(large, large)
    with pytest.raises(PinwarpError, match="too large"):
        BONE.with_vertices(1e200 * BONE.vertices)


@pytest.mark.parametrize("kind", list(MapKind))
@pytest.mark.parametrize("value", [0.0, 5e-324, 1e-300, 1e-40, 1.0, 1e38, 1e39, 1e300])
def test_figures_of_any_size_have_levels_and_a_range(kind, value):
    values = np.array([value, value / 2, value])
    assert np.isfinite(kind.levels(values)).all()
    low, high = automatic_range(kind, values)
    assert low < high
    assert np.isfinite([low, high]).all()
