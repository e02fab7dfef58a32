"""Curves and patches in landmark files: read as groups of their landmarks."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Side
from pinwarp.io.landmark_files import read_landmarks
from pinwarp.io.landmark_formats.reading import ReadGroup


def read(tmp_path: Path, name: str, text: str):
    path = tmp_path / name
    path.write_text(text)
    return read_landmarks(path, Side.SOURCE)


def markup(kind: str, labels: str, **more: object) -> str:
    points = [{"label": label, "position": [float(n), 0.0, 0.0]} for n, label in enumerate(labels)]
    return json.dumps({"markups": [{"type": kind, "controlPoints": points, **more}]})


@pytest.mark.parametrize(("kind", "closed"), [("Curve", False), ("ClosedCurve", True)])
def test_a_curve_of_slicer_is_one(tmp_path: Path, kind: str, closed: bool) -> None:
    reading = read(tmp_path, "linea.mrk.json", markup(kind, "abc"))
    assert reading.groups == (
        ReadGroup("linea", ("a", "b", "c"), is_closed=closed, are_handles=True),
    )
    assert reading.single == ()
    # Who wants only landmarks gets its points.
    assert reading.names == ("a", "b", "c")
    assert reading.notes == ()
    named = read(tmp_path, "x.mrk.json", markup(kind, "abc", name=" rim\n1 "))
    assert named.groups[0].name == "rim 1"


def test_points_of_a_curve_may_all_have_one_label(tmp_path: Path) -> None:
    reading = read(tmp_path, "a.mrk.json", markup("Curve", "FFF"))
    assert reading.groups[0].points == ("F", "F_2", "F_3")
    assert reading.skipped == ()


def test_other_markups_are_read_as_landmarks_still(tmp_path: Path) -> None:
    reading = read(tmp_path, "a.mrk.json", markup("Plane", "abc"))
    assert reading.groups == ()
    assert reading.notes == ("It is a Plane: its control points were read.",)
    angle = read(tmp_path, "b.mrk.json", markup("Angle", "abc"))
    assert angle.notes == ("It is an Angle: its control points were read.",)


def test_a_point_of_a_curve_that_is_none_is_told_and_left_out(tmp_path: Path) -> None:
    text = markup("Curve", "abc").replace("[1.0, 0.0, 0.0]", "[1.0, 0.0]")
    reading = read(tmp_path, "a.mrk.json", text)
    assert reading.groups[0].points == ("a", "c")
    assert "three numbers" in reading.skipped[0].reason


PTS = """Version 1.0
6
S000 1 2 3
C000-000 1 0 0
C000-001 9999 9999 9999
C001-000 3 0 0
P000-000 4 0 0
C000-002 2 0 0
"""


def test_landmark_files_have_curves_and_patches(tmp_path: Path) -> None:
    reading = read(tmp_path, "a.pts", PTS)
    assert [(x.name, x.points, x.is_curve) for x in reading.groups] == [
        ("C000", ("C000-000", "C000-001", "C000-002"), True),
        ("C001", ("C001-000",), True),
        ("P000", ("P000-000",), False),
    ]
    assert [x.name for x in reading.single] == ["S000"]
    assert reading.count == 6


def test_a_bad_line_is_skipped_and_its_point_missing(tmp_path: Path) -> None:
    reading = read(tmp_path, "a.pts", PTS.replace("C000-002 2 0 0", "C000-002 2 zero 0"))
    assert reading.groups[0].points == ("C000-000", "C000-001")
    assert reading.skipped[0].line == 8


TPS = """LM3=1
1 2 3
CURVES=2
POINTS=3
0 0 0
1 0 0
2 0 0
POINTS=5
0 0 5
1 0 5
1 1 5
0 1 5
0 0 5
ID=femur
SCALE=2
"""


def test_curves_of_tps_files_are_read_and_closed_where_they_end_where_they_begin(
    tmp_path: Path,
) -> None:
    reading = read(tmp_path, "a.tps", TPS)
    open_one, closed = reading.groups
    assert open_one == ReadGroup("curve_0", ("curve_0_0", "curve_0_1", "curve_0_2"))
    assert closed.is_closed
    assert len(closed.points) == 4
    assert [x.name for x in reading.single] == ["landmark_0"]
    assert reading.landmarks[2].source == (2.0, 0.0, 0.0)


def test_a_file_of_nothing_but_curves_is_read(tmp_path: Path, shared_data: Path) -> None:
    path = shared_data / "other-programs" / "13-tps-morphometrics" / "all_curves.tps"
    reading = read_landmarks(path, Side.SOURCE)
    assert reading.groups == (ReadGroup("curve_0", ("curve_0_0", "curve_0_1")),)
    assert reading.landmarks[1].source == (4.0, 5.0, 6.0)


def test_damaged_curves_of_tps_files_say_where(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"line 4: 'many' is no number of points"):
        read(tmp_path, "a.tps", TPS.replace("POINTS=3", "POINTS=many"))
    cut = read(tmp_path, "a.tps", TPS[: TPS.index("1 1 5")])
    assert "announces 5 points of curve_1 and holds 2" in " ".join(cut.notes)
    bad = read(tmp_path, "a.tps", TPS.replace("1 0 0", "1 x 0"))
    assert bad.groups[0].points == ("curve_0_0", "curve_0_2")
    assert bad.skipped[0].line == 6
    outline = read(tmp_path, "a.tps", "LM3=1\n1 2 3\nOUTLINES=1\nPOINTS=2\n1 1\n2 2\n")
    assert outline.groups == ()
    assert outline.notes == ("Outlines were left out.",)


ROWS = "LM3=8\n" + "".join(f"{n} 0 0\n" for n in range(8))


def test_sliders_of_geomorph_lie_beside_the_landmarks(tmp_path: Path) -> None:
    # From 1 over 3 and 4 to 2; 5, 6, 7 all around; 8 on the surface.
    sliders = "before,slide,after\n1,3,4\n3,4,2\n7,5,6\n5,6,7\n6,7,5\n"
    (tmp_path / "a.sliders.csv").write_text(sliders)
    (tmp_path / "a.surfslide.csv").write_text('"x"\n8\n')
    reading = read(tmp_path, "a.tps", ROWS)
    crest, ring, patch = reading.groups
    assert crest.points == ("landmark_0", "landmark_2", "landmark_3", "landmark_1")
    assert crest.anchors == {"landmark_0", "landmark_1"}
    assert (ring.points, ring.is_closed) == (("landmark_4", "landmark_5", "landmark_6"), True)
    assert (patch.points, patch.is_curve) == (("landmark_7",), False)
    assert [x.name for x in reading.single] == ["landmark_0", "landmark_1"]
    assert reading.notes == ("What slides was read from a.sliders.csv and a.surfslide.csv.",)


@pytest.mark.parametrize(
    ("sliders", "words"),
    [
        ("before,slide,after\n1,3\n", r"a\.sliders\.csv, line 2: Expected 3 row numbers"),
        ("1,3,x\n", r"a\.sliders\.csv, line 1: Expected 3 row numbers"),
        ("1,3,9\n", r"line 1: There are 8 landmarks"),
        ("0,3,4\n", r"line 1: There are 8 landmarks"),
    ],
)
def test_damaged_sliders_are_refused_with_their_line(
    tmp_path: Path, sliders: str, words: str
) -> None:
    (tmp_path / "a.sliders.csv").write_text(sliders)
    with pytest.raises(FileFormatError, match=words):
        read(tmp_path, "a.tps", ROWS)
