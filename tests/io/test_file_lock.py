"""Locks that the operating system lets go of when a process dies."""

from __future__ import annotations

import errno
import subprocess
import sys
from pathlib import Path

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
    def unsupported(_handle: int) -> None:
        raise OSError(errno.ENOSYS, "Function not implemented")

    monkeypatch.setattr(file_lock, "_lock", unsupported)
    lock = FileLock.take(path)
    assert lock is not None
    lock.release()
