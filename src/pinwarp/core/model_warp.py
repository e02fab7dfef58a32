"""Carrying all that stands on a body of a musculoskeletal model through the body's warp.

Every part goes from its frame into the body's, through the warp, and back into its frame as that
is afterwards, always from the model as it was: nothing is warped twice because its frame moved.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.coordinate_function import CoordinateFunction
from pinwarp.core.frame_warp import BodyRules, CarriedFrames
from pinwarp.core.inside import is_inside
from pinwarp.core.local_affine import Warp
from pinwarp.core.mesh import Mesh
from pinwarp.core.model_parts import (
    BodyParts,
    MeshPart,
    Part,
    PointPart,
    StationFramePart,
    TrajectoryPart,
    WrapPart,
    WrapShape,
)
from pinwarp.core.model_rows import ElementRow
from pinwarp.core.placement import Placement, turn_in_degrees
from pinwarp.core.trajectory_warp import CLOSE_ENOUGH, NotCarried, carried_way
from pinwarp.core.wrap_warp import is_in_wrap, warped_wrap

__all__ = ["BodyRules", "FunctionChange", "WarpedBody", "warp_body"]

Matrix = NDArray[np.float64]
_Wrap = tuple[Placement, Matrix]

# Above these a frame that keeps its orientation, and a wrap that no longer fits, are flagged.
LARGE_TURN = 5.0
LARGE_MISFIT = 0.15
# Metres that a joint may be off for standing on the body's own frame.
LARGE_SHIFT = 1e-3
# What moves less, in metres or radians, is rounding: its text is left as it is.
SAME = 1e-12

_SIZES = {
    WrapShape.CYLINDER: ("radius", "length"),
    WrapShape.ELLIPSOID: ("dimensions",),
    WrapShape.SPHERE: ("radius",),
}


@dataclass(frozen=True, eq=False)
class FunctionChange:
    """A function in the place of another, and the coordinate that it depends on, if any."""

    function: CoordinateFunction
    coordinate: str


@dataclass(frozen=True, eq=False)
class WarpedBody:
    """A body whose parts were carried.

    Attributes
    ----------
    parts
        What was carried.
    rows
        What became of every part, in the order of the file.
    values
        New values by key and by OpenSim's name for the property.
    functions
        New functions by the key of the old one.
    meshes
        New meshes by key, in the frame that they stand in, to be drawn without factors.
    frames, places
        Where every frame and every (3,) point is now in the body, by path.
    wraps
        Where every wrap is now in the body, and its size, by path.
    """

    parts: BodyParts
    rows: tuple[ElementRow, ...]
    values: dict[int, dict[str, Matrix]]
    functions: dict[int, FunctionChange]
    meshes: dict[int, Mesh]
    frames: dict[str, Placement]
    places: dict[str, Matrix]
    wraps: dict[str, tuple[Placement, Matrix]]


def warp_body(
    parts: BodyParts,
    warp: Warp,
    rules: BodyRules | None = None,
    deviation: Callable[[Matrix], Matrix] | None = None,
) -> WarpedBody:
    """Carry a body's parts.

    Parameters
    ----------
    parts
        What stands on the body.
    warp
        Takes (m, 3) places in the body's frame and unit to where they are on the subject, in
        that same frame.
    rules
        Which frames turn and what is kept; without them none and nothing.
    deviation
        The standard deviation of one coordinate of the warp at (m, 3) places, in the body's
        unit; None where it is not known.

    Returns
    -------
    WarpedBody

    Raises
    ------
    ValueError
        When stations no longer make a frame.

    Examples
    --------
    >>> thigh = "/bodyset/thigh"
    >>> knee = PointPart(1, "/markerset/KNEE", "marker", 3, thigh, np.array([0, -0.4, 0]))
    >>> centre = PointPart(0, thigh, "mass centre", 2, thigh, np.zeros(3))
    >>> warped = warp_body(BodyParts(thigh, centre, points=(knee,)), lambda x: 1.1 * x)
    >>> warped.values[1]["location"].round(9).tolist()
    [0.0, -0.44, 0.0]
    >>> warped.rows[-1].path, warped.rows[-1].outcome.value
    ('/markerset/KNEE', 'warped')
    """
    carrier = _Carrier(parts, warp, rules or BodyRules(), deviation)
    carrier.carry()
    return WarpedBody(
        parts,
        tuple(sorted(carrier.rows, key=lambda row: row.line)),
        carrier.values,
        carrier.functions,
        carrier.meshes,
        {path: carrier.frames.after(path) for path in parts.frames},
        {point.path: carrier.frames.new_place(point) for point in parts.points},
        {path: now for path, (_, _, now) in carrier.wraps.items()},
    )


class _Carrier:
    """Carries part by part and writes down what became of it."""

    def __init__(
        self,
        parts: BodyParts,
        warp: Warp,
        rules: BodyRules,
        deviation: Callable[[Matrix], Matrix] | None,
    ) -> None:
        self._parts, self._warp, self._rules, self._deviation = parts, warp, rules, deviation
        self.frames = CarriedFrames(parts, warp, rules)
        self.rows: list[ElementRow] = []
        self.values: dict[int, dict[str, Matrix]] = {}
        self.functions: dict[int, FunctionChange] = {}
        self.meshes: dict[int, Mesh] = {}
        # Wraps and bones in the body's frame, as they were and as they are now.
        self.wraps: dict[str, tuple[WrapShape, _Wrap, _Wrap]] = {}
        self._bones: list[tuple[Mesh, Mesh]] = []

    def carry(self) -> None:
        parts = self._parts
        for path in parts.frames:
            self._frame(path)
        for wrap in parts.wraps:
            self._wrap(wrap)
        for mesh in parts.meshes:
            self._mesh(mesh)
        flags = self._entered()
        for point in parts.points:
            self._point(point, "location", flags.get(point.key, ""))
        self._point(parts.mass_centre, "mass_center")
        for trajectory in parts.trajectories:
            self._trajectory(trajectory)
        shift = float(np.linalg.norm(self._warp(np.zeros((1, 3)))[0]))
        origin = replace(parts.mass_centre, kind="origin")
        words = "the body's own frame stays, the bone moves through it"
        self._say(origin, False, words, moved=shift)
        for joint in parts.joints:
            words = "on the body's own frame, whose origin stays"
            flag = (
                f"The bone moves by {1e3 * shift:.1f} mm there and the joint does not: give it "
                "an offset frame in OpenSim."
            )
            self._say(joint, False, words, moved=shift, flag=flag if shift > LARGE_SHIFT else "")
        for kept in parts.kept:
            self._say(kept, False, kept.words, flag=kept.flag)

    def _say(self, part: Part, is_warped: bool, words: str, **figures: Any) -> None:
        about = (self._parts.name, part.path, part.kind, part.line)
        self.rows.append(ElementRow(*about, is_warped, words, **figures))

    def _is_kept(self, part: Part, **figures: Any) -> bool:
        if part.path in self._rules.keep:
            self._say(part, False, "as asked for: its numbers are left as they are", **figures)
            return True
        return False

    def _set(self, key: int, name: str, new: Matrix, old: Matrix) -> None:
        if np.abs(new - old).max() > SAME:
            self.values.setdefault(key, {})[name] = new

    def _set_angles(self, key: int, name: str, new: Placement, old: Placement) -> None:
        if np.abs(new.rotation - old.rotation).max() > SAME:
            self.values.setdefault(key, {})[name] = new.angles

    def _figures(self, before: Matrix, after: Matrix) -> dict[str, float]:
        return {
            "moved": float(np.linalg.norm(after - before)),
            "plus_minus": (
                math.nan if self._deviation is None else float(self._deviation(before[None])[0])
            ),
        }

    def _frame(self, path: str) -> None:
        part = self._parts.frames[path]
        before, after = self.frames.before(path), self.frames.after(path)
        angle = turn_in_degrees(self.frames.turn(path))
        figures = self._figures(before.origin, after.origin) | {"turned": angle}
        if isinstance(part, StationFramePart):
            self._say(part, True, "OpenSim makes it anew of its warped stations", **figures)
            return
        if self._is_kept(part, **figures):
            return
        local = after.seen_from(self.frames.after(part.frame))
        self._set(part.key, "translation", local.origin, part.placement.origin)
        if self.frames.is_turned(path):
            self._set_angles(part.key, "orientation", local, part.placement)
            self._say(part, True, "origin carried, turned with the bone", **figures)
            return
        flag = (
            f"The bone turns by {angle:.1f}° here and the frame keeps its orientation: compare "
            "with the frame turned."
        )
        words = "origin carried, orientation kept"
        self._say(part, True, words, flag=flag if angle > LARGE_TURN else "", **figures)

    def _point(self, point: PointPart, name: str, flag: str = "") -> None:
        before, after = self.frames.place(point), self.frames.new_place(point)
        figures = self._figures(before, after)
        # The mass centre goes by the path of its body, for which no rule is meant.
        if name == "location" and self._is_kept(point, flag=flag, **figures):
            return
        local = self.frames.after(point.frame).into(after[None])[0]
        self._set(point.key, name, local, point.location)
        self._say(point, True, "carried", flag=flag, **figures)

    def _entered(self) -> dict[int, str]:
        """Return what to say of path points that came to be inside of their wrap or of the bone."""
        points = [point for point in self._parts.points if point.is_of_path]
        if not points:
            return {}
        before = np.array([self.frames.place(point) for point in points])
        after = np.array([self.frames.new_place(point) for point in points])
        into_bone = np.zeros(len(points), dtype=np.bool_)
        for old, new in self._bones:
            into_bone |= ~is_inside(old, before) & is_inside(new, after)
        flags = {
            point.key: "It is inside of the warped bone, and was outside before."
            for point, entered in zip(points, into_bone, strict=True)
            if entered
        }
        for point, was, now in zip(points, before, after, strict=True):
            for path in point.wraps:
                if path not in self.wraps:
                    continue
                shape, old_wrap, new_wrap = self.wraps[path]
                if is_in_wrap(shape, *new_wrap, now) and not is_in_wrap(shape, *old_wrap, was):
                    name = path.rsplit("/", 1)[-1]
                    flags[point.key] = (
                        f"It is inside of {name}, which its muscle wraps over, and was outside "
                        "before: the muscle may no longer wrap."
                    )
        return flags

    def _wrap(self, wrap: WrapPart) -> None:
        old = self.frames.before(wrap.frame).holding(wrap.placement)
        fit = warped_wrap(self._warp, wrap.shape, old, wrap.size)
        now = (fit.placement, fit.size)
        if wrap.path in self._rules.keep:
            now = (self.frames.after(wrap.frame).holding(wrap.placement), wrap.size)
        self.wraps[wrap.path] = (wrap.shape, (old, wrap.size), now)
        figures = self._figures(old.origin, now[0].origin) | {"turned": turn_in_degrees(fit.turn)}
        if self._is_kept(wrap, **figures):
            return
        local = fit.placement.seen_from(self.frames.after(wrap.frame))
        self._set(wrap.key, "translation", local.origin, wrap.placement.origin)
        self._set_angles(wrap.key, "xyz_body_rotation", local, wrap.placement)
        names = _SIZES[wrap.shape]
        sizes = (np.split(size, len(names)) for size in (fit.size, wrap.size))
        for name, new, old_size in zip(names, *sizes, strict=True):
            self._set(wrap.key, name, new, old_size)
        was, is_ = (" × ".join(f"{1e3 * x:.2f}" for x in size) for size in (wrap.size, fit.size))
        kind = wrap.kind.removeprefix("wrap ")
        flag = (
            f"The warped surface is no {kind} any more, it varies by {fit.misfit:.0%}: look at "
            "the muscles that wrap over it."
        )
        words = f"{' and '.join(names)} {was} mm became {is_} mm, varies by {fit.misfit:.0%}"
        self._say(wrap, True, words, flag=flag if fit.misfit > LARGE_MISFIT else "", **figures)

    def _mesh(self, part: MeshPart) -> None:
        old = part.on(self.frames.before(part.frame))
        after = self.frames.after(part.frame)
        if part.path in self._rules.keep:
            self._bones.append((old, part.on(after)))
            self._is_kept(part)
            return
        new = old.with_vertices(self._warp(old.vertices))
        self._bones.append((old, new))
        self.meshes[part.key] = new.with_vertices(after.into(new.vertices))
        moved = np.linalg.norm(new.vertices - old.vertices, axis=1)
        words = f"{len(moved):,} vertices carried, by {1e3 * moved.max():.1f} mm at most"
        self._say(part, True, words, moved=float(moved.mean()))

    def _trajectory(self, part: TrajectoryPart) -> None:
        before, after = self.frames.before(part.frame), self.frames.after(part.frame)

        def local_warp(places: Matrix) -> Matrix:
            return after.into(self._warp(before.out(places)))

        if self._is_kept(part):
            return
        try:
            way = carried_way(local_warp, part.axes, part.functions, part.coordinates)
        except NotCarried as error:
            flag = "Its numbers are those of the generic bone: change them by hand."
            self._say(part, False, f"{error}", flag=flag)
            return
        moved = np.linalg.norm(after.out(way.after) - before.out(way.before), axis=1)
        rows = zip(part.function_keys, part.functions, way.functions, strict=True)
        for key, old, new in rows:
            where = way.knots if len(way.knots) else np.zeros(1)
            if np.abs(new(where) - old(where)).max() > SAME:
                self.functions[key] = FunctionChange(new, way.coordinate)
        knots = f"{len(way.knots)} knots of {way.coordinate}" if way.coordinate else "one place"
        off = f", off by {1e3 * way.misfit:.3f} mm at most in between" if way.coordinate else ""
        flag = (
            f"Between its knots it leaves the warped way by {1e3 * way.misfit:.2f} mm."
            if way.misfit > 10 * CLOSE_ENOUGH
            else ""
        )
        words = f"carried at {knots}{off}"
        self._say(part, True, words, moved=float(moved.mean()), flag=flag)
