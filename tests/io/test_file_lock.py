"""Locks that the operating system lets go of when a process dies."""

from __future__ import annotations

import errno
import subprocess
import sys
from pathlib import Path

import filelock
import pytest

from pinwarp.io import file_lock
from pinwarp.io.file_lock import FileLock

HOLD = (
    "import sys; from pathlib import Path; from pinwarp.io.file_lock import FileLock\n"
    "lock = FileLock.take(Path(sys.argv[1])); print(lock is not None, flush=True)\n"
    "sys.stdin.read()"
)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "lock"
    path.touch()
    return path


def test_a_lock_is_held_once_and_free_after_its_release(path: Path) -> None:
    lock = FileLock.take(path)
    assert FileLock.take(path) is None
    lock.release()
    lock.release()
    again = FileLock.take(path)
    assert again is not None
    again.release()


def test_a_killed_process_holds_its_lock_until_it_dies_and_no_longer(path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, str(path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as holder:
        assert holder.stdout.readline() == "True\n"
        assert FileLock.take(path) is None
        holder.kill()
        holder.wait()
    lock = FileLock.take(path)
    assert lock is not None
    lock.release()


def test_a_missing_file_cannot_be_locked(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        FileLock.take(tmp_path / "lock")


def test_a_file_system_without_locks_stands_in_nobodys_way(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unsupported(_handle: int, *, blocking: bool) -> bool:
        raise OSError(errno.ENOSYS, "Function not implemented")

    monkeypatch.setattr(file_lock, "lock_descriptor", unsupported)
    lock = FileLock.take(path)
    assert lock is not None
    lock.release()


def test_it_is_the_lock_that_other_programs_know(path: Path) -> None:
    other = filelock.FileLock(path, timeout=0, fallback_to_soft=False)
    with other:
        assert FileLock.take(path) is None
    lock = FileLock.take(path)
    assert lock is not None
    with pytest.raises(filelock.Timeout):
        other.acquire()
    lock.release()


def test_a_lock_leaves_nothing_behind_and_changes_nothing(path: Path) -> None:
    path.write_text("mine")
    lock = FileLock.take(path)
    assert lock is not None
    lock.release()
    assert [found.name for found in path.parent.iterdir()] == ["lock"]
    assert path.read_text() == "mine"


def test_a_folder_for_reading_only_can_be_locked_and_an_unreadable_file_says_so(
    path: Path,
) -> None:
    path.parent.chmod(0o500)
    try:
        lock = FileLock.take(path)
        assert lock is not None
        lock.release()
    finally:
        path.parent.chmod(0o700)
    with pytest.raises(IsADirectoryError):
        FileLock.take(path.parent)
