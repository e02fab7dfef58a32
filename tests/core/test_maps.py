"""Maps of the warp: the figures against the formulas, and when there is none."""

from __future__ import annotations

import gc
import math
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from scipy.spatial.distance import cdist
from tests.core.amplitudes import sigma_of
from tests.core.femur import femur_landmarks, femur_meshes

from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.core.maps import MapKind, automatic_range, overall_size, volume_map
from pinwarp.core.mesh import Mesh
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import PenaltyConvention, factorise, solve
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.io.meshes import MeshFile
from pinwarp.session import edits
from pinwarp.session.judging.survey import Surveyor
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver

SIZE = np.array([30.0, 25.0, 90.0])


def bone(scale=1.0, resolution=30):
    ball = pv.Sphere(radius=1.0, theta_resolution=resolution, phi_resolution=resolution)
    return Mesh(np.asarray(ball.points, float) * SIZE * scale, ball.regular_faces)


def file_of(mesh):
    return MeshFile(Path("/bone.ply"), mesh, "", ())


def session_of(source, destination, mesh=None, target=None, **changes):
    return Session(
        source=None if mesh is None else file_of(mesh),
        destination=None if target is None else file_of(target),
        landmarks=tuple(
            Landmark(f"p{i}", as_position(a), as_position(b))
            for i, (a, b) in enumerate(zip(source, destination, strict=True))
        ),
        **changes,
    )


def places(count, seed=0):
    ways = np.random.default_rng(seed).normal(size=(count, 3))
    return ways / np.linalg.norm(ways, axis=1)[:, None] * SIZE


def bent(source, scale=1.0):
    return scale * (source * [1.1, 0.9, 1.0] + 3 * np.sin(source / 20))


@pytest.fixture
def session():
    source = places(14)
    return session_of(source, bent(source), bone(), bone(1.05, 24), settings=WarpSettings(2.0))


def survey(session, kind, surveyor=None, **options):
    result = WarpSolver().solve(WarpInputs.of(session))
    destination = session.mesh(Side.DESTINATION)
    return (surveyor or Surveyor()).survey(result, destination, kind, **options)


def warp_of(session):
    source, destination = (np.array([p.position(s) for p in session.pairs]) for s in Side)
    factor = factorise(source)
    return factor, destination, solve(factor, destination, session.settings.penalty)


def slope(session, at):
    """The warp's derivative by differences."""
    _, _, spline = warp_of(session)
    step = 1e-4
    shifts = step * np.eye(3)
    ahead, behind = (spline.evaluate(at + sign * shifts) for sign in (1, -1))
    return ((ahead - behind) / (2 * step)).T


def test_the_volume_map_is_the_determinant_of_the_derivative(session):
    values = survey(session, MapKind.VOLUME).map.values
    vertices = session.mesh(Side.SOURCE).vertices
    for row in (3, 200, 500):
        assert values[row] == pytest.approx(np.linalg.det(slope(session, vertices[row])), rel=1e-4)


def test_the_stretch_maps_are_the_ends_of_what_the_derivative_does_to_directions(session):
    vertices = session.mesh(Side.SOURCE).vertices
    largest, smallest = (
        survey(session, kind).map.values
        for kind in (MapKind.LARGEST_STRETCH, MapKind.SMALLEST_STRETCH)
    )
    ways = np.random.default_rng(0).normal(size=(20_000, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    for row in (3, 200, 500):
        lengths = np.linalg.norm(ways @ slope(session, vertices[row]).T, axis=1)
        assert largest[row] == pytest.approx(lengths.max(), rel=2e-3)
        assert smallest[row] == pytest.approx(lengths.min(), rel=2e-3)


def test_the_uncertainty_is_the_square_root_of_the_kriging_variance(session):
    found = survey(session, MapKind.UNCERTAINTY).map
    factor, destination, _ = warp_of(session)
    source, n, s = factor.source, len(factor.source), session.settings.penalty
    drift = np.column_stack([np.ones(n), source])
    M = np.block([[-cdist(source, source) + s * np.eye(n), drift], [drift.T, np.zeros((4, 4))]])
    inverse = np.linalg.inv(M)
    G = inverse[:n, :n]
    vertices = session.mesh(Side.SOURCE).vertices
    c = np.column_stack([-cdist(vertices, source), np.ones(len(vertices)), vertices])
    size = session.mesh(Side.SOURCE).diagonal
    sigma = sigma_of(G, source, destination, size=size)
    expected = sigma * np.sqrt(-np.einsum("ij,jk,ik->i", c, inverse, c))
    assert np.allclose(found.values, expected, rtol=1e-4)
    assert found.suggestion.position == tuple(vertices[np.argmax(expected)])
    assert found.suggestion.deviation == pytest.approx(expected.max(), rel=1e-6)


def test_the_next_landmark_lowers_the_uncertainty_where_it_was_suggested(session):
    before = survey(session, MapKind.UNCERTAINTY).map.suggestion
    _, _, spline = warp_of(session)
    place = np.array([before.position])
    landmark = Landmark("new", before.position, as_position(spline.evaluate(place)[0]))
    session = edits.import_pairs(session, [landmark])
    found = survey(session, MapKind.UNCERTAINTY).map
    row = np.argmin(np.linalg.norm(session.mesh(Side.SOURCE).vertices - place, axis=1))
    assert found.values[row] < 0.5 * before.deviation
    assert found.suggestion.position != before.position


def test_a_vertex_without_a_triangle_is_neither_suggested_nor_counted():
    source = places(9)
    mesh = bone()
    lost = Mesh(np.vstack([mesh.vertices, [[0, 0, 900.0]]]), mesh.faces)
    session = session_of(source, bent(source), lost, bone(1.05))
    found = survey(session, MapKind.UNCERTAINTY).map
    assert found.values[-1] > found.highest
    assert found.suggestion.deviation == found.highest
    distances = survey(session, MapKind.DISTANCE).map
    assert distances.values[-1] > 500 > distances.highest


def test_the_distances_are_those_to_the_nearest_place_of_the_other_surface(session):
    found = survey(session, MapKind.DISTANCE).map
    _, _, spline = warp_of(session)
    warped = spline.evaluate(session.mesh(Side.SOURCE).vertices)
    target = session.mesh(Side.DESTINATION)
    surface = pv.make_tri_mesh(target.vertices, target.faces)
    _, nearest = surface.find_closest_cell(warped, return_closest_point=True)
    expected = np.linalg.norm(warped - nearest, axis=1)
    assert np.allclose(found.values, expected, atol=1e-4)
    figures = found.comparison.forward_figures
    assert figures.mean == pytest.approx(expected.mean(), rel=1e-4)
    assert figures.percentile_95 == pytest.approx(np.percentile(expected, 95), rel=1e-4)
    assert found.comparison.hausdorff >= figures.maximum == pytest.approx(expected.max(), rel=1e-4)
    assert [round(float(h.shares.sum()), 9) for h in found.histograms] == [1, 1]


def test_the_real_femur_misses_its_destination_by_what_is_known_of_it(shared_data):
    _, source, destination = femur_landmarks(shared_data)
    session = session_of(source, destination, *femur_meshes(shared_data), unit="mm")
    found = survey(session, MapKind.DISTANCE).map
    figures = found.comparison.forward_figures
    assert figures.mean == pytest.approx(2.25, rel=0.02)
    assert figures.percentile_95 == pytest.approx(5.40, rel=0.02)
    assert figures.maximum == pytest.approx(7.63, rel=0.02)


def test_bones_of_different_units_are_mapped_relative_to_their_sizes():
    source = places(14)
    plain = session_of(source, bent(source), bone())
    metres = session_of(source, bent(source, 0.001), bone())
    for kind, power in ((MapKind.VOLUME, 3), (MapKind.LARGEST_STRETCH, 1)):
        relative = survey(plain, kind, relative=True).map
        found = survey(metres, kind).map
        assert found.overall == pytest.approx(0.001 * relative.overall)
        assert np.allclose(found.values, relative.values, rtol=1e-4)
        as_is = survey(plain, kind).map
        assert as_is.overall == 1
        assert np.allclose(as_is.values, relative.values * relative.overall**power, rtol=1e-4)


def test_the_overall_size_is_that_of_the_affine_fit():
    source = places(14)
    factor = factorise(source)
    spline = solve(factor, bent(source), 0.0)
    affine = np.linalg.lstsq(np.column_stack([np.ones(14), source]), bent(source), rcond=None)[0]
    expected = np.linalg.det(affine[1:]) ** (1 / 3)
    assert overall_size(spline, factor) == pytest.approx(expected)


def test_a_mirrored_warp_is_mapped_like_the_other_one(session):
    source = np.array([p.source for p in session.pairs])
    mirrored = session_of(source, bent(source) * [-1, 1, 1], bone(), settings=WarpSettings(2.0))
    found, same = (survey(s, MapKind.VOLUME) for s in (mirrored, session))
    assert found.folds.count == 0
    assert np.allclose(found.map.values, same.map.values, rtol=1e-4)


def test_folds_are_found_without_any_map_and_name_those_responsible():
    source = places(14)
    destination = bent(source)
    apart = cdist(source, source) + 1e9 * np.eye(14)
    i, j = np.unravel_index(apart.argmin(), apart.shape)
    destination[[i, j]] = destination[[j, i]]
    found = survey(session_of(source, destination, bone(resolution=60)), None)
    assert found.map is None
    assert found.missing == ""
    assert found.folds.count > 0
    assert {int(i), int(j)} <= {row for finding in found.findings for row in finding.rows}
    values = survey(session_of(source, destination, bone(resolution=60)), MapKind.VOLUME).map.values
    assert np.array_equal(values <= 0, found.folds.is_folded)


def test_a_map_that_lacks_something_says_so_and_the_way_out(session):
    bare = replace(session, source=None)
    assert "Open the source mesh" in survey(bare, MapKind.VOLUME).missing
    bare = replace(session, destination=None)
    assert "Open the destination mesh" in survey(bare, MapKind.DISTANCE).missing
    assert survey(bare, MapKind.VOLUME).missing == ""
    bare = replace(session, landmarks=())
    assert "Place a landmark" in survey(bare, MapKind.VOLUME).missing
    assert survey(replace(session, landmarks=session.landmarks[:3]), MapKind.UNCERTAINTY).map
    few = replace(session, landmarks=session.landmarks[:2])
    assert "three pairs" in survey(few, MapKind.UNCERTAINTY).missing
    published = edits.set_convention(session, PenaltyConvention.OPYNSIM)
    assert "regularising" in survey(published, MapKind.UNCERTAINTY).missing
    assert survey(edits.set_penalty(published, 0.0), MapKind.UNCERTAINTY).missing == ""
    assert survey(replace(session, source=None), None).missing == ""


@pytest.mark.parametrize("how", ["flat", "twice"])
def test_pairs_that_tell_nothing_of_how_bones_bend_leave_it_to_their_size(how):
    few = places(4) * [1, 1, 0] if how == "flat" else np.vstack([places(4), places(4)[:1]])
    found = survey(session_of(few, few, bone()), MapKind.UNCERTAINTY).map
    assert 0 < found.highest < 0.5 * bone().diagonal


def test_what_a_survey_may_share_is_computed_once(session):
    surveyor, solver = Surveyor(), WarpSolver()
    result, target = solver.solve(WarpInputs.of(session)), session.mesh(Side.DESTINATION)
    first = surveyor.survey(result, target, MapKind.DISTANCE)
    assert surveyor.survey(result, target, MapKind.DISTANCE).map is first.map
    assert surveyor.maps == 1
    other = solver.solve(WarpInputs.of(edits.set_penalty(session, 5.0)))
    again = surveyor.survey(other, target, MapKind.DISTANCE)
    assert again.map is not first.map
    assert surveyor.indexes == 1, "the destination stays as it is"
    moved = surveyor.survey(other, bone(1.2), MapKind.DISTANCE)
    assert moved.map.highest > again.map.highest
    assert surveyor.indexes == 2


def test_nothing_is_kept_of_meshes_that_are_closed(session):
    surveyor, solver = Surveyor(), WarpSolver()
    surveyor.survey(
        solver.solve(WarpInputs.of(session)), session.mesh(Side.DESTINATION), MapKind.DISTANCE
    )
    index = weakref.ref(surveyor._index)
    other = replace(session, source=file_of(bone()), destination=file_of(bone(1.2)))
    # Looked at without a map: nothing takes the place of what was made for the other meshes.
    surveyor.survey(
        WarpSolver().solve(WarpInputs.of(other)), other.mesh(Side.DESTINATION), kind=None
    )
    gc.collect()
    assert index() is None
    held = [thing for thing in vars(surveyor).values() if isinstance(thing, SurfaceIndex | Mesh)]
    assert all(thing in (other.mesh(Side.SOURCE), other.mesh(Side.DESTINATION)) for thing in held)


def test_relative_and_plain_maps_are_not_mixed_up(session):
    surveyor, solver = Surveyor(), WarpSolver()
    result = solver.solve(WarpInputs.of(session))
    plain, relative, back = (
        surveyor.survey(result, None, MapKind.VOLUME, relative=flag).map
        for flag in (False, True, False)
    )
    assert relative.overall != 1
    assert np.allclose(relative.values * relative.overall**3, plain.values, rtol=1e-5)
    assert np.array_equal(back.values, plain.values)


@pytest.mark.parametrize(
    ("values", "expected"),
    [([0.0, 0.0], (0.0, 1.0)), ([0.0, 8.3e-4], (0.0, 1e-3)), ([1.0, 9.9], (0.0, 10.0))],
)
def test_a_length_is_shown_from_nought_to_a_round_number(values, expected):
    assert automatic_range(MapKind.DISTANCE, values) == pytest.approx(expected)


def test_a_ratio_is_shown_as_far_below_one_as_above():
    low, high = automatic_range(MapKind.VOLUME, [0.8, 1.0, 1.1])
    assert low == pytest.approx(0.8, rel=0.01)
    assert low * high == pytest.approx(1)
    assert automatic_range(MapKind.VOLUME, [-3.0, 1.0]) == (0.25, 4.0)
    low, high = automatic_range(MapKind.VOLUME, [1.0, 1.0])
    assert high / low == pytest.approx(2**0.2), "rounding is not blown up"


def test_what_is_folded_has_a_level_below_all_others():
    levels = MapKind.VOLUME.levels([1e-9, 0.0, -2.0, 2.0])
    assert levels.min() == levels[1] == levels[2] <= levels[0] < levels[3]
    assert math.isfinite(levels.min())
    mesh = Mesh(np.eye(3), [[0, 1, 2]])
    (histogram,) = volume_map([0.0, 1.0, 2.0], mesh).histograms
    assert histogram.shares.sum() == pytest.approx(1)
