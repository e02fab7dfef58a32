"""What stands on a body of a model as places to be drawn: points, muscle paths, wraps, frames."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.frame_warp import BodyRules, CarriedFrames
from pinwarp.core.model_parts import BodyParts, WrapShape
from pinwarp.core.model_warp import WarpedBody
from pinwarp.core.placement import HERE, Placement
from pinwarp.io.osim.body_parts import body_parts
from pinwarp.io.osim.model import OsimModel
from pinwarp.io.osim.neutral import neutral_pose

Matrix = NDArray[np.float64]

# Metres: the axes of a frame, and how much of the way to another body is shown at most.
AXIS_LENGTH, STUB_LENGTH = 0.025, 0.04
_AROUND = 24
# A straight line is drawn in so many pieces: some of them may be behind the bone.
_PIECES = 6
_MOVING = "moving path point"


class OutlineKind(StrEnum):
    """What a line is part of.

    Examples
    --------
    >>> OutlineKind.WRAP.value
    'wrap'
    """

    MUSCLE = "muscle"
    STUB = "stub"
    WRAP = "wrap"
    AXIS_X = "x"
    AXIS_Y = "y"
    AXIS_Z = "z"


@dataclass(frozen=True, eq=False)
class Outline:
    """A line that is part of an element.

    Parameters
    ----------
    path
        Of the element; of a muscle's line, that of the muscle.
    kind
        What it is.
    places
        (k, 3).
    group
        Which muscle, by its number; -1 for none.
    """

    path: str
    kind: OutlineKind
    places: Matrix
    group: int = -1


@dataclass(frozen=True, eq=False)
class Elements:
    """All that is drawn of a body, in one frame.

    Parameters
    ----------
    points
        (n, 3) places of path points, markers and stations.
    paths
        Of each.
    groups
        (n,) which muscle each is of, by its number; -1 for none.
    outlines
        Lines.
    """

    points: Matrix
    paths: tuple[str, ...]
    groups: NDArray[np.int64]
    outlines: tuple[Outline, ...]

    def mapped(self, where: Callable[[Matrix], Matrix]) -> Elements:
        """Return them elsewhere; ``where`` takes (m, 3) places, and is called once."""
        sizes = [len(self.points), *(len(one.places) for one in self.outlines)]
        if not sum(sizes):
            return self
        places = where(np.concatenate([self.points, *(one.places for one in self.outlines)]))
        points, *lines = np.split(places, np.cumsum(sizes)[:-1])
        outlines = (
            replace(one, places=line) for one, line in zip(self.outlines, lines, strict=True)
        )
        return replace(self, points=points, outlines=tuple(outlines))

    def of_path(self, path: str) -> Matrix:
        """Return the places of one element, (m, 3): what is looked at when it is chosen."""
        own = [place for place, at in zip(self.points, self.paths, strict=True) if at == path]
        lines = [one.places for one in self.outlines if one.path == path]
        return np.concatenate([np.array(own).reshape(-1, 3), *lines])


@dataclass(frozen=True)
class PathStop:
    """A point of a muscle's path: its own path, its body, and where it is in that."""

    path: str
    body: str
    place: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class MusclePaths:
    """The paths of all muscles of a model, and where its bodies stand in one another.

    Parameters
    ----------
    stops
        By the muscle's path, in order along it.
    pose
        Where bodies are in the ground, for pictures.
    """

    stops: Mapping[str, tuple[PathStop, ...]]
    pose: Mapping[str, Placement]

    @classmethod
    def of(cls, model: OsimModel) -> MusclePaths:
        """Gather them.

        Examples
        --------
        >>> from pinwarp.io.osim.reading import read_model
        >>> from pinwarp.io.samples import sample_model
        >>> [stop.path for stop in MusclePaths.of(read_model(sample_model())).stops["/forceset/rf"]]
        ['/forceset/rf/path/rf-P1', '/forceset/rf/path/rf-P2', '/forceset/rf/path/rf-P3']
        """
        parts = {body: body_parts(model, body) for body in model.bodies}
        found: list[tuple[int, PathStop]] = []
        for body, one in parts.items():
            places = _places(one, CarriedFrames(one, lambda x: x, BodyRules()))
            lines = {part.path: part.line for part in (*one.points, *one.trajectories)}
            found += [
                (lines[path], PathStop(path, body, (place[0], place[1], place[2])))
                for path, place in places.items()
                if "/path/" in path
            ]
        stops: dict[str, list[PathStop]] = {}
        # In the file they stand in the order of the path.
        for _, stop in sorted(found, key=lambda one: one[0]):
            stops.setdefault(muscle_of(stop.path), []).append(stop)
        pose = neutral_pose(model, parts)
        return cls({muscle: tuple(path) for muscle, path in stops.items()}, pose)


def muscle_of(path: str) -> str:
    """Return the path of the muscle that a path point is of; empty for any other element.

    Examples
    --------
    >>> muscle_of("/forceset/rf/path/rf-P1"), muscle_of("/markerset/KNEE")
    ('/forceset/rf', '')
    """
    muscle, separator, _ = path.rpartition("/path/")
    return muscle if separator else ""


def elements_before(parts: BodyParts, muscles: MusclePaths) -> Elements:
    """Return what is drawn of a body as the model has it, in the body's frame.

    Parameters
    ----------
    parts
        The body.
    muscles
        Of its model.
    """
    frames = CarriedFrames(parts, lambda x: x, BodyRules())
    wraps = {
        wrap.path: (frames.before(wrap.frame).holding(wrap.placement), wrap.size)
        for wrap in parts.wraps
    }
    placed = {path: frames.before(path) for path in parts.frames}
    return _elements(parts, muscles, _places(parts, frames), placed, wraps)


def elements_after(warped: WarpedBody, muscles: MusclePaths) -> Elements:
    """Return what is drawn of a body as the new model will have it, in the body's frame.

    A point that moves along with a joint is where its own frame's warp leaves it.
    """
    places = dict(warped.places)
    for part in warped.parts.trajectories:
        if part.kind == _MOVING:
            frame = warped.frames.get(part.frame, HERE)
            new = [
                warped.functions[key].function if key in warped.functions else old
                for key, old in zip(part.function_keys, part.functions, strict=True)
            ]
            places[part.path] = frame.out(np.array([[float(f(0.0)) for f in new]]))[0]
    return _elements(warped.parts, muscles, places, warped.frames, warped.wraps)


def _places(parts: BodyParts, frames: CarriedFrames) -> dict[str, Matrix]:
    places = {point.path: frames.place(point) for point in parts.points}
    for part in parts.trajectories:
        if part.kind == _MOVING:
            at = np.array([[float(function(0.0)) for function in part.functions]])
            places[part.path] = frames.before(part.frame).out(at @ part.axes.T)[0]
    return places


def _elements(
    parts: BodyParts,
    muscles: MusclePaths,
    places: Mapping[str, Matrix],
    frames: Mapping[str, Placement],
    wraps: Mapping[str, tuple[Placement, Matrix]],
) -> Elements:
    own = [path for path in dict.fromkeys(map(muscle_of, places)) if path]
    numbers = {path: number for number, path in enumerate(own)}
    groups = [numbers.get(muscle_of(path), -1) for path in places]
    outlines: list[Outline] = []
    for muscle, number in numbers.items():
        outlines += _muscle(parts.path, muscle, number, muscles, places)
    shapes = {wrap.path: wrap.shape for wrap in parts.wraps}
    for path, (placement, size) in wraps.items():
        for ring in _rings(shapes[path], size):
            outlines.append(Outline(path, OutlineKind.WRAP, placement.out(ring)))
    for path, placement in frames.items():
        kinds = (OutlineKind.AXIS_X, OutlineKind.AXIS_Y, OutlineKind.AXIS_Z)
        for kind, axis in zip(kinds, AXIS_LENGTH * np.eye(3), strict=True):
            outlines.append(Outline(path, kind, placement.out([[0, 0, 0], axis])))
    return Elements(
        np.array([*places.values()]).reshape(-1, 3),
        tuple(places),
        np.array(groups, dtype=np.int64),
        tuple(outlines),
    )


def _muscle(
    body: str, muscle: str, number: int, muscles: MusclePaths, places: Mapping[str, Matrix]
) -> Iterator[Outline]:
    """Yield a muscle's straight lines on a body, and where it goes on to others."""
    stops, pose = muscles.stops.get(muscle, ()), muscles.pose
    for a, b in itertools.pairwise(stops):
        if a.body == b.body == body:
            line = _straight(places[a.path], places[b.path])
            yield Outline(muscle, OutlineKind.MUSCLE, line, number)
            continue
        for here, there in ((a, b), (b, a)):
            if here.body != body or there.body == body or not {body, there.body} <= pose.keys():
                continue
            start = places[here.path]
            seen = pose[body].into(pose[there.body].out([there.place]))[0]
            along = seen - start
            far = float(np.linalg.norm(along))
            if far > 0:
                end = start + along * min(1.0, STUB_LENGTH / far)
                yield Outline(muscle, OutlineKind.STUB, _straight(start, end), number)


def _straight(start: Matrix, end: Matrix) -> Matrix:
    return np.linspace(start, end, _PIECES + 1)


def _rings(shape: WrapShape, size: Matrix) -> Iterator[Matrix]:
    """Yield the lines that show a wrap, in its own frame."""
    angles = np.linspace(0, 2 * np.pi, _AROUND + 1)
    circle = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    if shape is WrapShape.CYLINDER:
        radius, half = float(size[0]), float(size[1]) / 2
        for z in (-half, half):
            yield radius * circle + [0, 0, z]
        for x, y, _ in radius * circle[: -1 : _AROUND // 4]:
            yield _straight(np.array([x, y, -half]), np.array([x, y, half]))
        return
    scale = np.broadcast_to(size, (3,))
    for turn in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        yield circle[:, turn] * scale
