"""A source of two closed parts, the smaller of which a warp folds as a whole."""

from __future__ import annotations

import numpy as np
import pyvista as pv

from pinwarp.core.landmarks import Landmark, as_position
from pinwarp.core.mesh import Mesh

SMALL_CENTRE, SMALL_RADIUS = np.array([0.0, 0.0, 100.0]), 4.0


def _sphere(centre: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    ball = pv.Sphere(radius=radius, center=centre, theta_resolution=24, phi_resolution=24).clean()
    return np.asarray(ball.points, float), ball.regular_faces


def two_spheres() -> Mesh:
    """Return a ball of radius 50 and, 100 away from its middle, one of radius 4."""
    large, faces = _sphere(np.zeros(3), 50.0)
    small, more = _sphere(SMALL_CENTRE, SMALL_RADIUS)
    return Mesh(np.vstack([large, small]), np.vstack([faces, more + len(large)]))


def pairs() -> tuple[Landmark, ...]:
    """Return pairs that leave the large sphere as it is and mirror the small one in x."""
    around = np.vstack([np.eye(3), -np.eye(3)])
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / np.sqrt(3)
    fixed = 50.0 * np.vstack([around, corners])
    near = SMALL_CENTRE + 1.5 * SMALL_RADIUS * np.vstack([around, corners])
    mirrored = near * [-1.0, 1.0, 1.0]
    sides = zip(np.vstack([fixed, near]), np.vstack([fixed, mirrored]), strict=True)
    return tuple(
        Landmark(f"p{i}", as_position(a), as_position(b)) for i, (a, b) in enumerate(sides)
    )
