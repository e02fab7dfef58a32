from __future__ import annotations

import csv
import re
from pathlib import Path

import pytest
from hypothesis import given, settings

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Role, Side, scaled
from pinwarp.io.landmark_files import (
    FORMATS,
    LANDMARK_SUFFIXES,
    LandmarkFormat,
    LandmarkReading,
    read_landmarks,
    write_landmarks,
)
from pinwarp.io.landmark_formats import (
    amira,
    blank_table,
    idav,
    meshlab,
    mni_tag,
    nts,
    opensim_creator,
)
from pinwarp.io.template import read_template

from . import strategies
from .landmark_formats.examples import EXAMPLES, IDAV, SLICER_JSON, Example

PAIR_FORMATS = [known for known in FORMATS if known.HOLDS.pairs]
NAMED = [known for known in FORMATS if known.HOLDS.names]
# What becomes of blanks in a name, where they stand between two words of a line.
BLANKS: dict[LandmarkFormat, str] = {idav: "_", nts: "_", blank_table: " "}
ODD_NAMES = ["=1+1", "'=1+1", "-5", "@b", 'say "a"', "a, b", "Höcker ✓", "a\\b", "<&>", "#1", "1"]


def name_of(known: LandmarkFormat) -> str:
    return known.NAME


def example_name(example: Example) -> str:
    return f"{example.format} {example.text[:12]!r}"


def saved(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


# Telling the formats apart


@pytest.mark.parametrize("example", EXAMPLES, ids=example_name)
def test_the_example_of_every_format_is_read_exactly(tmp_path: Path, example: Example) -> None:
    path = saved(tmp_path, f"a{example.suffix}", example.text)
    reading = read_landmarks(path, Side.SOURCE)
    assert reading.format == example.format
    assert reading.landmarks == example.landmarks
    assert reading.skipped == ()
    assert reading.count == len(example.landmarks)
    assert reading.is_pairs == any(x.destination for x in example.landmarks)


@pytest.mark.parametrize("suffix", [*LANDMARK_SUFFIXES, ".unknown", ""])
@pytest.mark.parametrize("example", EXAMPLES, ids=example_name)
def test_a_file_under_any_suffix_is_known_by_its_content(
    tmp_path: Path, example: Example, suffix: str
) -> None:
    # A table of three columns is all that is left of the one of Slicer 3, which had no header,
    # and one between blanks of those that begin with more.
    if (suffix, example.format) in (
        (".fcsv", "OpenSim Creator CSV"),
        (".pts", "Table between blanks"),
        (".particles", "Table between blanks"),
    ):
        return
    reading = read_landmarks(saved(tmp_path, f"a{suffix}", example.text), Side.SOURCE)
    assert (reading.format, reading.landmarks) == (example.format, example.landmarks)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
@pytest.mark.parametrize("example", EXAMPLES, ids=example_name)
def test_every_format_is_known_in_the_encodings_of_editors(
    tmp_path: Path, example: Example, encoding: str
) -> None:
    path = saved(tmp_path, "a.any", example.text.encode(encoding))
    assert read_landmarks(path, Side.SOURCE).landmarks == example.landmarks


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("example", EXAMPLES, ids=example_name)
def test_every_format_is_read_with_any_line_ends(
    tmp_path: Path, example: Example, end: str
) -> None:
    text = example.text.replace("\r\n", "\n").replace("\n", end)
    assert read_landmarks(saved(tmp_path, "a", text), Side.SOURCE).landmarks == example.landmarks


@pytest.mark.parametrize("example", EXAMPLES, ids=example_name)
def test_one_side_goes_where_it_was_asked_for(tmp_path: Path, example: Example) -> None:
    reading = read_landmarks(saved(tmp_path, "a", example.text), Side.DESTINATION)
    if not reading.is_pairs:
        assert [x.destination for x in reading.landmarks] == [x.source for x in example.landmarks]
        assert all(x.source is None for x in reading.landmarks)


def test_the_suffix_settles_what_a_table_leaves_open(tmp_path: Path) -> None:
    text = "fovea,1,2,3,1,1\n"
    slicer = read_landmarks(saved(tmp_path, "a.fcsv", text), Side.SOURCE)
    opensim = read_landmarks(saved(tmp_path, "a.csv", text), Side.SOURCE)
    assert (slicer.frame, slicer.unit, opensim.frame, opensim.unit) == ("RAS", "mm", "", "")
    assert slicer.landmarks == opensim.landmarks


def test_a_session_is_not_taken_for_landmarks(tmp_path: Path) -> None:
    path = saved(tmp_path, "a.csv", "# pinwarp-session: 1\nname,role\n")
    with pytest.raises(FileFormatError, match="open it instead"):
        read_landmarks(path, Side.SOURCE)


def test_a_file_too_long_to_be_landmarks_is_refused(tmp_path: Path) -> None:
    path = saved(tmp_path, "a.csv", "1,2,3\n" * 20_001)
    with pytest.raises(FileFormatError, match="20,001 lines, and a landmark file at most"):
        read_landmarks(path, Side.SOURCE)


# Round trips


def came_back(
    path: Path, landmarks: list[Landmark], side: Side | None, unit: str = ""
) -> LandmarkReading:
    write_landmarks(path, landmarks, side, unit=unit)
    reading = read_landmarks(path, side or Side.SOURCE)
    assert reading.skipped == ()
    return reading


def expected_side(
    known: LandmarkFormat, landmarks: list[Landmark], side: Side
) -> list[tuple[str, str]]:
    """Name and position, exact to the last bit, as the format can hold them."""
    if not known.HOLDS.empty:
        landmarks = [x for x in landmarks if x.position(side)]
    marks = [(x.name, repr(x.position(side))) for x in landmarks]
    if not known.HOLDS.names:
        marks = [(f"landmark_{n}", at) for n, (_, at) in enumerate(marks)]
    if known is meshlab:
        marks = [(re.sub("[\ufffe\uffff]", "\ufffd", name), at) for name, at in marks]
    if known in BLANKS:
        marks = [(BLANKS[known].join(name.split()), at) for name, at in marks]
    return marks


@settings(max_examples=20)
@given(landmarks=strategies.landmark_lists(strategies.trimmed_names))
@pytest.mark.parametrize("side", list(Side))
@pytest.mark.parametrize("known", FORMATS, ids=name_of)
def test_one_side_comes_back_exactly(
    tmp_path_factory: pytest.TempPathFactory,
    known: LandmarkFormat,
    side: Side,
    landmarks: list[Landmark],
) -> None:
    expected = expected_side(known, landmarks, side)
    if not expected or len({name for name, _ in expected}) < len(expected):
        return
    path = tmp_path_factory.getbasetemp() / f"side{known.SUFFIXES[0]}"
    reading = came_back(path, landmarks, side)
    assert reading.format == known.NAME
    assert [(x.name, repr(x.position(side))) for x in reading.landmarks] == expected
    assert all(x.position(side.other) is None for x in reading.landmarks)


@given(landmarks=strategies.landmark_lists(strategies.trimmed_names))
@pytest.mark.parametrize("known", PAIR_FORMATS, ids=name_of)
def test_pairs_come_back_exactly_half_placed_ones_included(
    tmp_path_factory: pytest.TempPathFactory, known: LandmarkFormat, landmarks: list[Landmark]
) -> None:
    path = tmp_path_factory.getbasetemp() / f"pairs{known.SUFFIXES[0]}"
    notes = write_landmarks(path, landmarks, None)
    if known in (mni_tag, amira):
        halves = [x for x in landmarks if not x.is_complete]
        assert any("both sides" in note for note in notes) == bool(halves)
        landmarks = [x for x in landmarks if x.is_complete]
    if not landmarks:
        return
    reading = read_landmarks(path, Side.SOURCE)
    assert reading.is_pairs
    assert reading.skipped == ()
    assert [(repr(x.source), repr(x.destination)) for x in reading.landmarks] == [
        (repr(x.source), repr(x.destination)) for x in landmarks
    ]
    if known.HOLDS.names:
        assert reading.names == tuple(x.name for x in landmarks)


@pytest.mark.parametrize("known", NAMED, ids=name_of)
def test_odd_names_come_back(tmp_path: Path, known: LandmarkFormat) -> None:
    landmarks = [Landmark(name, (n, 2, 3)) for n, name in enumerate(ODD_NAMES)]
    reading = came_back(tmp_path / f"a{known.SUFFIXES[0]}", landmarks, Side.SOURCE)
    blanks = BLANKS.get(known, " ")
    assert list(reading.names) == [name.replace(" ", blanks) for name in ODD_NAMES]


@pytest.mark.parametrize("known", NAMED, ids=name_of)
def test_a_name_of_two_lines_comes_back_on_one(tmp_path: Path, known: LandmarkFormat) -> None:
    path = tmp_path / f"a{known.SUFFIXES[0]}"
    reading = came_back(path, [Landmark("left\ntragus", (1, 2, 3))], Side.SOURCE)
    assert reading.names[0].replace("_", " ") == "left tragus"


@pytest.mark.parametrize("suffix", [".csv", ".bigwarp.csv"])
def test_no_cell_of_a_table_is_a_formula(tmp_path: Path, suffix: str) -> None:
    names = ["=cmd|' /C calc'!A0", "+1", "-1+1", "@sum", "\t=1"]
    path = tmp_path / f"a{suffix}"
    write_landmarks(path, [Landmark(name, (1, 2, 3)) for name in names], Side.SOURCE)
    with path.open(newline="") as file:
        cells = [cell for row in csv.reader(file) for cell in row]
    assert len([cell for cell in cells if cell.startswith("'")]) == len(names)
    assert not [cell for cell in cells if re.match(r"\s*[=+@]|-\D", cell)]


def test_names_that_differ_by_blanks_only_stay_different(tmp_path: Path) -> None:
    landmarks = [Landmark("a b", (1, 2, 3)), Landmark("a_b", (4, 5, 6)), Landmark("a  b")]
    reading = came_back(tmp_path / "a.pts", landmarks, Side.SOURCE)
    assert reading.names == ("a_b", "a_b_2", "a_b_3")
    assert write_landmarks(tmp_path / "a.pts", landmarks, Side.SOURCE) == (
        "3 names with blanks got underscores.",
    )


def test_switched_off_pairs_come_back_from_bigwarp(tmp_path: Path) -> None:
    landmarks = [
        Landmark("on", (1, 2, 3), (4, 5, 6)),
        Landmark("off", (1, 2, 3), (4, 5, 6), enabled=False),
        Landmark("half", (1, 2, 3)),
    ]
    assert list(came_back(tmp_path / "a.bigwarp.csv", landmarks, None).landmarks) == landmarks


# Units and frames


@pytest.mark.parametrize("suffix", [".fcsv", ".mrk.json"])
@pytest.mark.parametrize(("unit", "factor"), [("m", 1000.0), ("cm", 10.0), ("mm", 1.0), ("", 1.0)])
def test_slicer_gets_millimetres_and_the_way_back_is_known(
    tmp_path: Path, suffix: str, unit: str, factor: float
) -> None:
    landmarks = [Landmark("a", (0.147277, -0.034081, 1e-9)), Landmark("b", (1, 2, 3))]
    reading = came_back(tmp_path / f"a{suffix}", landmarks, Side.SOURCE, unit)
    assert (reading.unit, reading.frame) == ("mm", "LPS")
    assert reading.landmarks[1].source == (factor, 2 * factor, 3 * factor)
    back = scaled(reading.landmarks, 1 / factor)
    for before, after in zip(landmarks, back, strict=True):
        assert after.source == pytest.approx(before.source, rel=4e-16)


@pytest.mark.parametrize("known", [x for x in FORMATS if not x.NAME.startswith("3D")], ids=name_of)
def test_formats_without_a_unit_keep_the_numbers_and_say_none(
    tmp_path: Path, known: LandmarkFormat
) -> None:
    path = tmp_path / f"a{known.SUFFIXES[0]}"
    reading = came_back(path, [Landmark("a", (0.1, 0.2, 0.3))], Side.SOURCE, "m")
    assert (reading.unit, reading.frame) == ("", "")
    assert reading.landmarks[0].source == (0.1, 0.2, 0.3)


@pytest.mark.parametrize(
    ("unit", "position", "reason"),
    [("furlong", (1, 2, 3), "one furlong is not known"), ("m", (1e308, 0, 0), "not finite")],
)
def test_what_cannot_be_converted_is_refused_and_the_old_file_stays(
    tmp_path: Path, unit: str, position: tuple[float, float, float], reason: str
) -> None:
    path = saved(tmp_path, "a.fcsv", "old")
    with pytest.raises(FileFormatError, match=reason) as caught:
        write_landmarks(path, [Landmark("a", position)], Side.SOURCE, unit=unit)
    assert str(caught.value).startswith("a.fcsv: ")
    assert path.read_text() == "old"


# Writing


def test_an_unknown_suffix_is_refused_with_those_that_are_known(tmp_path: Path) -> None:
    for name in ("a.docx", "a"):
        with pytest.raises(FileFormatError, match=r"not supported.*\.csv, .*\.fcsv"):
            write_landmarks(tmp_path / name, [Landmark("a", (1, 2, 3))], Side.SOURCE)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("known", [x for x in FORMATS if not x.HOLDS.pairs], ids=name_of)
def test_pairs_are_not_written_where_only_one_side_fits(
    tmp_path: Path, known: LandmarkFormat
) -> None:
    path = tmp_path / f"a{known.SUFFIXES[0]}"
    with pytest.raises(FileFormatError, match=r"one side only.*\.csv, \.bigwarp\.csv, .*\.tag"):
        write_landmarks(path, [Landmark("a", (1, 2, 3), (4, 5, 6))], None)
    assert not path.exists()


@pytest.mark.parametrize("known", FORMATS, ids=name_of)
def test_writing_into_a_missing_folder_is_an_os_error(
    tmp_path: Path, known: LandmarkFormat
) -> None:
    with pytest.raises(OSError, match="No such file"):
        write_landmarks(tmp_path / "no" / f"a{known.SUFFIXES[0]}", [], Side.SOURCE)


@pytest.mark.parametrize("suffix", [".csv", ".fcsv", ".tag"])
def test_what_is_left_out_is_said(tmp_path: Path, suffix: str) -> None:
    landmarks = [Landmark("a", (1, 2, 3)), Landmark("b"), Landmark("c", None, (1, 2, 3))]
    notes = write_landmarks(tmp_path / f"a{suffix}", landmarks, Side.SOURCE)
    assert notes == ("2 landmarks that are not placed were left out.",)


@pytest.mark.parametrize("suffix", [".mrk.json", ".pp", ".pts", ".tps", ".morphologika.txt"])
def test_a_landmark_that_is_not_placed_keeps_its_row(tmp_path: Path, suffix: str) -> None:
    landmarks = [Landmark("a"), Landmark("b", (1, 2, 3)), Landmark("c")]
    reading = came_back(tmp_path / f"a{suffix}", landmarks, Side.SOURCE)
    assert [x.source for x in reading.landmarks] == [None, (1, 2, 3), None]
    assert reading.notes == ("2 landmarks have no position: they are names still to be placed.",)


@pytest.mark.parametrize("known", FORMATS, ids=name_of)
def test_what_a_format_has_no_place_for_is_told(tmp_path: Path, known: LandmarkFormat) -> None:
    landmark = Landmark("a", (1, 2, 3), role=Role.PASSENGER, note="=x", locked=True)
    path, holds = tmp_path / f"a{known.SUFFIXES[0]}", known.HOLDS
    notes = write_landmarks(path, [landmark], Side.SOURCE)
    (found,) = read_landmarks(path, Side.SOURCE).landmarks
    assert (found.source, found.role) == ((1, 2, 3), Role.PAIR)
    assert found.note == ("=x" if holds.notes else "")
    assert found.locked == holds.locks
    told = " ".join(notes)
    for words, has_place in (
        ("only their order", holds.names),
        ("notes: those of a", holds.notes),
        ("locks: those of a", holds.locks),
        ("1 passenger (a)", False),
    ):
        assert (words in told) != has_place, words


# Templates


@pytest.mark.parametrize("example", EXAMPLES, ids=example_name)
def test_a_landmark_file_of_any_format_is_a_template(tmp_path: Path, example: Example) -> None:
    path = saved(tmp_path, f"a{example.suffix}", example.text)
    assert read_template(path) == tuple(x.name for x in example.landmarks)


def test_what_is_still_to_be_placed_is_said(tmp_path: Path) -> None:
    for example in (IDAV, SLICER_JSON):
        reading = read_landmarks(saved(tmp_path, "a", example.text), Side.SOURCE)
        assert reading.notes == ("1 landmark without a position is a name still to be placed.",)


def test_nobody_takes_a_csv_file_for_another_format() -> None:
    assert [x.NAME for x in FORMATS if x.matches("name,x,y,z\nfovea,1,2,3\n")] == [
        opensim_creator.NAME
    ]
