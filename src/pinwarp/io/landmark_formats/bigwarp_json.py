"""BigWarp's landmarks as JSON, alone or within a project."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.io.landmark_formats.bigwarp import is_active, made
from pinwarp.io.landmark_formats.json_root import alone, json_root, part, place
from pinwarp.io.landmark_formats.lines import one_line
from pinwarp.io.landmark_formats.reading import DefaultName, Gathering, LandmarkReading
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written

NAME = "BigWarp JSON"
SUFFIXES = (".bigwarp.json",)
HOLDS = Holds(pairs=True, switches=True)

_SIGNATURES = ('"movingPoints"', '"BigWarpLandmarks"', '"fixedPoints"')
# How BigWarp itself writes what is not there, and how others do.
_MISSING = (math.inf, -math.inf, "Infinity", "-Infinity", "inf", None)


def matches(head: str) -> bool:
    """Whether a text begins as JSON with points of BigWarp.

    Examples
    --------
    >>> matches('{"type": "BigWarpLandmarks"'), matches('{"markups": []}')
    (True, False)
    """
    return head.lstrip().startswith("{") and any(word in head for word in _SIGNATURES)


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    """Read pairs: what moves is the source, what is fixed is the destination.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it: landmarks, or a project that has some under Transform.
    side
        Not used: both sides are in the file.

    Returns
    -------
    LandmarkReading
        ``Infinity`` is a position that is missing. A complete pair that is not active is
        disabled.

    Raises
    ------
    FileFormatError
        When it is not JSON, its points are not in three dimensions, or there is none.

    Examples
    --------
    >>> text = '{"movingPoints": [[1, 2, 3]], "fixedPoints": [[4, 5, 6]], "names": ["Pt-0"]}'
    >>> read("a.json", text, Side.SOURCE).landmarks[0].destination
    (4.0, 5.0, 6.0)
    """
    del side
    root, notes = json_root(path, text)
    project = part(part(root, "Transform", dict), "landmarks", dict)
    held = root if project is None else project
    moving, fixed = (part(held, f"{which}Points", list) or [] for which in ("moving", "fixed"))
    if (part(held, "numDimensions", float) or _width(moving) or _width(fixed)) == 2:
        raise FileFormatError(
            path, "These landmarks of BigWarp have two dimensions. Three are needed."
        )
    names, active = part(held, "names", list) or [], part(held, "active", list) or []
    gathering = Gathering(path)
    for number in range(max(len(moving), len(fixed))):
        gathering.take(
            1,
            f"point {number + 1}",
            _landmark,
            [_at(points, number) for points in (moving, fixed)],
            _at(names, number),
            _at(active, number),
            DefaultName.of(number),
        )
    return gathering.reading(
        NAME, "movingPoints and fixedPoints: lists of three numbers", is_pairs=True, notes=notes
    )


def _width(points: Sequence[object]) -> int:
    first = points[0] if points else None
    return len(first) if isinstance(first, list) else 0


def _at(values: Sequence[Any], number: int) -> Any:
    return values[number] if number < len(values) else None


def _landmark(
    points: Sequence[object], name: object, active: object, default: DefaultName
) -> Landmark:
    name, active = alone(name), alone(active)
    source, destination = map(_place, points)
    label = name if isinstance(name, str) else ""
    return made(label, source, destination, default, active=active is not False)


def _place(value: object) -> Position | None:
    value = alone(value)
    if isinstance(value, list) and len(value) == 3 and all(x in _MISSING for x in value):
        return None
    return place(value)


def text_of(outgoing: Outgoing) -> Written:
    """Return the landmarks, pairs or those of one side with the other one missing.

    Parameters
    ----------
    outgoing
        The landmarks.

    Examples
    --------
    >>> text = text_of(Outgoing((Landmark("a", (1, 2, 3)),), None)).text
    >>> json.loads(text)["movingPoints"], json.loads(text)["active"]
    ([[1.0, 2.0, 3.0]], [False])
    """
    marks = [
        x if outgoing.side is None else x.placed(outgoing.side.other, None)
        for x in outgoing.landmarks
    ]
    root = {
        "type": "BigWarpLandmarks",
        "numDimensions": 3,
        "movingPoints": [_numbers(mark.source) for mark in marks],
        "fixedPoints": [_numbers(mark.destination) for mark in marks],
        "active": [is_active(mark) for mark in marks],
        "names": [one_line(mark.name).strip() for mark in marks],
    }
    return Written(json.dumps(root, indent=1, ensure_ascii=False) + "\n")


def _numbers(position: Position | None) -> list[float]:
    # Java's JSON, as Python's, has a word for it.
    return [math.inf] * 3 if position is None else list(map(float, position))
