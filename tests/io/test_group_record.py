"""Curves and patches in a session file."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinwarp.core.errors import FileFormatError, LandmarkError, PinwarpError
from pinwarp.core.groups import Curve, Group, Handle, Patch
from pinwarp.core.landmarks import Landmark
from pinwarp.io.group_record import SlidRecord
from pinwarp.io.session_file import SessionRecord, read_session, write_session

from . import strategies

places = st.tuples(*[strategies.coordinates] * 3)


def is_group_name(name: str) -> bool:
    try:
        Patch(name)
    except LandmarkError:
        return False
    return True


odd = st.sampled_from(
    [
        "a b",
        "a 1",
        "1",
        "a=b",
        "name=x",
        "points=9 name=y",
        "around=z",
        "a,b",
        "a,=b,",
        "=1+1",
        "'=1+1",
        ";",
        ", ,",
        '"',
        'a"b',
        '"#',
        "#",
        "# curve: x",
        "a;-b;",
        "ä, ö",
        "x:y",
        "/",
    ]
)
group_names = (strategies.trimmed_names | odd).filter(is_group_name)


@st.composite
def curves(draw: st.DrawFn, name: str) -> Curve:
    is_closed = draw(st.booleans())
    handle = st.builds(
        Handle, places, st.none() | places, st.just("") | st.sampled_from(["apex", "=a, b\nc "])
    )
    handles = draw(st.lists(handle, min_size=3, max_size=5))
    count = draw(st.integers(0, 9))
    excluded = draw(st.frozensets(st.integers(0, count - 1))) if count else frozenset()
    return Curve(name, tuple(handles), is_closed, count, excluded, draw(st.booleans()))


@st.composite
def patches(draw: st.DrawFn, name: str, around: list[str]) -> Patch:
    points = draw(st.lists(places, max_size=6))
    excluded = st.frozensets(st.integers(0, len(points) - 1)) if points else st.just(frozenset())
    return Patch(
        name,
        tuple(points),
        draw(st.sampled_from(["", *around])),
        draw(st.none() | places),
        draw(excluded),
    )


@st.composite
def records(draw: st.DrawFn) -> SessionRecord:
    names = draw(st.lists(group_names, max_size=4, unique=True))
    groups: list[Group] = [
        draw(curves(name) | patches(name, names[: max(number, 1)]))
        for number, name in enumerate(names)
    ]
    slid = None
    if groups and draw(st.booleans()):
        points = [
            place
            for group in groups
            for place in (
                [draw(places) for _ in range(group.count - len(group.excluded))]
                if isinstance(group, Curve)
                else [p for n, p in enumerate(group.points) if n not in group.excluded]
            )
        ]
        there = [draw(st.none() | places) for _ in points]
        slid = SlidRecord(tuple(points), tuple(there), "sha256:ab12")
    marks = draw(strategies.landmark_lists(strategies.names))
    return SessionRecord(tuple(marks), groups=tuple(groups), slid=slid)


HANDLES = (
    Handle((0.5, 1.0, 2.0), (1.0, 1.5, 1.0), "apex"),
    Handle((3.0, 4.0, 5.0), (2.0, 2.0, 2.25)),
    Handle((6.0, 7.0, 8.0), None),
)
CREST = Curve("crest, left = 1", HANDLES, count=3, excluded=frozenset({1}))
RING = Curve("ring", HANDLES, is_closed=True, count=2, drawn=True)
CAP = Patch("cap", ((1.5, 1.0, 1.0), (2.0, 2.5, 2.0)), "ring", (0.5, 0.25, 1e-17), frozenset({0}))
WHOLE = Patch("whole", ((9.0, 9.5, 9.0),))
SLID = SlidRecord(
    (
        *((1.0, 0.5, 0.0), (2.0, 0.0, 0.5), (3.0, 0.0, 0.0), (4.0, 0.0, 0.0)),
        *(*CAP.points[1:], *WHOLE.points),
    ),
    ((5.0, 0.0, 0.5), None, (6.0, 0.0, 0.0), (7.0, 0.0, 0.0), (8.0, 0.0, 0.0), None),
    "sha256:ab12",
)
APEX = Landmark("apex", (0.5, 1.0, 2.0), (1.0, 1.5, 1.0), note="so")
RECORD = SessionRecord((APEX,), groups=(CREST, RING, CAP, WHOLE), slid=SLID)


@given(records())
@settings(max_examples=120)
def test_any_curves_and_patches_come_back_to_the_last_bit(
    tmp_path_factory: pytest.TempPathFactory, record: SessionRecord
) -> None:
    path = tmp_path_factory.getbasetemp() / "groups.pinwarp.csv"
    write_session(path, record)
    assert repr(read_session(path)) == repr(record)
    first = "2" if record.groups else "1"
    assert path.read_text(encoding="utf-8").startswith(f"# pinwarp-session: {first}\n")


def test_what_a_curve_is_called_is_no_formula_in_the_file(tmp_path: Path) -> None:
    path = tmp_path / "a.pinwarp.csv"
    group = replace(CREST, name="=1+1,-2")
    write_session(path, SessionRecord((APEX,), groups=(group, Patch("+x", ((1, 2, 3),)))))
    for row in csv.reader(io.StringIO(path.read_text(encoding="utf-8"))):
        for cell in row:
            assert not cell.startswith(("=", "@", "+")) or re.fullmatch(r"[-+.\de]*", cell)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("quotes", [csv.QUOTE_MINIMAL, csv.QUOTE_ALL])
def test_a_spreadsheet_may_save_it_again(tmp_path: Path, separator: str, quotes: int) -> None:
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, RECORD)
    rows = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8"))))
    out = io.StringIO(newline="")
    writer = csv.writer(out, delimiter=separator, lineterminator="\r\n", quoting=quotes)
    for row in rows:
        if not row[0].startswith("#") and row[0] != "name":
            row[2] = {"1": "TRUE", "0": "FALSE"}[row[2]]
            if separator == ";":
                row[3:9] = [cell.replace(".", ",") for cell in row[3:9]]
        writer.writerow([*row, *[""] * (10 - len(row))])
    path.write_bytes(out.getvalue().encode("utf-8-sig"))
    assert read_session(path) == RECORD


def test_rows_may_stand_in_another_order(tmp_path: Path) -> None:
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, RECORD)
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    top = next(n for n, line in enumerate(lines) if line.startswith("name,"))
    path.write_text("".join([*lines[: top + 1], *lines[:top:-1]]), encoding="utf-8")
    assert read_session(path) == RECORD


def test_without_where_they_had_come_to_rest_patches_keep_their_points(tmp_path: Path) -> None:
    path = tmp_path / "a.pinwarp.csv"
    record = replace(RECORD, slid=None)
    write_session(path, record)
    assert read_session(path) == record
    assert ",curve," not in path.read_text(encoding="utf-8")


def test_what_had_come_to_rest_of_other_points_is_not_written(tmp_path: Path) -> None:
    """A session is saved after a count was changed and before anything slid again."""
    path = tmp_path / "a.pinwarp.csv"
    for groups in [(replace(RING, count=9),), (WHOLE,), (CREST, RING)]:
        write_session(path, replace(RECORD, groups=groups))
        assert read_session(path) == replace(RECORD, groups=groups, slid=None)


@pytest.mark.parametrize(
    ("found", "put", "words"),
    [
        (r"ring 2,handle.*\n", "", "'ring' lacks some of its rows"),
        (r"ring [123],handle.*\n", "", "ring: a closed curve goes through at least 3"),
        (r"cap 2,surface.*\n", "", "'cap' lacks some of its rows"),
        (r"ring 2,curve.*\n", "", "some of the points that slid are missing"),
        (r"(ring 2,curve)", r"ring 3,curve", "'ring' has no point 3"),
        (r"crest, left = 1 1\",curve", r'crest, left = 1 2",curve', "is excluded"),
        (r"(cap 2,surface.*\n)", r"\1\1", "'cap 2' is there twice"),
        (r"(ring 2,curve.*\n)", r"\1\1", "'ring 2' is there twice"),
        (r"cap 2,surface", "cap,surface", "no name of a group and a number"),
        (r"cap 2,surface", "cap 02,surface", "no name of a group and a number"),
        (r"cap 2,surface", "other 1,surface", "'cap' lacks some"),
        (r"# patch: points=1 name=whole\n", "", "points of 'whole', but no line"),
        (r"# patch: points=1 name=whole\n", "# patch: points=1\n", "has no name"),
        (r"points=1 name=whole", "points=2 name=whole", "'whole' lacks some of its rows"),
        (r"points=1 name=whole", "points=0 name=whole", "or has too many"),
        (r"points=1 name=whole", "points=-1 name=whole", "points of 'whole' is '-1', no number"),
        (r"points=1 name=whole", "points=9999 name=whole", "more than 5000 points"),
        (r"name=whole", "name=cap", "two groups are called 'cap'"),
        (r"closed=1", "closed=2", "closed of 'ring' is neither 0 nor 1"),
        (r"destination=drawn", "destination=maybe", "destination of 'ring' is 'maybe'"),
        (r"excluded=1", "excluded=7", "has no point 8"),
        (r"inside=0.5/0.25", "inside=0.25", "inside of 'cap' is no position"),
        (r"inside=0.5", "inside=x", "'x' is not a number"),
        (r"method=1", "method=x", "method of 'slid' is 'x', no number"),
        (r"(# slid: .*\n)", r"\1\1", "slid is given twice"),
        (r"# patch_around: ring\n", "# patch_around: ring\n# patch_around: ring\n", "no patch"),
        (r"cap 2,surface,1,2.0,2.5,2.0", "cap 2,surface,1,,,", "'cap 2' has no position on the"),
        (r"cap 2,surface,1,2.0", "cap 2,surface,1,two", "'two' is not a number"),
    ],
)
def test_damaged_groups_are_refused_in_words_not_half_read(
    tmp_path: Path, found: str, put: str, words: str
) -> None:
    path = tmp_path / "a.pinwarp.csv"
    write_session(path, RECORD)
    text, times = re.subn(found, put, path.read_text(encoding="utf-8"))
    assert times
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FileFormatError) as caught:
        read_session(path)
    assert words.lower() in str(caught.value).lower()
    assert str(caught.value).startswith("a.pinwarp.csv")


@settings(max_examples=300)
@given(random=st.randoms(use_true_random=False))
def test_any_change_gives_a_session_or_a_pinwarp_error(
    tmp_path_factory: pytest.TempPathFactory, random: Random
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.pinwarp.csv"
    write_session(path, RECORD)
    content = bytearray(path.read_bytes())
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
            b"=",
            b"#",
            b" ",
            b"1",
            b"/",
            b"\xc2\x85",
        ]
        content[place : place + random.choice([0, 1, 9])] = random.choice(junk)
    path.write_bytes(bytes(content))
    try:
        record = read_session(path)
    except PinwarpError:
        return
    write_session(path, record)
    assert read_session(path) == record
