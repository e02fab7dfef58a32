"""Landmark sets for property tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st


@st.composite
def landmark_pairs(draw, least=5, most=24):
    """Pairs in general position: source and destination as (n, 3) arrays."""
    count = draw(st.integers(least, most))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    scale = draw(st.sampled_from([1e-3, 1.0, 400.0]))
    offset = rng.normal(size=3) * scale * draw(st.sampled_from([0.0, 1.0, 20.0]))
    stretch = np.array([1.0, draw(st.floats(0.3, 1.0)), draw(st.floats(0.3, 1.0))])
    source = rng.uniform(-1, 1, (count, 3)) * stretch
    bend = 0.2 * np.sin(2 * source[:, [1, 2, 0]]) + 0.05 * rng.normal(size=(count, 3))
    affine = np.eye(3) + 0.3 * rng.normal(size=(3, 3))
    return source * scale + offset, (source @ affine + bend) * scale - offset


def rotations(seed: int) -> np.ndarray:
    """A proper rotation."""
    Q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return Q * np.sign(np.linalg.det(Q))
