"""What accepted landmarks tell about the others."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.hooked import hooked, places

from pinwarp.core.errors import LandmarkError
from pinwarp.core.guessed import Reading, guessed
from pinwarp.core.mesh import Mesh
from pinwarp.core.pose import Pose
from pinwarp.core.spline import factorise, solve
from pinwarp.core.surface import Surface

SIZE = 60.0


def reading_of(mesh: Mesh, radius=3.0) -> Reading:
    """A reading that takes every place to where it is."""
    corners = 50 * np.vstack([np.zeros(3), np.eye(3)])
    still = Pose(1.0, np.eye(3), np.zeros(3))
    return Reading(still, solve(factorise(corners), corners), Surface(mesh), SIZE, 0.01, radius)


@pytest.fixture(scope="module")
def reading():
    return reading_of(hooked())


def test_with_nothing_accepted_places_are_where_the_reading_has_them(reading):
    found = guessed(reading, places())
    np.testing.assert_array_equal(found.positions, reading.evaluate(places()))
    assert set(found.radii) == {3.0}
    assert not found.beyond_rim.any()
    assert sorted(found.order) == list(range(len(places())))


def test_what_an_accepted_landmark_missed_moves_its_neighbours_most(reading):
    u = reading.surface.closest(places()).positions
    missed = reading.surface.closest(u[:1] + np.array([4.0, 3.0, 0.0])).positions
    before, after = guessed(reading, u), guessed(reading, u, u[:1], missed)
    moved = np.linalg.norm(after.positions - before.positions, axis=1)
    away = np.linalg.norm(u - u[0], axis=1)
    assert moved[0] > 0.5 * np.linalg.norm(missed - u[0])
    assert moved[away > 2 * SIZE].max() < 0.2 * moved[0]
    assert after.order[0] == 0


def test_the_doubt_follows_how_far_accepted_landmarks_lay_off(reading):
    u = reading.surface.closest(places(8)).positions
    met = guessed(reading, u, u[:6], u[:6]).radii[0]
    # With six that were met exactly, four that are worth the doubt at first are left.
    assert met == pytest.approx(3.0 * np.sqrt(4 / 10), rel=1e-3)
    far = reading.surface.closest(u[:6] + np.array([20.0, 0, 0])).positions
    assert guessed(reading, u, u[:6], far).radii[0] > 3.0


def test_pairs_that_the_warp_was_made_to_meet_prove_nothing_about_it(reading):
    u = reading.surface.closest(places(8)).positions
    met = Reading(
        reading.pose, reading.spline, reading.surface, SIZE, 0.01, 3.0, met=(u[:6], u[:6])
    )
    assert guessed(met, u, u[:6], u[:6]).radii[0] == pytest.approx(3.0)


def test_what_lies_beyond_the_end_of_the_destination_is_said_to():
    bone = hooked()
    below = (bone.vertices[bone.faces][:, :, 2] < 20).all(axis=1)
    half = reading_of(Mesh(bone.vertices, bone.faces[below]))
    u = Surface(bone).closest(places()).positions
    beyond = guessed(half, u).beyond_rim
    assert beyond[u[:, 2] > 20].all()
    # The triangles across the cut are gone, too.
    assert not beyond[u[:, 2] < 0].any()


def test_a_reading_of_a_source_in_a_mirror_puts_the_same_landmarks_at_the_same_places(reading):
    mirror = Pose(1.0, np.diag([1.0, -1.0, 1.0]), np.array([0.0, 30.0, 0.0]))
    turned = reading.after(mirror)
    assert turned.mirrored
    found = turned.evaluate(mirror.back(places()))
    np.testing.assert_allclose(found, reading.evaluate(places()), atol=1e-9)


def test_an_accepted_landmark_without_its_other_half_is_refused(reading):
    with pytest.raises(LandmarkError, match="accepted source landmarks"):
        guessed(reading, places(), places(2), places(1))
