"""The directions that a surface faces."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv

from pinwarp.core.mesh import Mesh
from pinwarp.core.normals import vertex_normals


@pytest.mark.parametrize("size", [1e-150, 1.0, 1e150])
def test_normals_of_a_sphere_point_outwards_in_every_unit(size):
    ball = pv.Icosphere(nsub=3)
    mesh = Mesh(np.asarray(ball.points, dtype=float) * size, ball.regular_faces)
    outwards = np.asarray(ball.points, dtype=float)
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", vertex_normals(mesh), outwards).min() > 0.999


def test_a_larger_triangle_weighs_more():
    corners = [[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 1]]
    mesh = Mesh(corners, [[0, 1, 2], [0, 2, 3]])
    normal = vertex_normals(mesh)[0]
    assert normal == pytest.approx(np.array([10, 0, 100]) / np.hypot(10, 100))


def test_what_has_no_area_has_no_normal():
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0], [5, 5, 5]], [[0, 1, 2]])
    assert vertex_normals(mesh).tolist() == [[0, 0, 0]] * 4
