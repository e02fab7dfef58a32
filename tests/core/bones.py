"""A small bone of our own, and a smooth warp of it that is known everywhere, in millimetres."""

from __future__ import annotations

import numpy as np

from pinwarp.core.mesh import Mesh


def bone(around=24, along=40) -> Mesh:
    """A closed, bowed and bumpy tube with two different ends, 200 mm long."""
    v = np.linspace(0, np.pi, along + 2)[1:-1]
    u = np.arange(around) * 2 * np.pi / around
    angle, height = np.meshgrid(u, v)
    rows = [shape(angle.ravel(), height.ravel()), shape(np.zeros(1), np.zeros(1))]
    rows.append(shape(np.zeros(1), np.full(1, np.pi)))
    i, j = np.meshgrid(np.arange(along - 1), np.arange(around), indexing="ij")
    here, beside = i * around + j, i * around + (j + 1) % around
    below, across = here + around, beside + around
    faces = [
        np.stack([here, below, beside], axis=-1).reshape(-1, 3),
        np.stack([beside, below, across], axis=-1).reshape(-1, 3),
    ]
    ring, count = np.arange(around), around * along
    turned = (ring + 1) % around
    faces.append(np.column_stack([np.full(around, count), ring, turned]))
    last = count - around
    faces.append(np.column_stack([np.full(around, count + 1), last + turned, last + ring]))
    return Mesh(np.vstack(rows), np.vstack(faces))


def shape(angle, height):
    """Places on the bone: the angle around and, from 0 to pi, how far along."""
    radius = np.sin(height) ** 0.5 * (11 + 5 * np.cos(2 * height) ** 2)
    radius = radius * (1 + 0.12 * np.cos(3 * angle) * np.cos(height) + 0.1 * np.cos(angle))
    bow = 5 * np.sin(height)
    return np.column_stack(
        [radius * np.cos(angle) + bow, radius * np.sin(angle), 100 * np.cos(height)]
    )


def truth(points):
    """Where a place of the bone goes: stretched, moved, bent and swollen, nowhere folded."""
    linear = np.array([[1.08, 0.03, -0.02], [0.0, 0.95, 0.04], [0.02, -0.01, 1.1]])
    x, y, z = np.asarray(points).T
    bend = [5 * np.sin(z / 35) + 0.01 * y**2, 4 * np.cos(z / 28), 2 * np.sin(x / 9)]
    return points @ linear.T + [30.0, -12.0, 55.0] + np.column_stack(bend)


def landmarks(count) -> np.ndarray:
    """Places spread over the bone; fewer are the first of more."""
    number = np.arange(count)
    angle = 2 * np.pi * np.modf(0.5 + 0.7548776662466927 * (number + 1))[0]
    height = np.pi * (0.04 + 0.92 * np.modf(0.5 + 0.5698402909980532 * (number + 1))[0])
    return shape(angle, height)


def named_places(count=60) -> np.ndarray:
    """Places that are no landmarks, to see how far a warp is from the truth there."""
    rng = np.random.default_rng(7)
    return shape(2 * np.pi * rng.random(count), np.pi * (0.05 + 0.9 * rng.random(count)))


def off_truth(spline, places=None) -> float:
    """Root mean square of how far a warp takes places from where they truly go."""
    places = named_places() if places is None else places
    error = spline.evaluate(places) - truth(places)
    return float(np.sqrt(np.mean(np.sum(error**2, axis=1))))
