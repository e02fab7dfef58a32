"""Made-up sets of landmarks with and without mistakes, to judge those who judge them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pinwarp.core.factor import SourceFactor, factorise

# Half the extents of a bone in millimetres, or the spread where landmarks are in a cloud.
SHAPES = ("box", "cube", "cloud", "rod", "shell")
# How far a bone differs from an affine map of the other, and how far a landmark is off, as shares
# of the diagonal.
BENT, OFF = 0.02, 0.1


@dataclass(frozen=True, eq=False)
class MadeUp:
    """Pairs, factorised, and the rows that are wrong: what is displaced, and what is exchanged."""

    factor: SourceFactor
    destination: np.ndarray
    displaced: tuple[int, ...] = ()
    swapped: tuple[int, int] | tuple[()] = ()

    @property
    def wrong(self) -> set[int]:
        """All rows that are not right."""
        return {*self.displaced, *self.swapped}


def landmarks(count: int, rng: np.random.Generator, shape: str = "box") -> np.ndarray:
    """Random places in or on a bone, the longer ones 400 mm long."""
    if shape in ("box", "cube"):
        return rng.uniform(-1, 1, (count, 3)) * ([60, 60, 200] if shape == "box" else 100)
    if shape in ("cloud", "rod"):
        return rng.normal(size=(count, 3)) * (60 if shape == "cloud" else [25, 25, 100])
    places = rng.normal(size=(count, 3))
    return places / np.linalg.norm(places, axis=1)[:, None] * [60, 60, 200]


def diagonal(source: np.ndarray) -> float:
    """The diagonal of the landmarks' box."""
    return float(np.linalg.norm(np.ptp(source, axis=0)))


def stationary(factor: SourceFactor, rng: np.random.Generator) -> np.ndarray:
    """A random field of the spline's own kind, now and then with noise."""
    values, _ = factor.modes
    weights = np.sqrt(np.maximum(values, 0))[:, None] * rng.normal(size=(len(values), 3))
    field = factor.modes_at_landmarks @ weights
    size = diagonal(factor.source)
    field *= BENT * size / np.sqrt(np.mean(np.sum(field**2, axis=1)))
    noise = rng.choice([0, 1e-3, 3e-3]) * size
    return _affine(factor.source, rng) + field + noise * rng.normal(size=field.shape)


def smooth(factor: SourceFactor, rng: np.random.Generator) -> np.ndarray:
    """Six sines of one to three times the bone's length, each three per cent of it high."""
    source, length = factor.source, float(np.ptp(factor.source, axis=0).max())
    destination = _affine(source, rng)
    for _ in range(6):
        direction = rng.normal(size=3)
        along = source @ (direction / np.linalg.norm(direction))
        phase = 2 * np.pi * (along / length / rng.uniform(1, 3) + rng.uniform())
        height = 0.03 * length * rng.normal(size=3) / np.sqrt(3)
        destination = destination + np.sin(phase)[:, None] * height
    return destination


def heavy_tailed(factor: SourceFactor, rng: np.random.Generator) -> np.ndarray:
    """A smooth field of landmarks digitised by people: most well, a few of them badly."""
    noise = 0.01 * diagonal(factor.source) * rng.standard_t(4, size=factor.source.shape)
    return smooth(factor, rng) + noise


Field = Callable[[SourceFactor, np.random.Generator], np.ndarray]


def made_up(
    count: int,
    seed: int,
    field: Field = stationary,
    *,
    displaced: int = 0,
    off: float = OFF,
    swap: bool = False,
    shape: str = "",
) -> MadeUp:
    """A set with mistakes: some displaced by a share of the diagonal, two exchanged before."""
    rng = np.random.default_rng([count, seed])
    factor = factorise(landmarks(count, rng, shape or SHAPES[seed % len(SHAPES)]))
    destination = field(factor, rng)
    rows = rng.permutation(count)[: displaced + 2].tolist()
    for row in rows[:displaced]:
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        destination[row] += off * diagonal(factor.source) * direction
    pair: tuple[int, int] | tuple[()] = ()
    if swap:
        pair = (rows[-2], rows[-1])
        destination[list(pair)] = destination[list(pair[::-1])]
    return MadeUp(factor, destination, tuple(rows[:displaced]), pair)


def _affine(source: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return source @ (np.eye(3) + 0.08 * rng.normal(size=(3, 3)))
