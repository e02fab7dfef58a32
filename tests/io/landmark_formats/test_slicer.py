from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any

import pytest

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side, flipped
from pinwarp.io.landmark_files import write_landmarks

from .reading import read, skipped, sources

FCSV = """# Markups fiducial file version = 4.11
# CoordinateSystem = {frame}
# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID
{rows}"""
ROW = "vtkMRMLMarkupsFiducialNode_0,1,2,3,0,0,0,1,1,1,0,{label},,vtkMRMLScalarVolumeNode1\n"


def fcsv(*rows: str, frame: str = "LPS") -> str:
    return FCSV.format(frame=frame, rows="\n".join(rows))


def markups(*points: Any, **keys: Any) -> str:
    return json.dumps(
        {"markups": [{"type": "Fiducial", "controlPoints": points, **keys}]}, indent=1
    )


# .fcsv


@pytest.mark.parametrize(
    ("said", "meant"), [("LPS", "LPS"), ("RAS", "RAS"), ("0", "RAS"), ("1", "LPS"), ("lps", "LPS")]
)
def test_positions_stay_as_stored_and_the_frame_is_named(said: str, meant: str) -> None:
    reading = read(fcsv("1,12.5,-40.2,60.1,0,0,0,1,1,1,0,nasion,,", frame=said))
    assert sources(reading) == {"nasion": (12.5, -40.2, 60.1)}
    assert (reading.frame, reading.unit, reading.notes) == (meant, "mm", ())


def test_a_frame_that_is_not_known_is_said() -> None:
    reading = read(fcsv("1,1,2,3,0,0,0,1,1,1,0,a,,", frame="IJK"))
    assert reading.frame == ""
    assert reading.notes == ("The coordinate system 'IJK' is not known.",)


@pytest.mark.parametrize(
    ("label", "name"),
    [
        ("nasion", "nasion"),
        ('"left, tragus"', "left, tragus"),
        ('"the ""real"" one"', 'the "real" one'),
        ("5 inch", "5 inch"),
        ("", "landmark_0"),
    ],
)
def test_labels_are_read_with_and_without_quotes(label: str, name: str) -> None:
    assert read(fcsv(ROW.format(label=label))).names == (name,)


def test_a_file_of_slicer_3_has_its_label_first_and_is_in_ras() -> None:
    reading = read("L-0,1,2,3,1,1\nL-1,4,5,6,1,1\n", ".fcsv")
    assert sources(reading) == {"L-0": (1, 2, 3), "L-1": (4, 5, 6)}
    assert reading.frame == "RAS"


def test_the_two_cells_that_slicer_5_adds_say_what_was_placed() -> None:
    rows = [f"{n},1,2,3,0,0,0,1,1,1,0,p{n},,,{n},0" for n in range(4)]
    reading = read(fcsv(*rows))
    assert sources(reading) == {"p0": None, "p1": (1, 2, 3), "p2": (1, 2, 3), "p3": None}


@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ("1,1,2", "a number is missing"),
        ("1,,,,0,0,0,1,1,1,0,a,,", "no coordinates"),
        ("1,1,2,x,0,0,0,1,1,1,0,a,,", "'x' is not a number"),
        ("1,1,2,nan,0,0,0,1,1,1,0,a,,", "not a finite number"),
        ('1,7,8,9,0,0,0,1,1,1,0,"first,,', "quotes do not match"),
    ],
)
def test_a_bad_row_is_skipped_with_its_line(row: str, reason: str) -> None:
    reading = read(fcsv("1,1,2,3,0,0,0,1,1,1,0,first,,", row, "3,4,5,6,0,0,0,1,1,1,0,last,,"))
    assert reading.names == ("first", "last")
    ((line, why),) = skipped(reading)
    assert line == 5
    assert reason in why


def test_what_is_written_has_slicers_header_and_fourteen_cells(tmp_path: Path) -> None:
    path = tmp_path / "a.fcsv"
    write_landmarks(path, [Landmark("a, b", (1, 2, 3)), Landmark("c", (4, 5, 6))], Side.SOURCE)
    lines = path.read_text().splitlines()
    assert lines[:3] == FCSV.format(frame="LPS", rows="").splitlines()
    rows = list(csv.reader(lines[3:]))
    assert [len(row) for row in rows] == [14, 14]
    assert [row[0] for row in rows] == ["1", "2"]
    assert [row[11] for row in rows] == ["a, b", "c"]


# .mrk.json


def test_what_is_not_said_is_as_in_slicer() -> None:
    reading = read(markups({"label": "a", "position": [1, 2, 3]}))
    assert (reading.frame, reading.unit) == ("LPS", "mm")
    assert sources(reading) == {"a": (1, 2, 3)}


@pytest.mark.parametrize(
    ("units", "unit"),
    [("mm", "mm"), ("m", "m"), (["mm", "UCUM", "millimeter"], "mm"), ("", "mm"), (None, "mm")],
)
def test_the_unit_is_a_word_or_a_code(units: object, unit: str) -> None:
    assert read(markups({"position": [1, 2, 3]}, coordinateUnits=units)).unit == unit


@pytest.mark.parametrize(
    "point",
    [
        {"position": ""},
        {"position": []},
        {"position": None},
        {},
        {"position": [0, 0, 0], "positionStatus": "undefined"},
        {"position": [0, 0, 0], "positionStatus": "missing"},
    ],
)
def test_a_point_that_is_not_defined_is_a_name(point: dict[str, Any]) -> None:
    reading = read(markups({"label": "a", **point}))
    assert reading.landmarks == (Landmark("a"),)
    assert reading.skipped == ()


def test_of_several_lists_the_first_is_read_and_every_curve() -> None:
    root = json.loads(markups({"label": "a", "position": [1, 2, 3]}, coordinateSystem="RAS"))
    root["markups"][0]["type"] = "Curve"
    root["markups"].append({"controlPoints": [{"label": "b", "position": [4, 5, 6]}]})
    root["markups"].append({"controlPoints": [{"label": "c", "position": [7, 8, 9]}], "name": "G"})
    root["markups"].append({**root["markups"][0], "name": "rim", "type": "ClosedCurve"})
    reading = read(json.dumps(root))
    # What is in another frame than the first list is turned.
    assert sources(reading) == {"b": (4, 5, 6), "a": (-1, -2, 3), "a_2": (-1, -2, 3)}
    assert reading.frame == "LPS"
    assert [(x.name, x.points, x.is_closed) for x in reading.groups] == [
        ("a", ("a",), False),
        ("rim", ("a_2",), True),
    ]
    assert "2 lists of points: the first was read, not G." in reading.notes[0]


@pytest.mark.parametrize(
    ("point", "reason"),
    [
        ('{"label": "b", "position": [1, 2]}', "not a list of three numbers"),
        ('{"label": "b", "position": "1 2 3"}', "not a list of three numbers"),
        ('{"label": "b", "position": [1, 2, "3"]}', "'3' is not a number"),
        ('{"label": "b", "position": [1, 2, true]}', "'True' is not a number"),
        ('{"label": "b", "position": [1, 2, NaN]}', "not a finite number"),
        ('{"label": "b", "position": [1, 2, 1e999]}', "not a finite number"),
        ('{"label": "b", "position": [1, 2, ' + "9" * 5000 + "]}", "not a finite number"),
        ("17", "not a control point"),
        ("[[[]]]", "not a control point"),
    ],
)
def test_a_bad_point_is_skipped_with_the_line_it_begins_at(point: str, reason: str) -> None:
    text = '{"markups": [\n{"controlPoints": [\n{"label": "a",\n "position": [1, 2, 3]},\n%s,\n'
    reading = read(text % point + '{"label": "c", "position": [4, 5, 6]}]}]}')
    assert reading.names == ("a", "c")
    ((line, why),) = skipped(reading)
    assert line == 5
    assert reason in why


@pytest.mark.parametrize(
    ("text", "line", "reason"),
    [
        ('{"markups": [\n{"controlPoints": [', 2, "not JSON, or it was cut off"),
        ('{\n"a": 1,,}', 2, "not JSON"),
        ('{"markups": []}', 1, "no list of control points"),
        ('{"markups": {"0": []}}', 1, "no list of control points"),
        ('{"markups": [{"controlPoints": 7}]}', 1, "no list of control points"),
        ('{"markups": [[]]}', 1, "no list of control points"),
        ('{"a": ' + "[" * 100_000 + "]" * 100_000 + "}", 1, "nested too deeply"),
    ],
)
def test_what_is_no_list_of_points_is_refused_with_a_line(
    text: str, line: int, reason: str
) -> None:
    with pytest.raises(FileFormatError, match=reason) as caught:
        read(text, ".mrk.json")
    assert caught.value.line == line
    # Nobody knows which program wrote it.
    assert "again in 3D Slicer" not in str(caught.value)


def test_what_is_written_is_as_the_schema_wants_it(tmp_path: Path) -> None:
    path = tmp_path / "a.mrk.json"
    write_landmarks(path, [Landmark("a", (1, 2, 3)), Landmark("b")], Side.SOURCE, unit="m")
    root = json.loads(path.read_text())
    # What Slicer itself checks.
    assert re.search(r"markups-schema-v1\.[0-9]+\.[0-9]+\.json#*$", root["@schema"])
    (markup,) = root["markups"]
    assert markup["type"] == "Fiducial"
    assert (markup["coordinateSystem"], markup["coordinateUnits"]) == ("LPS", "mm")
    placed, unset = markup["controlPoints"]
    assert placed["position"] == [1000.0, 2000.0, 3000.0]
    assert (placed["positionStatus"], unset["positionStatus"]) == ("defined", "undefined")
    assert unset["position"] == ""
    assert len(placed["orientation"]) == 9
    assert placed["id"] != unset["id"]
    for point in (placed, unset):
        assert (point["selected"], point["locked"], point["visibility"]) == (True, False, True)


def test_lps_and_ras_differ_by_the_signs_of_x_and_y() -> None:
    reading = read(fcsv("1,12.5,-40.2,60.1,0,0,0,1,1,1,0,nasion,,"))
    (turned,) = flipped(reading.landmarks, Side.SOURCE)
    assert turned.source == (-12.5, 40.2, 60.1)
    assert flipped((turned,), Side.SOURCE) == reading.landmarks
    assert flipped((turned,), Side.DESTINATION) == (turned,)
