"""What a spreadsheet would run is text in every table, and itself again when it is read."""

from __future__ import annotations

import csv
import io
import math
import os
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.clipboard_table import clipboard_text, read_clipboard
from pinwarp.io.csv_cells import formula_unquoted, numeral
from pinwarp.io.csv_text import csv_line
from pinwarp.io.landmark_files import read_landmarks, write_landmarks
from pinwarp.io.mesh_reference import MeshReference
from pinwarp.io.report import ReportRow, write_figures
from pinwarp.io.session_file import SessionRecord, read_session, write_session
from pinwarp.io.summary_file import COLUMNS, read_summary, write_summary

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.IGNORECASE)
FORMULAS = [
    "=cmd|' /C calc'!A0",
    "+1+cmd",
    "-2+3+cmd",
    "@SUM(A1)",
    "＝1+1",
    "-inf",
]
each_formula = pytest.mark.parametrize("formula", FORMULAS)


def cells_of(text: str) -> list[str]:
    """Return every cell a spreadsheet finds, whatever it takes for the separator."""
    return [
        cell
        for separator in ",;\t"
        for row in csv.reader(io.StringIO(text), delimiter=separator)
        for cell in row
    ]


def assert_harmless(text: str) -> None:
    for cell in cells_of(text):
        assert not re.match(r"[=+\-@\t\r\n＝＋－＠]", cell) or NUMBER.fullmatch(cell), repr(cell)


@each_formula
def test_in_no_cell_of_a_report(tmp_path, formula):
    path = tmp_path / "a.csv"
    write_figures(path, [ReportRow(formula, formula, formula, -1.5, formula)])
    write_figures(path, [ReportRow(formula, formula, formula, -1.5, formula)])
    assert_harmless(path.read_text(encoding="utf-8"))
    assert path.read_text(encoding="utf-8").splitlines()[1].split(",")[-2] == "-1.5"


def test_an_infinite_figure_is_no_formula(tmp_path):
    write_figures(tmp_path / "a.csv", [ReportRow("a", "b", "c", -math.inf)])
    assert "'-inf" in (tmp_path / "a.csv").read_text(encoding="utf-8")


@each_formula
def test_in_no_column_of_a_summary_also_one_that_was_read(tmp_path, formula):
    path = tmp_path / "summary.csv"
    write_summary(path, [dict.fromkeys(COLUMNS, formula)])
    assert_harmless(path.read_text(encoding="utf-8"))
    again = read_summary(path)
    assert again == {formula: dict.fromkeys(COLUMNS, formula)}
    write_summary(path, again.values())
    assert_harmless(path.read_text(encoding="utf-8"))


@each_formula
def test_in_no_cell_of_what_is_copied(formula):
    text = clipboard_text([Landmark(formula, (-1, 2, 3), note=formula)])
    assert_harmless(text)
    (row,) = read_clipboard(text).rows
    assert (row.name, row.values["note"], row.values["source"]) == (formula, formula, (-1, 2, 3))


@each_formula
@pytest.mark.parametrize("name", ["a.csv", "a.bigwarp.csv"])
def test_in_no_cell_of_landmarks(tmp_path, formula, name):
    path = tmp_path / name
    write_landmarks(path, [Landmark(formula, (-1, 2, 3), (4, -5, 6))], None)
    assert_harmless(path.read_text(encoding="utf-8"))
    (landmark,) = read_landmarks(path, Side.SOURCE).landmarks
    assert (landmark.name, landmark.source) == (formula, (-1, 2, 3))


@each_formula
def test_in_no_cell_and_no_line_of_a_session(tmp_path, formula):
    path = tmp_path / "a.pinwarp.csv"
    # As the system spells it, which may have no such letters.
    mesh = tmp_path / os.fsdecode(f"a,{formula.replace('/', '')}.stl".encode())
    record = SessionRecord(
        (Landmark(formula, (-1, 2, 3), note=formula, extra=((formula, formula),)),),
        source_mesh=MeshReference(mesh, "ab", 3),
        unit=f"mm,{formula}",
        unknown=(("by", f'Ada; "{formula}'), ("", f"x,\t{formula}")),
    )
    write_session(path, record)
    assert_harmless(path.read_text(encoding="utf-8"))
    assert read_session(path) == record


def test_an_older_header_with_quotes_is_read_as_it_is(tmp_path):
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, SessionRecord(unit='"mm"'))
    assert '# unit: "mm"\n' in path.read_text(encoding="utf-8")
    assert read_session(path).unit == '"mm"'


@pytest.mark.parametrize("name", ["=1+1", "-7", "'=1+1", "@a", "+x"])
def test_a_label_of_slicer_is_as_it_is_for_it_is_no_spreadsheets_table(tmp_path, name):
    path = tmp_path / "a.fcsv"
    write_landmarks(path, [Landmark(name, (1, 2, 3))], Side.SOURCE)
    assert path.read_text(encoding="utf-8").splitlines()[-1].split(",")[11] == name
    assert read_landmarks(path, Side.SOURCE).names == (name,)


@given(st.lists(st.text(st.characters(exclude_characters="\0\r", codec="utf-8"), max_size=9)))
def test_every_cell_is_harmless_and_comes_back(cells):
    # A line of one empty cell is a blank one.
    cells = ["name", *cells]
    line = csv_line(cells)
    found = [cell for row in csv.reader(io.StringIO(line, newline=""), strict=True) for cell in row]
    assert [formula_unquoted(cell) for cell in found] == cells
    for cell in found:
        assert not re.match(r"[=+\-@\t\r\n]", cell)


@pytest.mark.parametrize("number", ["-1", "+1.5", "-.5e-3", "1e9", "-0.0"])
def test_a_number_stays_one_and_a_name_that_looks_like_it_is_text(number):
    assert csv_line([numeral(number)]) == f"{number}\n"
    assert formula_unquoted(csv_line([number]).strip()) == number
    assert csv_line([number]).startswith("'") == (number[0] in "+-")


def test_every_table_is_written_by_the_one_place():
    source = Path(__file__).parents[2] / "src" / "pinwarp"
    users = {
        path.name for path in source.rglob("*.py") if "formula_quoted(" in path.read_text("utf-8")
    }
    assert users == {"csv_cells.py", "csv_text.py"}
    assert not [
        path.name
        for path in source.rglob("*.py")
        if "csv.writer" in path.read_text(encoding="utf-8")
    ]
