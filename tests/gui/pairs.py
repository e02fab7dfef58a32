"""Made-up pairs for the sample bones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pinwarp.core.landmarks import Landmark, as_position
from pinwarp.session import edits


def give_pairs(user, source, destination) -> None:
    """Start over with these pairs on the meshes that are open."""
    landmarks = tuple(
        Landmark(f"p{i}", as_position(a), as_position(b))
        for i, (a, b) in enumerate(zip(source, destination, strict=True))
    )
    session = edits.set_penalty(replace(user.session, landmarks=landmarks), 0.0)
    user.editor.replace_all(session, None)
    user.settle()


def scattered(count: int = 60) -> np.ndarray:
    """Source landmarks in and around the sample bone, in millimetres."""
    return np.random.default_rng(2).uniform(-1, 1, (count, 3)) * [40, 40, 200]


def noisy(source: np.ndarray) -> np.ndarray:
    """Destinations that ask for a penalty."""
    noise = np.random.default_rng(3).normal(size=source.shape)
    return source + 12 * np.sin(source[:, [1, 2, 0]] / 40) + 5 * noise
