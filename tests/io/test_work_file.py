"""Unsaved work on the disk comes back as it was."""

from __future__ import annotations

import tempfile
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.errors import FileFormatError
from pinwarp.io.session_file import MeshReference, SessionRecord, read_session, write_session
from pinwarp.io.work_file import UnsavedWork, read_work, write_work
from tests.io.strategies import landmark_lists, texts, trimmed_names

NOW = datetime(2024, 11, 22, 13, 3, tzinfo=UTC)


@given(landmark_lists(trimmed_names), texts, st.none() | texts)
def test_unsaved_work_comes_back_as_it_was(landmarks, name, label):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "work.pinwarp.csv")
        work = UnsavedWork(
            SessionRecord(tuple(landmarks)), Path("/bones", f"{name}.csv"), "ab", label, NOW
        )
        write_work(path, work)
        again = read_work(path)
        assert [a.name for a in again.record.landmarks] == [a.name for a in landmarks]
        assert (again.path, again.label, again.edited) == (work.path, label, NOW)


def test_meshes_are_named_by_their_absolute_paths(tmp_path: Path) -> None:
    mesh = MeshReference(tmp_path / "bones" / "femur.stl", "ab", 3)
    path = tmp_path / "state" / "work.pinwarp.csv"
    path.parent.mkdir()
    write_work(path, UnsavedWork(SessionRecord(source_mesh=mesh), None, None, None, NOW))
    moved = path.rename(tmp_path / "work.pinwarp.csv")
    assert read_work(moved).record.source_mesh == mesh


def test_what_another_journal_has_left_in_a_session_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "work.pinwarp.csv"
    write_work(path, UnsavedWork(SessionRecord(), None, None, "first", NOW))
    # Somebody has opened the journal by hand as a session.
    write_work(path, UnsavedWork(read_session(path), None, None, "second", NOW))
    assert read_work(path).label == "second"
    assert read_work(path).record == SessionRecord()


@pytest.mark.parametrize("text", ["", "[]", "{", '{"path": 1}', '{"path": null, "edited": "x"}'])
def test_a_session_without_what_makes_it_a_journal_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "work.pinwarp.csv"
    write_session(path, SessionRecord(unknown=(("unsaved_work", text),)))
    with pytest.raises(FileFormatError, match="unsaved work"):
        read_work(path)
