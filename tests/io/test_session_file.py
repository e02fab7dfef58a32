from __future__ import annotations

import csv
import io
import math
import re
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinwarp.core.basis import Basis
from pinwarp.core.components import Components
from pinwarp.core.errors import (
    FileFormatError,
    LandmarkError,
    NewerFileError,
    PenaltyError,
    PinwarpError,
)
from pinwarp.core.landmarks import Landmark, Role
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import PenaltyConvention
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.io.session_file import (
    MeshReference,
    SessionRecord,
    read_session,
    session_text,
    write_session,
)

from . import strategies

EXAMPLE = """\
# pinwarp-session: 1
# source_mesh: femur.stl sha256=ab12 vertices=456
# destination_mesh: ../shared/left subject.stl sha256=cd34 vertices=89666
# warping_penalty: 0.0042
# penalty_convention: opynsim
# unit: m
# treat_as_planar: yes
# camera: 1, 2; 3
# a remark
# landmarks: 3
name,role,enabled,source_x,source_y,source_z,destination_x,destination_y,destination_z,note,colour
lateral_epicondyle,pair,1,0.482677,-0.034081,0.147277,-0.09938,-0.28054,-0.0003,,red
glmed_r_p2,passenger,1,0.087685,-0.094538,0.114963,,,,"a ""note"", two
lines",
half,pair,0,,,,1,2,3,,
"""


def example(folder: Path) -> SessionRecord:
    return SessionRecord(
        landmarks=(
            Landmark(
                "lateral_epicondyle",
                (0.482677, -0.034081, 0.147277),
                (-0.09938, -0.28054, -0.0003),
                extra=(("colour", "red"),),
            ),
            Landmark(
                "glmed_r_p2",
                (0.087685, -0.094538, 0.114963),
                role=Role.PASSENGER,
                note='a "note", two\nlines',
                extra=(("colour", ""),),
            ),
            Landmark("half", None, (1, 2, 3), enabled=False, extra=(("colour", ""),)),
        ),
        source_mesh=MeshReference(folder / "femur.stl", "ab12", 456),
        destination_mesh=MeshReference(
            folder.parent / "shared" / "left subject.stl", "cd34", 89666
        ),
        settings=WarpSettings(0.0042, PenaltyConvention.OPYNSIM, planar=True),
        unit="m",
        unknown=(("camera", "1, 2; 3"), ("", "a remark")),
    )


def save(folder: Path, content: str | bytes) -> Path:
    path = folder / "a.pinwarp.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def resaved(text: str, separator: str, width: int) -> str:
    """Save a session as a spreadsheet does: every line as wide as the table, quotes as needed."""
    out = io.StringIO(newline="")
    writer = csv.writer(out, delimiter=separator, lineterminator="\r\n")
    for row in csv.reader(io.StringIO(text, newline="")):
        flags = {"1": "TRUE", "0": "FALSE"}
        is_landmark = len(row) == width and row[1] in ("pair", "passenger")
        cells = [*row[:2], flags[row[2]], *row[3:]] if is_landmark else row
        if separator == ";" and is_landmark:
            cells[3:9] = [cell.replace(".", ",") for cell in cells[3:9]]
        writer.writerow([*cells, *[""] * (width - len(cells))])
    return out.getvalue()


# Round trips


def test_the_example_of_the_format_is_read(tmp_path: Path) -> None:
    assert read_session(save(tmp_path, EXAMPLE)) == example(tmp_path)


def test_the_example_is_written_as_it_stands(tmp_path: Path) -> None:
    write_session(tmp_path / "b.csv", example(tmp_path))
    text = (tmp_path / "b.csv").read_bytes().decode()
    assert text == EXAMPLE.replace(",1,2,3,", ",1.0,2.0,3.0,")


def test_an_empty_session_comes_back(tmp_path: Path) -> None:
    write_session(tmp_path / "a.csv", SessionRecord())
    assert read_session(tmp_path / "a.csv") == SessionRecord()
    assert "planar" not in (tmp_path / "a.csv").read_text()


@given(
    landmarks=strategies.landmark_lists(strategies.names),
    penalty=st.floats(min_value=0, allow_nan=False) | st.sampled_from([0.0, 5e-324, math.inf]),
    convention=st.sampled_from(PenaltyConvention),
    components=st.sampled_from(Components),
    blend=st.floats(0, 1),
    unit=st.sampled_from(["mm", "m", ""]),
    planar=st.booleans(),
    basis=st.sampled_from(Basis),
)
def test_any_session_comes_back_exactly(
    tmp_path_factory: pytest.TempPathFactory,
    landmarks: list[Landmark],
    penalty: float,
    convention: PenaltyConvention,
    components: Components,
    blend: float,
    unit: str,
    planar: bool,
    basis: Basis,
) -> None:
    path = tmp_path_factory.getbasetemp() / "a.pinwarp.csv"
    record = SessionRecord(
        tuple(landmarks),
        settings=WarpSettings(
            penalty, convention, components, blend, planar and basis is Basis.R, basis
        ),
        unit=unit,
    )
    write_session(path, record)
    assert repr(read_session(path)) == repr(record)


@given(landmarks=strategies.landmark_lists(strategies.names), text=strategies.texts)
def test_unknown_columns_come_back_exactly(
    tmp_path_factory: pytest.TempPathFactory, landmarks: list[Landmark], text: str
) -> None:
    path = tmp_path_factory.getbasetemp() / "a.pinwarp.csv"
    extra = (("=colour", text), ("Size", "5"))
    record = SessionRecord(tuple(replace(landmark, extra=extra) for landmark in landmarks))
    write_session(path, record)
    assert read_session(path) == record


@pytest.mark.parametrize(
    "name",
    [
        "femur.stl",
        "left femur.stl",
        "a=b sha256=x vertices=1.stl",
        " blanks at both ends ",
        "sub/folder/femur.stl",
        "two\nlines.stl",
        '"quoted".stl',
        "Höcker, links; 100 %.stl",
        "#1.stl",
        "a: b.stl",
    ],
)
@pytest.mark.parametrize("place", ["", "../shared", "/elsewhere"])
def test_mesh_paths_come_back(tmp_path: Path, name: str, place: str) -> None:
    folder = tmp_path / "session"
    folder.mkdir()
    # An absolute place replaces the folder.
    mesh = Path(str((folder / place).resolve()), name)
    record = SessionRecord(source_mesh=MeshReference(mesh, "ab", 3))
    write_session(folder / "a.csv", record)
    assert read_session(folder / "a.csv") == record


def test_a_session_moves_together_with_its_meshes(tmp_path: Path) -> None:
    old, new = tmp_path / "old" / "study", tmp_path / "new" / "study"
    old.mkdir(parents=True)
    mesh = MeshReference(tmp_path / "old" / "shared" / "femur.stl", "ab", 3)
    write_session(old / "a.csv", SessionRecord(source_mesh=mesh))
    assert (
        "# source_mesh: ../shared/femur.stl sha256=ab vertices=3\n" in (old / "a.csv").read_text()
    )
    (tmp_path / "old").rename(tmp_path / "new")
    found = read_session(new / "a.csv").source_mesh
    assert found is not None
    assert found.path == tmp_path / "new" / "shared" / "femur.stl"


def test_a_path_given_relative_is_absolute_once_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write_session("a.csv", SessionRecord(source_mesh=MeshReference(Path("femur.stl"), "ab", 3)))
    found = read_session("a.csv").source_mesh
    assert found is not None
    assert found.path == tmp_path / "femur.stl"


def test_names_and_notes_are_no_formulas_in_the_file(tmp_path: Path) -> None:
    landmark = Landmark("=1+1", note="@SUM(A1)", extra=(("-x", "+1"),))
    write_session(tmp_path / "a.csv", SessionRecord((landmark,)))
    rows = list(csv.reader(io.StringIO((tmp_path / "a.csv").read_text())))
    assert not any(cell.startswith(("=", "+", "-", "@")) for row in rows[-2:] for cell in row)
    assert read_session(tmp_path / "a.csv").landmarks == (landmark,)


@pytest.mark.parametrize("line", ["# :source_mesh: a", "## a: b", "#", "# a", "# a:", "# a: b: c"])
def test_header_lines_that_are_not_understood_stay_as_they_are(tmp_path: Path, line: str) -> None:
    text = EXAMPLE.replace("# a remark", line)
    record = read_session(save(tmp_path, text))
    write_session(tmp_path / "b.csv", record)
    assert read_session(tmp_path / "b.csv") == record
    assert record.source_mesh == example(tmp_path).source_mesh


# Spreadsheets and editors


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_a_session_saved_again_by_a_spreadsheet_is_read(
    tmp_path: Path, separator: str, encoding: str
) -> None:
    text = resaved(EXAMPLE.replace("half", "Höcker"), separator, 11)
    expected = example(tmp_path)
    renamed = replace(expected.landmarks[2], name="Höcker")
    expected = replace(expected, landmarks=(*expected.landmarks[:2], renamed))
    assert read_session(save(tmp_path, text.encode(encoding))) == expected


def test_a_table_without_the_empty_cells_at_the_end_of_its_rows_is_read(tmp_path: Path) -> None:
    text = "\n".join(line.rstrip(",") for line in EXAMPLE.split("\n"))
    assert read_session(save(tmp_path, text)) == example(tmp_path)


@pytest.mark.parametrize(
    "change",
    [
        ("\n", "\r\n"),
        ("# unit: m\n", "# unit: m\n\n#\n"),
        ("# unit: m\n", "#unit:m\n"),
        ("name,role", "Name,ROLE"),
        ("half,pair,0", "half,Pair,no"),
        ("half,pair,0,,,,1,2,3,,\n", "half,pair,0,,,,1,2,3,,"),
        ("half,pair,0,,,,1,2,3,,\n", "half,pair,0,,,, 1 ,2.0,3e0,,\n\n,,,,,,,,,,\n"),
        ("lateral_epicondyle,pair,1,", "lateral_epicondyle,pair,,"),
    ],
)
def test_changes_by_hand_that_change_nothing_are_read(
    tmp_path: Path, change: tuple[str, str]
) -> None:
    text = EXAMPLE.replace(*change)
    assert text != EXAMPLE
    expected = example(tmp_path)
    found = read_session(save(tmp_path, text))
    # A bare # is kept like any remark; a note keeps the line ends of its file.
    found = replace(found, unknown=tuple(entry for entry in found.unknown if entry != ("", "")))
    notes = [mark.note.replace("\r\n", "\n") for mark in found.landmarks]
    marks = tuple(replace(m, note=n) for m, n in zip(found.landmarks, notes, strict=True))
    assert replace(found, landmarks=marks) == expected


# Damage


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("# pinwarp-session: 1\n", "", "not a pinwarp session"),
        ("# pinwarp-session: 1\n", "name,x,y,z\n", "not a pinwarp session"),
        ("session: 1", "session: one", "line 1: The version 'one'"),
        ("session: 1", "session: 0", "line 1: The version '0'"),
        (" vertices=456", " vertices=many", "line 2: A mesh is given as"),
        ("landmarks: 3", "landmarks: few", "line 10: The number of landmarks is 'few'"),
        ("half,pair,0,,,,1,2,3,,\n", "", "It announces 3 landmarks and holds 2: was it cut off"),
        ("0.0042", "-0.0042", "line 4: The warping penalty -0.0042 is negative"),
        ("0.0042", "nan", "line 4: 'nan' is not a finite number"),
        ("0.0042", "much", "line 4: 'much' is not a number"),
        ("opynsim", "other", "line 5: The convention 'other'"),
        ("# unit: m\n", "# unit: m\n# unit: mm\n", "line 7: Unit is given twice"),
        ("planar: yes", "planar: maybe", "line 7: Treat_as_planar is 'maybe'"),
        (
            "# unit: m\n",
            "# unit: m\n# basis: cubic\n",
            "line 7: The basis 'cubic' is none of r, r2logr",
        ),
        (
            "# unit: m\n",
            "# unit: m\n# basis: r2logr\n",
            "line 7: Landmarks can be treated as planar",
        ),
        ("destination_y,", "", "line 11: The column 'destination_y' is missing"),
        ("note,colour", "note,note", "line 11: Two columns"),
        ("lateral_epicondyle,pair", "lateral_epicondyle,friend", "line 12: The role 'friend'"),
        ("lateral_epicondyle,pair,1", "lateral_epicondyle,pair,2", "line 12: 'enabled' is '2'"),
        ("lateral_epicondyle,pair", " ,pair", "line 12: A landmark needs a name"),
        ("-0.034081", "", "line 12: A number is missing"),
        ("-0.034081", "x", "line 12: 'x' is not a number"),
        ("-0.034081", "inf", "line 12: 'inf' is not a finite number"),
        ("-0.034081", "1e400", "line 12: '1e400' is not a finite number"),
        (",,red", ",,red,blue", "line 12: The row has 12 cells for 11 columns"),
        ('"a ""note""', '"a "note""', "line 13: The quotes do not match"),
        ('lines",', "lines,", "line 13: The quotes do not match"),
        ("half", "glmed_r_p2", "line 15: The name 'glmed_r_p2' was used before"),
        (",1,2,3,,\n", ",1,2", "line 15: The row ends after 8 of 11 cells"),
        (",1,2,3,,\n", ",1,2\n", "line 15: A number is missing"),
        ("half,pair,0,,,,1,2,3,,\n", "half", "line 15: The row ends after 1 of 11"),
        (EXAMPLE[EXAMPLE.index("name,") :], "", "table of landmarks is missing"),
    ],
)
def test_a_damaged_session_is_refused_with_its_line(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    assert old in EXAMPLE
    with pytest.raises(FileFormatError, match=reason) as caught:
        read_session(save(tmp_path, EXAMPLE.replace(old, new, 1)))
    assert "a.pinwarp.csv" in str(caught.value)
    assert str(caught.value).endswith(".")
    assert not isinstance(caught.value, NewerFileError)


def test_only_a_session_of_another_basis_is_kept_from_older_programs(tmp_path: Path) -> None:
    for basis, version in ((Basis.R, "1"), (Basis.R2_LOG_R, "3")):
        record = SessionRecord(settings=WarpSettings(basis=basis))
        text = session_text(record)
        assert text.startswith(f"# pinwarp-session: {version}\n")
        assert ("# basis: r2logr\n" in text) is (basis is not Basis.R)


def test_a_newer_session_is_refused_by_its_version_only(tmp_path: Path) -> None:
    path = save(tmp_path, "# pinwarp-session: 4\nwhatever\nthis is\n")
    with pytest.raises(NewerFileError, match=r"newer pinwarp \(version 4\); update pinwarp"):
        read_session(path)


@pytest.mark.parametrize(
    "content", [b"", bytes(range(256)) * 9, b"\x89PNG\r\n\x1a\n\0", b"\xff\xfe"]
)
def test_noise_is_refused(tmp_path: Path, content: bytes) -> None:
    with pytest.raises(FileFormatError, match=r"empty|not a pinwarp session"):
        read_session(save(tmp_path, content))


def test_a_missing_session_and_a_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="no such file"):
        read_session(tmp_path / "no.csv")
    with pytest.raises(FileFormatError, match="is a folder"):
        read_session(tmp_path)


def test_a_row_that_was_cut_off_before_its_last_cell_is_refused(tmp_path: Path) -> None:
    text = EXAMPLE[: EXAMPLE.index("glmed_r_p2")]
    start, last_comma = text.index("lateral"), text.rindex(",")
    for end in range(start + 1, last_comma + 1):
        with pytest.raises(FileFormatError, match=r"line 12: The row ends after \d+ of 11"):
            read_session(save(tmp_path, text[:end]))


@settings(max_examples=500)
@given(random=st.randoms(use_true_random=False))
def test_any_change_to_a_session_gives_a_session_or_a_pinwarp_error(
    tmp_path_factory: pytest.TempPathFactory, random: Random
) -> None:
    content = bytearray(EXAMPLE.encode())
    for _ in range(random.randint(1, 4)):
        place = random.randrange(len(content) + 1)
        junk = [
            b"",
            b'"',
            b";",
            b",",
            b"\n",
            b"\0",
            b"\xff",
            b"nan",
            b"#",
            b"\r",
            b"'=",
            b":",
            b"9",
        ]
        content[place : place + random.choice([0, 1, 9])] = random.choice(junk)
    path = save(tmp_path_factory.getbasetemp(), bytes(content))
    try:
        record = read_session(path)
    except PinwarpError:
        return
    write_session(path, record)
    assert read_session(path) == record


# What cannot be written


def test_two_landmarks_of_one_name_are_not_written(tmp_path: Path) -> None:
    path = save(tmp_path, "old")
    with pytest.raises(LandmarkError, match="Two landmarks are called 'a'"):
        write_session(path, SessionRecord((Landmark("a"), Landmark("a"))))
    assert path.read_text() == "old"


def test_a_note_that_could_not_be_read_back_is_not_written(tmp_path: Path) -> None:
    longest = SessionRecord((Landmark("a", note='"' * 100_000),))
    write_session(tmp_path / "a.csv", longest)
    assert read_session(tmp_path / "a.csv") == longest
    with pytest.raises(LandmarkError, match="'a' is too long"):
        write_session(tmp_path / "a.csv", SessionRecord((Landmark("a", note="x" * 100_001),)))
    assert read_session(tmp_path / "a.csv") == longest


@pytest.mark.parametrize("penalty", [-1.0, math.nan])
def test_a_penalty_that_is_none_is_not_written(tmp_path: Path, penalty: float) -> None:
    with pytest.raises(PenaltyError):
        write_session(tmp_path / "a.csv", SessionRecord(settings=WarpSettings(penalty)))
    assert list(tmp_path.iterdir()) == []


def test_spreads_are_columns_only_where_somebody_measured_them(tmp_path: Path) -> None:
    path = tmp_path / "a.pinwarp.csv"
    plain = Landmark("a", extra=(("colour", "red"),))
    measured = Landmark("b", (1, 2, 3), source_spread=0.25)
    write_session(path, SessionRecord((plain, measured)))
    lines = path.read_text().splitlines()
    assert lines[-3].endswith(",note,source_spread,colour")
    assert lines[-1].endswith(",0.25,")
    assert read_session(path).landmarks == (
        plain,
        replace(measured, extra=(("colour", ""),)),
    )
    for wrong, reason in (("-1", "is below 0"), ("wide", "is not a number")):
        path.write_text("\n".join(lines).replace(",0.25,", f",{wrong},") + "\n")
        with pytest.raises(FileFormatError, match=f"line {len(lines)}.*{reason}"):
            read_session(path)
    both = replace(measured, destination_spread=0.5)
    write_session(path, SessionRecord((both,)))
    assert read_session(path).landmarks == (both,)


def test_locks_are_a_column_only_where_some_landmark_is_locked(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    free, locked = Landmark("a"), Landmark("b", locked=True, extra=(("colour", "red"),))
    write_session(path, SessionRecord((free,)))
    assert "locked" not in path.read_text()
    write_session(path, SessionRecord((free, locked)))
    assert path.read_text().splitlines()[-3].endswith(",note,locked,colour")
    assert read_session(path).landmarks == (replace(free, extra=(("colour", ""),)), locked)


def test_an_empty_lock_is_open_and_nonsense_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    write_session(path, SessionRecord((Landmark("a", locked=True),)))
    text = path.read_text()
    path.write_text(text.replace(",,1\n", ",,\n"))
    assert not read_session(path).landmarks[0].locked
    path.write_text(text.replace(",,1\n", ",,maybe\n"))
    with pytest.raises(FileFormatError, match="'locked' is 'maybe' and not 1 or 0"):
        read_session(path)


PLACES = ((0.1, 2.0, 3.0), (4.0, 5e-17, 6.0), (7.0, 8.0, 1 / 3))
REFINED = RefinementRecord(PLACES, PLACES[::-1], 6.5, 0.25, True, 9, 2, "sha256:ab12")


def test_a_refined_session_is_version_2_and_reads_back_to_the_last_bit(tmp_path: Path) -> None:
    record = replace(example(tmp_path), refinement=REFINED)
    locked = (replace(record.landmarks[0], locked=True), *record.landmarks[1:])
    for one in (record, replace(record, landmarks=locked), SessionRecord(refinement=REFINED)):
        path = tmp_path / "a.pinwarp.csv"
        write_session(path, one)
        assert path.read_text().startswith("# pinwarp-session: 2\n")
        assert read_session(path) == one


def test_without_a_refinement_older_versions_can_read_the_session(tmp_path: Path) -> None:
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, example(tmp_path))
    assert path.read_text().startswith("# pinwarp-session: 1\n")


def test_a_landmark_may_be_called_as_a_fitted_place_is(tmp_path: Path) -> None:
    path = tmp_path / "a.pinwarp.csv"
    record = SessionRecord((Landmark("fitted_1", (1, 2, 3)),), refinement=REFINED)
    write_session(path, record)
    assert read_session(path) == record


@pytest.mark.parametrize(
    ("found", "put", "words"),
    [
        (r"# refine: .*\n", "", "the line '# refine: ...' is missing"),
        (r"fitted_[123],.*\n", "", "what it fitted is missing"),
        (r"feature=6.5", "feature=-1", "a length below 0"),
        (r"tolerance=0.25 ", "", "does not say its tolerance"),
        (r"turned=1", "turned=perhaps", "not 0 or 1"),
        (r"places=9", "places=nine", "no number"),
        (r"(fitted_2,fitted,1,[^,]*),", r"\1x,", "fitted_2|is not a number|no number"),
        (r"(fitted_2,fitted,1),[^,]*,[^,]*,[^,]*,", r"\1,,,,", "lacks one of its positions"),
    ],
)
def test_a_damaged_refinement_is_refused_not_half_read(
    tmp_path: Path, found: str, put: str, words: str
) -> None:
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, replace(example(tmp_path), refinement=REFINED))
    text, times = re.subn(found, put, path.read_text())
    assert times
    path.write_text(text)
    with pytest.raises(FileFormatError, match=words):
        read_session(path)


# Written by hand or by a script


def test_a_session_needs_no_more_than_paths_names_and_places(tmp_path: Path) -> None:
    text = (
        "# pinwarp-session: 1\n# source_mesh: left femur.stl\n# destination_mesh: subject.stl\n"
        "name,source_x,source_y,source_z,destination_x,destination_y,destination_z\n"
        "fovea,1,2,3,4,5,6\nnotch,7,8,9,,,\n"
    )
    record = read_session(save(tmp_path, text))
    assert record.source_mesh == MeshReference(tmp_path / "left femur.stl")
    assert record.landmarks == (
        Landmark("fovea", (1, 2, 3), (4, 5, 6)),
        Landmark("notch", (7, 8, 9)),
    )
    assert (record.settings, record.unit) == (WarpSettings(), "mm")


def test_a_side_may_be_left_out_but_no_coordinate(tmp_path: Path) -> None:
    text = "# pinwarp-session: 1\nname,source_x,source_y,source_z\nfovea,1,2,3\n"
    assert read_session(save(tmp_path, text)).landmarks == (Landmark("fovea", (1, 2, 3)),)
    with pytest.raises(FileFormatError, match="column 'source_z' is missing"):
        read_session(save(tmp_path, text.replace(",source_z", "").replace(",3", "")))
    with pytest.raises(FileFormatError, match="column 'source_x' is missing"):
        read_session(save(tmp_path, "# pinwarp-session: 1\nname\nfovea\n"))


@pytest.mark.parametrize("said", ["", " sha256=ab12", " vertices=456", " sha256=ab vertices=4"])
@pytest.mark.parametrize("name", ["a.stl", "a=b sha256=x vertices=1", " sha256=", "a vertices=4"])
def test_what_is_said_of_a_mesh_comes_back_and_no_more(
    tmp_path: Path, name: str, said: str
) -> None:
    words = dict(word.split("=") for word in said.split())
    mesh = MeshReference(tmp_path / name, words.get("sha256", ""), int(words.get("vertices", 0)))
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, SessionRecord(source_mesh=mesh))
    assert path.read_text().splitlines()[1].endswith(said)
    assert read_session(path).source_mesh == mesh


def test_a_curve_is_open_and_of_twenty_points_where_nobody_says(tmp_path: Path) -> None:
    text = (
        "# pinwarp-session: 2\n# curve: name=crest\n"
        "name,role,source_x,source_y,source_z\n"
        "crest 1,handle,1,2,3\ncrest 2,handle,4,5,6\n"
    )
    (curve,) = read_session(save(tmp_path, text)).groups
    assert (curve.name, curve.count, curve.is_closed) == ("crest", 20, False)


def test_a_file_cut_off_between_two_rows_is_noticed_and_rows_may_be_added(tmp_path: Path) -> None:
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, SessionRecord(tuple(Landmark(f"p{n}", (n, 2, 3)) for n in range(4))))
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(lines[:-1]))
    with pytest.raises(FileFormatError, match="announces 4 landmarks and holds 3: was it cut off"):
        read_session(path)
    path.write_text("".join([*lines, lines[-1].replace("p3", "p4")]))
    assert len(read_session(path).landmarks) == 5
