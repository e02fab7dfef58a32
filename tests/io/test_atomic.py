from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from pinwarp.core.errors import words_of
from pinwarp.io import atomic
from pinwarp.io.atomic import atomic_path, sweep, write_atomically


def test_a_file_is_written_and_nothing_else_is_left(tmp_path: Path) -> None:
    write_atomically(tmp_path / "a.csv", "ä\r\nb\n")
    assert (tmp_path / "a.csv").read_bytes() == "ä\r\nb\n".encode()
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]


def test_the_temporary_file_is_beside_the_target_and_has_its_suffix(tmp_path: Path) -> None:
    with atomic_path(tmp_path / "bone.stl") as temporary:
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".stl"
        assert temporary.exists()


def test_when_the_block_fails_the_old_file_stays(tmp_path: Path) -> None:
    target = tmp_path / "a.csv"
    target.write_text("old")

    def interrupted() -> None:
        with atomic_path(target) as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_a_full_disk_stays_an_os_error_and_the_old_file_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "a.csv"
    target.write_text("old")

    def full(_handle: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(atomic.os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        write_atomically(target, "new")
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
def test_a_disk_that_fills_up_while_writing_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "a.csv"
    target.write_text("old")

    def write_to_full_disk(_path: Path, data: bytes) -> None:
        with open("/dev/full", "wb") as file:
            file.write(data)

    monkeypatch.setattr(Path, "write_bytes", write_to_full_disk)
    with pytest.raises(OSError, match="No space left"):
        write_atomically(target, "new")
    assert target.read_text() == "old"


@pytest.mark.skipif(os.name != "posix", reason="permissions are POSIX")
def test_permissions_of_an_existing_file_are_kept(tmp_path: Path) -> None:
    target = tmp_path / "a.csv"
    target.write_text("old")
    target.chmod(0o640)
    write_atomically(target, "new")
    assert target.stat().st_mode & 0o777 == 0o640


@pytest.mark.skipif(os.name != "posix", reason="the umask is POSIX")
def test_a_new_file_follows_the_umask(tmp_path: Path) -> None:
    (tmp_path / "usual").write_text("")
    write_atomically(tmp_path / "ours", "")
    assert (tmp_path / "ours").stat().st_mode == (tmp_path / "usual").stat().st_mode


@pytest.mark.skipif(os.name != "posix", reason="links need rights on Windows")
def test_a_symbolic_link_stays_and_its_target_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    real = tmp_path / "real" / "a.csv"
    real.write_text("old")
    link = tmp_path / "link.csv"
    link.symlink_to(real)
    write_atomically(link, "new")
    assert link.is_symlink()
    assert real.read_text() == "new"


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write anywhere")
def test_a_read_only_file_or_folder_is_refused(tmp_path: Path) -> None:
    target = tmp_path / "a.csv"
    target.write_text("old")
    target.chmod(0o444)
    with pytest.raises(PermissionError):
        write_atomically(target, "new")
    target.chmod(0o644)
    tmp_path.chmod(0o555)
    try:
        with pytest.raises(PermissionError):
            write_atomically(target, "new")
    finally:
        tmp_path.chmod(0o755)
    assert target.read_text() == "old"


def test_a_file_marked_read_only_is_not_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "a.csv"
    target.write_text("old")
    monkeypatch.setattr(atomic.os, "access", lambda *_: False)
    with pytest.raises(PermissionError):
        write_atomically(target, "new")
    assert target.read_text() == "old"


def test_a_missing_folder_or_a_folder_as_target_is_an_os_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        write_atomically(tmp_path / "no" / "a.csv", "")
    with pytest.raises(IsADirectoryError):
        write_atomically(tmp_path, "")
    assert list(tmp_path.iterdir()) == []


def test_an_error_of_the_system_names_the_file_and_not_the_temporary_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "femur.csv"

    def full(_handle: int) -> None:
        # As the system says it of a write: without a name.
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(atomic.os, "fsync", full)
    with pytest.raises(OSError, match="No space left") as found:
        write_atomically(target, "new")
    assert words_of(found.value) == f"{target}: No space left on device."

    def forbidden(path: Path, *_: object) -> int:
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    monkeypatch.setattr(atomic.os, "open", forbidden)
    with pytest.raises(PermissionError) as found:
        write_atomically(target, "new")
    assert words_of(found.value) == f"{target}: Permission denied."


def test_what_somebody_is_reading_just_now_is_replaced_a_moment_later(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # So Windows answers while another window, or what looks for viruses, has the file open.
    refusals, replace = [PermissionError(13, "Access is denied")] * 2, Path.replace

    def held_open(path: Path, target: Path) -> Path:
        if refusals:
            raise refusals.pop()
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", held_open)
    write_atomically(tmp_path / "a.csv", "old")
    assert (tmp_path / "a.csv").read_bytes() == b"old"
    refusals += [PermissionError(13, "Access is denied")] * 10
    with pytest.raises(PermissionError, match="denied"):
        write_atomically(tmp_path / "a.csv", "new")
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"old"]


def test_words_of_another_writer_are_kept(tmp_path: Path) -> None:
    def fail() -> None:
        with atomic_path(tmp_path / "a.png"):
            raise OSError("Is the disk full?")

    with pytest.raises(OSError, match=r"^Is the disk full\?$"):
        fail()


def left_behind(path: Path, age: float = 2 * atomic.SWEPT_AFTER) -> Path:
    path.write_text("half")
    then = path.stat().st_mtime - age
    os.utime(path, (then, then))
    return path


def test_what_a_killed_writer_left_is_swept_when_the_next_one_is_done(tmp_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", WRITE_HALF, str(tmp_path / "femur.pinwarp.csv")],
        stdout=subprocess.PIPE,
        text=True,
    ) as writer:
        assert writer.stdout.readline() == "half\n"
        writer.kill()
    (left,) = tmp_path.iterdir()
    write_atomically(tmp_path / "b.csv", "")
    assert left.exists(), "its writer may still be at it"
    then = left.stat().st_mtime - 2 * atomic.SWEPT_AFTER
    os.utime(left, (then, then))
    write_atomically(tmp_path / "b.csv", "")
    assert [path.name for path in tmp_path.iterdir()] == ["b.csv"]


WRITE_HALF = (
    "import sys, time; from pinwarp.io.atomic import atomic_path\n"
    "with atomic_path(sys.argv[1]) as temporary:\n"
    "    temporary.write_text('half'); print('half', flush=True); time.sleep(60)"
)


def test_only_what_is_old_and_ours_is_swept(tmp_path: Path) -> None:
    ours = [".pinwarp-0123456789ab", ".pinwarp-0123456789ab.stl"]
    others = [
        ".pinwarp-0123456789ab.stl.bak",
        ".pinwarp-0123456789AB.stl",
        ".pinwarp-settings",
        "pinwarp-0123456789ab.stl",
        ".pinwarp-0123456789abc.stl",
        "copy of .pinwarp-0123456789ab.stl",
    ]
    for name in (*ours, *others):
        left_behind(tmp_path / name)
    left_behind(tmp_path / ".pinwarp-aaaaaaaaaaaa.csv", age=60)
    (tmp_path / ".pinwarp-bbbbbbbbbbbb").mkdir()
    (tmp_path / ".pinwarp-cccccccccccc").symlink_to(tmp_path / ".pinwarp-settings")
    for name in (".pinwarp-bbbbbbbbbbbb", ".pinwarp-cccccccccccc"):
        os.utime(tmp_path / name, (0, 0), follow_symlinks=False)
    inner = tmp_path / "inner"
    inner.mkdir()
    left_behind(inner / ours[0])
    before = {path.name for path in tmp_path.iterdir()}
    sweep(tmp_path)
    assert before - {path.name for path in tmp_path.iterdir()} == set(ours)
    assert (inner / ours[0]).exists()


def test_a_folder_that_cannot_be_looked_into_is_left_alone(tmp_path: Path) -> None:
    sweep(tmp_path / "there is none")
