"""Where the frames of a body are before and after its warp."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.local_affine import LocalAffine, Warp, directions, local_affine
from pinwarp.core.model_parts import BodyParts, OffsetPart, PointPart
from pinwarp.core.placement import HERE, Placement, frame_of_stations

Matrix = NDArray[np.float64]

FRAME_RADIUS = 0.02
"""Over a ball of this radius, in metres, it is asked how the bone turns where a frame stands."""


@dataclass(frozen=True)
class BodyRules:
    """What is chosen for one body.

    Parameters
    ----------
    turns
        Whether its frames turn with the bone; otherwise they keep their orientation.
    turn, keep
        Paths of frames that turn whatever is said above, and of elements that are left as they
        are.
    """

    turns: bool = False
    turn: frozenset[str] = frozenset()
    keep: frozenset[str] = frozenset()


class CarriedFrames:
    """The frames of a body, each found when it is first asked for.

    Parameters
    ----------
    parts
        The body.
    warp
        Takes (m, 3) places in the body's frame.
    rules
        Which frames turn and what is kept.
    """

    def __init__(self, parts: BodyParts, warp: Warp, rules: BodyRules) -> None:
        self._parts, self._warp, self._rules = parts, warp, rules
        self._points = {point.key: point for point in parts.points}
        self._before: dict[str, Placement] = {parts.path: HERE}
        self._after: dict[str, Placement] = {parts.path: HERE}
        self._turns: dict[str, LocalAffine] = {}

    def before(self, path: str) -> Placement:
        """Return where a frame was in the body."""
        if path not in self._before:
            part = self._parts.frames[path]
            if isinstance(part, OffsetPart):
                found = self.before(part.frame).holding(part.placement)
            else:
                places = [self.place(self._points[key]) for key in part.stations]
                found = frame_of_stations(places, part.ab_axis, part.ab_x_ac_axis)
            self._before[path] = found
        return self._before[path]

    def after(self, path: str) -> Placement:
        """Return where a frame is now in the body."""
        if path not in self._after:
            part = self._parts.frames[path]
            if not isinstance(part, OffsetPart):
                places = [self.new_place(self._points[key]) for key in part.stations]
                found = frame_of_stations(places, part.ab_axis, part.ab_x_ac_axis)
            elif path in self._rules.keep:
                found = self.after(part.frame).holding(part.placement)
            else:
                before = self.before(path)
                rotation = (
                    self.turn(path) @ before.rotation
                    if self.is_turned(path)
                    else self.after(part.frame).rotation @ part.placement.rotation
                )
                found = Placement(rotation, self._warp(before.origin[None])[0])
            self._after[path] = found
        return self._after[path]

    def is_turned(self, path: str) -> bool:
        """Whether a frame is to turn with the bone."""
        return self._rules.turns or path in self._rules.turn

    def turn(self, path: str) -> Matrix:
        """Return how the bone turns where a frame stands, (3, 3)."""
        if path not in self._turns:
            offsets = FRAME_RADIUS * directions()
            self._turns[path] = local_affine(self._warp, self.before(path).origin, offsets)
        return self._turns[path].rotation

    def place(self, point: PointPart) -> Matrix:
        """Return where a point was in the body, (3,)."""
        return np.asarray(self.before(point.frame).out(point.location[None])[0])

    def new_place(self, point: PointPart) -> Matrix:
        """Return where a point is now in the body, (3,)."""
        if point.path in self._rules.keep:
            return np.asarray(self.after(point.frame).out(point.location[None])[0])
        return np.asarray(self._warp(self.place(point)[None])[0])
