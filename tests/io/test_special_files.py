"""What is no file, has no end or is too large: told in words by every reader, at once."""

from __future__ import annotations

import io
import os
import socket
import sys
import threading
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Side
from pinwarp.io import backup, reading
from pinwarp.io.atomic import write_atomically
from pinwarp.io.coefficients import read_coefficients
from pinwarp.io.landmark_files import read_landmarks
from pinwarp.io.manifest import read_manifest
from pinwarp.io.meshes import MESH_SUFFIXES, read_mesh
from pinwarp.io.reading import hash_of, read_content
from pinwarp.io.session_file import read_session
from pinwarp.io.summary_file import read_summary
from pinwarp.io.template import read_template

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pipes have no names there")

READERS: list[tuple[str, Callable[[Path], object]]] = [
    *((f"bone{suffix}", read_mesh) for suffix in MESH_SUFFIXES),
    ("a.csv", lambda path: read_landmarks(path, Side.SOURCE)),
    ("a.mrk.json", lambda path: read_landmarks(path, Side.SOURCE)),
    ("a.pp", lambda path: read_landmarks(path, Side.SOURCE)),
    ("study.csv", read_manifest),
    ("a.pinwarp.csv", read_session),
    ("template.csv", read_template),
    ("warp.json", read_coefficients),
    ("warp.npz", read_coefficients),
]
every_reader = pytest.mark.parametrize(("name", "read"), READERS, ids=[name for name, _ in READERS])


def in_time(read: Callable[[Path], object], path: Path) -> str:
    """Return what a reader complains about; a reader that waits fails instead of hanging."""
    told: list[str] = []

    def attempt() -> None:
        with pytest.raises(FileFormatError) as found:
            read(path)
        told.append(str(found.value))

    reader = threading.Thread(target=attempt, daemon=True)
    reader.start()
    reader.join(20)
    assert told, f"{path.name} was waited for"
    return told[0]


@every_reader
def test_a_pipe_that_nobody_writes_to_is_refused(tmp_path, name, read):
    os.mkfifo(tmp_path / name)
    words = in_time(read, tmp_path / name)
    assert words.startswith(f"{name}: ")
    assert "a pipe and not a file. Save what comes from it to a file" in words


@every_reader
def test_a_device_without_an_end_is_refused(tmp_path, name, read):
    (tmp_path / name).symlink_to("/dev/zero")
    words = in_time(read, tmp_path / name)
    assert words.startswith(f"{name}: ")
    assert "a device and not a file" in words


@every_reader
def test_a_link_that_loops_is_refused(tmp_path, name, read):
    (tmp_path / name).symlink_to(name)
    assert "symbolic links" in in_time(read, tmp_path / name)


@every_reader
def test_a_sparse_file_of_five_gigabytes_is_refused_before_it_is_read(
    tmp_path, name, read, monkeypatch
):
    with (tmp_path / name).open("wb") as file:
        file.truncate(5 << 30)

    def forbidden(_file: io.FileIO) -> bytes:
        raise AssertionError("it was read")

    monkeypatch.setattr(reading, "_next_chunk", forbidden)
    assert "5.0 GB is too large for" in in_time(read, tmp_path / name)


def test_sockets_and_folders_are_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.stl").mkdir()
    assert "This is a folder. Choose the mesh file" in in_time(read_mesh, tmp_path / "folder.stl")
    with socket.socket(socket.AF_UNIX) as server:
        # Names of sockets are short.
        server.bind("bone.stl")
        assert "a socket and not a file" in in_time(read_mesh, tmp_path / "bone.stl")


def test_the_limit_is_on_what_is_read_and_not_on_what_the_system_says(tmp_path, monkeypatch):
    path = tmp_path / "endless.csv"
    path.write_bytes(b"a")
    monkeypatch.setattr(reading, "_next_chunk", lambda _file: b"a" * 1000)
    with pytest.raises(FileFormatError, match=r"goes on and on.*at most 0 MB"):
        read_content(path, what="session", largest=100_000)


def test_a_file_that_the_system_gives_no_size_is_read():
    assert read_content("/proc/self/status", what="text").data.startswith(b"Name:")


def test_a_file_without_an_end_is_not_waited_for(tmp_path, monkeypatch):
    path = tmp_path / "log.csv"
    path.write_bytes(b"a")
    monkeypatch.setattr(reading.io, "FileIO", type("Log", (io.FileIO,), {"read": lambda *_: None}))
    with pytest.raises(FileFormatError, match="it has no end"):
        read_content(path, what="session")


def test_what_is_no_file_has_no_hash(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "zero").symlink_to("/dev/zero")
    with (tmp_path / "sparse").open("wb") as file:
        file.truncate(5 << 30)
    assert [hash_of(tmp_path / name) for name in ("pipe", "zero", "sparse")] == [None] * 3


def test_a_summary_that_is_a_pipe_is_none(tmp_path):
    os.mkfifo(tmp_path / "summary.csv")
    assert read_summary(tmp_path / "summary.csv") == {}


@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.symlink_to("/dev/full")])
def test_nothing_is_written_in_the_place_of_what_is_no_file(tmp_path, make):
    path = tmp_path / "a.pinwarp.csv"
    make(path)
    with pytest.raises(OSError, match="and not a file") as found:
        backup.write_keeping_previous(path, lambda place: write_atomically(place, "new"))
    assert Path(found.value.filename).name in ("a.pinwarp.csv", "full")
    assert not path.is_file()


def test_an_archive_that_unpacks_to_gigabytes_is_refused(tmp_path):
    path = tmp_path / "warp.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("weights.npy", bytes(80 << 20))
    with pytest.raises(FileFormatError, match="unpacks to more than any warp has"):
        read_coefficients(path)


@pytest.mark.parametrize(
    "text", ["[" * 100_000, '{"format": "pinwarp-coefficients", "format": "other"}']
)
def test_json_that_is_no_coefficients_is_refused(tmp_path, text):
    path = tmp_path / "warp.json"
    path.write_text(text)
    with pytest.raises(FileFormatError, match=r"Export them again"):
        read_coefficients(path)
