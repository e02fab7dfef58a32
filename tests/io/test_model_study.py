"""Studies of models as people write them, and the report of a warped one."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.errors import FileFormatError, NewerFileError
from pinwarp.core.model_rows import ElementRow
from pinwarp.io.model_report import report_csv, report_json, report_text
from pinwarp.io.model_study import BodyRow, StudyRecord, read_model_study, write_model_study

START = "# pinwarp-model: 1\n# model: leg.osim\nbody,session"
LETTERS = st.characters(exclude_categories=("Cs", "Cc"), exclude_characters="\u2028\u2029\x85")
NOTES = st.text(LETTERS, max_size=20).map(str.strip)
NAMES = st.text(st.sampled_from("abcµ_-'=ä1 "), min_size=1, max_size=8).map(str.strip).filter(bool)


def read(tmp_path, text):
    path = tmp_path / "leg.pinwarp-model.csv"
    path.write_text(text, encoding="utf-8", newline="")
    return read_model_study(path)


@given(
    st.lists(
        st.tuples(NAMES, st.booleans(), st.booleans(), NOTES), max_size=4, unique_by=lambda x: x[0]
    ),
    st.lists(NAMES, max_size=3),
)
def test_a_study_is_read_as_it_was_written(tmp_path_factory, rows, paths):
    folder = tmp_path_factory.getbasetemp().resolve()
    bodies = tuple(
        BodyRow(f"b{name}", folder / f"{number}.csv", turns, enabled, note, 4 + number)
        for number, (name, turns, enabled, note) in enumerate(rows)
    )
    rules = tuple(f"/forceset/{name}/P" for name in paths)
    study = StudyRecord(folder / "my leg.osim", "0a1b", bodies, rules, rules[:1])
    write_model_study(folder / "x.pinwarp-model.csv", study)
    assert read_model_study(folder / "x.pinwarp-model.csv") == study


def test_a_study_may_come_from_a_spreadsheet_in_another_order_of_columns(tmp_path):
    text = (
        "\ufeff# pinwarp-model: 1;;;\r\n# model: ../generic/leg.osim;;;\r\n"
        "Session;Body;Enabled;Orientation rule\r\nthigh.csv;thigh;yes;TURN\r\n;;;\r\n"
    )
    study = read(tmp_path, text.replace(";;;\r\n# model", "\r\n# model").replace("osim;;;", "osim"))
    assert study.model == tmp_path.parent / "generic" / "leg.osim"
    assert study.bodies == (BodyRow("thigh", tmp_path / "thigh.csv", True, True, "", 4),)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("name,x,y,z\n", None, "no study of a model"),
        (START.replace(": 1", ": 2"), 1, "newer pinwarp"),
        (START.replace(": 1", ": one"), 1, "no version that is known"),
        (START.replace("# model: leg.osim\n", ""), None, "no study of a model"),
        (f"# model: a.osim\n{START}", 3, "names its model badly"),
        (START.replace("body,", "bone,"), 3, "no columns body and session"),
        (f"{START}\nthigh,\n", 4, "There is no session"),
        (f"{START}\nthigh,a.csv\n/bodyset/thigh,b.csv\n", 5, "has a session in line 4 already"),
        (f"{START},enabled\nthigh,a.csv,perhaps\n", 4, "neither 1 nor 0"),
        (f"{START},orientation_rule\nthigh,a.csv,flip\n", 4, "neither keep nor turn"),
        (f'{START}\n"thigh,a.csv\n', 4, "quotes"),
        ("\0\0", None, "not a text file"),
    ],
)
def test_a_study_that_cannot_be_used_is_refused_with_its_line(tmp_path, text, line, words):
    with pytest.raises(FileFormatError, match=words) as found:
        read(tmp_path, text)
    assert found.value.line == line


def test_a_study_of_a_newer_version_says_so(tmp_path):
    with pytest.raises(NewerFileError):
        read(tmp_path, START.replace(": 1", ": 7"))


def row(path, **more):
    figures = {"kind": "marker", "line": 7, "is_warped": True, "words": "carried"} | more
    return ElementRow("thigh", path, **figures)


def test_the_table_is_safe_to_open_and_has_millimetres():
    rows = [
        row("/markerset/=cmd", moved=0.01, plus_minus=0.002, turned=-3.5),
        row("/markerset/a,b", is_warped=False, flag="Look at it."),
    ]
    first, second = csv.DictReader(io.StringIO(report_csv(rows)))
    assert (first["moved_mm"], first["plus_minus_mm"], first["turned_deg"]) == ("10", "2", "-3.5")
    assert (first["outcome"], second["outcome"]) == ("warped", "flagged")
    assert (second["path"], second["moved_mm"]) == ("/markerset/a,b", "")


def test_json_has_no_figures_that_are_not_known():
    told = report_json([row("/a", moved=math.nan, turned=2.0)], {"model": "leg"})
    assert json.loads(json.dumps(told, allow_nan=False)) == told
    (element,) = told["elements"]
    assert (element["moved_mm"], element["turned_deg"], element["rule"]) == (None, 2.0, "carried")
    assert told["counts"] == {"warped": 1, "kept": 0, "flagged": 0}


def test_the_text_tells_kinds_in_short_and_what_is_flagged_in_full():
    rows = [row("/a", moved=0.01), row("/b", moved=0.03), row("/c", moved=0.02, flag="Look.")]
    text = report_text([*rows, row("/d", kind="mesh", is_warped=False)], ["A note."])
    assert text.splitlines() == [
        "thigh",
        "  3 markers warped, moved by 20.0 mm on average and 30.0 mm at most, 1 flagged",
        "  1 mesh kept",
        "! /c (marker, warped: carried)",
        "  Look.",
        "- A note.",
        "2 warped, 1 kept, 1 flagged",
    ]


def test_paths_are_seen_from_the_folder_of_the_study(tmp_path, monkeypatch):
    monkeypatch.chdir("/")
    study = read(tmp_path, f"{START}\nthigh,marks/a.csv\nhip,{tmp_path / 'b.csv'}\n")
    assert [body.session for body in study.bodies] == [
        *(tmp_path / "marks" / "a.csv", tmp_path / "b.csv"),
    ]
    assert study.model == Path(tmp_path, "leg.osim")
