from __future__ import annotations

import threading
import time

import numpy as np
import pytest
import pyvista as pv
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.core.femur import femur_landmarks, femur_meshes

from pinwarp.core import kernel, surface_distance
from pinwarp.core.errors import Cancelled, LandmarkError
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import factorise, solve
from pinwarp.core.surface_comparison import DistanceFigures, compare_surfaces
from pinwarp.core.surface_distance import SurfaceIndex

TRIANGLE = Mesh([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]])


def by_brute_force(mesh, places):
    """Every place against every triangle, in extended precision and by other formulas."""
    a, b, c = np.moveaxis(mesh.vertices.astype(np.longdouble)[mesh.faces], 1, 0)
    best = np.full(len(places), np.inf, np.longdouble)
    for i, place in enumerate(np.asarray(places, np.longdouble)):
        corners = [a - place, b - place, c - place]
        for k in range(3):
            best[i] = min(best[i], to_segments(corners[k], corners[(k + 1) % 3]).min())
        normal = np.cross(b - a, c - a)
        length = np.linalg.norm(normal.astype(float), axis=1)
        # Above or below a triangle, a place sees all edges turn the same way.
        turns = [
            np.sum(np.cross(corners[k], corners[(k + 1) % 3]) * normal, axis=1) for k in range(3)
        ]
        over = np.all(np.array(turns) > 0, axis=0) & (length > 0)
        if over.any():
            heights = np.abs(np.sum(corners[0] * normal, axis=1)[over])
            squares = np.sum(normal * normal, axis=1)[over]
            best[i] = min(best[i], (heights / np.sqrt(squares)).min())
    return best.astype(float)


def to_segments(p, q):
    way = q - p
    square = np.sum(way * way, axis=1)
    share = np.where(square > 0, -np.sum(p * way, axis=1) / np.where(square > 0, square, 1), 0)
    nearest = p + np.clip(share, 0, 1)[:, None] * way
    return np.sqrt(np.sum(nearest * nearest, axis=1))


def by_vtk(mesh, places):
    surface = pv.make_tri_mesh(mesh.vertices, mesh.faces)
    return np.abs(
        pv.PolyData(places).compute_implicit_distance(surface).point_data["implicit_distance"]
    )


@pytest.fixture(params=["compiled", "numpy"])
def way(request, monkeypatch):
    """Both ways of searching, whatever the size."""
    if request.param == "numpy":
        monkeypatch.setattr(kernel, "compiled", lambda: None)
    else:
        assert kernel.compiled() is not None
        monkeypatch.setattr(surface_distance, "WORTH_COMPILING", 0)
        monkeypatch.setattr(surface_distance, "WORTH_THREADS", 50)
    return request.param


@st.composite
def soups(draw):
    """Triangles of all kinds: fair ones, slivers, edges and places; some vertices unused."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(1, 60))
    scale = draw(st.sampled_from([1e-3, 1.0, 400.0]))
    vertices = rng.normal(size=(count + 6, 3)) * draw(st.sampled_from([1.0, 0.1]))
    faces = rng.integers(0, count + 3, (count, 3))
    kind = draw(st.sampled_from(["any", "flat", "slivers", "far", "clustered"]))
    if kind == "flat":
        vertices[:, 2] = 0
    elif kind == "slivers":
        vertices *= [1, 1e-5, 1e-5]
    elif kind == "far":
        vertices += 1000
    elif kind == "clustered":
        vertices[::2] *= 1e-3
    places = np.vstack(
        [
            vertices.mean(axis=0) + rng.normal(size=(60, 3)) * rng.choice([0.1, 1, 30], (60, 1)),
            vertices,
            vertices[faces].mean(axis=1),
        ]
    )
    return Mesh(vertices * scale, faces), places * scale


@given(soups())
def test_distances_are_what_every_triangle_asked_alone_says(soup):
    mesh, places = soup
    size = np.abs(mesh.vertices).max()
    expected = by_brute_force(mesh, places)
    index = SurfaceIndex(mesh)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(surface_distance, "WORTH_COMPILING", 0)
        compiled = index.distances(places)
        patch.setattr(kernel, "compiled", lambda: None)
        plain = index.distances(places)
    # Rounding in coordinates, and a little more for slivers, whose normals are not sharp.
    tolerance = 1e-10 * expected + 1e-10 * size
    assert (np.abs(compiled - expected) <= tolerance).all()
    assert (np.abs(plain - expected) <= tolerance).all()


@given(soups())
def test_the_closest_position_is_in_its_triangle_and_as_far_as_the_distance(soup):
    mesh, places = soup
    index = SurfaceIndex(mesh)
    positions, triangles = index.closest(places)
    size = np.abs(mesh.vertices).max() + np.abs(places).max()
    apart = np.linalg.norm(places - positions, axis=1)
    assert np.abs(apart - index.distances(places)).max() <= 1e-12 * size
    for position, row in zip(positions, triangles, strict=True):
        alone = Mesh(mesh.vertices, mesh.faces[row : row + 1])
        assert by_brute_force(alone, position[None])[0] <= 1e-12 * size


def test_vtk_says_the_same_of_a_closed_bone(way):
    solid = pv.ParametricEllipsoid(60, 60, 200).triangulate().clean()
    mesh = Mesh(np.asarray(solid.points, float), solid.regular_faces)
    rng = np.random.default_rng(0)
    places = rng.uniform(-1, 1, (500, 3)) * [90, 90, 250]
    assert np.abs(SurfaceIndex(mesh).distances(places) - by_vtk(mesh, places)).max() < 1e-9


def test_from_the_middle_of_a_ball_everything_is_as_close(way):
    ball = pv.Sphere(radius=1.0, theta_resolution=40, phi_resolution=40)
    mesh = Mesh(np.asarray(ball.points, float), ball.regular_faces)
    assert SurfaceIndex(mesh).distances(np.zeros((3, 3))) == pytest.approx(
        by_brute_force(mesh, np.zeros((1, 3)))[0], rel=1e-12
    )


def test_far_away_places_stay_exact(way):
    mesh = Mesh(np.random.default_rng(1).normal(size=(60, 3)), np.arange(60).reshape(-1, 3))
    for far in (1e3, 1e8, 1e15):
        places = np.random.default_rng(2).normal(size=(20, 3)) * far
        expected = by_brute_force(mesh, places)
        assert SurfaceIndex(mesh).distances(places) == pytest.approx(expected, rel=1e-14)


def test_one_triangle_has_a_face_edges_and_corners(way):
    index = SurfaceIndex(TRIANGLE)
    places = [[0.2, 0.3, -5], [0.5, -3, 4], [4, 0, 4], [-1, 1, 0], [0.25, 0.25, 0], [1, 2, 0]]
    expected = [5, 5, 5, 1, 0, 2 / 5**0.5]
    assert index.distances(places) == pytest.approx(expected)
    positions, triangles = index.closest(places)
    assert positions[5] == pytest.approx([0.2, 1.6, 0])
    assert set(triangles.tolist()) == {0}


@pytest.mark.parametrize(
    ("vertices", "place", "distance"),
    [
        ([[1, 1, 1]] * 3, [1, 1, 3], 2),
        ([[0, 0, 0], [2, 0, 0], [1, 0, 0]], [1.5, 3, 0], 3),
        ([[0, 0, 0], [2, 0, 0], [2, 0, 0]], [5, 4, 0], 5),
        ([[0, 0, 0], [0, 0, 0], [2, 0, 0]], [-3, 4, 0], 5),
        ([[0, 0, 0], [1e6, 0, 0], [5e5, 1e-3, 0]], [5e5, 5e-4, 7], 7),
    ],
)
def test_a_triangle_without_area_is_the_edge_or_place_it_is(way, vertices, place, distance):
    assert SurfaceIndex(Mesh(vertices, [[0, 1, 2]])).distances([place]) == pytest.approx(distance)


def test_a_vertex_without_a_triangle_is_no_surface(way):
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 2, 0], [9, 9, 9]], [[0, 1, 2]])
    assert SurfaceIndex(mesh).distances([[9, 9, 9]])[0] > 9
    compared = compare_surfaces(mesh, TRIANGLE)
    assert compared.forward[3] > 9
    assert compared.forward_figures.maximum == compared.hausdorff == 0


def test_no_places_are_fine_and_bad_ones_are_named(way):
    index = SurfaceIndex(TRIANGLE)
    assert index.distances(np.zeros((0, 3))).shape == (0,)
    positions, triangles = index.closest(np.zeros((0, 3)))
    assert positions.shape == (0, 3)
    assert triangles.shape == (0,)
    with pytest.raises(LandmarkError, match="row 1"):
        index.distances([[0, 0, 0], [0, np.nan, 0]])
    with pytest.raises(LandmarkError, match="shape"):
        index.distances([0, 0, 0])


def test_many_places_are_shared_by_threads_and_keep_their_order(monkeypatch):
    mesh = Mesh(np.random.default_rng(1).normal(size=(600, 3)), np.arange(600).reshape(-1, 3))
    places = np.random.default_rng(2).normal(size=(surface_distance.WORTH_THREADS + 3, 3))
    index = SurfaceIndex(mesh)
    together = index.distances(places)
    monkeypatch.setattr(surface_distance, "WORTH_THREADS", 10**9)
    assert np.array_equal(together, index.distances(places))
    # An index is asked by any thread at any time.
    answers = [np.empty(0)] * 4

    def ask(row):
        answers[row] = index.distances(places)

    threads = [threading.Thread(target=ask, args=(row,)) for row in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(answer, together) for answer in answers)


def test_warming_up_compiles_the_search_there_is_one_of():
    surface_distance.warm_up()
    loops = surface_distance._compiled()
    before = len(loops.closest_triangles.signatures)
    mesh = Mesh(np.random.default_rng(1).normal(size=(60, 3)), np.arange(60).reshape(-1, 3))
    SurfaceIndex(mesh).distances(np.random.default_rng(2).normal(size=(9000, 3)))
    SurfaceIndex(mesh).distances(np.repeat(mesh.vertices, 100, axis=0))
    read_only = np.repeat(mesh.vertices, 100, axis=0)
    read_only.setflags(write=False)
    SurfaceIndex(mesh).closest(read_only)
    assert before == len(loops.closest_triangles.signatures) == 1


def test_for_a_few_landmarks_on_a_bone_nothing_compiled_is_loaded(monkeypatch):
    asked = []
    monkeypatch.setattr(surface_distance, "_compiled", lambda: asked.append(True))
    ball = pv.Icosphere(radius=10.0, nsub=5)
    index = SurfaceIndex(Mesh(ball.points, ball.regular_faces))
    index.distances(index.mesh.vertices[:20])
    assert not asked
    index.distances(index.mesh.vertices[:2000])
    assert asked


# Comparisons


def test_a_comparison_has_both_directions_and_takes_ready_indexes():
    rng = np.random.default_rng(3)
    a = Mesh(rng.normal(size=(30, 3)), np.arange(30).reshape(-1, 3))
    b = Mesh(rng.normal(size=(42, 3)) + 1, np.arange(42).reshape(-1, 3))
    compared = compare_surfaces(a, b)
    assert compared.forward == pytest.approx(by_brute_force(b, a.vertices))
    assert compared.backward == pytest.approx(by_brute_force(a, b.vertices))
    assert compared.forward_figures == DistanceFigures.of(compared.forward)
    assert compared.hausdorff == max(compared.forward.max(), compared.backward.max())
    back = compare_surfaces(b, a, index_a=SurfaceIndex(b), index_b=SurfaceIndex(a))
    assert np.array_equal(back.backward, compared.forward)
    assert back.hausdorff == compared.hausdorff


def test_a_surface_lies_on_itself():
    mesh = Mesh(np.random.default_rng(3).normal(size=(300, 3)), np.arange(300).reshape(-1, 3))
    assert compare_surfaces(mesh, mesh).hausdorff < 1e-15


def test_figures_are_those_of_numpy():
    values = np.random.default_rng(4).uniform(0, 9, 101)
    figures = DistanceFigures.of(values)
    assert figures.mean == pytest.approx(values.mean())
    assert figures.rms == pytest.approx(np.linalg.norm(values) / 101**0.5)
    assert figures.percentile_95 == pytest.approx(np.sort(values)[95])
    assert figures.maximum == values.max()


def test_the_femur_lies_as_far_from_its_destination_as_documented(shared_data):
    _, source, destination = femur_landmarks(shared_data)
    mesh, target = femur_meshes(shared_data)
    spline = solve(factorise(source), destination)
    warped = mesh.with_vertices(spline.evaluate(mesh.vertices))
    compared = compare_surfaces(warped, target)
    figures = compared.forward_figures
    assert figures.mean == pytest.approx(2.25, rel=0.02)
    assert figures.percentile_95 == pytest.approx(5.40, rel=0.02)
    assert figures.maximum == pytest.approx(7.63, rel=0.02)
    assert np.abs(compared.forward - by_vtk(target, warped.vertices)).max() < 1e-9
    assert np.abs(compared.backward - by_vtk(warped, target.vertices)).max() < 1e-9


@given(st.integers(0, 2**31 - 1))
@settings(max_examples=20)
def test_an_index_like_that_of_other_vertices_is_as_exact(seed):
    rng = np.random.default_rng(seed)
    faces = rng.integers(0, 30, (60, 3))
    mesh = Mesh(rng.normal(size=(30, 3)), faces)
    moved = mesh.with_vertices(rng.normal(size=(30, 3)))
    places = rng.normal(size=(40, 3)) * 3
    found = SurfaceIndex(moved, like=SurfaceIndex(mesh)).distances(places)
    assert np.allclose(found, SurfaceIndex(moved).distances(places), rtol=0, atol=1e-12)


def test_an_index_like_that_of_other_triangles_sorts_anew():
    one = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    two = Mesh([[0, 0, 5], [1, 0, 5], [0, 1, 5], [1, 1, 9]], [[0, 1, 2], [1, 2, 3]])
    assert SurfaceIndex(two, like=SurfaceIndex(one)).distances([[1, 1, 9]]).tolist() == [0.0]


@pytest.mark.parametrize("threads", [1, 2])
def test_a_search_and_an_index_are_stopped_at_any_checkpoint(monkeypatch, threads):
    loops = surface_distance._compiled()
    if loops is None:
        pytest.skip("without numba")
    monkeypatch.setattr(loops, "THREADS", threads)
    monkeypatch.setattr(surface_distance, "PART", 100)
    places = np.random.default_rng(3).normal(size=(surface_distance.WORTH_THREADS, 3))
    mesh = Mesh(places, np.arange(len(places) // 3 * 3).reshape(-1, 3))
    index, told = SurfaceIndex(mesh), []
    index.distances(places, told.append)
    assert len(told) >= 40
    assert sorted(told) == told

    def stops(share):
        if share > 0.3:
            raise Cancelled("Cancelled.")

    searched = []
    search = loops.closest_triangles

    def slowly(*given):
        # So that who is to be told has a turn before all is done, on a busy machine too.
        time.sleep(0.005)
        searched.append(1)
        search(*given)

    monkeypatch.setattr(loops, "closest_triangles", slowly)
    with pytest.raises(Cancelled):
        index.distances(places, stops)
    assert len(searched) < 40
    with pytest.raises(Cancelled):
        SurfaceIndex(mesh, checkpoint=stops)
    with pytest.raises(Cancelled):
        compare_surfaces(mesh, mesh, checkpoint=stops)
