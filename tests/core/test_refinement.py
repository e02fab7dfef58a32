from __future__ import annotations

import itertools

import numpy as np
import pytest
from tests.core.bones import bone, landmarks, off_truth, truth
from tests.core.femur import femur_landmarks, femur_meshes
from tests.core.pelvis import pelvis_landmarks, pelvis_meshes

from pinwarp.core.errors import LandmarkError, MeshError, PenaltyError
from pinwarp.core.factor import factorise
from pinwarp.core.folds import folds_of
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.mesh import Mesh
from pinwarp.core.readiness import InsideOutError
from pinwarp.core.refinement import refine
from pinwarp.core.refinement_inputs import RefinementSettings
from pinwarp.core.sampling import even_places
from pinwarp.core.spline import solve
from pinwarp.core.surface_distance import SurfaceIndex

SOURCE = bone()
TRUTH = SOURCE.with_vertices(truth(SOURCE.vertices))
COARSE = RefinementSettings(smallest_feature=14.0)


def distances(spline, destination=TRUTH, source=SOURCE):
    return SurfaceIndex(destination).distances(spline.evaluate(source.vertices))


def folded(spline, source=SOURCE):
    return folds_of(determinants(jacobians(spline, source.vertices)), source, spline).count


def turned(mesh):
    return Mesh(mesh.vertices, mesh.faces[:, ::-1])


@pytest.mark.parametrize("count", [10, 20, 40])
def test_a_refined_warp_is_nearer_to_the_truth_at_places_that_were_no_landmarks(count):
    u = landmarks(count)
    before = solve(factorise(u), truth(u))
    refined = refine(SOURCE, TRUTH, u, truth(u), COARSE)
    assert off_truth(refined.spline) < 0.85 * off_truth(before)
    assert distances(refined.spline).mean() < 0.4 * distances(before).mean()
    assert np.abs(refined.spline.evaluate(u) - truth(u)).max() < 1e-8
    assert refined.folding == 0
    assert folded(refined.spline) == 0


def test_the_refined_warp_is_the_ordinary_spline_of_its_pairs():
    u = landmarks(10)
    refined = refine(SOURCE, TRUTH, u, truth(u), COARSE)
    again = solve(factorise(refined.pairs[0]), refined.pairs[1])
    apart = again.evaluate(SOURCE.vertices) - refined.spline.evaluate(SOURCE.vertices)
    assert np.abs(apart).max() < 1e-8
    assert refined.landmarks == 10
    assert len(refined.pairs[0]) == 10 + refined.fitted


def test_refining_twice_gives_the_same_bit_for_bit():
    u = landmarks(10)
    first, second = (refine(SOURCE, TRUTH, u, truth(u), COARSE).spline for _ in range(2))
    np.testing.assert_array_equal(first.weights, second.weights)
    np.testing.assert_array_equal(first.affine, second.affine)


def test_every_level_is_told_and_is_a_warp_without_folds_that_comes_closer():
    u, levels = landmarks(10), []
    refined = refine(SOURCE, TRUTH, u, truth(u), COARSE, told=levels.append)
    assert [level.number for level in levels] == list(range(1, levels[0].count + 1))
    assert levels[-1].feature == 14.0
    assert all(b.feature < a.feature for a, b in itertools.pairwise(levels))
    means = [distances(level.spline).mean() for level in levels]
    assert means[-1] < 0.5 * means[0]
    assert all(folded(level.spline) == 0 for level in levels)
    assert levels[-1].spline is refined.spline


def test_whoever_watches_may_end_it():
    class Enough(Exception):
        pass

    def stop(share, words):
        assert words
        if share > 0.5:
            raise Enough

    u = landmarks(10)
    with pytest.raises(Enough):
        refine(SOURCE, TRUTH, u, truth(u), COARSE, progress=stop)


def test_the_unit_does_not_matter():
    u = landmarks(12)
    refined = refine(SOURCE, TRUTH, u, truth(u), COARSE).spline.evaluate(SOURCE.vertices)
    small = [mesh.with_vertices(1e-3 * mesh.vertices) for mesh in (SOURCE, TRUTH)]
    settings = RefinementSettings(smallest_feature=14e-3)
    metres = refine(*small, 1e-3 * u, 1e-3 * truth(u), settings).spline
    np.testing.assert_allclose(1e3 * metres.evaluate(small[0].vertices), refined, atol=1e-5)


def test_smaller_features_are_followed_by_more_places():
    u = landmarks(12)
    coarse = refine(SOURCE, TRUTH, u, truth(u), RefinementSettings(smallest_feature=40.0))
    fine = refine(SOURCE, TRUTH, u, truth(u), RefinementSettings(smallest_feature=11.0))
    assert fine.places > coarse.places
    assert distances(fine.spline).mean() < distances(coarse.spline).mean()


def test_half_a_destination_is_fitted_where_it_is_and_folds_nothing():
    middle = TRUTH.vertices[TRUTH.faces].mean(axis=1)[:, 2]
    half = Mesh(TRUTH.vertices, TRUTH.faces[middle > 55.0])
    u = landmarks(20)
    before = solve(factorise(u), truth(u))
    refined = refine(SOURCE, half, u, truth(u), COARSE)
    covered = SOURCE.vertices[TRUTH.vertices[:, 2] > 65.0]
    index = SurfaceIndex(half)
    assert index.distances(refined.spline.evaluate(covered)).mean() < 0.5 * (
        index.distances(before.evaluate(covered)).mean()
    )
    assert refined.fitted < 0.75 * refined.places
    assert folded(refined.spline) == 0
    # What is not covered goes about where the landmarks take it.
    beyond = SOURCE.vertices[TRUTH.vertices[:, 2] < 40.0]
    assert off_truth(refined.spline, beyond) < 1.5 * off_truth(before, beyond)


def test_holes_separate_triangles_and_edges_of_three_do_no_harm():
    u = landmarks(16)
    whole = refine(SOURCE, TRUTH, u, truth(u), COARSE).spline
    holed = Mesh(TRUTH.vertices, np.delete(TRUTH.faces, np.arange(400, 440), axis=0))
    soup = Mesh(TRUTH.vertices[TRUTH.faces.ravel()], np.arange(TRUTH.faces.size).reshape(-1, 3))
    a, b, _ = TRUTH.faces[300]
    away = TRUTH.vertices[a] + [60.0, 0, 0]
    fin = Mesh([*TRUTH.vertices, away], [*TRUTH.faces, [a, b, len(TRUTH.vertices)]])
    for destination in (holed, soup, fin):
        refined = refine(SOURCE, destination, u, truth(u), COARSE).spline
        assert folded(refined) == 0
        assert distances(refined).mean() < 1.5 * distances(whole).mean()


@pytest.mark.parametrize(
    ("source", "destination", "culprit"),
    [(turned(SOURCE), TRUTH, "source"), (SOURCE, turned(TRUTH), "destination")],
)
def test_an_inside_out_mesh_is_refused_by_name_and_turned_by_choice(source, destination, culprit):
    u = landmarks(10)
    with pytest.raises(InsideOutError, match=f"most likely the {culprit}"):
        refine(source, destination, u, truth(u), COARSE)
    settings = RefinementSettings(smallest_feature=14.0, turn_destination=True)
    refined = refine(source, destination, u, truth(u), settings)
    expected = refine(SOURCE, TRUTH, u, truth(u), COARSE)
    assert distances(refined.spline).mean() < 1.2 * distances(expected.spline).mean()


@pytest.mark.parametrize(
    ("source", "destination", "words"),
    [
        (landmarks(3), truth(landmarks(3)), "from 4 on"),
        (landmarks(9) * [1, 0, 1], truth(landmarks(9)), "in one plane"),
        (landmarks(9) * [-1, 1, 1], truth(landmarks(9)), "mirror"),
        (landmarks(9), truth(landmarks(8)), "each needs its counterpart"),
        (landmarks(9) * np.nan, truth(landmarks(9)), "not usable"),
    ],
)
def test_landmarks_that_cannot_begin_it_are_refused_in_words(source, destination, words):
    with pytest.raises(LandmarkError, match=words):
        refine(SOURCE, TRUTH, source, destination, COARSE)


def test_bones_that_do_not_lie_on_one_another_are_refused():
    u = landmarks(10)
    with pytest.raises(MeshError, match="Look for wrong pairs"):
        refine(SOURCE, TRUTH, u, truth(u) + np.array([70.0, 0, 0]), COARSE)


@pytest.mark.parametrize("feature", [0.0, -1.0, np.nan, np.inf])
def test_a_smallest_feature_that_is_no_length_is_refused(feature):
    with pytest.raises(LandmarkError, match="smallest feature"):
        RefinementSettings(smallest_feature=feature)


def test_a_negative_tolerance_is_refused():
    with pytest.raises(PenaltyError):
        RefinementSettings(landmark_tolerance=-1.0)


def test_with_a_tolerance_wrong_landmarks_pull_less():
    u = landmarks(24)
    v = truth(u) + np.random.default_rng(5).normal(scale=3.0, size=u.shape)
    met = refine(SOURCE, TRUTH, u, v, COARSE)
    tolerant = refine(
        SOURCE, TRUTH, u, v, RefinementSettings(smallest_feature=14.0, landmark_tolerance=30.0)
    )
    assert off_truth(tolerant.spline) < 0.8 * off_truth(met.spline)


def test_what_the_landmarks_fold_is_left_and_nothing_else_folds():
    # Two vertices change places, and turn over what lies between them.
    u = np.vstack([landmarks(20), SOURCE.vertices[[400, 402]]])
    v = truth(u)
    v[[20, 21]] = v[[21, 20]]
    before = solve(factorise(u), v)
    there = determinants(jacobians(before, SOURCE.vertices)) <= 0
    refined = refine(SOURCE, TRUTH, u, v, COARSE)
    after = determinants(jacobians(refined.spline, SOURCE.vertices)) <= 0
    assert there.any()
    assert not (after & ~there).any()


def test_places_close_to_noise_do_not_fold():
    rng = np.random.default_rng(3)
    noisy = TRUTH.with_vertices(TRUTH.vertices + rng.normal(scale=0.5, size=TRUTH.vertices.shape))
    u = landmarks(20)
    refined = refine(SOURCE, noisy, u, truth(u), RefinementSettings(smallest_feature=8.0))
    assert folded(refined.spline) == 0
    assert distances(refined.spline).mean() < 0.5


def test_the_real_femur_reaches_the_targets(shared_data):
    _, u, v = femur_landmarks(shared_data)
    source, destination = femur_meshes(shared_data)
    refined = refine(source, destination, u, v)
    places, _ = even_places(source, 5000)
    distance = SurfaceIndex(destination).distances(refined.spline.evaluate(places))
    assert distance.mean() <= 0.30
    assert np.percentile(distance, 95) <= 0.80
    assert np.abs(refined.spline.evaluate(u) - v).max() < 1e-8
    assert refined.folding == 0
    assert folded(refined.spline, source) == 0


def test_the_pelvis_is_refined_to_what_truly_answers_to_what(shared_data):
    template, target = pelvis_meshes(shared_data)
    rows = pelvis_landmarks(template)
    u, v = template.vertices[rows], target.vertices[rows]
    refined = refine(template, target, u, v, RefinementSettings(smallest_feature=9.0))
    missed = np.linalg.norm(refined.spline.evaluate(template.vertices) - target.vertices, axis=1)
    assert np.sqrt(np.mean(missed**2)) < 1.5
    assert folded(refined.spline, template) == 0


def test_half_of_the_real_femur_is_fitted_where_it_is(shared_data):
    _, u, v = femur_landmarks(shared_data)
    source, destination = femur_meshes(shared_data)
    axis = int(np.argmax(np.ptp(destination.vertices, axis=0)))
    along = destination.vertices[destination.faces].mean(axis=1)[:, axis]
    half = Mesh(destination.vertices, destination.faces[along > np.median(along)])
    refined = refine(source, half, u, v, RefinementSettings(smallest_feature=12.0))
    places, _ = even_places(half, 5000)
    warped = source.with_vertices(refined.spline.evaluate(source.vertices))
    assert SurfaceIndex(warped).distances(places).mean() < 0.8
    assert folded(refined.spline, source) == 0
