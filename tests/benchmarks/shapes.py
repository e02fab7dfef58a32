"""Femur-sized test data of any size, in millimetres."""

from __future__ import annotations

import numpy as np


def surface_points(count: int, seed: int = 0) -> np.ndarray:
    """Points on a bumpy, bowed tube of 420 mm."""
    u, v = np.random.default_rng(seed).random((2, count))
    angle, along = 2 * np.pi * u, np.pi * v
    radius = np.sin(along) * (18 + 9 * np.cos(2 * along) ** 2 + 4 * np.cos(3 * angle))
    bow = 6 * np.sin(2 * np.pi * v)
    return np.column_stack(
        [radius * np.cos(angle) + bow, radius * np.sin(angle), 210 * np.cos(along)]
    )


def true_warp(points: np.ndarray) -> np.ndarray:
    """A smooth map like that from one femur to another."""
    linear = np.array([[1.08, 0.03, -0.02], [0.0, 0.95, 0.04], [0.02, -0.01, 1.1]])
    x, y, z = points.T
    bend = [6 * np.sin(z / 70) + 0.002 * y**2, 4 * np.cos(z / 55), 3 * np.sin(x / 9)]
    return points @ linear.T + np.array([30.0, -12.0, 55.0]) + np.column_stack(bend)


def landmark_pairs(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Pairs placed to half a millimetre."""
    source = surface_points(count, seed=count)
    noise = np.random.default_rng(count).normal(scale=0.5, size=(count, 3))
    return source, true_warp(source) + noise
