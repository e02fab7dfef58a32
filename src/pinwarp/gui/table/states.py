"""What several landmarks have in common: what an action on all of them does follows from it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pinwarp.core.landmarks import Landmark, Role


def all_disabled(landmarks: Iterable[Landmark]) -> bool:
    """Whether all that could take part are disabled."""
    pairs = [mark for mark in landmarks if mark.role is not Role.PASSENGER]
    return bool(pairs) and not any(mark.enabled for mark in pairs)


def all_locked(landmarks: Sequence[Landmark]) -> bool:
    """Whether all are locked."""
    return bool(landmarks) and all(mark.locked for mark in landmarks)


def all_passengers(landmarks: Sequence[Landmark]) -> bool:
    """Whether all are passengers."""
    return bool(landmarks) and all(mark.role is Role.PASSENGER for mark in landmarks)
