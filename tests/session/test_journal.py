"""Unsaved work is on the disk a moment after it was done, whatever happens then."""

from __future__ import annotations

import errno
import shutil
import tempfile
import time
from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.session_file import MeshReference, SessionRecord, write_session
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.keeping import journal
from pinwarp.session.keeping.journal import WORK, Journal
from pinwarp.session.keeping.recovery import find_lost_work, window_with
from pinwarp.session.session import Session, to_record


@pytest.fixture
def windows(tmp_path: Path) -> Path:
    return tmp_path / "state" / "windows"


@contextmanager
def keeping(editor: Editor, windows: Path, failures: list[Exception] | None = None):
    """A journal that is closed in the end."""
    told = [] if failures is None else failures
    kept = Journal(editor, windows, failed=told.append)
    try:
        yield kept
    finally:
        kept.close()
    assert failures is not None or told == []


def eventually(condition: Callable[[], bool], seconds: float = 10.0) -> bool:
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True


def lost_if_killed_now(windows: Path):
    """What a next start would find, were the process killed at this moment."""
    with tempfile.TemporaryDirectory() as folder:
        # In the copy nobody holds the locks: the kernel lets go of them when a process dies.
        copy = Path(folder, "windows")
        copy.mkdir()
        for window in windows.iterdir():
            (copy / window.name).mkdir()
            for file in window.iterdir():
                try:
                    shutil.copy(file, copy / window.name)
                except FileNotFoundError:
                    continue  # replaced or removed this very moment
        return find_lost_work(copy)


def is_kept(editor: Editor, windows: Path) -> bool:
    found = lost_if_killed_now(windows)
    if not editor.is_dirty:
        return found == []
    return [lost.work.record for lost in found] == [to_record(editor.committed)]


def a_session() -> Session:
    return Session(
        source=MeshReference(Path("/bones/left femur.stl"), "ab", 456),
        landmarks=(Landmark("fovea", (1, 2, 3), (4, 5, 6)), Landmark("tip", (0.1, 0.2, 0.3))),
        unknown=(("by", "Ada"),),
    )


def test_a_change_is_kept_with_its_label_time_and_file(windows: Path, tmp_path: Path) -> None:
    editor, path = Editor(), tmp_path / "femur.pinwarp.csv"
    with keeping(editor, windows):
        editor.replace_all(a_session(), path, sha256="cd")
        editor.commit(edits.rename(editor.session, "tip", "apex"), "Rename tip")
        assert eventually(lambda: is_kept(editor, windows))
        (lost,) = lost_if_killed_now(windows)
    assert (lost.name, lost.pairs) == ("femur", 1)
    assert (lost.work.path, lost.work.sha256, lost.work.label) == (path, "cd", "Rename tip")
    assert abs(time.time() - lost.work.edited.timestamp()) < 10
    assert lost.work.record.source_mesh.path == Path("/bones/left femur.stl")
    assert lost.work.record.unknown == (("by", "Ada"),)


def test_the_first_change_is_written_at_once(windows: Path) -> None:
    editor = Editor()
    with keeping(editor, windows):
        time.sleep(journal.PAUSE + 0.1)
        with mock.patch.object(journal, "PAUSE", 60.0):
            editor.commit(a_session(), "Open")
            assert eventually(lambda: is_kept(editor, windows))


def test_a_drag_is_kept_only_once_it_has_ended(windows: Path) -> None:
    editor = Editor(a_session())
    with keeping(editor, windows), mock.patch.object(journal, "write_work") as written:
        for x in range(5):
            editor.preview(edits.move(editor.committed, "tip", Side.SOURCE, (x, 0, 0)))
            time.sleep(0.02)
        time.sleep(journal.PAUSE)
        assert not written.called
        editor.commit(edits.move(editor.committed, "tip", Side.SOURCE, (4, 0, 0)), "Move tip")
        assert eventually(lambda: written.called)


def test_undoing_everything_leaves_nothing_to_be_restored(windows: Path) -> None:
    editor = Editor(a_session())
    with keeping(editor, windows):
        editor.commit(edits.remove(editor.session, ["tip"]), "Delete tip")
        assert eventually(lambda: len(lost_if_killed_now(windows)) == 1)
        editor.undo()
        assert eventually(lambda: lost_if_killed_now(windows) == [])


def test_saving_and_closing_remove_the_journal(windows: Path, tmp_path: Path) -> None:
    editor = Editor(a_session())
    with keeping(editor, windows) as kept:
        editor.commit(edits.remove(editor.session, ["tip"]), "Delete tip")
        assert eventually((kept.folder / WORK).exists)
        editor.mark_saved(tmp_path / "a.pinwarp.csv")
        assert eventually(lambda: not (kept.folder / WORK).exists())
        editor.commit(edits.remove(editor.session, ["fovea"]), "Delete fovea")
        assert eventually((kept.folder / WORK).exists)
    assert list(windows.iterdir()) == []


def test_closing_right_after_a_change_leaves_nothing(windows: Path) -> None:
    for _ in range(20):
        editor = Editor()
        with keeping(editor, windows):
            editor.commit(a_session(), "Open")
        assert list(windows.iterdir()) == []


def test_the_work_of_a_living_window_is_not_offered(windows: Path) -> None:
    editor = Editor()
    with keeping(editor, windows):
        editor.commit(a_session(), "Open")
        assert eventually(lambda: is_kept(editor, windows))
        assert find_lost_work(windows) == []
        # Looking must not have taken anything from it.
        assert is_kept(editor, windows)


def test_a_full_disk_is_told_and_the_work_kept_once_there_is_room(
    windows: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    editor, failures = Editor(), []
    monkeypatch.setattr(journal, "_RETRY", 0.05)
    write, full = journal.write_work, [True]

    def write_if_there_is_room(path, work):
        if full[0]:
            raise OSError(errno.ENOSPC, "No space left on device")
        write(path, work)

    monkeypatch.setattr(journal, "write_work", write_if_there_is_room)
    with keeping(editor, windows, failures):
        editor.commit(a_session(), "Open")
        assert eventually(lambda: len(failures) > 1)
        assert "No space left" in str(failures[0])
        full[0] = False
        assert eventually(lambda: is_kept(editor, windows))


def test_a_folder_that_was_tidied_up_is_made_again(windows: Path) -> None:
    editor = Editor()
    with keeping(editor, windows) as kept:
        editor.commit(a_session(), "Open")
        assert eventually(lambda: is_kept(editor, windows))
        shutil.rmtree(windows)
        editor.commit(edits.remove(editor.session, ["tip"]), "Delete tip")
        assert eventually((kept.folder / WORK).exists)


def a_dead_window(windows: Path, session: Session | None = None, label: str = "Open") -> Path:
    """A window's folder as a kill leaves it."""
    editor = Editor()
    with keeping(editor, windows) as kept:
        editor.commit(session or a_session(), label)
        assert eventually((kept.folder / WORK).exists)
        copy = windows.parent / kept.folder.name
        shutil.copytree(kept.folder, copy)
    return Path(shutil.move(copy, windows))


def test_several_dead_windows_are_listed_the_latest_first(windows: Path) -> None:
    for label in ("first", "second", "third"):
        a_dead_window(windows, label=label)
    assert [lost.work.label for lost in find_lost_work(windows)] == ["third", "second", "first"]


def test_discarded_work_is_gone_and_other_work_stays(windows: Path) -> None:
    a_dead_window(windows, label="kept")
    a_dead_window(windows, label="discarded")
    find_lost_work(windows)[0].discard()
    assert [lost.work.label for lost in find_lost_work(windows)] == ["kept"]


def test_a_dead_window_without_work_is_tidied_up(windows: Path) -> None:
    folder = a_dead_window(windows)
    (folder / WORK).unlink()
    # What a kill in the middle of a write leaves.
    (folder / ".pinwarp-0123.csv").write_text("# pinwarp-se")
    assert find_lost_work(windows) == []
    assert not folder.exists()


def test_work_that_cannot_be_read_is_kept_and_not_offered(windows: Path) -> None:
    folder = a_dead_window(windows)
    (folder / WORK).write_text("# pinwarp-session: 99\n")
    assert find_lost_work(windows) == []
    assert (folder / WORK).exists()


def test_a_session_that_is_no_journal_is_not_offered(windows: Path) -> None:
    folder = a_dead_window(windows)
    write_session(folder / WORK, SessionRecord())
    assert find_lost_work(windows) == []


def test_restored_work_stays_where_it_was_until_it_is_kept_anew(
    windows: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    dead = a_dead_window(windows)
    (lost,) = find_lost_work(windows)
    editor, failures, full, write = Editor(), [], [True], journal.write_work
    monkeypatch.setattr(journal, "_RETRY", 0.05)

    def write_if_there_is_room(path, work):
        if full[0]:
            raise OSError(errno.ENOSPC, "No space left on device")
        write(path, work)

    monkeypatch.setattr(journal, "write_work", write_if_there_is_room)
    with keeping(editor, windows, failures) as kept:
        lock = lost.claim()
        assert lost.claim() is None, "no other process can take it"
        editor.replace_all(a_session(), None, saved=False)
        kept.inherit(dead, lock)
        assert eventually(lambda: len(failures) > 1)
        assert (dead / WORK).exists()
        full[0] = False
        assert eventually(lambda: not dead.exists())
        assert is_kept(editor, windows)


def test_a_session_open_in_another_window_is_noticed(windows: Path, tmp_path: Path) -> None:
    path = tmp_path / "femur.pinwarp.csv"
    write_session(path, SessionRecord())
    one, other = Editor(), Editor()
    with keeping(one, windows) as mine, keeping(other, windows) as theirs:
        assert window_with(windows, path, mine.folder) is None
        other.replace_all(a_session(), path)
        assert eventually(lambda: window_with(windows, path, mine.folder) is not None)
        assert window_with(windows, path, theirs.folder) is None, "it does not meet itself"
        found = window_with(windows, tmp_path / "." / path.name, mine.folder)
        assert not found.has_unsaved_work
        other.commit(edits.remove(other.session, ["tip"]), "Delete tip")
        assert eventually(lambda: window_with(windows, path, mine.folder).has_unsaved_work)
        assert window_with(windows, path, mine.folder).since == found.since
    assert window_with(windows, path, mine.folder) is None


steps = st.lists(
    st.sampled_from(["add", "move", "remove", "undo", "redo", "preview", "save", "open"]),
    min_size=1,
    max_size=12,
)


@settings(max_examples=30)
@given(steps)
def test_after_any_sequence_of_changes_the_newest_session_is_kept(sequence: list[str]) -> None:
    rng = np.random.default_rng(len(sequence))
    with (
        tempfile.TemporaryDirectory() as folder,
        mock.patch.object(journal, "PAUSE", 0.01),
    ):
        windows, editor = Path(folder, "windows"), Editor()
        with keeping(editor, windows):
            for step in sequence:
                take(step, editor, tuple(rng.normal(size=3)), Path(folder))
            assert eventually(lambda: is_kept(editor, windows)), sequence


def take(step: str, editor: Editor, place: tuple[float, float, float], folder: Path) -> None:
    """Do one thing as a user would."""
    names = [landmark.name for landmark in editor.committed.landmarks]
    match step:
        case "add":
            session, name = edits.place(editor.committed, Side.SOURCE, place)
            editor.commit(session, f"Add {name}")
        case "move" if names:
            editor.commit(edits.move(editor.committed, names[0], Side.SOURCE, place), "Move")
        case "preview" if names:
            editor.preview(edits.move(editor.committed, names[-1], Side.SOURCE, place))
        case "remove" if names:
            editor.commit(edits.remove(editor.committed, names[:1]), "Delete")
        case "undo":
            editor.undo()
        case "redo":
            editor.redo()
        case "save":
            editor.mark_saved(folder / "a.pinwarp.csv")
        case "open":
            editor.replace_all(a_session(), folder / "b.pinwarp.csv")


def test_of_steady_work_never_more_than_two_seconds_are_missing(windows: Path) -> None:
    editor = Editor(a_session())
    states: list[tuple[float, SessionRecord]] = [(time.monotonic(), to_record(editor.session))]
    losses = []
    with keeping(editor, windows):
        for i in range(120):
            editor.commit(edits.move(editor.session, "tip", Side.SOURCE, (i, 0, 0)), "Move tip")
            states.append((time.monotonic(), to_record(editor.session)))
            time.sleep(0.015)
            if i % 9 == 8:
                killed = time.monotonic()
                found = lost_if_killed_now(windows)
                records = [record for _, record in states]
                index = records.index(found[0].work.record) if found else 0
                replaced = states[index + 1][0] if index + 1 < len(states) else killed
                losses.append(killed - replaced)
    assert max(losses) < 2.0
