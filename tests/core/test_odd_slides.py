"""Meshes, curves and patches as nobody should have them: each slides, or says what to do."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from tests.core.bones import bone, landmarks, shape, truth
from tests.core.pelvis import pelvis_landmarks, pelvis_meshes

from pinwarp.core.curves import PathFinder
from pinwarp.core.errors import LandmarkError, MeshError, RangeError
from pinwarp.core.gathering import gathered, with_points_over
from pinwarp.core.groups import Curve, Handle, Patch, anchored, moved_group
from pinwarp.core.held_slide import HeldSlide
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.sliding import Semilandmarks, slide
from pinwarp.core.surface import Surface
from pinwarp.io.meshes import read_mesh

MESH = bone()
FACES = MESH.faces
TRUTH = MESH.with_vertices(truth(MESH.vertices))
U = landmarks(14)
V = truth(U)
RING = shape(np.arange(6) * np.pi / 3, np.full(6, 1.3))
CREST = shape(np.full(3, 0.4), np.array([0.8, 1.2, 1.6]))


def curve(name, places, count, *, is_closed=False, anchors=(), there=None):
    """A curve, of which the first or last handles may be at landmarks of these rows."""
    ends = [None] * len(places) if there is None else there
    handles = [Handle(place, end) for place, end in zip(places, ends, strict=True)]
    for at, row in anchors:
        handles[at] = Handle(handles[at].source, handles[at].destination, f"lm_{row}")
    return Curve(name, tuple(handles), is_closed, count, drawn=there is not None)


def patch(name, count, around="", inside=None):
    """A patch whose points are still to be found, and how many."""
    return Patch(name, (), around, inside), count


GROUPS = (
    curve("ring", RING, 10, is_closed=True),
    curve("crest", CREST, 5),
    patch("whole", 100),
)


def anchored_at(group, named):
    return anchored(group, {name: Landmark(name, place) for name, place in named.items()})


def slid(groups=GROUPS, source=MESH, destination=TRUTH, u=U, v=V):
    """Gather and slide, and see that all is as it must be."""
    surface, finder = Surface(destination), PathFinder(Surface(source))
    named = {f"lm_{row}": place for row, place in enumerate(u)}
    made = []
    for group in groups:
        if isinstance(group, tuple):
            group = with_points_over(*group, finder, named.values(), made)
        made.append(anchored_at(group, named))
    points = gathered(made, named, finder, lambda: PathFinder(surface))
    found = slide(u, v, points.semilandmarks, surface)
    assert all(b <= a for a, b in itertools.pairwise(found.energies))
    assert len(found.energies) <= 16
    assert np.isfinite(found.positions).all()
    size = np.ptp(v)
    assert np.abs(found.spline.evaluate(u) - v).max() < 1e-9 * size
    assert surface.index.distances(found.positions[~found.is_freed]).max() < 1e-9 * size
    at_rest = HeldSlide.of(found).warp(v)
    places = found.spline.source
    assert np.abs(at_rest.evaluate(places) - found.spline.evaluate(places)).max() < 1e-9 * size
    return found


ORDINARY = slid()


def scaled(group, unit):
    if isinstance(group, tuple):
        return group
    return moved_group(group, Side.SOURCE, lambda places: unit * np.array(places))


@pytest.mark.parametrize("unit", [1e-9, 1e-3, 1e6, 1e12])
def test_the_unit_does_not_matter(unit):
    found = slid(
        [scaled(group, unit) for group in GROUPS],
        MESH.with_vertices(unit * MESH.vertices),
        MESH.with_vertices(unit * TRUTH.vertices),
        unit * U,
        unit * V,
    )
    np.testing.assert_allclose(found.positions / unit, ORDINARY.positions, atol=1e-3)


@pytest.mark.parametrize("unit", [1e-70, 1e70])
def test_what_no_distance_can_be_measured_in_is_refused(unit):
    with pytest.raises(RangeError, match="check its unit"):
        slid([scaled(GROUPS[0], unit)], MESH.with_vertices(unit * MESH.vertices), TRUTH, unit * U)


def soup(mesh):
    return Mesh(mesh.vertices[mesh.faces.ravel()], np.arange(mesh.faces.size).reshape(-1, 3))


def with_strays(mesh):
    """Vertices without a triangle, far away."""
    return Mesh(np.vstack([mesh.vertices, [[1e4, 0, 0], [0, 1e5, 0]]]), mesh.faces)


def with_slivers(mesh):
    """Triangles without an area, of which one is a place and one an edge."""
    return Mesh(mesh.vertices, [[3, 3, 3], [5, 5, 6], *mesh.faces])


def with_some_twice(mesh):
    return Mesh(mesh.vertices, np.vstack([mesh.faces, mesh.faces[300:700]]))


def with_fins(mesh):
    """Triangles that stand off edges, which three share then."""
    rows = mesh.faces[::200, :2]
    tips = mesh.vertices[rows[:, 0]] * [1.3, 1.3, 1.0]
    fins = np.column_stack([rows, len(mesh.vertices) + np.arange(len(rows))])
    return Mesh(np.vstack([mesh.vertices, tips]), np.vstack([mesh.faces, fins]))


def with_some_turned(mesh):
    faces = mesh.faces.copy()
    faces[::9] = faces[::9, ::-1]
    return Mesh(mesh.vertices, faces)


DAMAGES = [soup, with_strays, with_slivers, with_some_twice, with_fins, with_some_turned]


@pytest.mark.parametrize("damaged", DAMAGES)
def test_damaged_meshes_slide_nearly_as_whole_ones_do(damaged):
    for source, destination in ((damaged(MESH), TRUTH), (MESH, damaged(TRUTH))):
        found = slid(source=source, destination=destination)
        assert found.freed < 12
        apart = found.spline.evaluate(MESH.vertices) - ORDINARY.spline.evaluate(MESH.vertices)
        assert np.sqrt(np.mean(np.sum(apart**2, axis=1))) < 1.0


def test_points_over_holes_are_freed_and_the_others_slide():
    gone = np.concatenate([np.arange(100, 140), np.arange(700, 760), np.arange(1300, 1350)])
    found = slid(destination=Mesh(TRUTH.vertices, np.delete(FACES, gone, axis=0)))
    assert 0 < found.freed < 15


@pytest.mark.parametrize("count", [1, 2, 1500])
def test_one_point_or_more_than_there_are_vertices_slide(count):
    assert len(slid([patch("whole", count)]).positions) == count


def test_landmarks_off_the_surface_do_no_harm():
    off = np.array([3.0, 2.0, 1.0])
    ends = curve("ends", CREST, 6, anchors=[(0, 3), (-1, 5)])
    assert slid([*GROUPS, ends], u=U + off, v=V + off).freed < 5


def test_handles_off_the_surface_are_laid_on_it():
    found = slid([curve("ring", RING * [3, 3, 1], 10, is_closed=True)])
    assert found.freed == 0


def test_a_curve_may_be_drawn_from_either_end():
    crest, reverse = (
        curve("crest", CREST[::step], 5, there=truth(CREST)[::step]) for step in (1, -1)
    )
    one, other = (slid([group, GROUPS[2]]).positions for group in (crest, reverse))
    np.testing.assert_allclose(one[5:], other[5:], atol=0.5)
    np.testing.assert_allclose(one[:5], other[4::-1], atol=0.5)


def test_two_handles_at_one_place_are_one():
    doubled = curve("crest", CREST[[0, 0, 1, 2, 2]], 5)
    plain = slid(GROUPS[1:2]).positions
    np.testing.assert_allclose(slid([doubled]).positions, plain, atol=1e-9)


def test_patches_on_both_sides_of_a_curve_and_over_one_another_slide():
    inside, outside = np.array([0, 0, 100.0]), np.array([0, 0, -100.0])
    patches = [patch("whole", 80), patch("cap", 80, "ring", inside)]
    assert slid([GROUPS[0], *patches, patch("rest", 40, "ring", outside)]).freed < 5


def test_the_real_pelvis_where_three_triangles_share_edges_takes_curves(shared_data):
    template, target = pelvis_meshes(shared_data)
    rows = pelvis_landmarks(template)
    raw = read_mesh(shared_data / "msk-morph-pelvis" / "target_pelvis_r.stl").mesh
    groups = [
        curve("open", template.vertices[rows[[0, 3, 5]]], 8, anchors=[(0, 0), (-1, 5)]),
        curve(
            "closed",
            template.vertices[rows[[1, 4, 2, 7]]],
            8,
            is_closed=True,
            anchors=[(0, 1)],
        ),
        patch("inside", 40, "closed", template.vertices[rows[9]]),
    ]
    for destination in (target, raw):
        assert slid(groups, template, destination, template.vertices[rows], target.vertices[rows])


MIXED = FACES.copy()
MIXED[:700] = MIXED[:700, ::-1]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"destination": Mesh(TRUTH.vertices, FACES[:, ::-1])}, "most likely the destination"),
        ({"destination": Mesh(TRUTH.vertices, MIXED)}, "inside out in part"),
        ({"destination": Mesh(np.eye(3), [[0, 1, 2]])}, "ends before all points"),
        ({"v": V + 500}, "Look for wrong pairs"),
        ({"v": V[np.random.default_rng(0).permutation(14)]}, "Look for wrong pairs"),
        ({"u": np.vstack([U, U[:1]]), "v": np.vstack([V, V[:1]])}, "rows 0 and 14"),
        (
            {"u": np.vstack([U, U[:1] + 1e-4]), "v": np.vstack([V, V[:1]])},
            "Points 0 and 14 of the source lie at one place, or nearly",
        ),
        ({"groups": [patch("whole", 100_000)]}, "whole: 100,000 points"),
        ({"groups": [patch("one", 3000), patch("two", 3000)]}, "at most 5,000 can slide"),
    ],
)
def test_what_cannot_slide_is_refused_in_words(given, words):
    with pytest.raises((LandmarkError, MeshError), match=words):
        slid(**given)


def test_points_that_all_lose_their_counterpart_are_refused():
    # The rest of the bone is there, but not where these points are.
    around = np.abs(TRUTH.vertices[FACES].mean(axis=1) - truth(RING).mean(axis=0)).max(axis=1)
    half = Mesh(TRUTH.vertices, FACES[around > 40])
    with pytest.raises(MeshError, match=r"ends before all points|No point has a counterpart"):
        slide(U, V, Semilandmarks(RING, RING * [0.08, 0.08, 0]), Surface(half))


@pytest.mark.parametrize(
    ("normals", "words"),
    [(np.full((6, 3), np.nan), "normal of a semilandmark"), (np.ones((2, 3)), "2 normals")],
)
def test_normals_that_are_none_are_refused(normals, words):
    with pytest.raises(LandmarkError, match=words):
        slide(U, V, Semilandmarks(RING, normals), Surface(TRUTH))


def test_a_point_at_a_landmark_is_named():
    with pytest.raises(LandmarkError, match="Points 2 and 14"):
        slide(U, V, Semilandmarks(U[2:3], Surface(MESH).closest(U[2:3]).normals), Surface(TRUTH))
