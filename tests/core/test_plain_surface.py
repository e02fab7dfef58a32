"""Surfaces made plain for a search."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.hooked import hooked
from tests.two_spheres import two_spheres

from pinwarp.core.mesh import Mesh
from pinwarp.core.plain_surface import PlainSurface, thinned
from pinwarp.core.sampling import triangle_areas
from pinwarp.core.surface_distance import SurfaceIndex


def test_a_thinned_surface_stays_where_it_was():
    bone = hooked(60, 90)
    thin = thinned(bone, 2000)
    assert len(thin.faces) < 2500
    off = SurfaceIndex(bone).distances(thin.vertices)
    assert off.max() < np.sqrt(3 * triangle_areas(bone).sum() / 2000)
    assert triangle_areas(thin).sum() == pytest.approx(triangle_areas(bone).sum(), rel=0.1)
    assert thinned(bone, len(bone.faces)) is bone


def test_a_surface_that_faces_inwards_is_turned_and_one_that_does_not_is_left():
    bone = hooked()
    inside_out = Mesh(bone.vertices, bone.faces[:, ::-1])
    assert PlainSurface.of(bone).mesh is bone
    np.testing.assert_array_equal(PlainSurface.of(inside_out).mesh.faces, bone.faces)


def test_parts_count_but_not_splinters_nor_how_a_file_lists_corners():
    bone = hooked()
    moved = bone.vertices + np.array([500.0, 0, 0])
    two = Mesh(np.vstack([bone.vertices, moved]), np.vstack([bone.faces, bone.faces + len(moved)]))
    corner_by_corner = Mesh(
        bone.vertices[bone.faces].reshape(-1, 3), np.arange(3 * len(bone.faces)).reshape(-1, 3)
    )
    assert PlainSurface.of(two).parts == 2
    assert PlainSurface.of(corner_by_corner).parts == 1
    assert PlainSurface.of(two_spheres()).parts == 1


def test_an_open_surface_has_a_rim():
    bone = hooked()
    below = (bone.vertices[bone.faces][:, :, 2] < 0).all(axis=1)
    assert PlainSurface.of(bone).rim == 0
    assert PlainSurface.of(Mesh(bone.vertices, bone.faces[below])).rim > 0.3
