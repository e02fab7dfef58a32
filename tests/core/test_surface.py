from __future__ import annotations

import numpy as np
import pytest
from tests.core.bones import bone, landmarks, truth

from pinwarp.core.errors import MeshError
from pinwarp.core.mesh import Mesh
from pinwarp.core.normals import vertex_normals
from pinwarp.core.sampling import even_places, spread_places, triangle_areas
from pinwarp.core.spline import factorise, solve
from pinwarp.core.surface import Surface, carried_normals, welded_faces

SQUARE = Mesh([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], [[0, 1, 2], [0, 2, 3]])


def soup(mesh):
    """The same triangles, each with corners of its own, as an STL file has them."""
    return Mesh(mesh.vertices[mesh.faces.ravel()], np.arange(mesh.faces.size).reshape(-1, 3))


@pytest.mark.parametrize(
    ("place", "ends"),
    [
        ((2, 1, 5), False),
        ((2, -1, 0), True),
        ((2, 2, 0), False),
        ((5, 5, 1), True),
        ((4, 2, 0), True),
    ],
)
def test_a_place_on_the_edge_of_a_surface_is_told_from_one_on_an_edge_between_triangles(
    place, ends
):
    assert Surface(SQUARE).closest([place]).on_rim.tolist() == [ends]


def test_a_surface_without_a_rim_has_none_even_as_separate_triangles():
    mesh = bone(12, 16)
    assert not Surface(mesh).has_rim
    assert not Surface(soup(mesh)).has_rim
    assert welded_faces(soup(mesh)).shape == mesh.faces.shape


def test_separate_triangles_face_as_joined_ones_do():
    mesh = bone(12, 16)
    positions, triangles = even_places(mesh, 200)
    joined, apart = (Surface(m).at(triangles, positions).normals for m in (mesh, soup(mesh)))
    np.testing.assert_allclose(apart, joined, atol=1e-12)
    assert np.abs(np.linalg.norm(joined, axis=1) - 1).max() < 1e-12


def test_an_edge_of_three_triangles_is_no_rim():
    fin = Mesh([*SQUARE.vertices, [2, 2, 3]], [*SQUARE.faces, [0, 2, 4]])
    assert Surface(fin).closest([[2, 2, 0], [2, 2, 3.5]]).on_rim.tolist() == [False, True]


def test_normals_are_carried_as_the_warped_surface_faces():
    mesh = bone(60, 90)
    u = landmarks(40)
    spline = solve(factorise(u), truth(u))
    carried = carried_normals(spline, mesh.vertices, vertex_normals(mesh))
    warped = vertex_normals(mesh.with_vertices(spline.evaluate(mesh.vertices)))
    assert np.percentile(np.sum(carried * warped, axis=1), 1) > 0.98


def test_even_places_are_as_many_as_the_area_asks_for():
    mesh = bone(12, 16)
    _, triangles = even_places(mesh, 20_000)
    areas = triangle_areas(mesh)
    expected = 20_000 * areas / areas.sum()
    assert np.abs(np.bincount(triangles, minlength=len(areas)) - expected).max() <= 1


def test_fewer_spread_places_are_the_first_of_more():
    mesh, taken = bone(12, 16), landmarks(5)
    many, of_many = spread_places(mesh, 90, taken)
    few, of_few = spread_places(mesh, 30, taken)
    np.testing.assert_array_equal(few, many[:30])
    np.testing.assert_array_equal(of_few, of_many[:30])


def test_spread_places_lie_on_the_surface_and_apart_from_one_another_and_landmarks():
    mesh, taken = bone(24, 40), landmarks(12)
    places, _ = spread_places(mesh, 150, taken)
    everything = np.vstack([taken, places])
    apart = np.linalg.norm(everything[:, None] - places[None], axis=2)
    apart[len(taken) + np.arange(150), np.arange(150)] = np.inf
    spacing = np.sqrt(triangle_areas(mesh).sum() / 150)
    assert apart.min() > 0.6 * spacing
    assert Surface(mesh).index.distances(places).max() < 1e-9


def test_places_stay_within_a_region():
    region = np.array([False, True])
    _, triangles = spread_places(SQUARE, 9, region=region)
    assert set(triangles.tolist()) == {1}


def test_a_mesh_without_area_has_no_place():
    flat = Mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
    with pytest.raises(MeshError, match="no area"):
        spread_places(flat, 3)
