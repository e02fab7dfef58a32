from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.core.bones import bone, landmarks, off_truth, shape, truth
from tests.core.femur import femur_landmarks, femur_meshes
from tests.core.pelvis import pelvis_landmarks, pelvis_meshes

from pinwarp.core.curves import PathFinder
from pinwarp.core.errors import LandmarkError, MeshError
from pinwarp.core.factor import factorise
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.mesh import Mesh
from pinwarp.core.patches import patch
from pinwarp.core.quality import bending_energy
from pinwarp.core.readiness import InsideOutError
from pinwarp.core.sampling import even_places
from pinwarp.core.sliding import Semilandmarks, SlidingCurve, slide
from pinwarp.core.spline import solve
from pinwarp.core.surface import Surface

SOURCE = bone()
ON_SOURCE = Surface(SOURCE)
ON_TRUTH = Surface(SOURCE.with_vertices(truth(SOURCE.vertices)))


@pytest.fixture(scope="module")
def femur(shared_data):
    _, u, v = femur_landmarks(shared_data)
    source, destination = femur_meshes(shared_data)
    return u, v, Surface(source), Surface(destination)


def with_curve(points, count=12, height=1.3):
    """The points, and a ring of a curve around the bone."""
    ring = ON_SOURCE.closest(shape(np.arange(count) * 2 * np.pi / count, np.full(count, height)))
    return Semilandmarks(
        np.vstack([points.source, ring.positions]), np.vstack([points.normals, ring.normals])
    )


@settings(max_examples=15)
@given(st.integers(6, 20), st.integers(10, 80))
def test_the_energy_never_rises_and_the_points_stay_on_the_surface(count, points):
    u = landmarks(count)
    slid = slide(u, truth(u), patch(ON_SOURCE, points, away_from=u), ON_TRUTH)
    assert all(b <= a for a, b in zip(slid.energies, slid.energies[1:], strict=False))
    assert slid.converged
    assert len(slid.energies) <= 15
    placed = slid.positions[~slid.is_freed]
    assert ON_TRUTH.index.distances(placed).max() < 1e-9
    np.testing.assert_allclose(slid.spline.evaluate(u), truth(u), atol=1e-8)


def test_nothing_slides_from_a_bone_to_itself():
    u = landmarks(12)
    slid = slide(u, u, patch(ON_SOURCE, 60, away_from=u), ON_SOURCE)
    assert slid.slid.max() < 1e-12 * 200
    assert slid.freed == 0
    assert slid.converged


@pytest.mark.parametrize("count", [10, 20, 40])
def test_sliding_comes_nearer_to_the_truth_than_the_landmarks_alone(count):
    u = landmarks(count)
    slid = slide(u, truth(u), patch(ON_SOURCE, 150, away_from=u), ON_TRUTH)
    assert off_truth(slid.spline) < 0.85 * off_truth(solve(factorise(u), truth(u)))
    assert determinants(jacobians(slid.spline, SOURCE.vertices)).min() > 0.3


def test_the_same_landmarks_slide_to_the_same_places_bit_for_bit():
    u = landmarks(10)
    points = patch(ON_SOURCE, 60, away_from=u)
    first, second = (slide(u, truth(u), points, ON_TRUTH).positions for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_at_rest_no_point_would_bend_less_by_moving_on_its_plane():
    u = landmarks(10)
    points = patch(ON_SOURCE, 40, away_from=u)
    slid = slide(u, truth(u), points, ON_TRUTH)
    energy = bending_energy(slid.spline).sum()
    factor = factorise(slid.spline.source)
    for seed in range(20):
        rng = np.random.default_rng(seed)
        places = slid.spline.evaluate(slid.spline.source)
        places[len(u) :] += 0.3 * rng.normal(size=(len(places) - len(u), 3))
        places[len(u) :] = ON_TRUTH.closest(places[len(u) :]).positions
        assert bending_energy(solve(factor, places)).sum() > energy


def test_points_of_a_drawn_curve_stay_on_it_in_order():
    u = landmarks(12)
    points = with_curve(patch(ON_SOURCE, 30, away_from=u))
    rows = len(u) + 30 + np.arange(12)
    drawn = truth(shape(np.linspace(0, 2 * np.pi, 41)[:-1], np.full(40, 1.35)))
    path = PathFinder(ON_TRUTH).through(ON_TRUTH.closest(drawn).positions, is_closed=True)
    curves = (SlidingCurve(rows, is_closed=True, path=path),)
    slid = slide(u, truth(u), Semilandmarks(points.source, points.normals, curves), ON_TRUTH)
    ring = slid.positions[30:]
    on_path, _ = path.closest(ring)
    # The path is straight between its places, the surface is not.
    assert np.abs(on_path - ring).max() < 0.05
    assert ON_TRUTH.index.distances(ring).max() < 1e-9
    assert not slid.is_freed[30:].any()
    assert slid.energies[-1] < slid.energies[0]


def test_points_of_a_curve_that_was_not_drawn_stay_on_the_surface():
    u = landmarks(12)
    points = with_curve(patch(ON_SOURCE, 30, away_from=u))
    rows = len(u) + 30 + np.arange(12)
    curves = (SlidingCurve(rows, is_closed=True),)
    slid = slide(u, truth(u), Semilandmarks(points.source, points.normals, curves), ON_TRUTH)
    assert ON_TRUTH.index.distances(slid.positions[~slid.is_freed]).max() < 1e-9
    # A curve point may leave its place along the curve only: it slides less than a free one.
    unheld = slide(u, truth(u), points, ON_TRUTH)
    assert slid.energies[-1] >= unheld.energies[-1] * (1 - 1e-6)


@pytest.mark.parametrize(("count", "is_closed"), [(1, False), (1, True), (2, True)])
def test_points_of_a_curve_too_short_for_a_direction_slide_on_the_surface(count, is_closed):
    u = landmarks(12)
    points = with_curve(patch(ON_SOURCE, 30, away_from=u), count)
    curves = (SlidingCurve(len(u) + 30 + np.arange(count), is_closed),)
    on_curve, on_surface = (
        slide(u, truth(u), replace(points, curves=either), ON_TRUTH) for either in (curves, ())
    )
    assert on_surface.slid[30:].max() > 0.01
    np.testing.assert_allclose(on_curve.positions, on_surface.positions, atol=1e-9)


def test_a_crest_may_face_either_way_where_points_over_the_surface_may_not():
    u = landmarks(12)
    ring = ON_SOURCE.closest(shape(np.arange(12) * 2 * np.pi / 12, np.full(12, 1.3)))
    # A third of them lie on the other flank.
    normals = np.where(np.arange(12)[:, None] % 3 == 0, ring.normals[:, [1, 2, 0]], ring.normals)
    crest = SlidingCurve(len(u) + np.arange(12), is_closed=True)
    slid = slide(u, u, Semilandmarks(ring.positions, normals, (crest,)), ON_SOURCE)
    assert len(slid.positions) == 12
    with pytest.raises(MeshError, match="faces as the destination does"):
        slide(u, u, Semilandmarks(ring.positions, normals), ON_SOURCE)


def test_a_curve_may_end_in_landmarks():
    u = landmarks(12)
    ends = [2, 7]
    path = PathFinder(ON_SOURCE).through(ON_SOURCE.closest(u[ends]).positions)
    between = ON_SOURCE.closest(path.points(7)[1:-1])
    rows = np.concatenate([[2], len(u) + np.arange(5), [7]])
    points = Semilandmarks(between.positions, between.normals, (SlidingCurve(rows),))
    slid = slide(u, truth(u), points, ON_TRUTH)
    assert slid.converged
    np.testing.assert_allclose(slid.spline.evaluate(u), truth(u), atol=1e-8)


def test_points_beyond_the_end_of_the_destination_are_freed_and_counted():
    mesh = ON_TRUTH.mesh
    middle = mesh.vertices[mesh.faces].mean(axis=1)[:, 2]
    half = Surface(Mesh(mesh.vertices, mesh.faces[middle > 55.0]))
    u = landmarks(16)
    kept = truth(u)[:, 2] > 60.0
    slid = slide(u[kept], truth(u[kept]), patch(ON_SOURCE, 80), half)
    beyond = truth(patch(ON_SOURCE, 80).source)[:, 2] < 45.0
    assert slid.freed > 20
    assert slid.is_freed[beyond].mean() > 0.9
    assert len(slid.used) == kept.sum() + 80 - slid.freed


def test_a_landmark_set_wrong_misses_most_when_it_is_left_out():
    u = landmarks(14)
    v = truth(u)
    v[3] += [0.0, 0.0, 15.0]
    slid = slide(u, v, patch(ON_SOURCE, 100, away_from=u), ON_TRUTH)
    errors = np.linalg.norm(slid.leave_one_out(), axis=1)
    assert errors.shape == (14,)
    assert errors.argmax() == 3


@pytest.mark.parametrize(
    ("source", "destination", "words"),
    [
        (landmarks(3), truth(landmarks(3)), "from 4 on"),
        (landmarks(0), landmarks(0), "no pairs"),
        (landmarks(8) * [1, 1, 0], truth(landmarks(8)), "All source landmarks lie in one plane"),
        (landmarks(8), truth(landmarks(8)) * [0, 1, 1], "All destination landmarks lie in one"),
        (landmarks(8) * [0, 0, 1], truth(landmarks(8)), "on one line"),
        (landmarks(8)[[0, 1, 2, 3, 4, 4]], truth(landmarks(6)), "rows 4 and 5 lie at one place"),
        (landmarks(8) * [-1, 1, 1], truth(landmarks(8)), "mirror one of the meshes"),
    ],
)
def test_landmarks_that_cannot_carry_a_surface_are_refused_in_words(source, destination, words):
    with pytest.raises(LandmarkError, match=words):
        slide(source, destination, patch(ON_SOURCE, 20), ON_TRUTH)


def test_an_inside_out_destination_is_refused_and_named():
    turned = Surface(Mesh(ON_TRUTH.mesh.vertices, ON_TRUTH.mesh.faces[:, ::-1]))
    u = landmarks(10)
    with pytest.raises(InsideOutError, match="most likely the destination"):
        slide(u, truth(u), patch(ON_SOURCE, 30), turned)


def test_landmarks_that_do_not_lay_one_surface_on_the_other_are_refused():
    u = landmarks(10)
    with pytest.raises(MeshError, match="Look for wrong pairs"):
        slide(u, truth(u) + np.array([60.0, 0, 0]), patch(ON_SOURCE, 60), ON_TRUTH)


def test_on_the_real_femur_300_points_reach_the_targets(femur):
    u, v, source, destination = femur
    points = patch(source, 300, away_from=u)
    slid = slide(u, v, points, destination)
    everywhere, _ = even_places(source.mesh, 5000)
    distances = destination.index.distances(slid.spline.evaluate(everywhere))
    assert distances.mean() <= 0.65
    assert slid.freed < 15
    assert len(slid.energies) <= 15
    errors = np.linalg.norm(slid.leave_one_out(), axis=1)
    assert np.sqrt(np.mean(errors**2)) < 9.2


def test_on_the_real_femur_leaving_out_and_redoing_everything_is_better_than_before(femur):
    u, v, source, destination = femur
    errors = []
    for row in range(0, len(u), 4):
        kept = np.arange(len(u)) != row
        points = patch(source, 300, away_from=u[kept])
        slid = slide(u[kept], v[kept], points, destination)
        before = solve(factorise(u[kept]), v[kept])
        errors.append(
            [
                np.linalg.norm(warp.evaluate(u[row : row + 1])[0] - v[row])
                for warp in (before, slid.spline)
            ]
        )
    before, after = np.sqrt(np.mean(np.square(errors), axis=0))
    assert after < before


def test_on_the_pelvis_sliding_finds_what_truly_answers_to_what(shared_data):
    template, target = pelvis_meshes(shared_data)
    rows = pelvis_landmarks(template)
    u, v = template.vertices[rows], target.vertices[rows]
    surface = Surface(target)
    # Three triangles share an edge here and there: no harm.
    slid = slide(u, v, patch(Surface(template), 300, away_from=u), surface)
    missed = np.linalg.norm(slid.spline.evaluate(template.vertices) - target.vertices, axis=1)
    before = solve(factorise(u), v).evaluate(template.vertices) - target.vertices
    assert missed.mean() <= 1.5
    assert missed.mean() < 0.4 * np.linalg.norm(before, axis=1).mean()
    path = PathFinder(surface).through(v[:3])
    assert surface.index.distances(path.places).max() < 1e-9
