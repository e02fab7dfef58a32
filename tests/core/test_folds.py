from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv
from hypothesis import given
from hypothesis import strategies as st
from tests.core.femur import femur_landmarks, femur_meshes
from tests.core.strategies import rotations

from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.folds import AT_MOST, _losses, folds_of
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import factorise, identity, solve

SIZE = np.array([60.0, 60.0, 200.0])


def ellipsoid():
    ball = pv.Sphere(radius=1.0, theta_resolution=80, phi_resolution=40)
    return Mesh(np.asarray(ball.points, float) * SIZE, ball.regular_faces)


BONE = ellipsoid()


def pairs(seed, count=20):
    """Landmarks all over the made-up bone, and another subject's without a fold."""
    ways = np.random.default_rng(seed).normal(size=(count, 3))
    source = ways / np.linalg.norm(ways, axis=1)[:, None] * SIZE
    bent = source * [1.1, 1.0, 0.9] + 8 * np.sin(source[:, [1, 2, 0]] / 60)
    return source, bent @ rotations(seed)


def found(mesh, source, destination, penalty=0.0):
    spline = solve(factorise(source), destination, penalty)
    return folds_of(determinants(jacobians(spline, mesh.vertices)), mesh, spline)


def neighbours(source, row):
    """A landmark and the one next to it."""
    near = np.linalg.norm(source - source[row], axis=1).argsort()[1]
    return row, int(near)


@pytest.mark.parametrize("mirror", [1, -1])
def test_a_smooth_warp_has_no_fold_mirrored_or_not(mirror):
    source, destination = pairs(1)
    folds = found(BONE, source, destination * [1, 1, mirror])
    assert folds.mirrors == (mirror < 0)
    assert folds.count == 0
    assert folds.patches == ()


@pytest.mark.parametrize("mirror", [1, -1])
@pytest.mark.parametrize("seed", [0, 1, 2, 4, 5, 7])
def test_two_neighbours_exchanged_are_the_ones_responsible(seed, mirror):
    source, destination = pairs(seed)
    i, j = neighbours(source, int(np.random.default_rng(seed).integers(20)))
    destination[[i, j]] = destination[[j, i]]
    folds = found(BONE, source, destination * [1, 1, mirror])
    assert folds.mirrors == (mirror < 0)
    largest = folds.patches[0]
    assert set(largest.landmarks) == {i, j}
    # The fold is between them.
    middle = BONE.vertices[largest.vertices].mean(axis=0)
    assert set(np.linalg.norm(source - middle, axis=1).argsort()[:3]) >= {i, j}


@pytest.mark.parametrize("seed", range(7))
def test_a_landmark_pulled_past_its_neighbour_folds_with_it(seed):
    source, destination = pairs(seed)
    i, j = neighbours(source, 3)
    destination[i] += 2 * (destination[j] - destination[i])
    folds = found(BONE, source, destination)
    assert set(folds.patches[0].landmarks) == {i, j}


def test_two_folds_apart_are_two_patches_each_with_its_own_landmarks():
    source, destination = pairs(2, 40)
    low = neighbours(source, int(source[:, 2].argmin()))
    high = neighbours(source, int(source[:, 2].argmax()))
    for i, j in (low, high):
        destination[[i, j]] = destination[[j, i]]
    patches = found(BONE, source, destination).patches
    assert {frozenset(patch.landmarks) for patch in patches} == {frozenset(low), frozenset(high)}


def test_patches_are_what_is_connected_by_folded_edges_and_nothing_is_lost():
    source, destination = pairs(3)
    folds = found(BONE, source, destination[np.random.default_rng(0).permutation(20)])
    sizes = [len(patch.vertices) for patch in folds.patches]
    assert len(sizes) > 1
    assert sizes == sorted(sizes, reverse=True)
    assert sum(sizes) == folds.count == folds.is_folded.sum()
    patch_of = np.full(len(BONE.vertices), -1)
    for number, patch in enumerate(folds.patches):
        assert (patch_of[patch.vertices] == -1).all()
        patch_of[patch.vertices] = number
        assert 1 <= len(patch.landmarks) <= AT_MOST
        # Flooding from any one of its vertices reaches them all.
        reached = {int(patch.vertices[0])}
        inside = BONE.faces[folds.is_folded[BONE.faces].sum(axis=1) >= 2]
        while True:
            touching = inside[np.isin(inside, list(reached)).any(axis=1)]
            grown = reached | set(touching[folds.is_folded[touching]].tolist())
            if grown == reached:
                break
            reached = grown
        assert reached == set(patch.vertices.tolist())
    assert ((patch_of >= 0) == folds.is_folded).all()


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 5.0]))
def test_what_the_landmarks_take_is_all_that_is_lost(seed, penalty):
    source, destination = pairs(seed, 8)
    destination += 20 * np.random.default_rng(seed).normal(size=destination.shape)
    spline = solve(factorise(source), destination, penalty)
    # At a landmark, too, where its own term is left out.
    places = np.vstack([BONE.vertices[::97], source])
    lost = np.linalg.det(spline.affine[1:]) - determinants(jacobians(spline, places))
    assert _losses(spline, places).sum() == pytest.approx(lost.sum(), rel=1e-8, abs=1e-8)


def test_the_determinant_and_not_the_spline_says_where():
    determinant = np.ones(len(BONE.vertices))
    determinant[[0, 500]] = [0.0, -1.0]
    source, destination = pairs(0)
    folds = folds_of(determinant, BONE, solve(factorise(source), destination))
    assert [patch.vertices.tolist() for patch in folds.patches] == [[0], [500]]
    with pytest.raises(ValueError, match="determinants"):
        folds_of(determinant[:-1], BONE, identity())


def test_a_vertex_without_a_triangle_cannot_fold():
    mesh = Mesh([*np.eye(3), [5, 5, 5]], [[0, 1, 2]])
    assert folds_of([-1.0, 1.0, 1.0, -1.0], mesh, identity()).count == 1


def test_an_affine_map_that_flattens_everything_names_no_landmark():
    source, _ = pairs(0)
    flat = solve(factorise(source), source * [1, 1, 0], np.inf)
    folds = folds_of(np.zeros(len(BONE.vertices)), BONE, flat)
    assert folds.count == len(BONE.vertices)
    assert len(folds.patches) == 1
    assert folds.patches[0].landmarks == ()


def test_a_fold_is_said_in_words():
    names = ["landmark_3", "landmark_9", "apex"]

    def said(rows, count):
        return Finding(FindingKind.FOLD, rows, count).describe(names, "mm")

    end = ": the warp turns the surface inside out there."
    assert said((0, 1), 312) == "312 vertices fold near landmark_3 and landmark_9" + end
    assert said((2,), 1) == "1 vertex folds near apex" + end
    assert said((2, 1, 0), 1312) == (
        "1,312 vertices fold near apex, landmark_9 and landmark_3" + end
    )
    assert said((), 2) == "2 vertices fold" + end


def test_a_patch_is_a_finding():
    source, destination = pairs(0)
    i, j = neighbours(source, 5)
    destination[[i, j]] = destination[[j, i]]
    patch = found(BONE, source, destination).patches[0]
    assert patch.finding == Finding(FindingKind.FOLD, patch.landmarks, len(patch.vertices))


# The real femur


def test_the_femur_does_not_fold_until_two_landmarks_are_exchanged(shared_data):
    names, source, destination = femur_landmarks(shared_data)
    mesh, _ = femur_meshes(shared_data)
    assert found(mesh, source, destination).count == 0
    swapped = [names.index(name) for name in ("landmark_11", "landmark_17")]
    destination[swapped] = destination[swapped[::-1]]
    folds = found(mesh, source, destination)
    assert folds.count > 0
    assert set(folds.patches[0].landmarks[:2]) == set(swapped)
