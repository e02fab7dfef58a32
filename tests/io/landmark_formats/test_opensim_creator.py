from __future__ import annotations

import csv
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinwarp.core.errors import FileFormatError, PinwarpError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.landmark_files import (
    LandmarkReading,
    read_landmarks,
    write_landmarks,
)
from tests.io import strategies


def read(folder: Path, content: str | bytes, side: Side = Side.SOURCE) -> LandmarkReading:
    path = folder / "a.landmarks.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_landmarks(path, side)


def placed(reading: LandmarkReading) -> dict[str, tuple[float, ...] | None]:
    return {landmark.name: landmark.source for landmark in reading.landmarks}


A_B = {"a": (1.0, 2.0, 3.0), "b": (-4.5, 0.05, 600.0)}


@pytest.mark.parametrize(
    "content",
    [
        "name,x,y,z\na,1,2,3\nb,-4.5,.05,6e2\n",
        "Name,X,Y,Z\r\na,1,2,3\r\nb,-4.5,5e-2,600\r\n",
        "NAME,X,Y,Z\ra,1,2,3\rb,-4.5,0.05,600",
        "\ufeffname,x,y,z\na,1,2,3\nb,-4.5,0.05,600\n",
        "a,1,2,3\nb,-4.5,0.05,600\n",
        "name;x;y;z\na;1;2;3\nb;-4.5;0.05;600\n",
        "name;x;y;z\na;1,0;2,0;3,0\nb;-4,5;0,05;6e2\n",
        "a;1,0;2,0;3,0\nb;-4,5;0,05;600\n",
        "name\tx\ty\tz\na\t1\t2\t3\nb\t-4.5\t0.05\t600\n",
        '"name","x","y","z"\n"a","1","2","3"\n"b","-4.5","0.05","600"\n',
        "# made by hand\nname,x,y,z\n\na,1,2,3\n   \n# between, the, rows\n,,,\nb,-4.5,0.05,600\n",
        "name,x,y,z,colour,size\na,1,2,3,red,5\nb,-4.5,0.05,600,,\n",
        "name , x, y, z\n a , 1, 2, 3\n b, -4.5, 0.05, 600\n",
        "name,x,y,z,,\na,1,2,3,,\nb,-4.5,0.05,600,,\n",
    ],
)
def test_a_file_of_one_side_is_read_however_it_is_written(tmp_path: Path, content: str) -> None:
    reading = read(tmp_path, content)
    assert placed(reading) == A_B
    assert not reading.is_pairs
    assert reading.skipped == ()


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
def test_umlauts_are_read_in_every_encoding_a_spreadsheet_uses(
    tmp_path: Path, encoding: str
) -> None:
    reading = read(tmp_path, "name,x,y,z\nHöcker,1,2,3\n".encode(encoding))
    assert [landmark.name for landmark in reading.landmarks] == ["Höcker"]


def test_the_position_is_put_on_the_side_that_was_asked_for(tmp_path: Path) -> None:
    (landmark,) = read(tmp_path, "a,1,2,3\n", Side.DESTINATION).landmarks
    assert landmark == Landmark("a", destination=(1, 2, 3))


def test_nameless_rows_are_named_by_their_row_so_that_a_bad_one_shifts_nothing(
    tmp_path: Path,
) -> None:
    reading = read(tmp_path, "x,y,z\n1,2,3\n1,oops,3\n4,5,6\n")
    assert placed(reading) == {"landmark_0": (1, 2, 3), "landmark_2": (4, 5, 6)}
    assert [line.line for line in reading.skipped] == [3]


def test_four_columns_have_the_name_first_even_if_it_is_a_number(tmp_path: Path) -> None:
    assert placed(read(tmp_path, "1,2,3,4\n5,6,7,8\n")) == {"1": (2, 3, 4), "5": (6, 7, 8)}


@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ("c,1,2", "three coordinates"),
        ("c,1,2,", "three coordinates"),
        ("c,1,,3", "a number is missing"),
        ("c,1,2,x", "'x' is not a number"),
        ("c,1,2,nan", "'nan' is not a finite number"),
        ("c,-inf,2,3", "not a finite number"),
        ("c,1e999,2,3", "not a finite number"),
        ("c,1_000,2,3", "not a number"),
        ("c,0x10,2,3", "not a number"),
        ("c,\u0661,2,3", "not a number"),
        ("c", "three coordinates"),
        ('"c,1,2,3', "quotes do not match"),
        ('"c"d,1,2,3', "quotes do not match"),
        ("#c,1,2,3", "which makes it a comment"),
    ],
)
def test_a_bad_row_is_skipped_and_its_line_is_named(tmp_path: Path, row: str, reason: str) -> None:
    reading = read(tmp_path, f"name,x,y,z\na,1,2,3\n\n{row}\nb,-4.5,0.05,600\n")
    assert placed(reading) == A_B
    ((line, text, why),) = [(s.line, s.text, s.reason) for s in reading.skipped]
    assert (line, text) == (4, row)
    assert reason in why


def test_thousands_and_decimal_points_in_one_number_are_not_guessed_at(tmp_path: Path) -> None:
    reading = read(tmp_path, "name;x;y;z\na;1;2;3\nb;1.234,5;0;0\n")
    assert [line.line for line in reading.skipped] == [3]


def test_decimal_commas_between_commas_are_not_guessed_at(tmp_path: Path) -> None:
    reading = read(tmp_path, 'name,x,y,z\na,1,2,3\nb,"1,5",0,0\n')
    assert [line.line for line in reading.skipped] == [3]


@pytest.mark.parametrize(
    "content",
    [
        "name,source.x,source.y,source.z,dest.x,dest.y,dest.z\na,1,2,3,4,5,6\nb,1,1,1,,,\nc,,,,2,2,2\n",
        "Name;Source.X;Source.Y;Source.Z;Dest.X;Dest.Y;Dest.Z\na;1;2;3;4;5;6\nb;1;1;1\nc;;;;2;2;2\n",
        "a,1,2,3,4,5,6\nb,1,1,1,,,\nc,,,,2,2,2\n",
    ],
)
def test_pairs_are_read_and_half_filled_ones_keep_their_side(tmp_path: Path, content: str) -> None:
    reading = read(tmp_path, content)
    assert reading.is_pairs
    assert reading.skipped == ()
    assert reading.landmarks == (
        Landmark("a", (1, 2, 3), (4, 5, 6)),
        Landmark("b", (1, 1, 1), None),
        Landmark("c", None, (2, 2, 2)),
    )


def test_six_numbers_without_a_header_are_nameless_pairs(tmp_path: Path) -> None:
    reading = read(tmp_path, "1,2,3,4,5,6\n7,8,9,10,11,12\n")
    assert reading.is_pairs
    assert reading.landmarks[1] == Landmark("landmark_1", (7, 8, 9), (10, 11, 12))


def test_half_a_position_in_a_pair_is_skipped_with_its_line(tmp_path: Path) -> None:
    header = "name,source.x,source.y,source.z,dest.x,dest.y,dest.z\n"
    reading = read(tmp_path, header + "a,1,2,3,4,5,6\nb,1,2,3,4,,\n")
    assert [landmark.name for landmark in reading.landmarks] == ["a"]
    assert [(s.line, s.reason) for s in reading.skipped] == [(3, "a number is missing")]


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "empty"),
        (b"name,x,y,z\n", "No landmark"),
        (b"name,x,y,z\na,1,2,oops\n", r"No landmark could be read \(line 2: 'oops'"),
        (bytes(range(256)), "not a text file"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "a PNG image"),
        (b"<html><body>404</body></html>", "a web page"),
        (b"\xff\xfe\0", "text file|No landmark"),
        (b'"' * 301, "No landmark"),
        (b"a" * 200_000, "No landmark"),
    ],
)
def test_a_file_without_landmarks_is_refused_with_its_name(
    tmp_path: Path, content: bytes, reason: str
) -> None:
    with pytest.raises(FileFormatError, match=reason) as caught:
        read(tmp_path, content)
    assert "a.landmarks.csv" in str(caught.value)


def test_a_missing_a_huge_file_and_a_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="no such file"):
        read_landmarks(tmp_path / "no.csv", Side.SOURCE)
    with pytest.raises(FileFormatError, match="is a folder"):
        read_landmarks(tmp_path, Side.SOURCE)
    with (tmp_path / "huge.csv").open("wb") as file:
        file.truncate((64 << 20) + 1)
    with pytest.raises(FileFormatError, match="too large"):
        read_landmarks(tmp_path / "huge.csv", Side.SOURCE)


@given(landmarks=strategies.landmark_lists(strategies.trimmed_names))
@pytest.mark.parametrize("side", list(Side))
def test_one_side_comes_back_exactly(
    tmp_path_factory: pytest.TempPathFactory, side: Side, landmarks: list[Landmark]
) -> None:
    path = tmp_path_factory.getbasetemp() / "side.csv"
    write_landmarks(path, landmarks, side)
    expected = [(mark.name, repr(mark.position(side))) for mark in landmarks if mark.position(side)]
    if not expected:
        return
    reading = read_landmarks(path, side)
    assert reading.skipped == ()
    assert [(mark.name, repr(mark.position(side))) for mark in reading.landmarks] == expected


@given(landmarks=strategies.landmark_lists(strategies.trimmed_names))
def test_pairs_come_back_exactly(
    tmp_path_factory: pytest.TempPathFactory, landmarks: list[Landmark]
) -> None:
    if not landmarks:
        return
    path = tmp_path_factory.getbasetemp() / "pairs.csv"
    write_landmarks(path, landmarks, None)
    reading = read_landmarks(path, Side.SOURCE)
    assert reading.is_pairs
    assert reading.skipped == ()
    assert [(m.name, repr(m.source), repr(m.destination)) for m in reading.landmarks] == [
        (m.name, repr(m.source), repr(m.destination)) for m in landmarks
    ]


def test_a_name_that_is_a_formula_is_not_one_in_the_file(tmp_path: Path) -> None:
    write_landmarks(tmp_path / "a.csv", [Landmark("=cmd|' /C calc'!A0", (1, 2, 3))], Side.SOURCE)
    with (tmp_path / "a.csv").open(newline="") as file:
        cell = list(csv.reader(file))[1][0]
    assert cell == "'=cmd|' /C calc'!A0"


@settings(max_examples=200)
@given(random=st.randoms(use_true_random=False))
def test_any_change_to_a_file_gives_landmarks_or_a_pinwarp_error(
    tmp_path_factory: pytest.TempPathFactory, random: Random
) -> None:
    content = bytearray(
        b'name,source.x,source.y,source.z,dest.x,dest.y,dest.z\na,1,2,3,4,5,6\n"b, c",1e5,,,,,\n'
    )
    for _ in range(random.randint(1, 5)):
        place = random.randrange(len(content) + 1)
        removed = random.choice([0, 1, 9])
        junk = [b"", b'"', b";", b",", b"\n", b"\0", b"\xff", b"nan", b"#", b"\r", b"'=", b"\t\t\t"]
        content[place : place + removed] = random.choice(junk)
    path = tmp_path_factory.getbasetemp() / "changed.csv"
    path.write_bytes(content)
    try:
        reading = read_landmarks(path, Side.SOURCE)
    except PinwarpError:
        return
    assert reading.landmarks


def test_the_landmarks_of_the_tutorial_pair_by_name(shared_data: Path) -> None:
    folder = shared_data / "opensim-creator-femur"
    source = read_landmarks(folder / "femur_r_warp.landmarks.csv", Side.SOURCE)
    destination = read_landmarks(folder / "subject_femur_r.landmarks.csv", Side.DESTINATION)
    stations = read_landmarks(folder / "femur_r.landmarks.csv", Side.SOURCE)
    names = {landmark.name for landmark in source.landmarks}
    assert names == {landmark.name for landmark in destination.landmarks}
    assert (len(source.landmarks), len(stations.landmarks)) == (20, 10)
    assert source.skipped == destination.skipped == stations.skipped == ()
    assert source.landmarks[2] == Landmark("landmark_10", source=(0.485162, -0.008192, 0.146533))
