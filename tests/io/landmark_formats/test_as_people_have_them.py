"""Files as other programs and people write them: read right, or refused in words that help."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.io.landmark_files import read_landmarks, write_landmarks

from .reading import read, skipped, sources

A_B = {"a": (1, 2, 3), "b": (4, 5, 6)}
NAMELESS = {"landmark_0": (1, 2, 3), "landmark_1": (4, 5, 6)}


def markups(*points: object, **others: object) -> str:
    return json.dumps({"markups": [{"type": "Fiducial", "controlPoints": points, **others}]})


# Points that a program found by itself


def test_a_preview_is_a_place_in_both_formats_of_slicer() -> None:
    point = {"label": "Na", "position": [1.5, -2, 3], "positionStatus": "preview"}
    assert sources(read(markups(point))) == {"Na": (1.5, -2, 3)}
    fcsv = "# Markups fiducial file version = 4.11\n1,1.5,-2,3,0,0,0,1,1,1,0,Na,,,1,0\n"
    assert sources(read(fcsv)) == {"Na": (1.5, -2, 3)}


# Names that are there twice


SAME_NAMES = {
    ".csv": "name,x,y,z\nF,1,2,3\nF,4,5,6\nF_2,7,8,9\n",
    ".mrk.json": markups(
        *({"label": x, "position": [n, 2, 3]} for n, x in enumerate(("F", "F", "F_2")))
    ),
    ".fcsv": "# Markups fiducial file version = 4.11\n"
    + "".join(f"{n},{n},2,3,0,0,0,1,1,1,0,{x},,\n" for n, x in enumerate(("F", "F", "F_2"))),
    ".pp": "<PickedPoints>"
    + "".join(f'<point x="{n}" y="2" z="3" name="{x}"/>' for n, x in enumerate(("F", "F", "F_2")))
    + "</PickedPoints>",
    ".tag": 'MNI Tag Point File\nPoints =\n 1 2 3 "F"\n 4 5 6 "F"\n 7 8 9 "F_2";\n',
    ".txt": "F 1 2 3\nF 4 5 6\nF_2 7 8 9\n",
}


@pytest.mark.parametrize("suffix", SAME_NAMES)
def test_landmarks_of_one_name_are_all_kept_and_none_takes_a_name_that_is_there(
    suffix: str,
) -> None:
    reading = read(SAME_NAMES[suffix], suffix)
    assert reading.names == ("F", "F_3", "F_2")
    assert reading.skipped == ()
    assert reading.notes == ("2 landmarks are called 'F': numbers were put behind the name.",)


def test_a_row_without_a_name_never_takes_the_name_of_a_later_one() -> None:
    reading = read(',1,2,3\nlandmark_0,4,5,6\n"",7,8,9\n')
    assert reading.names == ("landmark_0_2", "landmark_0", "landmark_2")


# Tables by their header


@pytest.mark.parametrize(
    "text",
    [
        "name,z,y,x\na,3,2,1\nb,6,5,4\n",
        "id,name,x,y,z\n7,a,1,2,3\n8,b,4,5,6\n",
        ",name,x,y,z\n0,a,1,2,3\n1,b,4,5,6\n",
        "x,y,z,name\n1,2,3,a\n4,5,6,b\n",
        "name,type,x,y,z\na,Landmark,1,2,3\nb,Landmark,4,5,6\n",
        "label;X;Y;Z\na;1,0;2,0;3,0\nb;4,0;5,0;6,0\n",
        "Landmark\tpos_x\tpos_y\tpos_z\na\t1\t2\t3\nb\t4\t5\t6\n",
        "sep=;\nname;x;y;z\na;1;2;3\nb;4;5;6\n",
        "Landmarks of Ada\nname,x,y,z\na,1,2,3\nb,4,5,6\n",
        # R writes no name above the names of rows.
        '"x","y","z"\n"a",1,2,3\n"b",4,5,6\n',
        '"","x","y","z"\n"a",1,2,3\n"b",4,5,6\n',
        "name,error,x,y,z\na,0.5,1,2,3\nb,0.25,4,5,6\n",
        "#name,z,y,x\na,3,2,1\nb,6,5,4\n",
        "Point ID,X Coord,Y Coord,Z Coord\na,1,2,3\nb,4,5,6\n",
        "1,2,3,a\n4,5,6,b\n",
    ],
)
def test_columns_are_those_that_the_header_names(text: str) -> None:
    reading = read(text, ".csv")
    assert sources(reading) == A_B
    assert reading.doubts == ()


@pytest.mark.parametrize(
    "header",
    [
        "dest.x,dest.y,dest.z,source.x,source.y,source.z,name",
        "target_x,target_y,target_z,source_x,source_y,source_z,label",
        "fixed x,fixed y,fixed z,moving x,moving y,moving z,landmark",
    ],
)
def test_the_sides_of_pairs_are_those_that_the_header_names(header: str) -> None:
    reading = read(f"{header}\n4,5,6,1,2,3,a\n", ".csv")
    assert reading.landmarks == (Landmark("a", (1, 2, 3), (4, 5, 6)),)


def test_the_header_may_say_the_unit() -> None:
    assert read("name,x (mm),y (mm),z (mm)\na,1,2,3\n").unit == "mm"
    assert read("name,x_m,y_m,z_m\na,1,2,3\n").unit == "m"
    assert read("name,x [mm],y [cm],z [mm]\na,1,2,3\n").unit == ""


def test_further_columns_of_numbers_are_told() -> None:
    (note,) = read("name,x,y,z,x.1,y.1,z.1\na,1,2,3,4,5,6\n", ".csv").notes
    assert note == "3 further columns of numbers were passed over."


def test_a_column_of_types_sets_the_role() -> None:
    text = "name,type,x,y,z\na,landmark,1,2,3\nb,Passenger,4,5,6\nc,Semilandmark,7,8,9\n"
    reading = read(text, ".csv")
    assert [x.role for x in reading.landmarks] == [Role.PAIR, Role.PASSENGER, Role.PAIR]
    ((name, points, is_curve),) = [(x.name, x.points, x.is_curve) for x in reading.groups]
    assert (name, points, is_curve) == ("semilandmarks", ("c",), False)


def test_notes_locks_and_switches_have_columns_of_their_own() -> None:
    reading = read("name,x,y,z,note,locked,enabled\na,1,2,3,worn,1,0\nb,4,5,6,,,\n")
    assert reading.landmarks == (
        Landmark("a", (1, 2, 3), note="worn", locked=True, enabled=False),
        Landmark("b", (4, 5, 6)),
    )


# What is no file of landmarks


@pytest.mark.parametrize(
    ("text", "doubt"),
    [
        ("roll,pitch,yaw,speed\n1,2,3,4\n", "not x, y and z"),
        ("PC1,PC2,PC3,PC4\n1,2,3,4\n", "not x, y and z"),
        ("time,x,y,z\n0.1,1,2,3\n0.2,1,2,3\n", "column 'time'"),
        ("timestamp,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n0.1,1,2,3,4,5,6\n", "'timestamp'"),
        ("t,a_x,a_y,a_z,g_x,g_y,g_z,m_x,m_y,m_z\n1,2,3,4,5,6,7,8,9,10\n", "column 't'"),
        ("fem01,1,2,3,4,5,6,7,8,9\n", "one row per specimen"),
        ("1.5,2,3,4,5,6\n" * 501, "501 rows of six numbers"),
    ],
)
def test_what_may_be_no_landmarks_is_doubted(text: str, doubt: str) -> None:
    (first, *_) = read(text, ".csv").doubts
    assert doubt in first


@pytest.mark.parametrize(
    ("content", "name", "words"),
    [
        (b"\0" * 128 + b"DICM" + b"\1" * 99, "a", "a DICOM image.*segment"),
        (b"\0" * 344 + b"n+1\0", "a.csv", "a NIfTI volume.*segment"),
        (b"\x1f\x8b" + b"\0" * 99, "a.nii.gz", "a NIfTI volume"),
        (b"\x1f\x8b" + b"\0" * 99, "a.gz", "packed file. Unpack"),
        (b"NRRD0004\n", "a", "an NRRD volume"),
        (b"PK\3\4" + b"\0" * 50, "a.xlsx", "a spreadsheet.*CSV"),
        (b"\1\2\0\3", "a.ckpt", "a Stratovan Checkpoint file.*.pts, NTS"),
        (b"\1\2\0\3", "a.vb4", "a Viewbox file.*as text"),
        (b"solid femur\nfacet normal 0 0 1\n", "a.txt", "a mesh .*stl.*Open it as"),
        (b"# Blender\nv 1 2 3\nv 1 2 4\nv 1 3 3\nf 1 2 3\n", "a.txt", "a mesh .*obj.*Open it as"),
        (b"ply\nformat ascii 1.0\n", "a.txt", "a mesh .*ply"),
        (b'{"version": 1, "groups": []}', "a.json", "JSON, but.*CSV"),
        (b"PathFileType\t4\t(X/Y/Z)\n", "a.trc", "markers over time"),
        (b"name,status,pairs\na,done,16\n", "a.csv", "columns are not x, y and z"),
        (b"<!DOCTYPE html><html>404</html>", "a.csv", "a web page"),
    ],
)
def test_what_is_not_read_is_named_with_the_way_out(
    tmp_path: Path, content: bytes, name: str, words: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(FileFormatError, match=words):
        read_landmarks(tmp_path / name, Side.SOURCE)


def test_a_volume_too_large_for_landmarks_is_named_all_the_same(tmp_path: Path) -> None:
    path = tmp_path / "brain.nii"
    with path.open("wb") as file:
        file.write(b"\0" * 344 + b"n+1\0")
        file.truncate(9 << 20)
    with pytest.raises(FileFormatError, match="a NIfTI volume"):
        read_landmarks(path, Side.SOURCE)


# Tables between blanks


@pytest.mark.parametrize(
    "text",
    [
        "a 1.0 2.0 3.0\nb 4.0 5.0 6.0\n",
        "a\t1 2 3\nb  4   5\t6\n",
        "2\na 1 2 3\nb 4 5 6\n",
        "2\nmade by a program\na 1 2 3\nb 4 5 6\n",
        "# name x y z\na 1 2 3\nb 4 5 6\n",
        "# name z y x\na 3 2 1\nb 6 5 4\n",
        'Landmarks-1.0\n2\n"a"\n1 2 3 1 1\n"b"\n4 5 6 1 1\n',
        "name x y z\na 1 2 3\nb 4 5 6\n",
        "1 2 3 a\n4 5 6 b\n",
        '"x" "y" "z"\n"a" 1 2 3\n"b" 4 5 6\n',
        "a 1,0 2,0 3,0\nb 4,0 5,0 6,0\n",
    ],
)
def test_a_table_between_blanks_is_read_however_it_is_written(text: str) -> None:
    reading = read(text, ".txt")
    assert reading.format == "Table between blanks"
    assert sources(reading) == A_B


@pytest.mark.parametrize(
    "text",
    [
        "1.0 2.0 3.0\n4.0 5.0 6.0\n",
        "2\n1 2 3\n4 5 6\n",
        "x y z\n1 2 3\n4 5 6\n",
        "1 2 3 0.5\n4 5 6 0.25\n",
        "1 2 3 0.6 0.8 0\n4 5 6 0 0 1\n",
    ],
)
@pytest.mark.parametrize("suffix", [".txt", ".xyz", ".particles"])
def test_places_between_blanks_need_no_names(text: str, suffix: str) -> None:
    assert sources(read(text, suffix)) == NAMELESS


def test_colours_behind_places_are_no_destinations() -> None:
    reading = read("1.5 2 3 255 128 0\n4 5 6 0 0 1\n", ".xyz")
    assert sources(reading) == {"landmark_0": (1.5, 2, 3), "landmark_1": (4, 5, 6)}
    assert not reading.is_pairs
    assert "passed over" in reading.notes[0]


def test_a_name_between_blanks_may_have_several_words_or_be_a_number() -> None:
    assert read("left  tragus 1 2 3\nnasion 4 5 6\n").names == ("left tragus", "nasion")
    assert read("1 1.5 2 3\n2 4 5 6\n", ".txt").names == ("1", "2")


def test_a_count_that_is_too_large_is_told() -> None:
    (note,) = read("3\n1 2 3\n4 5 6\n", ".xyz").notes
    assert "announces 3 landmarks and holds 2" in note


# 3D Slicer


@pytest.mark.parametrize(("axes", "frame"), [("r,a,s", "RAS"), ("l,p,s", "LPS")])
def test_slicers_table_says_frame_unit_and_what_is_not_defined(axes: str, frame: str) -> None:
    reading = read(
        f"label,{axes},defined,selected,visible,locked,description\n"
        "nasion,1,2,3,1,0,1,1,worn\nbregma,0,0,0,0,1,1,0,\n",
        ".csv",
    )
    assert reading.landmarks == (
        Landmark("nasion", (1, 2, 3), note="worn", locked=True, enabled=False),
        Landmark("bregma"),
    )
    assert (reading.format, reading.frame, reading.unit) == (
        "3D Slicer control-point table",
        frame,
        "mm",
    )


@pytest.mark.parametrize("suffix", [".fcsv", ".mrk.json", ".slicer.csv"])
def test_description_locked_and_selected_come_and_go(tmp_path: Path, suffix: str) -> None:
    marks = (
        Landmark("a", (1, 2, 3), note="worn, left", locked=True, enabled=False),
        Landmark("b", (4, 5, 6)),
    )
    path = tmp_path / f"a{suffix}"
    assert write_landmarks(path, marks, Side.SOURCE) == ()
    assert read_landmarks(path, Side.SOURCE).landmarks == marks


def test_a_first_list_that_is_empty_hides_no_other() -> None:
    root = {
        "markups": [
            {"controlPoints": []},
            {"controlPoints": [{"label": "A", "position": [1, 2, 3]}]},
        ]
    }
    assert sources(read(json.dumps(root))) == {"A": (1, 2, 3)}


def test_values_may_stand_in_lists_of_one_as_r_writes_them() -> None:
    point = {"label": ["A"], "position": [[1], [2], [3]], "positionStatus": ["defined"]}
    other = {"label": ["B"], "position": [4, 5, 6], "locked": [True], "description": ["worn"]}
    root = {
        "markups": [
            {
                "type": ["Fiducial"],
                "coordinateSystem": ["RAS"],
                "coordinateUnits": ["m"],
                "controlPoints": [point, other],
            }
        ]
    }
    reading = read(json.dumps(root))
    assert reading.landmarks == (
        Landmark("A", (1, 2, 3)),
        Landmark("B", (4, 5, 6), locked=True, note="worn"),
    )
    assert (reading.frame, reading.unit) == ("RAS", "m")


@pytest.mark.parametrize(
    "head",
    [
        "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\ncolumns = {}\n",
        "Markups fiducial file version = 4.11\nCoordinateSystem = 1\ncolumns = {}\n",
        "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n{}\n",
    ],
)
def test_header_lines_of_fcsv_may_have_lost_their_sign(head: str) -> None:
    columns = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID"
    reading = read(head.format(columns) + "1,1,2,3,0,0,0,1,1,1,0,nasion,,\n", ".fcsv")
    assert sources(reading) == {"nasion": (1, 2, 3)}
    assert (reading.frame, skipped(reading)) == ("LPS", [])


# TPS


def test_a_scale_without_a_value_scales_nothing() -> None:
    reading = read("LM3=1\n1 2 3\nID=a\nSCALE=\n")
    assert sources(reading) == {"landmark_0": (1, 2, 3)}
    assert reading.notes == ("SCALE= has no value: the coordinates were taken as they are.",)


def test_a_file_of_nothing_but_curves_is_read_as_curves() -> None:
    reading = read("LM3=0\nCURVES=1\nPOINTS3=2\n1 2 3\n4 5 6\nID=fem\n")
    assert reading.names == ("curve_0_0", "curve_0_1")
    assert [group.points for group in reading.groups] == [("curve_0_0", "curve_0_1")]


# NTS


@pytest.mark.parametrize(
    "text",
    [
        '"fem01\n1 2 3 0 DIM=3\n1 2 3\n4 5 6\n',
        "1 2 3 0 dim=3\n1 2 3 4 5 6\n",
        "'fem01\n1 1 6 0 DIM=3\n1 2 3 4 5 6\n",
        "1 1L 6 1 9999 DIM=3\nfem01.ply\n\n1 2 3\n4 5 6\n",
        "1 1L 6 0 DIM=3\n17\n1 2 3 4 5 6\n",
        "1 1B 6 0 DIM=3\nfem01 1 2 3 4 5 6\n",
        "1 1E 6 0 DIM=3\n1 2 3 4 5 6 fem01\n",
        "1 1L 6L 0 DIM=3\nfem01\n1x 1y 1z 2x\n2y 2z\n1 2 3 4 5 6\n",
    ],
)
def test_nts_is_read_however_it_is_written(text: str) -> None:
    reading = read(text, ".nts")
    assert reading.format == "NTS"
    assert [x.source for x in reading.landmarks] == [(1, 2, 3), (4, 5, 6)]


@pytest.mark.parametrize(
    ("header", "missing"), [("1 9999", "9999.0"), ("1 -999", "-999"), ("0", "NA"), ("1 NA", "NA")]
)
def test_the_code_for_what_is_missing_stands_in_the_first_line(header: str, missing: str) -> None:
    text = f"1 1L 9 {header} DIM=3\nfemur\n1 2 3 {missing} {missing} {missing} 7 {missing} 9\n"
    reading = read(text, ".dta")
    assert sources(reading) == {"landmark_0": (1, 2, 3), "landmark_1": None}
    assert skipped(reading) == [(3, "one of its coordinates is missing")]


def test_nts_in_two_dimensions_or_cut_off_is_told() -> None:
    with pytest.raises(FileFormatError, match="line 1: Its landmarks are not in three"):
        read("1 1 4 0 DIM=2\n1 2 3 4\n", ".nts")
    (note,) = read("1 1 9 0 DIM=3\n1 2 3 4 5 6\n", ".nts").notes
    assert "announces 3 landmarks and holds 2" in note


# Amira


ONE_SET = """# AmiraMesh 3D ASCII 2.0

define Markers 2

Parameters {
    NumSets 1,
    ContentType "LandmarkSet"
}
Markers { float[3] Coordinates } @1

# Data section follows
@1
1.000000000000000e+00 2 3 \n4 5 6 \n
"""


def test_landmark_sets_of_amira_are_one_side_or_pairs() -> None:
    assert sources(read(ONE_SET)) == NAMELESS
    two = ONE_SET.replace("NumSets 1", "NumSets 2").replace(
        "} @1\n", "} @1\nMarkers { float[3] Coordinates2 } @2\n"
    )
    reading = read(two.replace("AmiraMesh", "Avizo") + "@2\n7 8 9\n10 11 12\n")
    assert reading.is_pairs
    assert reading.landmarks[1] == Landmark("landmark_1", (4, 5, 6), (10, 11, 12))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("ASCII", "BINARY-LITTLE-ENDIAN", "binary.*ASCII"),
        ("float[3]", "float[2]", "two dimensions"),
        ("Coordinates }", "Coordinates3 }", "more than two sets"),
        (
            'define Markers 2\n\nParameters {\n    NumSets 1,\n    ContentType "LandmarkSet"',
            "",
            "something else",
        ),
    ],
)
def test_what_amira_holds_else_is_refused_in_words(old: str, new: str, words: str) -> None:
    with pytest.raises(FileFormatError, match=words):
        read(ONE_SET.replace(old, new))


def test_a_landmark_set_that_is_cut_off_is_told() -> None:
    (note,) = read(ONE_SET.replace("4 5 6", "")).notes
    assert "announces 2 landmarks and holds 1" in note


# BigWarp


@pytest.mark.parametrize(
    "text",
    [
        '"Pt-0","true","1","2","3","4"\n',
        '"Pt-0","true","17","1","2","3","4"\n',
        '{"numDimensions": 2, "movingPoints": [[1, 2]], "fixedPoints": [[3, 4]]}',
    ],
)
def test_landmarks_of_bigwarp_in_two_dimensions_are_named(text: str) -> None:
    with pytest.raises(FileFormatError, match=r"of BigWarp have two dimensions\. Three are needed"):
        read(text)


def test_bigwarps_json_is_read_alone_and_within_a_project() -> None:
    landmarks = {
        "type": "BigWarpLandmarks",
        "numDimensions": 3,
        "movingPoints": [[1, 2, 3], [4, 5, 6]],
        "fixedPoints": [[7, 8, 9], ["Infinity"] * 3],
        "active": [False, False],
        "names": ["a", "b"],
    }
    expected = (
        Landmark("a", (1, 2, 3), (7, 8, 9), enabled=False),
        Landmark("b", (4, 5, 6)),
    )
    project = {"Sources": {}, "Transform": {"type": "Thin Plate Spline", "landmarks": landmarks}}
    for root in (landmarks, project):
        assert read(json.dumps(root)).landmarks == expected


# Several specimens


SEVERAL = {
    "TPS": "LM3=1\n1 2 3\nID=fem01\nLM3=1\n4 5 6\nID=fem02\nSCALE=2\n",
    "Morphologika": "[individuals]\n2\n[landmarks]\n1\n[names]\nfem01\nfem02\n[rawpoints]\n"
    "'#1\n1 2 3\n'#2\n8 10 12\n",
    "NTS": "1 2L 6 0 DIM=3\nfem01\nfem02\n1 2 3 1 2 3\n8 10 12 8 10 12\n",
    "Table of specimens (MorphoJ)": "Id,x1,y1,z1,x2,y2,z2,x3,y3,z3\n"
    "fem01,1,2,3,4,5,6,7,8,9\nfem02,8,10,12,4,5,6,7,8,9\n",
}


@pytest.mark.parametrize("which", ["fem02", "FEM02", "2"])
@pytest.mark.parametrize("name", SEVERAL)
def test_one_of_several_specimens_is_named_behind_the_file(
    tmp_path: Path, name: str, which: str
) -> None:
    path = tmp_path / "a.any"
    path.write_text(SEVERAL[name])
    reading = read_landmarks(path, Side.SOURCE)
    assert (reading.format, reading.specimens) == (name, ("fem01", "fem02"))
    assert (reading.specimen, reading.landmarks[0].source) == ("fem01", (1, 2, 3))
    assert reading.notes[0] == "2 specimens: the first was read (fem01)."
    other = read_landmarks(f"{path}#{which}", Side.SOURCE)
    assert (other.specimen, other.landmarks[0].source) == ("fem02", (8, 10, 12))
    assert not any("specimens" in note for note in other.notes)


def test_a_specimen_that_is_not_there_is_told_with_those_that_are(tmp_path: Path) -> None:
    path = tmp_path / "a.tps"
    path.write_text(SEVERAL["TPS"])
    with pytest.raises(FileFormatError, match=r"no specimen 'x' in it.*from 1 to 2: fem01"):
        read_landmarks(f"{path}#x", Side.SOURCE)
    (tmp_path / "a.csv").write_text("a,1,2,3\n")
    with pytest.raises(FileFormatError, match="holds one specimen: leave out '#2'"):
        read_landmarks(f"{tmp_path}/a.csv#2", Side.SOURCE)


def test_a_sign_in_the_name_of_a_file_is_part_of_the_name(tmp_path: Path) -> None:
    path = tmp_path / "a.csv#2"
    path.write_text("a,1,2,3\n")
    assert read_landmarks(path, Side.SOURCE).names == ("a",)


@pytest.mark.parametrize(
    ("header", "names"),
    [
        ("Id,x1,y1,z1,x2,y2,z2,x3,y3,z3", ("landmark_0", "landmark_1", "landmark_2")),
        ("Id,LM1x,LM1y,LM1z,LM2x,LM2y,LM2z,LM3x,LM3y,LM3z", ("LM1", "LM2", "LM3")),
        (
            "Sample_name,LM 1_X,LM 1_Y,LM 1_Z,LM 2_X,LM 2_Y,LM 2_Z,u_x,u_y,u_z",
            ("LM 1", "LM 2", "u"),
        ),
        (",1.X,1.Y,1.Z,2.X,2.Y,2.Z,3.X,3.Y,3.Z", ("1", "2", "3")),
        ("specimen,nasion x,nasion y,nasion z,b x,b y,b z,c x,c y,c z", ("nasion", "b", "c")),
    ],
)
def test_a_row_for_each_specimen_is_known_by_its_columns(
    header: str, names: tuple[str, ...]
) -> None:
    reading = read(f"{header}\nfem01,1,2,3,NA,NA,NA,7,8,9\n", ".csv")
    assert reading.names == names
    assert [x.source for x in reading.landmarks] == [(1, 2, 3), None, (7, 8, 9)]
    assert reading.specimens == ("fem01",)
