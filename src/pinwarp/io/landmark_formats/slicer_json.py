"""3D Slicer's list of control points, ``.mrk.json``: landmarks and curves."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Position, Side, flipped
from pinwarp.core.words import counted, some_of, with_article
from pinwarp.io.csv_cells import shortened
from pinwarp.io.landmark_formats.json_root import alone, json_root, part, place, word
from pinwarp.io.landmark_formats.lines import checked_name, landmark_on
from pinwarp.io.landmark_formats.reading import (
    MOST,
    DefaultName,
    Gathering,
    LandmarkReading,
    ReadGroup,
)
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written, in_millimetres

NAME = "3D Slicer .mrk.json"
SUFFIXES = (".mrk.json", ".json")
HOLDS = Holds(notes=True, locks=True, switches=True, curves=True, frame="LPS", unit="mm")

_SCHEMA = (
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/"
    "Resources/Schema/markups-schema-v1.0.3.json#"
)
_ORIENTATION = [-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, 1.0]
_POINTS = re.compile(r'"controlPoints"\s*:\s*\[')
_BETWEEN = re.compile(r"[\s,]*")
_CURVES = ("Curve", "ClosedCurve")
# A preview, which programs write that find landmarks themselves, is a place.
_UNPLACED = ("undefined", "missing")


class _List(NamedTuple):
    """A list of control points: what it is, what it is called, its points and where they stand."""

    kind: str
    name: str
    frame: str
    unit: str
    points: list[Any]
    places: list[tuple[int, str]]

    @property
    def is_curve(self) -> bool:
        return self.kind in _CURVES


def matches(head: str) -> bool:
    """Whether a text begins as a JSON object, which few other formats do.

    Examples
    --------
    >>> matches('{"@schema": "..."}'), matches("name,x,y,z")
    (True, False)
    """
    return head.lstrip().startswith("{")


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    """Read the first list of landmarks that has any, and all curves, positions as stored.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it; values may each stand in a list of one, as R writes them.
    side
        The side the landmarks belong to.

    Returns
    -------
    LandmarkReading
        Points that are ``"undefined"`` or ``"missing"`` come without a position; description,
        locked and selected are note, locked and enabled. The frame is LPS and the unit mm where
        the file says nothing, as in Slicer.

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
    root, notes = json_root(path, text)
    lists = _lists(path, root, text)
    filled = [one for one in lists if one.points]
    single = [one for one in filled if not one.is_curve]
    single.sort(key=lambda one: one.kind != "Fiducial")
    chosen = [*single[:1], *(one for one in filled if one.is_curve)]
    if len(single) > 1:
        left = some_of([one.name or one.kind for one in single[1:]])
        notes.append(
            f"{counted(len(single), 'list')} of points: the first was read, not {left}. Save each "
            "to a file of its own to read them."
        )
    if single and single[0].kind != "Fiducial":
        notes.append(f"It is {with_article(word(single[0].kind))}: its control points were read.")
    frame, unit = (chosen[0].frame, chosen[0].unit) if chosen else ("", "mm")
    if frame not in ("LPS", "RAS"):
        notes += [f"The coordinate system {shortened(frame)} is not known."] if frame else []
        frame = ""
    if any(one.unit != unit for one in chosen):
        notes.append(f"Its lists are in several units; all were read as if in {unit}.")
    gathering = Gathering(path)
    for one in chosen:
        turns = {one.frame, frame} == {"LPS", "RAS"}
        numbers = [
            gathering.take(line, words, _landmark, point, side, DefaultName.of(number), turns)
            for number, (point, (line, words)) in enumerate(
                zip(one.points, one.places, strict=True)
            )
        ]
        if one.is_curve:
            name = checked_name(one.name or Path(path).name.partition(".")[0])
            closed = one.kind == "ClosedCurve"
            group = ReadGroup(name, is_closed=closed, are_handles=True)
            gathering.add_group(group, numbers)
    return gathering.reading(
        NAME,
        'controlPoints as in: {"label": "nasion", "position": [12.5, -40.2, 60.1]}',
        frame=frame,
        unit=unit,
        notes=notes,
    )


def _lists(path: str | Path, root: object, text: str) -> list[_List]:
    """Return the lists of control points in a file."""
    found = part(root, "markups", list)
    markups = [part(root, "markups", dict)] if found is None else found
    described: list[dict[str, Any]] = [
        one
        for x in markups
        if isinstance(one := alone(x), dict) and part(one, "controlPoints", list) is not None
    ]
    if not described:
        raise FileFormatError(
            path,
            "This is JSON, but there is no list of control points (markups) of 3D Slicer in it, "
            "and no landmarks of BigWarp. Export the landmarks as CSV (name,x,y,z) from the "
            "program that wrote it.",
            1,
        )
    counts = [part(x, "controlPoints", list) or [] for x in described]
    if sum(map(len, counts)) > MOST:
        raise FileFormatError(
            path,
            f"It has more than {MOST:,} entries, which are no landmarks. "
            "Check that it is the right file.",
            1,
        )
    places = _places(text, [len(points) for points in counts])
    lists = []
    for markup, points, where in zip(described, counts, places, strict=True):
        frame = word(markup.get("coordinateSystem") or "LPS")
        lists.append(
            _List(
                part(markup, "type", str) or "Fiducial",
                (part(markup, "name", str) or "").strip(),
                {"0": "RAS", "1": "LPS"}.get(frame, frame.upper()),
                _unit(markup.get("coordinateUnits")),
                points,
                where,
            )
        )
    return lists


def _unit(value: object) -> str:
    """Return the unit, given as a word or as a code, its scheme and its meaning."""
    if value in (None, "", []):
        return "mm"
    if isinstance(value, list) and value:
        value = value[0]
    return word(value).strip("[]").split(",")[0].strip("\"' ")


def _places(text: str, counts: Sequence[int]) -> Iterator[list[tuple[int, str]]]:
    """Find the line at which each control point of each list begins, and how it begins."""
    decoder = json.JSONDecoder(parse_int=float)
    line = counted_to = at = 0
    for count in counts:
        start = _POINTS.search(text, at)
        at = start.end() if start else at
        found = []
        for _ in range(count):
            between = _BETWEEN.match(text, at)
            at = between.end() if between else at
            line += text.count("\n", counted_to, at)
            counted_to = at
            try:
                end = decoder.raw_decode(text, at)[1]
            except ValueError:
                # The key stood somewhere else, too: the line is that of the first.
                end = at
            found.append((line + 1, " ".join(text[at : min(end, at + 400)].split())))
            at = end
        yield found


def _landmark(point: object, side: Side, default: DefaultName, turns: bool) -> Landmark:
    point = alone(point)
    if not isinstance(point, dict):
        raise ValueError("it is not a control point")
    name = (part(point, "label", str) or "").strip()
    status = part(point, "positionStatus", str)
    position = None if status in _UNPLACED else place(point.get("position"))
    landmark = replace(
        landmark_on(side, name or default, position),
        note=(part(point, "description", str) or "").strip(),
        locked=part(point, "locked", bool) is True,
        enabled=part(point, "selected", bool) is not False,
    )
    return flipped([landmark], side)[0] if turns else landmark


def text_of(outgoing: Outgoing) -> Written:
    """Return the list of one side, and a list for each curve.

    As in ``.fcsv``, the frame is said to be LPS, and positions are converted to millimetres:
    Slicer refuses or ignores a unit that is not its own.

    Parameters
    ----------
    outgoing
        Those that have no position on the side are written as undefined.

    Raises
    ------
    LandmarkError
        When the unit is none that can be converted.

    Examples
    --------
    >>> text = text_of(Outgoing((Landmark("nasion", (0.5, 0, 1)),), unit="m")).text
    >>> json.loads(text)["markups"][0]["controlPoints"][0]["position"]
    [500.0, 0.0, 1000.0]
    """
    assert outgoing.side is not None, "pairs are refused before"
    marks = in_millimetres(outgoing.landmarks, outgoing.unit)
    points = {mark.name: (mark, mark.position(outgoing.side)) for mark in marks}
    along = {x for group in outgoing.groups for x in group.points if x not in group.anchors}
    single = [point for name, point in points.items() if name not in along]
    markups = [_markup(single, "Fiducial", "")] if single or not outgoing.groups else []
    for group in outgoing.groups:
        kind = "ClosedCurve" if group.is_closed else "Curve"
        markups.append(_markup([points[x] for x in group.points], kind, group.name))
    return Written(_text(markups, outgoing.remarks))


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
    return _text([_markup([(Landmark(label), at) for label, at in places], kind, name)])


def _text(markups: Sequence[dict[str, Any]], remarks: Sequence[str] = ()) -> str:
    # The schema allows for keys of others.
    made = {"remarks": list(remarks)} if remarks else {}
    root = {"@schema": _SCHEMA, **made, "markups": markups}
    return json.dumps(root, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _markup(
    points: Sequence[tuple[Landmark, Position | None]], kind: str, name: str
) -> dict[str, Any]:
    return {
        "type": kind,
        **({"name": name} if name else {}),
        "coordinateSystem": "LPS",
        "coordinateUnits": "mm",
        "locked": False,
        "fixedNumberOfControlPoints": False,
        "labelFormat": "%N-%d",
        "lastUsedControlPointNumber": len(points),
        "controlPoints": [
            {
                "id": str(number),
                "label": mark.name,
                "description": mark.note,
                "associatedNodeID": "",
                # What Slicer itself writes for a point that is not placed.
                "position": "" if at is None else [float(value) for value in at],
                "orientation": _ORIENTATION,
                "selected": mark.enabled,
                "locked": mark.locked,
                "visibility": True,
                "positionStatus": "undefined" if at is None else "defined",
            }
            for number, (mark, at) in enumerate(points, 1)
        ],
    }
