"""BigWarp, MeshLab, IDAV, Morphologika, TPS and MNI tag points."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.landmark_files import write_landmarks

from .reading import read, skipped, sources

# BigWarp


def test_an_inactive_pair_is_disabled_but_a_half_one_is_not() -> None:
    reading = read(
        '"a","false","1","2","3","4","5","6"\n"b","false","Infinity","-Infinity","inf","4","5","6"\n'
    )
    assert reading.landmarks == (
        Landmark("a", (1, 2, 3), (4, 5, 6), enabled=False),
        Landmark("b", None, (4, 5, 6)),
    )


def test_a_number_behind_the_second_cell_is_passed_over() -> None:
    reading = read('"a","true","17","1","2","3","4","5","6"\n')
    assert reading.landmarks == (Landmark("a", (1, 2, 3), (4, 5, 6)),)


@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ('"b","true","1","2","3","4"', "it needs 8 cells and has 6"),
        ('"b","perhaps","1","2","3","4","5","6"', "'perhaps' and not true or false"),
        ('"b","true","1","Infinity","3","4","5","6"', "not a finite number"),
        ('"b","true","1","2","3","4","5","NaN"', "not a finite number"),
    ],
)
def test_a_bad_row_of_bigwarp_is_skipped(row: str, reason: str) -> None:
    reading = read(f'"a","true","1","2","3","4","5","6"\n{row}\n')
    assert reading.names == ("a",)
    ((line, why),) = skipped(reading)
    assert line == 2
    assert reason in why


def test_a_half_pair_is_written_inactive(tmp_path: Path) -> None:
    write_landmarks(tmp_path / "a.bigwarp.csv", [Landmark("a", (1, 2, 3))], None)
    assert (tmp_path / "a.bigwarp.csv").read_text() == (
        '"a","false","1.0","2.0","3.0","Infinity","Infinity","Infinity"\n'
    )


# MeshLab


def test_points_of_meshlab_are_read_as_it_writes_them() -> None:
    reading = read(
        '<!DOCTYPE PickedPoints>\n<PickedPoints>\n <DocumentData>\n  <User name="ada"/>\n'
        ' </DocumentData>\n <point name="M2 (maxillary)" x="8.17" active="1" y="9.8" z="11"/>\n'
        ' <point active="0" x="0" y="0" z="0" name="Gonion"/>\n</PickedPoints>\n'
    )
    assert sources(reading) == {"M2 (maxillary)": (8.17, 9.8, 11), "Gonion": None}


@pytest.mark.parametrize(
    ("point", "reason"),
    [
        ('<point x="1" y="2" name="b"/>', "a number is missing"),
        ('<point x="1" y="2" z="z" name="b"/>', "'z' is not a number"),
        ('<point x="1" y="2" z="inf" name="b"/>', "not a finite number"),
        ('<point x="1" y="2" z="3" active="perhaps" name="b"/>', "'perhaps' and not 1 or 0"),
    ],
)
def test_a_bad_point_of_meshlab_is_skipped(point: str, reason: str) -> None:
    reading = read(f'<PickedPoints>\n<point x="1" y="2" z="3" name="a"/>\n{point}\n</PickedPoints>')
    assert reading.names == ("a",)
    assert reading.skipped[0].text == point
    ((line, why),) = skipped(reading)
    assert line == 3
    assert reason in why


LAUGHS = '<!DOCTYPE PickedPoints [\n<!ENTITY a "ha">\n<!ENTITY b "&a;&a;&a;&a;&a;&a;&a;">]>\n'
OUTSIDE = '<!DOCTYPE PickedPoints [\n<!ENTITY a SYSTEM "file:///etc/passwd">]>\n'


@pytest.mark.parametrize("declaration", [LAUGHS, OUTSIDE])
def test_entities_are_refused(declaration: str) -> None:
    point = '<point x="1" y="2" z="3" active="1" name="&a;"/>'
    with pytest.raises(FileFormatError, match="line 2: It declares entities"):
        read(f"{declaration}<PickedPoints>{point}</PickedPoints>", ".pp")


def test_xml_that_was_cut_off_is_refused_with_its_line() -> None:
    with pytest.raises(
        FileFormatError, match=r"line 2: This is not XML, or it was cut off"
    ) as caught:
        read('<PickedPoints>\n<point x="1" y="2', ".pp")
    assert "Save it again in MeshLab." in str(caught.value)


# IDAV and Stratovan


@pytest.mark.parametrize("end", ["", "\n", "\n\n"])
def test_an_empty_line_at_the_end_is_not_needed(end: str) -> None:
    reading = read("Version 1.0\n2\nS000 1 2 3\nS001 4 5 6" + end)
    assert sources(reading) == {"S000": (1, 2, 3), "S001": (4, 5, 6)}
    assert reading.notes == ()


def test_9999_is_missing_with_decimals_too_but_only_three_times() -> None:
    reading = read("Version 1.0\n2\nS000 9999.000 9999.0 9999\nS001 9999 1 2\n")
    assert sources(reading) == {"S000": None, "S001": (9999, 1, 2)}


def test_a_file_that_lost_landmarks_says_so() -> None:
    reading = read("Version 1.0\n3\nS000 1 2 3\nS001 4 5\n")
    assert skipped(reading) == [(4, "it needs three coordinates")]
    assert reading.notes == ("The file announces 3 landmarks and holds 2: was it cut off?",)


def test_names_of_several_words_and_none_are_read() -> None:
    reading = read("Version 1.0\n2\nleft tragus 1 2 3\n4 5 6\n")
    assert sources(reading) == {"left tragus": (1, 2, 3), "landmark_1": (4, 5, 6)}


def test_an_empty_line_is_written_behind_the_last_landmark(tmp_path: Path) -> None:
    write_landmarks(tmp_path / "a.pts", [Landmark("S000", (1, 2, 3))], Side.SOURCE)
    assert (tmp_path / "a.pts").read_text() == "Version 1.0\n1\nS000 1.0 2.0 3.0\n\n"


# Morphologika

MORPHOLOGIKA = "[individuals]\n{n}\n[landmarks]\n2\n[dimensions]\n3\n[rawpoints]\n{rows}"


def test_of_several_specimens_the_first_is_read() -> None:
    reading = read(MORPHOLOGIKA.format(n=3, rows="'#1\n1 2 3\n4 5 6\n" * 3))
    assert sources(reading) == {"landmark_0": (1, 2, 3), "landmark_1": (4, 5, 6)}
    assert reading.notes == ("3 specimens: the first was read (1).",)


def test_sections_that_do_not_concern_landmarks_are_passed_over() -> None:
    rows = "'#1\n1,2,3\nNA NA NA\n[wireframe]\n1 2\n[labels]\nsex\n[labelvalues]\nf\n"
    reading = read(MORPHOLOGIKA.format(n=1, rows=rows))
    assert sources(reading) == {"landmark_0": (1, 2, 3), "landmark_1": None}


def test_a_bad_row_does_not_shift_the_names_below_it() -> None:
    reading = read(MORPHOLOGIKA.format(n=1, rows="'#1\n1 2 x\n4 5 6\n"))
    assert sources(reading) == {"landmark_1": (4, 5, 6)}
    assert skipped(reading) == [(9, "'x' is not a number")]


def test_rows_that_are_missing_or_too_many_are_said() -> None:
    short = read(MORPHOLOGIKA.format(n=1, rows="'#1\n1 2 3\n"))
    assert short.notes == ("The file announces 2 landmarks and holds 1: was it cut off?",)
    long = read(MORPHOLOGIKA.format(n=1, rows="1 2 3\n" * 5))
    assert long.notes == ("3 lines behind the last were ignored.",)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[individuals]\n1\n[dimensions]\n2\n[rawpoints]\n1 2\n", "line 4: Its landmarks have 2"),
        ("[individuals]\nmany\n", "line 2: The number of individuals is 'many'"),
        ("[individuals]\n1\n[landmarks]\n-5\n", "line 4: The number of landmarks is '-5'"),
        ("[individuals]\n1\n[landmarks]\n0\n", "line 4: The number of landmarks is '0'"),
        ("[individuals]\n1\n[landmarks]\n2\n", "No landmark could be read"),
    ],
)
def test_what_is_not_three_dimensions_of_landmarks_is_refused(text: str, reason: str) -> None:
    with pytest.raises(FileFormatError, match=reason):
        read(text, ".txt")


def test_morphologika_gets_the_line_ends_it_wants(tmp_path: Path) -> None:
    path = tmp_path / "left femur.morphologika.txt"
    notes = write_landmarks(path, [Landmark("a", (1, 2, 3)), Landmark("b")], Side.SOURCE)
    assert notes == ("The format has no names for landmarks: only their order was kept.",)
    assert path.read_bytes().decode().split("\r\n") == [
        *["[individuals]", "1", "[landmarks]", "2", "[dimensions]", "3", "[names]", "left femur"],
        *["[rawpoints]", "'#1 left femur", "1.0 2.0 3.0", "NA NA NA", ""],
    ]


# TPS


def test_the_scale_multiplies_and_further_specimens_are_left_out() -> None:
    reading = read(
        "lm3=2\n1 2 3\n4 5 6\nCURVES=1\nPOINTS=2\n7 8 9\n7 8 9\nIMAGE=a.jpg\nID=femur\n"
        "SCALE=0.5\n\nLM3=2\n9 9 9\n9 9 9\nSCALE=7\n"
    )
    assert sources(reading) == {
        "landmark_0": (0.5, 1, 1.5),
        "landmark_1": (2, 2.5, 3),
        "curve_0_0": (3.5, 4, 4.5),
        "curve_0_1": (3.5, 4, 4.5),
    }
    assert [x.name for x in reading.single] == ["landmark_0", "landmark_1"]
    assert reading.skipped == ()
    assert reading.notes == (
        "2 specimens: the first was read (femur).",
        "The coordinates were multiplied by the scale 0.5.",
    )


def test_na_is_missing_in_any_case_and_half_of_it_is_an_error() -> None:
    reading = read("LM3=3\nNA NA NA\nna na na\nNA 1 2\nID=1\n")
    assert sources(reading) == {"landmark_0": None, "landmark_1": None}
    assert skipped(reading) == [(4, "'NA' is not a number")]


def test_a_scale_that_lifts_a_coordinate_beyond_numbers_skips_it() -> None:
    reading = read("LM3=2\n1e300 0 0\n1 2 3\nSCALE=1e300\n")
    assert reading.names == ("landmark_1",)
    assert "not finite" in reading.skipped[0].reason


def test_landmarks_that_were_lost_are_said() -> None:
    reading = read("LM3=3\n1 2 3\n")
    assert reading.notes == ("The file announces 3 landmarks and holds 1: was it cut off?",)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("LM=2\n1 2\n3 4\n", "line 1: Its landmarks have two dimensions"),
        ("LM3=1\n1 2 3\nSCALE=large\n", "line 3: The scale cannot be read: 'large'"),
        ("LM3=1\n1 2 3\nSCALE=?\n", "line 3: The scale cannot be read: '\\?' is not a number"),
        ("LM3=0\nID=1\n", "No landmark could be read"),
    ],
)
def test_what_tps_cannot_give_is_refused_with_its_line(text: str, reason: str) -> None:
    with pytest.raises(FileFormatError, match=reason):
        read(text, ".tps")


# MNI tag points


def test_points_of_one_volume_belong_to_the_side_that_was_asked_for() -> None:
    text = 'MNI Tag Point File\nVolumes = 1;\n% Volume 1: a.mnc\n\nPoints =\n 1 2 3 "a";\n'
    (landmark,) = read(text, side=Side.DESTINATION).landmarks
    assert landmark == Landmark("a", destination=(1, 2, 3))


def test_weights_and_labels_of_every_kind_are_read() -> None:
    rows = [
        "1 2 3",
        '1 2 3 0.5 1 2 "with weight"',
        "1 2 3 0 -1 -1 unquoted",
        r'1 2 3 "a \"real\" \\ one; % and more"',
        "1 2 3 bare;",
    ]
    reading = read("MNI Tag Point File\nVolumes = 1;\nPoints =\n" + "\n".join(rows))
    assert reading.names == (
        "landmark_0",
        "with weight",
        "unquoted",
        'a "real" \\ one; % and more',
        "bare",
    )
    assert reading.skipped == ()


@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ('1 2 3 "b"', "it needs 6 coordinates and has 3"),
        ('1 2 3 4 5 x "b"', "'x' is not a number"),
        ('1 2 3 4 5 inf "b"', "not a finite number"),
        ('1 2 3 4 5 6 "b', "quotes do not match"),
    ],
)
def test_a_bad_tag_point_is_skipped(row: str, reason: str) -> None:
    reading = read(f'MNI Tag Point File\nVolumes = 2;\nPoints =\n1 2 3 4 5 6 "a"\n{row}\n;\n')
    assert reading.names == ("a",)
    ((line, why),) = skipped(reading)
    assert line == 5
    assert reason in why


def test_lines_behind_the_last_point_are_skipped() -> None:
    reading = read("MNI Tag Point File\nVolumes = 1;\nPoints =\n1 2 3 a;\n4 5 6 b\n")
    assert reading.names == ("a",)
    assert skipped(reading) == [(5, "it stands behind the semicolon that ends the points")]


def test_more_than_two_volumes_are_refused() -> None:
    with pytest.raises(FileFormatError, match="line 2: The number of volumes is '3'"):
        read("MNI Tag Point File\nVolumes = 3;\nPoints =\n", ".tag")


PAIRS = [
    Landmark('say "a" \\ b', (0.1, 1 / 3, -0.0), (1e30, 5e-30, 4)),
    Landmark("Höcker; %", (1, 2, 3), (4, 5, 6)),
]


def test_vtk_reads_the_tag_points_we_write(tmp_path: Path) -> None:
    from vtkmodules.vtkIOMINC import vtkMNITagPointReader

    write_landmarks(tmp_path / "a.tag", PAIRS, None)
    reader = vtkMNITagPointReader()
    reader.SetFileName(str(tmp_path / "a.tag"))
    reader.Update()
    labels = reader.GetLabelText()
    assert reader.GetNumberOfVolumes() == 2
    for number, landmark in enumerate(PAIRS):
        assert labels.GetValue(number) == landmark.name
        # Its points are of single precision.
        for volume, position in enumerate((landmark.source, landmark.destination)):
            theirs = reader.GetPoints(volume).GetPoint(number)
            assert theirs == tuple(float(np.float32(value)) for value in position)


def test_we_read_the_tag_points_vtk_writes(tmp_path: Path) -> None:
    from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
    from vtkmodules.vtkIOMINC import vtkMNITagPointWriter

    writer, labels = vtkMNITagPointWriter(), vtkStringArray()
    for volume, side in enumerate(Side):
        points = vtkPoints()
        points.SetDataTypeToDouble()
        for landmark in PAIRS:
            points.InsertNextPoint(landmark.position(side))
        writer.SetPoints(volume, points)
    for landmark in PAIRS:
        labels.InsertNextValue(landmark.name)
    writer.SetLabelText(labels)
    writer.SetComments("Points: by hand\nPoints = 3")
    writer.SetFileName(str(tmp_path / "vtk.tag"))
    writer.Write()
    reading = read((tmp_path / "vtk.tag").read_bytes())
    assert reading.skipped == ()
    assert reading.names == tuple(landmark.name for landmark in PAIRS)
    for theirs, ours in zip(PAIRS, reading.landmarks, strict=True):
        # VTK writes fifteen digits.
        assert ours.source == pytest.approx(theirs.source, rel=1e-14)
        assert ours.destination == pytest.approx(theirs.destination, rel=1e-14)
