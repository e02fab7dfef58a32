"""3D Slicer's list of control points, ``.mrk.json``."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.io.csv_cells import shortened
from pinwarp.io.json_text import read_json
from pinwarp.io.landmark_formats.lines import checked_name, landmark_on
from pinwarp.io.landmark_formats.reading import MOST, Gathering, LandmarkReading, ReadGroup
from pinwarp.io.landmark_formats.writing import Written, in_millimetres

T = TypeVar("T")

NAME = "3D Slicer .mrk.json"
SUFFIXES = (".mrk.json", ".json")
HOLDS_PAIRS = False

_SCHEMA = (
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/"
    "Resources/Schema/markups-schema-v1.0.3.json#"
)
_ORIENTATION = [-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, 1.0]
_POINTS = re.compile(r'"controlPoints"\s*:\s*\[')
_BETWEEN = re.compile(r"[\s,]*")
_MOST_NAMED = 3
_CURVES = ("Curve", "ClosedCurve")
_AGAIN = "Save it again in 3D Slicer."


def matches(head: str) -> bool:
    """Whether a text begins as a JSON object, which no other format does.

    Examples
    --------
    >>> matches('{"@schema": "..."}'), matches("name,x,y,z")
    (True, False)
    """
    return head.lstrip().startswith("{")


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    """Read the first list of control points, or curve, positions as they are stored.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it.
    side
        The side the landmarks belong to.

    Returns
    -------
    LandmarkReading
        Points that are not ``"defined"`` come without a position. The frame is LPS and the
        unit mm where the file says nothing, as in Slicer.

    Raises
    ------
    FileFormatError
        When it is not JSON, or no landmark could be read.

    Examples
    --------
    >>> point = '{"label": "nasion", "position": [1, 2, 3]}'
    >>> text = '{"markups": [{"type": "Fiducial", "controlPoints": [' + point + "]}]}"
    >>> read("a.mrk.json", text, Side.SOURCE).landmarks[0].source
    (1.0, 2.0, 3.0)
    """
    root, notes = _parsed(path, text)
    markups = _part(root, "markups", list)
    markup = markups[0] if markups and isinstance(markups[0], dict) else {}
    points = _part(markup, "controlPoints", list)
    if points is None:
        raise FileFormatError(
            path, f"There is no list of control points (markups) in it. {_AGAIN}", 1
        )
    if markups and len(markups) > 1:
        notes.append(f"{len(markups)} lists: the first was read.")
    kind = markup.get("type", "Fiducial")
    is_curve = kind in _CURVES
    if kind != "Fiducial" and not is_curve:
        notes.append(f"It is a {_word(kind)}: its control points were read.")
    frame = _word(markup.get("coordinateSystem") or "LPS")
    frame = {"0": "RAS", "1": "LPS"}.get(frame, frame.upper())
    if frame not in ("LPS", "RAS"):
        notes.append(f"The coordinate system {shortened(frame)} is not known.")
        frame = ""
    gathering = Gathering(path)
    places = _places(text, len(points))
    names: dict[str, None] = {}
    for number, (point, (line, words)) in enumerate(zip(points, places, strict=True)):
        if not is_curve:
            gathering.take(line, words, _landmark, point, side, f"landmark_{number}")
            continue
        gathering.take(line, words, _curve_point, point, side, f"landmark_{number}", names)
    name = markup.get("name")
    name = name if isinstance(name, str) else Path(path).name.partition(".")[0]
    closed = kind == "ClosedCurve"
    group = ReadGroup(checked_name(name), tuple(names), is_closed=closed, are_handles=True)
    return gathering.reading(
        NAME,
        'controlPoints as in: {"label": "nasion", "position": [12.5, -40.2, 60.1]}',
        frame=frame,
        unit=_unit(markup.get("coordinateUnits")),
        notes=notes,
        groups=[group] if is_curve else [],
    )


def _parsed(path: str | Path, text: str) -> tuple[Any, list[str]]:
    """Return what the JSON says, and what the user should know about how it was understood."""
    # A point has three lists and a dozen keys; more than memory holds are quickly written.
    for what, count, most in (
        ("lists", text.count("{") + text.count("["), 10 * MOST),
        ("keys", text.count(":"), 30 * MOST),
    ):
        if count > most:
            raise FileFormatError(
                path,
                f"It has {count:,} {what}, far more than landmarks. Check that it is the right "
                "file.",
                1,
            )
    try:
        root, repeated = read_json(text, whole_as_float=True)
    except json.JSONDecodeError as error:
        raise FileFormatError(
            path, f"This is not JSON, or it was cut off ({error.msg}). {_AGAIN}", error.lineno
        ) from None
    except RecursionError:
        raise FileFormatError(
            path, f"Its lists are nested too deeply for landmarks. {_AGAIN}", 1
        ) from None
    few = ", ".join(shortened(key) for key in repeated[:_MOST_NAMED])
    more = f" and {len(repeated) - _MOST_NAMED} more" if len(repeated) > _MOST_NAMED else ""
    if repeated:
        return root, [f"A key is there twice, and the last counts: {few}{more}."]
    return root, []


def _part(value: Any, key: str, kind: type[T]) -> T | None:
    """Return what stands under a key, if anything of that kind does."""
    found = value.get(key) if isinstance(value, dict) else None
    return found if isinstance(found, kind) else None


def _word(value: object) -> str:
    """Return text from a file that may hold anything, short enough for a message."""
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    return (value if isinstance(value, str) else repr(value))[:20]


def _unit(value: object) -> str:
    """Return the unit, given as a word or as a code, its scheme and its meaning."""
    if value in (None, ""):
        return "mm"
    if isinstance(value, list) and value:
        value = value[0]
    return _word(value).strip("[]").split(",")[0].strip("\"' ")


def _places(text: str, count: int) -> Iterator[tuple[int, str]]:
    """Find the line at which each control point begins, and how it begins."""
    start = _POINTS.search(text)
    place = start.end() if start else 0
    decoder = json.JSONDecoder(parse_int=float)
    line, counted = 1, 0
    for _ in range(count):
        between = _BETWEEN.match(text, place)
        place = between.end() if between else place
        line += text.count("\n", counted, place)
        counted = place
        try:
            end = decoder.raw_decode(text, place)[1]
        except ValueError:
            # The key stood somewhere else, too: the line is that of the first.
            end = place
        yield line, " ".join(text[place : min(end, place + 400)].split())
        place = end


def _landmark(point: object, side: Side, default: str) -> Landmark:
    if not isinstance(point, dict):
        raise ValueError("it is not a control point")
    label = point.get("label")
    name = label.strip() if isinstance(label, str) else ""
    position = None
    if point.get("positionStatus", "defined") == "defined":
        position = _position(point.get("position"))
    return landmark_on(side, name or default, position)


def _curve_point(point: object, side: Side, default: str, names: dict[str, None]) -> Landmark:
    """Return a point of a curve: all may have one label."""
    landmark = _landmark(point, side, default)
    name, number = landmark.name, 2
    while name in names:
        name, number = f"{landmark.name}_{number}", number + 1
    names[name] = None
    return replace(landmark, name=name)


def _position(value: object) -> Position | None:
    if value in (None, "", []):
        return None
    if not isinstance(value, list) or len(value) != 3:
        raise ValueError("its position is not a list of three numbers")
    numbers = []
    for number in value:
        if not isinstance(number, float):
            raise ValueError(f"{shortened(str(number))} is not a number")
        if not math.isfinite(number):
            raise ValueError(f"'{number}' is not a finite number")
        numbers.append(number)
    x, y, z = numbers
    return (x, y, z)


def text_of(landmarks: Sequence[Landmark], side: Side | None, unit: str, title: str) -> Written:
    """Return the list of one side.

    As in ``.fcsv``, the frame is said to be LPS, and positions are converted to millimetres:
    Slicer refuses or ignores a unit that is not its own.

    Parameters
    ----------
    landmarks
        Those that have no position on the side are written as undefined.
    side
        The side to write.
    unit
        The unit the positions are in; empty where it is not known: then they stay as they are.
    title
        Not used.

    Raises
    ------
    LandmarkError
        When the unit is none that can be converted.

    Examples
    --------
    >>> text = text_of([Landmark("nasion", (0.5, 0, 1))], Side.SOURCE, "m", "skull").text
    >>> json.loads(text)["markups"][0]["controlPoints"][0]["position"]
    [500.0, 0.0, 1000.0]
    """
    del title
    assert side is not None, "pairs are refused before"
    placed = in_millimetres(landmarks, unit)
    return Written(markup_text([(x.name, x.position(side)) for x in placed], "Fiducial"))


def markup_text(places: Sequence[tuple[str, Position | None]], kind: str, name: str = "") -> str:
    """Return one list of control points in millimetres: landmarks, or a curve.

    Parameters
    ----------
    places
        Labels and positions; None is written as not placed.
    kind
        ``"Fiducial"``, ``"Curve"`` or ``"ClosedCurve"``.
    name
        What the list is called, if anything.
    """
    points = []
    for number, (label, position) in enumerate(places, 1):
        points.append(
            {
                "id": str(number),
                "label": label,
                "description": "",
                "associatedNodeID": "",
                # What Slicer itself writes for a point that is not placed.
                "position": "" if position is None else [float(value) for value in position],
                "orientation": _ORIENTATION,
                "selected": True,
                "locked": False,
                "visibility": True,
                "positionStatus": "undefined" if position is None else "defined",
            }
        )
    markup = {
        "type": kind,
        **({"name": name} if name else {}),
        "coordinateSystem": "LPS",
        "coordinateUnits": "mm",
        "locked": False,
        "fixedNumberOfControlPoints": False,
        "labelFormat": "%N-%d",
        "lastUsedControlPointNumber": len(points),
        "controlPoints": points,
    }
    root = {"@schema": _SCHEMA, "markups": [markup]}
    return json.dumps(root, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
