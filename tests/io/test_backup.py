"""Saving keeps the version before, and nothing about that can harm the save."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from pinwarp.io import backup
from pinwarp.io.atomic import write_atomically
from pinwarp.io.backup import write_keeping_previous
from pinwarp.io.file_names import backup_of, is_session


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "femur.pinwarp.csv"
    path.write_text("first")
    return path


def save(path: Path, text: str) -> OSError | None:
    return write_keeping_previous(path, lambda path: write_atomically(path, text))


def test_the_version_before_is_beside_the_file_and_no_session_to_the_dialogs(path: Path) -> None:
    assert save(path, "second") is None
    assert path.read_text() == "second"
    assert backup_of(path).read_text() == "first"
    assert not is_session(backup_of(path))
    assert save(path, "third") is None
    assert backup_of(path).read_text() == "second"


def test_a_first_save_has_no_backup(tmp_path: Path) -> None:
    assert save(tmp_path / "new.pinwarp.csv", "first") is None
    assert [path.name for path in tmp_path.iterdir()] == ["new.pinwarp.csv"]


def test_saving_twice_the_same_keeps_the_version_that_differs(path: Path) -> None:
    save(path, "second")
    save(path, "second")
    assert backup_of(path).read_text() == "first"


@pytest.mark.skipif(os.name != "posix", reason="permissions are POSIX")
def test_a_private_file_has_a_private_backup(path: Path) -> None:
    path.chmod(0o600)
    save(path, "second")
    assert backup_of(path).stat().st_mode & 0o777 == 0o600


def test_a_backup_that_cannot_be_written_does_not_stop_the_save(path: Path) -> None:
    backup_of(path).mkdir()
    problem = save(path, "second")
    assert isinstance(problem, IsADirectoryError)
    assert path.read_text() == "second"


def test_a_disk_that_is_full_for_the_backup_leaves_the_older_one(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save(path, "second")

    def full(_path: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(backup, "atomic_path", full)
    assert save(path, "third").errno == errno.ENOSPC
    assert path.read_text() == "third"
    assert backup_of(path).read_text() == "first"


def test_a_save_that_fails_leaves_the_file_and_its_backup(path: Path) -> None:
    save(path, "second")

    def full(_path: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with pytest.raises(OSError, match="No space left"):
        write_keeping_previous(path, full)
    assert path.read_text() == "second"
    assert backup_of(path).read_text() == "first"
