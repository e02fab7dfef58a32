"""Damaged landmark and session files: each gives a clear error or a correct reading."""

from __future__ import annotations

import math
import os
import random
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.settings import WarpSettings
from pinwarp.io.file_names import is_session
from pinwarp.io.landmark_files import FORMATS, read_landmarks, write_landmarks
from pinwarp.io.session_file import SessionRecord, read_session, write_session
from pinwarp.io.text import lines_of

from .landmark_formats.examples import EXAMPLES

LANDMARKS = (
    Landmark("fovea", (0.482677, -0.034081, 0.147277), (-0.09938, -0.28054, -0.0003)),
    Landmark('left, "real" tragus', (1e-7, 2.5, -3e20), (4, 5, 6), note="two\nlines"),
    Landmark("=1+1", (7, 8, 9), (1, 2, 3), enabled=False),
    Landmark("Höcker", None, (1, 2, 3)),
)

# What has no line to name: there is nothing in the file, or all of it is wrong.
WITHOUT_LINE = re.compile(
    "is empty|not a text file|too large|lines, and a landmark file|This is a session"
    r"|could be read\.|not a pinwarp session|table of landmarks is missing|newer pinwarp"
)


# Valid files to begin with


def valid_files(folder: Path) -> list[Path]:
    """A session, the example of every format, and a file of every format as we write it."""
    paths = [folder / "ours.pinwarp.csv"]
    write_session(paths[0], SessionRecord(LANDMARKS, settings=WarpSettings(0.0042), unit="m"))
    for number, example in enumerate(EXAMPLES):
        paths.append(folder / f"example{number}{example.suffix}")
        paths[-1].write_bytes(example.text.encode())
    for known in FORMATS:
        paths.append(folder / f"ours{known.SUFFIXES[0]}")
        write_landmarks(paths[-1], LANDMARKS, None if known.HOLDS.pairs else Side.SOURCE)
    return paths


@pytest.fixture(scope="module")
def originals(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return valid_files(tmp_path_factory.mktemp("valid"))


NUMBER_OF_FILES = 1 + len(EXAMPLES) + len(FORMATS)


# What must come out


def found_in(path: Path, content: bytes) -> tuple[Landmark, ...]:
    """Read, check that the outcome is a clear error or a sound reading, and return what it is."""
    path.write_bytes(content)
    count = len(lines_of(content.decode("latin-1").replace("\0", ""))) + 1
    try:
        if is_session(path):
            return sound(read_session(path).landmarks)
        reading = read_landmarks(path, Side.SOURCE)
    except FileFormatError as error:
        is_clear(error, path, count)
        return ()
    assert reading.format
    for skipped in reading.skipped:
        assert 1 <= skipped.line <= count
        assert 0 < len(skipped.reason) < 300
    return sound(reading.landmarks)


def is_clear(error: FileFormatError, path: Path, count: int) -> None:
    """Check that an error names the file, and the line where there is one."""
    text = str(error)
    assert text.startswith(path.name), text
    assert error.line is not None or "(line " in text or WITHOUT_LINE.search(text), text
    assert error.line is None or 1 <= error.line <= count, text
    assert text.endswith((".", "fovea,1.5,2,-3")) or "Expected are" in text, text
    assert len(text) < 600, text


def sound(landmarks: tuple[Landmark, ...]) -> tuple[Landmark, ...]:
    """Check that landmarks can be worked with and saved."""
    names = [landmark.name for landmark in landmarks]
    assert len(set(names)) == len(names)
    for landmark in landmarks:
        assert landmark.name.strip()
        landmark.name.encode()
        for side in Side:
            assert all(math.isfinite(value) for value in landmark.position(side) or ())
    return landmarks


@pytest.fixture(autouse=True)
def _no_test_hangs() -> Iterator[None]:
    """Far more than any of these takes, also on a busy machine."""
    if not hasattr(signal, "SIGALRM"):
        yield
        return

    def hangs(_number: int, _frame: object) -> None:
        raise AssertionError("reading hangs")

    before = signal.signal(signal.SIGALRM, hangs)
    signal.alarm(120)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


# The kinds of damage


def cut_off(data: bytes) -> Iterator[bytes]:
    """The file ends too early, at 40 places or more."""
    for end in range(0, len(data), max(1, len(data) // 40)):
        yield data[:end]


def noise(data: bytes) -> Iterator[bytes]:
    """Bytes that are no text stand somewhere in it."""
    dice = random.Random(1)
    for length in (1, 2, 7, 200):
        for _ in range(4):
            place = dice.randrange(len(data) + 1)
            yield data[:place] + dice.randbytes(length) + data[place:]
    yield dice.randbytes(3000)


def other_encodings(data: bytes) -> Iterator[bytes]:
    """It was saved in another encoding, or its mark says a wrong one."""
    text = data.decode()
    for encoding in ("utf-16", "utf-16-le", "utf-16-be", "utf-32", "latin-1", "cp1252", "utf-7"):
        yield text.encode(encoding, errors="replace")
    yield b"\xff\xfe" + data
    yield b"\xef\xbb\xbf\xef\xbb\xbf" + data
    yield data.decode("latin-1").encode()


def odd_numbers(data: bytes) -> Iterator[bytes]:
    """A number is none, not finite, huge, or written as nobody should."""
    numbers = list(re.finditer(rb"-?\d+\.?\d*", data))
    odd = (
        *(b"NaN", b"-nan", b"inf", b"Infinity", b"1e308", b"-1e999", b"1e-999", b"0x10", b"1_0"),
        *(b"", b"9999", b"NA", b"--1", b"1,5", b"1.2.3", b"9" * 5000, "١".encode()),
    )
    for number, word in enumerate(odd):
        for found in (numbers[(number * 5) % len(numbers)], numbers[-1]):
            yield data[: found.start()] + word + data[found.end() :]


def odd_rows(data: bytes) -> Iterator[bytes]:
    """Rows are doubled, missing, empty, swapped, or lose a column."""
    lines = data.splitlines(keepends=True)
    for number in range(len(lines)):
        rest = [*lines[:number], *lines[number + 1 :]]
        yield b"".join(rest)
        yield b"".join([*lines, lines[number]])
        yield b"".join([*lines[: number + 1], *lines[number:]])
        yield b"".join(
            [*lines[:number], lines[number].rpartition(b",")[0] + b"\n", *lines[number:]]
        )
        yield b"".join([*lines[:number], b"\n\n", *lines[number:]])
    yield b"".join(reversed(lines))


def other_separators(data: bytes) -> Iterator[bytes]:
    """Separators, quotes and line ends are others, or mixed."""
    for old, new in ((b",", b";"), (b",", b"\t"), (b" ", b","), (b'"', b"'"), (b'"', b'""')):
        yield data.replace(old, new)
        yield data.replace(old, new, 3)
    for new in (b"\r", b"\r\n", b"\n\r", b"\x0b", "\u2028".encode(), b""):
        yield data.replace(b"\n", new)
        yield data.replace(b"\n", new, 2)


def huge_fields(data: bytes) -> Iterator[bytes]:
    """Something in it is very long or very deep."""
    for filler in (b"x" * 150_000, b"[" * 50_000, b"<a>" * 20_000, b'"' * 99_999, b"\\" * 99_999):
        for share in (0.1, 0.5, 0.9):
            place = int(len(data) * share)
            yield data[:place] + filler + data[place:]


DAMAGES = (
    *(cut_off, noise, other_encodings, odd_numbers, odd_rows, other_separators),
    huge_fields,
)


def name_of(damage: Callable[[bytes], Iterator[bytes]]) -> str:
    return damage.__name__


@pytest.mark.parametrize("damage", DAMAGES, ids=name_of)
def test_a_damaged_file_gives_a_clear_error_or_a_sound_reading(
    originals: list[Path], tmp_path: Path, damage: Callable[[bytes], Iterator[bytes]]
) -> None:
    for original in originals:
        for content in damage(original.read_bytes()):
            found_in(tmp_path / original.name, content)


def test_the_damaged_files_are_many(originals: list[Path]) -> None:
    assert len(originals) == NUMBER_OF_FILES
    count = sum(len(list(damage(path.read_bytes()))) for path in originals for damage in DAMAGES)
    assert count >= 1200


def test_what_stands_before_the_end_of_a_cut_off_file_is_read_right_or_not_at_all(
    originals: list[Path], tmp_path: Path
) -> None:
    for original in originals:
        data = original.read_bytes()
        whole = found_in(tmp_path / original.name, data)
        assert whole
        for end in range(0, len(data), 7):
            found = found_in(tmp_path / original.name, data[:end])
            # Where nothing marks the end of a row, its last number may have lost digits.
            assert found[:-1] == whole[: max(0, len(found) - 1)], data[:end]


@settings(max_examples=600)
@given(number=st.integers(0, NUMBER_OF_FILES - 1), changes=st.randoms(use_true_random=False))
def test_any_change_to_a_file_gives_a_clear_error_or_a_sound_reading(
    originals: list[Path], number: int, changes: random.Random
) -> None:
    original = originals[number]
    content = bytearray(original.read_bytes())
    junk = (
        *(b"", b'"', b";", b",", b"\n", b"\r", b"\t", b" ", b"\0", b"\xff", b"nan", b"#", b"'="),
        *(b"=", b"{", b"}", b"[", b"]", b":", b"<", b">", b"/>", b"&", b"&#0;", b"\\u0000"),
        *(b"\\ud800", b"-", b"1e999", b"9999", b"NA", b"true", b"null", b"%", b"'#", b"LM3=9"),
    )
    for _ in range(changes.randint(1, 5)):
        place = changes.randrange(len(content) + 1)
        content[place : place + changes.choice([0, 1, 3, 20])] = changes.choice(junk)
    found_in(original.with_name(f"changed-{original.name}"), bytes(content))


# Files made to take time and memory

SIZE = (8 << 20) - 1000
ROWS = 19_900

WORST: dict[str, Callable[[], str]] = {
    "rows.csv": lambda: "".join(f"a{n},1.5,2.5,{n}.25\n" for n in range(ROWS)),
    "too-many-rows.csv": lambda: "a,1,2,3\n" * (SIZE // 8),
    "blank.csv": lambda: "\n" * SIZE,
    "bad-rows.csv": lambda: ("a,1,x,3" + "y" * 400 + "\n") * ROWS,
    "wide-rows.csv": lambda: ("1," * 200 + "\n") * ROWS,
    "one-line.csv": lambda: "," * SIZE,
    "unclosed.csv": lambda: '"a\n' * ROWS,
    "one-unclosed.csv": lambda: 'a,"' + '""' * (SIZE // 2),
    "not-ascii.csv": lambda: "é€✓" * (SIZE // 8),
    "lists.mrk.json": lambda: '{"markups":[' + "[]," * (SIZE // 3) + "0]}",
    "points.mrk.json": lambda: '{"markups":[{"controlPoints":[' + "{}," * 190_000 + "{}]}]}",
    "numbers.mrk.json": lambda: '{"markups":[{"controlPoints":[' + "1.5," * (SIZE // 4) + "0]}]}",
    "deep.mrk.json": lambda: '{"markups":' + "[" * 150_000,
    "keys.mrk.json": lambda: "{" + ",".join(f'"{n}":0' for n in range(SIZE // 11)) + "}",
    "digits.mrk.json": lambda: '{"markups":[{"controlPoints":[' + "9" * SIZE + "]}]}",
    "points.pp": lambda: "<PickedPoints>" + "<point/>" * (SIZE // 8),
    "deep.pp": lambda: "<PickedPoints>" + "<a>" * (SIZE // 3),
    "attribute.pp": lambda: '<PickedPoints a="' + "x" * SIZE,
    "attributes.pp": lambda: "<PickedPoints " + " ".join(f'a{n}=""' for n in range(SIZE // 12)),
    "words.pts": lambda: "Version 1.0\n1\n" + "1 " * (SIZE // 2),
    "specimens.tps": lambda: "LM3=1\n" * ROWS,
    "escapes.tag": lambda: 'MNI Tag Point File\nPoints =\n1 2 3 "' + "\\" * SIZE,
    "quotes.tag": lambda: "MNI Tag Point File\nPoints =\n1 2 3 " + '"' * SIZE,
    "rows.morphologika.txt": lambda: "[landmarks]\n19000\n[rawpoints]\n" + "1 2 3\n" * 19_000,
}

READ_EACH = """
import os, sys
from pathlib import Path
from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Side
from pinwarp.io.landmark_files import read_landmarks

def most_memory():
    (line,) = [x for x in Path("/proc/self/status").read_text().splitlines() if "VmHWM" in x]
    return int(line.split()[1]) // 1024

for path in sorted(Path(sys.argv[1]).iterdir()):
    if os.fork():
        os.wait()
        continue
    before = most_memory()
    try:
        read_landmarks(path, Side.SOURCE)
    except FileFormatError as error:
        assert str(error).startswith(path.name)
    print(path.name, most_memory() - before, flush=True)
    os._exit(0)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="asks Linux how much memory was taken")
def test_no_file_takes_more_than_200_megabytes(tmp_path: Path) -> None:
    for name, content in WORST.items():
        (tmp_path / name).write_text(content(), encoding="utf-8")
    # A process for each: nothing else is in its figure.
    command = [sys.executable, "-c", READ_EACH, str(tmp_path)]
    alone = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=alone)
    assert done.stderr == ""
    taken = dict(line.split() for line in done.stdout.splitlines())
    assert set(taken) == set(WORST)
    assert {name: megabytes for name, megabytes in taken.items() if int(megabytes) >= 200} == {}
