"""Landmarks from one program's format into another's."""

from __future__ import annotations

import pytest

from pinwarp.core.landmarks import Side
from pinwarp.io.landmark_files import read_landmarks
from pinwarp.session.keeping.files import read_session

RAS = (
    "# Markups fiducial file version = 4.11\n# CoordinateSystem = RAS\n"
    "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
    "1,1,2,3,0,0,0,1,1,1,0,nasion,,\n"
)


@pytest.fixture
def marks(tmp_path):
    path = tmp_path / "femur.csv"
    path.write_text("name,x,y,z\nfovea,1,2,3\nbad,1,2,nan\nnotch,4,5,6\n")
    return path


@pytest.fixture
def pairs(tmp_path):
    path = tmp_path / "pairs.csv"
    path.write_text("name,source.x,source.y,source.z,dest.x,dest.y,dest.z\nfovea,1,2,3,4,5,6\n")
    return path


@pytest.mark.parametrize("suffix", [".fcsv", ".mrk.json", ".pp", ".pts", ".tps", ".tag"])
def test_the_suffix_of_the_output_tells_the_format(pinwarp_command, marks, tmp_path, suffix):
    out = tmp_path / f"out{suffix}"
    outcome = pinwarp_command("convert", marks, out, "--unit", "mm", "--frame", "LPS")
    assert "2 landmarks, OpenSim Creator CSV to" in outcome.stdout
    reading = read_landmarks(out, Side.SOURCE)
    assert [x.source for x in reading.landmarks] == [(1.0, 2.0, 3.0), (4.0, 5.0, 6.0)]


def test_what_was_skipped_is_told_with_its_line(pinwarp_command, marks, tmp_path):
    outcome = pinwarp_command("convert", marks, tmp_path / "out.pp")
    assert "femur.csv: Line 3 was skipped: 'nan' is not a finite number." in outcome.stderr


def test_the_format_can_be_named_where_the_suffix_does_not_tell(pinwarp_command, marks, tmp_path):
    out = tmp_path / "out.dat"
    assert "'.dat' are not supported" in pinwarp_command("convert", marks, out, exit_code=2).stderr
    pinwarp_command("convert", marks, out, "--to", "pts")
    assert out.read_text().startswith("Version 1.0")
    outcome = pinwarp_command("convert", marks, tmp_path / "x.pp", "--to", "abc", exit_code=2)
    assert "Choose one of" in outcome.stderr


def test_pairs_into_a_format_of_one_side_need_the_side(pinwarp_command, pairs, tmp_path):
    out = tmp_path / "out.fcsv"
    outcome = pinwarp_command("convert", pairs, out, exit_code=2)
    assert "--side source or --side destination" in outcome.stderr
    pinwarp_command("convert", pairs, out, "--side", "destination", "--frame", "LPS")
    assert read_landmarks(out, Side.SOURCE).landmarks[0].source == (4.0, 5.0, 6.0)


def test_pairs_stay_pairs_where_the_format_holds_them(pinwarp_command, pairs, tmp_path):
    pinwarp_command("convert", pairs, tmp_path / "out.bigwarp.csv")
    reading = read_landmarks(tmp_path / "out.bigwarp.csv", Side.SOURCE)
    assert reading.is_pairs
    assert reading.landmarks[0].destination == (4.0, 5.0, 6.0)


def test_one_side_of_pairs_goes_into_a_file_of_one_side(pinwarp_command, pairs, tmp_path):
    pinwarp_command("convert", pairs, tmp_path / "out.csv", "--side", "source")
    assert not read_landmarks(tmp_path / "out.csv", Side.SOURCE).is_pairs


def test_a_session_gives_its_landmarks(pinwarp_command, study, tmp_path):
    session = study / "study.pinwarp.csv"
    pinwarp_command("convert", session, tmp_path / "all.csv")
    reading = read_landmarks(tmp_path / "all.csv", Side.SOURCE)
    expected = read_session(session).landmarks
    assert [(x.name, x.source, x.destination) for x in reading.landmarks] == [
        (x.name, x.source, x.destination) for x in expected
    ]


def test_ras_becomes_lps_where_the_format_says_lps(pinwarp_command, tmp_path):
    source = tmp_path / "ras.fcsv"
    source.write_text(RAS)
    outcome = pinwarp_command("convert", source, tmp_path / "lps.mrk.json")
    reading = read_landmarks(tmp_path / "lps.mrk.json", Side.SOURCE)
    assert (reading.frame, reading.landmarks[0].source) == ("LPS", (-1.0, -2.0, 3.0))
    assert "turned from RAS to LPS" in outcome.stderr
    outcome = pinwarp_command("convert", source, tmp_path / "plain.csv")
    assert read_landmarks(tmp_path / "plain.csv", Side.SOURCE).landmarks[0].source == (1, 2, 3)
    assert "are in RAS, and OpenSim Creator CSV cannot say so" in outcome.stderr


def test_metres_become_slicers_millimetres_where_the_unit_is_told(pinwarp_command, marks, tmp_path):
    out, told = tmp_path / "a.fcsv", ("--unit", "m", "--frame", "LPS")
    pinwarp_command("convert", marks, out, *told)
    assert read_landmarks(out, Side.SOURCE).landmarks[0].source == (1e3, 2e3, 3e3)
    told = ("--unit", "feet", "--frame", "LPS")
    outcome = pinwarp_command("convert", marks, tmp_path / "b.fcsv", *told, exit_code=2)
    assert "Choose mm, cm or m" in outcome.stderr


@pytest.mark.parametrize("suffix", [".fcsv", ".mrk.json", ".slicer.csv"])
def test_neither_unit_nor_frame_is_guessed(pinwarp_command, tmp_path, suffix):
    femur, out = tmp_path / "femur.csv", tmp_path / f"out{suffix}"
    femur.write_text("name,x,y,z\nfovea,0.1,0.2,0.3\nnotch,0.1,0.2,-0.1\n")
    outcome = pinwarp_command("convert", femur, out, exit_code=2)
    assert "femur.csv does not say its unit (--unit mm, cm or m; " in outcome.stderr
    assert "nor its frame (--frame LPS keeps the numbers" in outcome.stderr
    assert not out.exists()
    pinwarp_command("convert", femur, out, "--unit", "m", "--frame", "ras")
    reading = read_landmarks(out, Side.SOURCE)
    assert (reading.frame, reading.unit) == ("LPS", "mm")
    assert reading.landmarks[0].source == (-100, -200, 300)


def test_numbers_that_are_no_metres_are_taken_for_millimetres(pinwarp_command, tmp_path):
    femur, out = tmp_path / "femur.csv", tmp_path / "out.fcsv"
    femur.write_text("name,x,y,z\nfovea,100,200,300\nnotch,100,200,-100\n")
    outcome = pinwarp_command("convert", femur, out, "--frame", "LPS")
    assert "taken for millimetres" in outcome.stderr
    assert read_landmarks(out, Side.SOURCE).landmarks[0].source == (100, 200, 300)


def test_what_a_file_says_itself_cannot_be_said_otherwise(pinwarp_command, tmp_path):
    source, out = tmp_path / "ras.fcsv", tmp_path / "out.csv"
    source.write_text(RAS)
    outcome = pinwarp_command("convert", source, out, "--frame", "LPS", exit_code=2)
    assert "says that its frame is RAS: leave out --frame LPS" in outcome.stderr
    outcome = pinwarp_command("convert", source, out, "--unit", "m", exit_code=2)
    assert "says that its unit is mm: leave out --unit m" in outcome.stderr
    outcome = pinwarp_command("convert", source, out, "--frame", "XYZ", exit_code=2)
    assert "choose LPS or RAS" in outcome.stderr


def test_a_session_goes_to_slicer_as_its_mesh_would(pinwarp_command, study, tmp_path):
    out = tmp_path / "out.fcsv"
    session = study / "study.pinwarp.csv"
    outcome = pinwarp_command("convert", session, out, "--side", "source")
    assert "said to be in LPS, which 3D Slicer takes a mesh without a frame" in outcome.stderr


def test_what_may_be_no_landmarks_is_asked_about_before(pinwarp_command, tmp_path):
    log, out = tmp_path / "imu.csv", tmp_path / "out.pp"
    log.write_text("time,ax,ay,az,gx,gy,gz\n0.1,1,2,3,4,5,6\n")
    outcome = pinwarp_command("convert", log, out, exit_code=2)
    assert "imu.csv: Are these landmarks?" in outcome.stderr
    assert "column 'time'" in outcome.stderr
    assert not out.exists()
    outcome = pinwarp_command("convert", log, out, "--side", "source", "--force")
    assert "column 'time'" in outcome.stderr


def test_names_alone_are_no_file_of_positions(pinwarp_command, tmp_path):
    template, out = tmp_path / "names.pts", tmp_path / "out.csv"
    template.write_text("Version 1.0\n1\nS000 9999 9999 9999\n")
    outcome = pinwarp_command("convert", template, out, exit_code=2)
    assert "No landmark of names.pts has a position" in outcome.stderr
    pinwarp_command("convert", template, tmp_path / "out.tps")


def test_one_specimen_of_several_is_converted_or_each(pinwarp_command, tmp_path):
    source = tmp_path / "skulls.tps"
    source.write_text("LM3=1\n1 2 3\nID=fem01\nLM3=1\n4 5 6\nID=fem02\n")
    outcome = pinwarp_command("convert", source, tmp_path / "out.pp")
    assert "2 specimens: the first was read (fem01)." in outcome.stderr
    assert "skulls.tps#NAME takes another, skulls.tps#all each." in outcome.stderr
    pinwarp_command("convert", f"{source}#fem02", tmp_path / "two.pp")
    assert read_landmarks(tmp_path / "two.pp", Side.SOURCE).landmarks[0].source == (4, 5, 6)
    outcome = pinwarp_command(
        "convert", f"{source}#all", tmp_path / "all.mrk.json", "--unit", "mm", "--frame", "LPS"
    )
    for name, place in (("fem01", (1, 2, 3)), ("fem02", (4, 5, 6))):
        path = tmp_path / f"all_{name}.mrk.json"
        assert str(path) in outcome.stdout
        assert read_landmarks(path, Side.SOURCE).landmarks[0].source == place
    outcome = pinwarp_command("convert", f"{source}#x", tmp_path / "x.pp", exit_code=2)
    assert "no specimen 'x'" in outcome.stderr


def test_specimens_whose_names_differ_by_case_alone_do_not_share_a_file(pinwarp_command, tmp_path):
    source = tmp_path / "skulls.tps"
    source.write_text("LM3=1\n1 2 3\nID=fem01\nLM3=1\n4 5 6\nID=FEM01\n")
    outcome = pinwarp_command("convert", f"{source}#all", tmp_path / "all.pp", exit_code=2)
    assert "would be written to one file" in outcome.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["skulls.tps"]


def test_an_output_that_is_there_is_replaced_only_by_force(pinwarp_command, marks, tmp_path):
    out = tmp_path / "out.pp"
    out.write_text("precious")
    assert "use --force" in pinwarp_command("convert", marks, out, exit_code=2).stderr
    assert out.read_text() == "precious"
    pinwarp_command("convert", marks, out, "--force")
    before = marks.read_text()
    pinwarp_command("convert", marks, marks, "--force", exit_code=2)
    assert marks.read_text() == before
