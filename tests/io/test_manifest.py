"""Manifests as people write them, and what is wrong with them."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from pinwarp.core.components import Components
from pinwarp.core.errors import FileFormatError
from pinwarp.io.manifest import read_manifest

HEADER = "name,destination_landmarks"


def read(tmp_path: Path, text: str):
    path = tmp_path / "study.csv"
    path.write_text(text, encoding="utf-8")
    return read_manifest(path)


def problem(tmp_path: Path, text: str) -> FileFormatError:
    with pytest.raises(FileFormatError) as found:
        read(tmp_path, text)
    assert found.value.path == tmp_path / "study.csv"
    return found.value


def test_paths_are_seen_from_the_folder_of_the_manifest(tmp_path, monkeypatch):
    monkeypatch.chdir("/")
    absolute = tmp_path / "elsewhere" / "b.csv"
    anna, ben = read(
        tmp_path,
        f"{HEADER},destination_mesh\nanna,marks/a.csv,../a.stl\n\n# a remark\nben,{absolute},\n",
    ).subjects
    assert anna.destination_landmarks == tmp_path / "marks" / "a.csv"
    assert anna.destination_mesh == tmp_path.parent / "a.stl"
    assert (ben.destination_landmarks, ben.destination_mesh) == (absolute, None)
    assert (anna.line, ben.line) == (2, 5)


def test_columns_come_in_any_order_and_case_and_others_are_named(tmp_path):
    manifest = read(
        tmp_path, "Age,Penalty,Destination Landmarks,NAME,components\n7,inf,a.csv,anna,Without-Pose"
    )
    (anna,) = manifest.subjects
    assert anna.penalty == math.inf
    assert anna.components is Components.WITHOUT_POSE
    assert manifest.unused == ("age",)


@pytest.mark.parametrize("separator", [";", "\t"])
def test_spreadsheets_may_write_other_separators_and_decimal_commas(tmp_path, separator):
    rows = [["name", "destination_landmarks", "penalty"], ["anna", "a.csv", "0.5"]]
    if separator == ";":
        rows[1][2] = "0,5"
    text = "\r\n".join(separator.join(row) for row in rows)
    assert read(tmp_path, "\ufeff" + text).subjects[0].penalty == 0.5
    two = "\n".join(separator.join(row[:2]) for row in rows)
    assert read(tmp_path, two).subjects[0].penalty is None


def test_a_name_that_was_quoted_against_formulas_is_itself_again(tmp_path):
    assert read(tmp_path, f"{HEADER}\n'-7,a.csv\n").subjects[0].name == "-7"


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("name,landmarks\nanna,a.csv\n", 1, "column 'destination_landmarks' is missing"),
        ("# only a remark\n", 1, "column 'name' is missing"),
        ("name,name,destination_landmarks\n", 1, "'name' is there twice"),
        (f"{HEADER}\nanna,a.csv\nAnna,b.csv\n", 3, "was used in line 2"),
        (f"{HEADER}\n\n../anna,a.csv\n", 3, "holds '/'"),
        (f"{HEADER}\na\\b,a.csv\n", 2, "holds '\\\\'"),
        (f"{HEADER}\n..,a.csv\n", 2, "No file can be called '..'"),
        (f"{HEADER}\nCON,a.csv\n", 2, "No file can be called 'CON'"),
        (f"{HEADER}\n{'a' * 300},a.csv\n", 2, "too long"),
        (f"{HEADER}\n,a.csv\n", 2, "The name is missing"),
        (f'{HEADER}\n"anna,a.csv\n', 2, "quotes do not match"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(tmp_path, text, line, words):
    error = problem(tmp_path, text)
    assert words in error.reason
    assert error.line == line


@pytest.mark.parametrize(
    ("header", "row", "words"),
    [
        ("", "anna", "There is no destination_landmarks: write it"),
        ("", "anna,a.csv,surplus", "The row has 3 cells for 2 columns."),
        (
            ",penalty",
            "anna,a.csv,-1",
            "In the column 'penalty': the warping penalty -1 is negative.",
        ),
        (",penalty", "anna,a.csv,much", "In the column 'penalty': 'much' is not a number."),
        (",penalty", "anna,a.csv,nan", "In the column 'penalty': 'nan' is not a finite number."),
        (",penalty", f"anna,a.csv,{'9' * 1000}", f"'{'9' * 57}...' is not a finite"),
        (
            ",components",
            "anna,a.csv,elastic",
            "In the column 'components': 'elastic' is none of full",
        ),
        (
            "",
            "anna,~nosuchuser/x.csv",
            "In the column 'destination_landmarks': there is no user '~nosuchuser'.",
        ),
        (",destination_mesh", "anna,a.csv,~nosuchuser/x.stl", "no user '~nosuchuser'"),
    ],
)
def test_a_row_that_cannot_be_used_names_its_column_and_the_others_go_on(
    tmp_path, header, row, words
):
    found = read(tmp_path, f"{HEADER}{header}\n{row}\nben,b.csv\n").subjects
    assert [(one.name, one.line) for one in found] == [("anna", 2), ("ben", 3)]
    assert words in found[0].problem
    assert found[1].problem == ""


@pytest.mark.parametrize(
    ("one", "other"), [("t\u00e9te", "te\u0301te"), ("anna", "anna\u200b"), ("a b", "a\u00a0b")]
)
def test_two_names_that_look_the_same_are_refused(tmp_path, one, other):
    error = problem(tmp_path, f"{HEADER}\n{one},a.csv\n{other},b.csv\n")
    assert "was used in line 2 in letters that look the same" in error.reason


@pytest.mark.parametrize("name", ["con", "COM1.left", "com²", "NUL .a", "conin$", "anna.", "a:b"])
def test_what_windows_takes_for_a_device_is_no_subject(tmp_path, name):
    assert "file" in str(problem(tmp_path, f"{HEADER}\n{name},a.csv\n"))


@pytest.mark.parametrize("name", ["control", "com", "auxiliary.1", "lpt10"])
def test_what_only_begins_like_a_device_is_a_subject(tmp_path, name):
    (subject,) = read(tmp_path, f"{HEADER}\n{name},a.csv\n").subjects
    assert subject.name == name


def test_a_name_is_taken_also_where_its_row_cannot_be_used(tmp_path):
    assert "was used in line 2" in problem(tmp_path, f"{HEADER}\nanna\nanna,a.csv\n").reason


def test_a_manifest_without_subjects_says_so(tmp_path):
    assert "no subject" in problem(tmp_path, f"{HEADER}\n").reason
