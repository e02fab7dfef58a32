"""Poses from nothing: neither place, turn, unit nor hand may matter."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.core.hooked import hooked
from tests.core.strategies import rotations

from pinwarp.core.mesh import Mesh
from pinwarp.core.plain_surface import rms_radius
from pinwarp.core.pose import Mirror, Pose, PoseSettings, find_poses


class StoppedError(Exception):
    """What a progress raises to end a search."""


def a_pose(seed: int, unit: float, *, mirrored: bool) -> Pose:
    hand = np.diag([1.0, -1.0 if mirrored else 1.0, 1.0])
    return Pose(unit, rotations(seed) @ hand, unit * np.array([300.0, -20.0, 7.0]))


@settings(max_examples=2)
@given(st.integers(0, 99), st.sampled_from([1e-3, 1.0, 1e3]), st.booleans())
def test_a_pose_is_found_whatever_the_turn_the_unit_and_the_hand(seed, unit, mirrored):
    bone, true = hooked(), a_pose(seed, unit, mirrored=mirrored)
    best = find_poses(bone, true.posed(bone))[0]
    assert best.mirrored == mirrored
    off = best.apply(bone.vertices) - true.apply(bone.vertices)
    assert np.abs(off).max() < 0.03 * unit * rms_radius(bone.vertices)


def test_the_same_surfaces_give_the_same_poses_and_a_known_hand_is_the_only_one_tried():
    bone = hooked()
    subject = a_pose(1, 1.0, mirrored=False).posed(bone)
    one, two = (find_poses(bone, subject, PoseSettings(Mirror.YES)) for _ in range(2))
    assert len(one) > 1
    assert all(pose.mirrored for pose in one)
    assert [pose.cost for pose in one] == sorted(pose.cost for pose in two)
    for pose, again in zip(one, two, strict=True):
        np.testing.assert_array_equal(pose.rotation, again.rotation)


@pytest.mark.parametrize("calls", [1, 50])
def test_a_search_ends_where_its_progress_raises(calls):
    told = []

    def stop(share, words):
        told.append((share, words))
        if len(told) == calls:
            raise StoppedError

    with pytest.raises(StoppedError):
        find_poses(hooked(), hooked(), progress=stop)
    assert len(told) == calls
    assert [share for share, _ in told] == sorted(share for share, _ in told)
    assert all("pose" in words for _, words in told)


@given(st.integers(0, 99), st.booleans(), st.booleans())
def test_poses_follow_one_another_and_go_back(seed, first_mirrors, then_mirrors):
    first = a_pose(seed, 0.5, mirrored=first_mirrors)
    then = a_pose(seed + 1, 3.0, mirrored=then_mirrors)
    points = np.random.default_rng(seed).normal(size=(5, 3))
    both = then.after(first)
    assert both.mirrored == (first_mirrors != then_mirrors)
    np.testing.assert_allclose(both.apply(points), then.apply(first.apply(points)))
    np.testing.assert_allclose(then.back(then.apply(points)), points, atol=1e-9)


def test_a_posed_mesh_keeps_its_outside_outside():
    tetrahedron = Mesh(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    )
    for mirrored in (False, True):
        mesh = a_pose(2, 2.0, mirrored=mirrored).posed(tetrahedron)
        a, b, c = (mesh.vertices[mesh.faces[:, k]] - mesh.vertices.mean(axis=0) for k in range(3))
        assert np.sum(a * np.cross(b, c)) / 6 == pytest.approx(8 / 6)
