"""Landmarks, curves and patches in the files of other programs."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Side
from pinwarp.io.landmark_files import read_landmarks
from pinwarp.io.semilandmark_files import (
    SEMILANDMARK_SUFFIXES,
    format_of_semilandmarks,
    semilandmark_files,
    write_all,
)
from pinwarp.io.semilandmark_formats.points import CurveRows, PatchRows, PointSet


def place(row: int) -> tuple[float, float, float]:
    return (row + 0.5, 2.0 * row, 1e-3 * row)


# Landmarks 0-2; an open curve from 0 to 1 with points 3-5, 4 missing; a closed one that is
# anchored nowhere, 6-8; an open one that is anchored nowhere, 9-10; a patch, 11-12.
POINTS = PointSet(
    tuple(
        (f"{'lm' if row < 3 else 'x'} {row}", None if row in (2, 4) else place(row))
        for row in range(13)
    ),
    3,
    (
        CurveRows("crest: left", False, (0, 3, 4, 5, 1), (3, 4, 5)),
        CurveRows("ring", True, (6, 7, 8), (6, 7, 8)),
        CurveRows("line", False, (9, 10), (9, 10)),
    ),
    (PatchRows("cap", (11, 12)),),
    "mm",
)


def written(tmp_path: Path, suffix: str, points: PointSet = POINTS) -> tuple[list[Path], str]:
    texts, notes = semilandmark_files(tmp_path / f"femur{suffix}", points)
    write_all(texts)
    return list(texts), " ".join(notes)


def test_ends_of_open_curves_do_not_slide_and_closed_ones_do_all_around() -> None:
    crest, ring, line = POINTS.curves
    assert crest.sliders == ((0, 3, 4), (3, 4, 5), (4, 5, 1))
    assert ring.sliders == ((8, 6, 7), (6, 7, 8), (7, 8, 6))
    assert line.sliders == ()
    assert POINTS.sliding == (3, 4, 5, 6, 7, 8, 11, 12)


def test_landmark_files_number_single_points_curves_and_patches(tmp_path: Path) -> None:
    (path,), notes = written(tmp_path, ".pts")
    lines = path.read_text().splitlines()
    assert lines[:2] == ["Version 1.0", "13"]
    names = [line.split()[0] for line in lines[2:-1]]
    assert names == [
        *("S000", "S001", "S002", "C000-000", "C000-001", "C000-002"),
        *("C001-000", "C001-001", "C001-002", "C002-000", "C002-001", "P000-000", "P000-001"),
    ]
    assert lines[6] == "C000-001 9999 9999 9999"
    assert "no other names" in notes
    found = read_landmarks(path, Side.SOURCE)
    assert found.notes[0].startswith("2 landmarks have no position")


def test_morphologika_draws_curves_as_wires(tmp_path: Path) -> None:
    (path,), _ = written(tmp_path, ".morphologika.txt")
    content = path.read_bytes()
    assert content.count(b"\r\n") == content.count(b"\n")
    head, _, wires = content.decode().partition("[wireframe]\r\n")
    assert wires.split("\r\n")[:-1] == [
        *("1 4", "4 5", "5 6", "6 2", "7 8", "8 9", "9 7", "10 11"),
    ]
    assert "[landmarks]\r\n13\r\n" in head
    assert head.count("NA NA NA") == 2


def test_geomorph_has_sliders_and_surface_sliders_counted_from_one(tmp_path: Path) -> None:
    (tps, sliders, surface), notes = written(tmp_path, ".tps")
    assert [x.name for x in (sliders, surface)] == ["femur.sliders.csv", "femur.surfslide.csv"]
    assert tps.read_text().startswith("LM3=13\n0.5 0.0 0.0\n")
    assert tps.read_text().endswith("ID=femur\n")
    rows = list(csv.reader(sliders.read_text().splitlines()))
    assert rows[:3] == [["before", "slide", "after"], ["1", "4", "5"], ["4", "5", "6"]]
    assert len(rows) == 1 + 6
    assert surface.read_text() == "x\n12\n13\n"
    assert "2 at the ends of curves stay fixed" in notes
    assert "2 are missing (NA)" in notes


def test_tps_curves_hold_their_landmarks_and_close(tmp_path: Path) -> None:
    (path,), notes = written(tmp_path, ".curves.tps")
    lines = path.read_text().splitlines()
    assert lines[0] == "LM3=3"
    assert lines[4] == "CURVES=3"
    assert [line for line in lines if line.startswith("POINTS")] == [
        *("POINTS=5", "POINTS=4", "POINTS=2"),
    ]
    assert lines[6] == "0.5 0.0 0.0"
    assert lines[12] == lines[15]
    assert "no patches: 2 points were left out" in notes


def test_the_lines_of_r_say_what_slides_along_what(tmp_path: Path) -> None:
    (script, table), _ = written(tmp_path, ".R")
    text = script.read_text()
    assert "SMvector <- c(4, 5, 6, 7, 8, 9, 12, 13)" in text
    assert re.findall(r"  c\(([\d, ]*)\)", text) == ["1, 4, 5, 6, 2", "7, 8, 9, 7", "10, 11"]
    assert "surp <- c(12, 13)" in text
    assert 'read.csv("femur.points.csv", row.names = 1)' in text
    rows = list(csv.reader(table.read_text().splitlines()))
    assert rows[0] == ["name", "x", "y", "z"]
    assert rows[5] == ["x 4", "NA", "NA", "NA"]
    assert len({row[0] for row in rows}) == 14


def test_slicer_gets_a_curve_a_file_in_millimetres(tmp_path: Path) -> None:
    in_metres = PointSet(POINTS.places, 3, POINTS.curves, POINTS.patches, "m")
    paths, _ = written(tmp_path, ".mrk.json", in_metres)
    assert [path.name for path in paths] == [
        "femur.mrk.json",
        "femur.crest_left.mrk.json",
        "femur.ring.mrk.json",
        "femur.line.mrk.json",
        "femur.cap.mrk.json",
    ]
    found = [json.loads(path.read_text())["markups"][0] for path in paths]
    kinds = [markup["type"] for markup in found]
    assert kinds == ["Fiducial", "Curve", "ClosedCurve", "Curve", "Fiducial"]
    points = found[1]["controlPoints"]
    assert [point["label"] for point in points] == ["lm 0", "x 3", "x 4", "x 5", "lm 1"]
    assert points[1]["position"] == [3500.0, 6000.0, 3.0]
    assert points[2]["positionStatus"] == "undefined"


def test_groups_that_would_have_one_file_get_two(tmp_path: Path) -> None:
    twins = (CurveRows("a b", False, (0, 1), ()), CurveRows("A/B", False, (0, 1), ()))
    paths, _ = written(tmp_path, ".mrk.json", PointSet(POINTS.places[:2], 2, twins))
    assert [path.name for path in paths] == [
        "femur.mrk.json",
        "femur.a_b.mrk.json",
        "femur.A_B_2.mrk.json",
    ]


@pytest.mark.parametrize("suffix", SEMILANDMARK_SUFFIXES)
def test_patches_alone_and_curves_alone_are_written(tmp_path: Path, suffix: str) -> None:
    patches = PointSet(POINTS.places, 3, (), (PatchRows("p", tuple(range(3, 13))),))
    curves = PointSet(POINTS.places, 3, (CurveRows("c", True, (*range(3, 13),), (*range(3, 13),)),))
    for points in (patches, curves):
        paths, _ = written(tmp_path, suffix, points)
        assert all(path.read_text() for path in paths)


def test_another_suffix_is_refused_with_those_there_are() -> None:
    with pytest.raises(FileFormatError, match=r"'\.xyz' are not supported\. Choose one of \.tps"):
        format_of_semilandmarks(Path("femur.xyz"))
    assert format_of_semilandmarks(Path("A.MRK.JSON")).suffix == ".mrk.json"


def test_a_unit_that_slicer_does_not_know_is_refused(tmp_path: Path) -> None:
    inches = PointSet(POINTS.places, 3, unit="inch")
    with pytest.raises(FileFormatError, match="how many make one inch"):
        semilandmark_files(tmp_path / "a.mrk.json", inches)
