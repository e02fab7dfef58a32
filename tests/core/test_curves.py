from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.core.bones import bone, shape

from pinwarp.core.curves import CurvePath, PathFinder, tangents_along
from pinwarp.core.errors import LandmarkError, MeshError
from pinwarp.core.mesh import Mesh
from pinwarp.core.patches import patch, region_inside
from pinwarp.core.pieces import pieces_along
from pinwarp.core.sampling import triangle_areas
from pinwarp.core.surface import Surface
from pinwarp.core.surface_distance import SurfaceIndex


def ball(radius=10.0):
    sphere = pv.Icosphere(radius=radius, nsub=4)
    return Mesh(sphere.points, sphere.regular_faces)


BALL = ball()
BALL_SURFACE = Surface(BALL)
FINDER = PathFinder(BALL_SURFACE)


@settings(max_examples=25)
@given(st.integers(0, 10_000))
def test_a_way_over_a_ball_is_nearly_the_shortest(seed):
    a, b = np.random.default_rng(seed).normal(size=(2, 3))
    a, b = 10 * a / np.linalg.norm(a), 10 * b / np.linalg.norm(b)
    a, b = BALL_SURFACE.closest([a, b]).positions
    way = FINDER.between(a, b)
    shortest = 10 * np.arccos(np.clip(a @ b / np.linalg.norm(a) / np.linalg.norm(b), -1, 1))
    length = np.linalg.norm(np.diff(way, axis=0), axis=1).sum()
    np.testing.assert_array_equal(way[[0, -1]], [a, b])
    assert BALL_SURFACE.index.distances(way).max() < 1e-9
    # Of a thousand seeds the worst is 3.4 % longer.
    assert 0.98 * shortest <= length <= 1.05 * shortest


def test_a_curve_over_two_separate_parts_is_refused_in_words():
    away = BALL.vertices + np.array([100.0, 0, 0])
    both = Mesh(np.vstack([BALL.vertices, away]), np.vstack([BALL.faces, BALL.faces + len(away)]))
    with pytest.raises(MeshError, match="two parts of the mesh"):
        PathFinder(Surface(both)).through([[10, 0, 0], [110, 0, 0]])


@pytest.mark.parametrize("places", [[[0, 0, 10]], [[0, 0, 10], [0, 0, 10]]])
def test_one_place_is_no_curve(places):
    with pytest.raises(LandmarkError, match="at least 2 places"):
        FINDER.through(places)
    with pytest.raises(LandmarkError, match="at least 3 places"):
        FINDER.through([*places, [10, 0, 0]], is_closed=True)


def test_a_way_around_separate_triangles_is_found():
    corners = Mesh(BALL.vertices[BALL.faces.ravel()], np.arange(BALL.faces.size).reshape(-1, 3))
    path = PathFinder(Surface(corners)).through([[0, 0, 10], [0, 0, -10]])
    assert 30 < path.length < 33


def test_points_along_a_path_are_evenly_spaced_and_keep_its_ends():
    path = FINDER.through([[10, 0, 0], [0, 10, 0], [-10, 0, 0]])
    points = path.points(9)
    np.testing.assert_allclose(points[[0, -1]], path.places[[0, -1]], atol=1e-9)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert np.ptp(steps) < 0.02 * steps.mean()
    closed = FINDER.through([[10, 0, 0], [0, 10, 0], [-10, 0, 0], [0, -10, 0]], is_closed=True)
    assert abs(closed.length - 20 * np.pi) < 0.5
    around = np.vstack([closed.points(8), closed.points(8)[:1]])
    assert np.ptp(np.linalg.norm(np.diff(around, axis=0), axis=1)) < 0.2


@given(st.lists(st.floats(-2, 12), min_size=2, max_size=12))
def test_nobody_overtakes_on_an_open_path(along):
    path = CurvePath(np.array([[0.0, 0, 0], [4, 0, 0], [10, 0, 0]]))
    points = np.column_stack([along, np.ones(len(along)), np.zeros(len(along))])
    places, tangents = path.closest(points)
    assert (np.diff(places[:, 0]) > 0).all()
    assert places[:, 0].min() >= 0
    assert places[:, 0].max() <= 10 + 1e-9
    np.testing.assert_allclose(tangents, [[1, 0, 0]] * len(along), atol=1e-9)


def test_tangents_of_a_closed_curve_go_around():
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    root = np.sqrt(0.5)
    np.testing.assert_allclose(tangents_along(square, is_closed=True)[0], [root, -root, 0])


def test_a_patch_inside_a_closed_curve_stays_inside():
    north = FINDER.through([[8, 0, 6], [0, 8, 6], [-8, 0, 6], [0, -8, 6]], is_closed=True)
    cap = patch(BALL_SURFACE, 40, around=north, inside=[0, 0, 10])
    rest = patch(BALL_SURFACE, 40, around=north, inside=[0, 0, -10])
    assert cap.source[:, 2].min() > 5.5
    assert rest.source[:, 2].max() < 7.5
    assert np.sum(cap.normals * cap.source, axis=1).min() > 9.5


def test_a_region_on_a_coarse_mesh_is_as_large_as_its_curve_says():
    coarse = bone(8, 10)
    surface = Surface(coarse)
    ring = surface.closest(shape(np.linspace(0, 2 * np.pi, 9)[:-1], np.full(8, 1.2))).positions
    around = PathFinder(surface).through(ring, is_closed=True)
    fine, _, region = region_inside(surface, around, [0, 0, 100])
    _, _, other = region_inside(surface, around, [0, 0, -100])
    areas = triangle_areas(fine)
    assert not (region & other).any()
    # The curve's own triangles are of neither side.
    assert areas[region].sum() + areas[other].sum() > 0.9 * areas.sum()
    assert 0.2 < areas[region].sum() / areas.sum() < 0.5


def test_a_curve_that_encloses_nothing_has_no_inside():
    strip = Surface(Mesh([[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0]], [[0, 1, 2], [0, 2, 3]]))
    there_and_back = CurvePath(np.array([[2.0, 2, 0], [4, 2, 0], [6, 2, 0], [4, 2, 0]]), True)
    with pytest.raises(MeshError, match="encloses no part"):
        patch(strip, 5, around=there_and_back, inside=[5, 7, 0])


def test_an_open_curve_and_a_place_on_the_curve_are_refused():
    path = FINDER.through([[8, 0, 6], [0, 8, 6], [-8, 0, 6], [0, -8, 6]], is_closed=True)
    with pytest.raises(LandmarkError, match="Only a closed curve"):
        patch(BALL_SURFACE, 5, around=CurvePath(path.places), inside=[0, 0, 10])
    with pytest.raises(LandmarkError, match="Which side"):
        patch(BALL_SURFACE, 5, around=path)
    with pytest.raises(LandmarkError, match="lies on the curve"):
        patch(BALL_SURFACE, 5, around=path, inside=path.places[7])


@pytest.mark.parametrize("is_soup", [False, True])
def test_splitting_along_a_curve_keeps_the_surface_and_tells_where_each_piece_came_from(is_soup):
    mesh = bone(6, 8)
    if is_soup:
        mesh = Mesh(mesh.vertices[mesh.faces.ravel()], np.arange(mesh.faces.size).reshape(-1, 3))
    along = shape(np.linspace(0, 2 * np.pi, 400), np.full(400, 1.2))
    along = SurfaceIndex(mesh).closest(along)[0]
    pieces = pieces_along(mesh, along, 2.0)
    sums = np.bincount(pieces.parents, triangle_areas(pieces.mesh), len(mesh.faces))
    np.testing.assert_allclose(sums, triangle_areas(mesh))
    corners = pieces.mesh.vertices[pieces.mesh.faces]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    apart = np.linalg.norm(corners.mean(axis=1)[:, None] - along, axis=2).min(axis=1)
    assert (longest[apart < 2.0] <= 2.0).all()
    assert len(pieces.mesh.faces) < 4000
    nothing = np.zeros(len(pieces.mesh.faces), bool)
    assert np.ptp(pieces.parts(nothing)) == 0
    # Without what the curve runs over the bone falls in two, whatever the sizes.
    is_wall = np.zeros(len(pieces.mesh.faces), bool)
    is_wall[SurfaceIndex(pieces.mesh).closest(along)[1]] = True
    parts = pieces.parts(is_wall)
    shares = np.bincount(parts, np.where(is_wall, 0, triangle_areas(pieces.mesh)))
    largest = np.sort(shares / triangle_areas(mesh).sum())[::-1]
    assert largest[1] > 0.2
    assert largest[:2].sum() > 0.9
    assert largest[2:].max(initial=0) < 0.001


def test_a_way_that_was_found_is_not_looked_for_again():
    finder = PathFinder(BALL_SURFACE)
    first = finder.between([10, 0, 0], [0, 10, 0])
    assert finder.between([10, 0, 0], [0, 10, 0]) is first
    with pytest.raises(ValueError, match="read-only"):
        first[0] = 0.0
    other = finder.through([[10, 0, 0], [0, 10, 0], [0, 0, 10]])
    np.testing.assert_array_equal(other.places[: len(first)], first)
