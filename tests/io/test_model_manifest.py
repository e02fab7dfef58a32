"""Manifests of cohorts as people write them."""

from __future__ import annotations

import pytest

from pinwarp.core.errors import FileFormatError
from pinwarp.io.model_manifest import BodyFiles, ModelSubject, read_model_manifest

BODIES = ["hip", "thigh"]


def read(tmp_path, text):
    path = tmp_path / "cohort.csv"
    path.write_text(text)
    return read_model_manifest(path, BODIES)


def test_a_subject_has_what_its_row_names_and_other_bodies_stay_generic(tmp_path):
    manifest = read(
        tmp_path,
        "# a remark\nname;thigh_mesh;thigh;hip\nanna;a.stl;a/thigh.csv;hip.csv\n\nben;;;b.csv\n",
    )
    assert manifest.bodies == ("hip", "thigh")
    assert manifest.subjects == (
        ModelSubject(
            "anna",
            3,
            (
                BodyFiles("thigh", tmp_path / "a" / "thigh.csv", tmp_path / "a.stl"),
                BodyFiles("hip", tmp_path / "hip.csv"),
            ),
        ),
        ModelSubject("ben", 5, (BodyFiles("hip", tmp_path / "b.csv"),)),
    )


def test_a_row_that_cannot_be_used_is_a_subject_with_a_problem(tmp_path):
    anna, ben = read(tmp_path, "name,thigh\nanna,\nben,b.csv,c.csv\n").subjects
    assert anna.problem == "There are no landmarks of any body."
    assert ben.problem == "The row has 3 cells for 2 columns."


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("thigh\na.csv\n", 1, "name, and one for each body"),
        ("name,destination_landmarks\nanna,a.csv\n", 1, "name, and one for each body"),
        ("name,thigh,foot\nanna,a.csv,b.csv\n", 1, "'foot' is none of a body"),
        ("name,thigh,thigh\nanna,a.csv,b.csv\n", 1, "'thigh' is there twice"),
        ("name,thigh\n../anna,a.csv\n", 2, "which a file's name cannot"),
        ("name,thigh\nanna,a.csv\nAnna,b.csv\n", 3, "was used in line 2"),
        ('name,thigh\n"anna,a.csv\n', 2, "quotes"),
        ("name,thigh\n", None, "no subject in it"),
    ],
)
def test_a_manifest_that_cannot_be_used_is_refused_with_its_line(tmp_path, text, line, words):
    with pytest.raises(FileFormatError, match=words) as found:
        read(tmp_path, text)
    assert found.value.line == line
