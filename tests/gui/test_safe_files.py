"""User stories: files that others change, move or have open, and disks that are full."""

from __future__ import annotations

import errno
import shutil
import threading

import pytest
from qtpy.QtCore import Qt, QTimer
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication, QMessageBox

from pinwarp.core.landmarks import Side
from pinwarp.core.mesh import Mesh
from pinwarp.gui.files import saving, session_meshes
from pinwarp.gui.files.file_dialogs import Answer, FileDialogs, OpenTwice, Overwrite
from pinwarp.io import backup
from pinwarp.io.file_names import backup_of
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.io.samples import assets_folder
from pinwarp.io.session_file import read_session

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
CONTROL = Qt.KeyboardModifier.ControlModifier


def open_and_edit(user, path) -> None:
    user.window.parts.documents.open_session(path)
    user.settle()
    user.click(SOURCE, user.free_place(SOURCE))
    assert user.editor.is_dirty


def save(user) -> None:
    user.press(Qt.Key.Key_S, CONTROL)


# Two windows


@pytest.mark.parametrize("answer", OpenTwice)
def test_a_session_open_in_another_window_is_asked_about(user, another_user, sample_copy, answer):
    open_and_edit(user, sample_copy)
    another_user.dialogs.open_twice = answer
    another_user.dialogs.opens = [sample_copy]
    # The journal of the other window speaks a moment after it has opened the session.
    another_user.qtbot.waitUntil(
        lambda: (
            (found := another_user.window.parts.recovery.window_with(sample_copy)) is not None
            and found.has_unsaved_work
        ),
        timeout=10_000,
    )
    another_user.trigger("open_session")
    ((name, where),) = another_user.dialogs.open_twice_questions
    assert name == "femur_sample"
    assert where.startswith("in another window since")
    assert where.endswith("with unsaved changes")
    opened = answer is not OpenTwice.CANCEL
    assert (len(another_user.session.pairs) == 16) == opened
    assert another_user.editor.path == (sample_copy if answer is OpenTwice.ANYWAY else None)


def test_a_window_may_open_its_own_session_again(user, sample_copy):
    for _ in range(2):
        user.window.parts.documents.open_session(sample_copy)
        user.settle()
        user.qtbot.wait(50)
    assert user.dialogs.open_twice_questions == []
    assert user.editor.path == sample_copy


@pytest.mark.parametrize("answer", Overwrite)
def test_a_file_that_was_changed_by_others_is_not_overwritten_unasked(
    user, sample_copy, tmp_path, answer
):
    open_and_edit(user, sample_copy)
    theirs = sample_copy.read_bytes().replace(b"# unit: mm", b"# unit: cm")
    sample_copy.write_bytes(theirs)
    user.dialogs.overwrite, user.dialogs.saves = answer, [tmp_path / "mine.pinwarp.csv"]
    save(user)
    assert len(user.dialogs.overwrite_questions) == 1
    if answer is Overwrite.OVERWRITE:
        assert len(read_session(sample_copy).landmarks) == len(user.session.landmarks)
        assert backup_of(sample_copy).read_bytes() == theirs
    else:
        assert sample_copy.read_bytes() == theirs
    assert user.editor.is_dirty == (answer is Overwrite.CANCEL)
    assert (tmp_path / "mine.pinwarp.csv").exists() == (answer is Overwrite.SAVE_AS)


def test_saving_again_and_again_asks_nothing(user, sample_copy):
    for _ in range(3):
        open_and_edit(user, sample_copy)
        save(user)
        user.click(SOURCE, user.free_place(SOURCE))
        save(user)
    assert user.dialogs.overwrite_questions == []
    assert not user.editor.is_dirty


def test_a_name_that_gets_a_suffix_does_not_overwrite_what_has_it(user, tmp_path):
    path = tmp_path / "femur.pinwarp.csv"
    path.write_text("theirs")
    user.open_sample()
    user.dialogs.saves = [tmp_path / "femur.csv"]
    user.trigger("save_as")
    assert user.dialogs.overwrite_questions == [("femur.pinwarp.csv", "is there already")]
    assert path.read_text() == "theirs"


# Backups and full disks


def test_saving_keeps_the_version_before(user, sample_copy):
    before = sample_copy.read_bytes()
    open_and_edit(user, sample_copy)
    save(user)
    assert backup_of(sample_copy).read_bytes() == before
    assert user.window.statusBar().currentMessage() == "Saved femur_sample.pinwarp.csv"


def test_a_backup_opens_as_a_new_session(user, sample_copy):
    before = sample_copy.read_bytes()
    open_and_edit(user, sample_copy)
    save(user)
    user.dialogs.opens = [backup_of(sample_copy)]
    user.trigger("open_session")
    assert len(user.session.pairs) == 16
    assert user.editor.path is None
    save(user)
    assert backup_of(sample_copy).read_bytes() == before


def test_a_backup_that_fails_is_told_and_the_session_saved(user, sample_copy, monkeypatch):
    def full(_path):
        raise OSError(errno.ENOSPC, "No space left on device", str(backup_of(sample_copy)))

    monkeypatch.setattr(backup, "atomic_path", full)
    open_and_edit(user, sample_copy)
    save(user)
    assert not user.editor.is_dirty
    assert len(read_session(sample_copy).landmarks) == len(user.session.landmarks)
    message = user.window.statusBar().currentMessage()
    assert "not its previous version" in message
    assert "No space left" in message


def test_a_full_disk_leaves_the_old_file_and_the_work(user, sample_copy, monkeypatch):
    def full(_path, _record):
        raise OSError(errno.ENOSPC, "No space left on device", str(sample_copy))

    before = sample_copy.read_bytes()
    open_and_edit(user, sample_copy)
    monkeypatch.setattr(saving, "write_session", full)
    save(user)
    assert "No space left" in user.dialogs.errors[0][1]
    assert sample_copy.read_bytes() == before
    assert user.editor.is_dirty
    assert not backup_of(sample_copy).exists()


def test_closing_is_called_off_when_the_save_fails(user, sample_copy, monkeypatch):
    def full(_path, _record):
        raise OSError(errno.ENOSPC, "No space left on device")

    open_and_edit(user, sample_copy)
    monkeypatch.setattr(saving, "write_session", full)
    user.dialogs.unsaved = Answer.SAVE
    user.window.close()
    assert user.window.isVisible()
    assert user.editor.is_dirty


# Meshes that moved or changed


def open_session(user, path) -> None:
    user.dialogs.opens = [path]
    user.trigger("open_session")


def test_a_mesh_that_moved_into_a_folder_is_found_without_a_question(user, sample_copy):
    moved = sample_copy.parent / "bones" / "femur_generic.ply"
    moved.parent.mkdir()
    (sample_copy.parent / "femur_generic.ply").rename(moved)
    open_session(user, sample_copy)
    assert user.session.source.path == moved
    assert user.dialogs.missing_questions == []
    assert user.dialogs.told == []
    assert "femur_generic.ply was found in" in user.window.statusBar().currentMessage()


def test_another_mesh_of_the_same_name_is_asked_about(user, sample_copy):
    other = sample_copy.parent / "bones" / "femur_generic.ply"
    other.parent.mkdir()
    (sample_copy.parent / "femur_generic.ply").unlink()
    shutil.copy(assets_folder() / "femur_subject.ply", other)
    open_session(user, sample_copy)
    ((side, path, found),) = user.dialogs.missing_questions
    assert (side, path.name, found) == ("source", "femur_generic.ply", other)
    assert user.session.mesh(SOURCE) is None
    # Having been asked, the user is not told again what they have accepted.
    user.dialogs.missing = other
    open_session(user, sample_copy)
    assert user.session.source.path == other
    assert user.dialogs.told == []


def test_beside_a_mesh_that_was_located_the_other_is_found(user, sample_copy, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    for name in ("femur_generic.ply", "femur_subject.ply"):
        (sample_copy.parent / name).rename(elsewhere / name)
    user.dialogs.missing = elsewhere / "femur_generic.ply"
    open_session(user, sample_copy)
    assert [question[0] for question in user.dialogs.missing_questions] == ["source"]
    assert user.session.destination.path == elsewhere / "femur_subject.ply"
    # The same for the next session whose meshes went there.
    open_session(user, sample_copy)
    assert len(user.dialogs.missing_questions) == 1


def test_a_mesh_that_changed_is_noticed_until_the_session_is_saved(user, sample_copy):
    path = sample_copy.parent / "femur_generic.ply"
    mesh = read_mesh(path).mesh
    write_mesh(path, Mesh(mesh.vertices, mesh.faces[: len(mesh.faces) // 2]))
    vertices, now = len(mesh.vertices), len(read_mesh(path).mesh.vertices)
    known = read_session(sample_copy).source_mesh.sha256
    for _ in range(2):
        open_session(user, sample_copy)
        title, text, _ = user.dialogs.told[-1]
        assert title == "A mesh has changed"
        assert f"it had {vertices:,} vertices and has {now:,} now" in text
        assert "no longer lie on the surface" in text
    assert len(user.session.pairs) == 16
    assert user.session.mesh(SOURCE) is not None
    assert read_session(sample_copy).source_mesh.sha256 == known
    save(user)
    assert read_session(sample_copy).source_mesh.sha256 == read_mesh(path).sha256
    open_session(user, sample_copy)
    assert len(user.dialogs.told) == 2


# The questions themselves


@pytest.mark.parametrize(
    ("label", "answer"),
    [
        ("Overwrite", Overwrite.OVERWRITE),
        ("Save As…", Overwrite.SAVE_AS),
        ("Cancel", Overwrite.CANCEL),
    ],
)
def test_the_buttons_of_a_question_mean_what_they_say(user, label, answer):
    def press():
        box = QApplication.activeModalWidget()
        assert isinstance(box, QMessageBox)
        (button,) = (button for button in box.buttons() if button.text() == label)
        user.qtbot.mouseClick(button, Qt.MouseButton.LeftButton)

    QTimer.singleShot(100, user.window, press)
    assert FileDialogs(user.window).ask_overwrite("femur.pinwarp.csv", "was changed") is answer


def test_escape_at_a_question_cancels(user):
    QTimer.singleShot(
        100,
        user.window,
        lambda: user.qtbot.keyClick(QApplication.activeModalWidget(), Qt.Key.Key_Escape),
    )
    asked = FileDialogs(user.window).ask_open_twice("femur", "in another window")
    assert asked is OpenTwice.CANCEL


def test_a_mesh_of_the_same_name_can_be_used(user, tmp_path):
    def press():
        (button,) = (
            button
            for button in QApplication.activeModalWidget().buttons()
            if button.text() == "Use That One"
        )
        user.qtbot.mouseClick(button, Qt.MouseButton.LeftButton)

    QTimer.singleShot(100, user.window, press)
    other = tmp_path / "femur.stl"
    asked = FileDialogs(user.window).ask_missing_mesh("source", tmp_path / "x" / "femur.stl", other)
    assert asked == other


# Work that is done while another session is read


@pytest.fixture
def slow_reading(monkeypatch):
    """Meshes are read once this is set."""
    gate = threading.Event()

    def read_later(*args, **kwargs):
        gate.wait(30)
        return read_mesh(*args, **kwargs)

    yield lambda: monkeypatch.setattr(session_meshes, "read_any_mesh", read_later) or gate
    gate.set()


def click_meanwhile(user, at) -> None:
    QTest.mouseClick(user.window.viewports[SOURCE], Qt.MouseButton.LeftButton, pos=at)
    user.qtbot.waitUntil(lambda: user.editor.is_dirty)


@pytest.mark.parametrize("answer", Answer)
def test_work_done_while_a_session_is_read_is_asked_about(
    user, sample_copy, tmp_path, slow_reading, answer
):
    user.open_sample()
    at, gate = user.free_place(SOURCE), slow_reading()
    user.dialogs.opens = [sample_copy]
    user.window.actions_by_key["open_session"].trigger()
    assert user.dialogs.unsaved_questions == 0
    click_meanwhile(user, at)
    mine, saved = user.session.landmarks, tmp_path / "mine.pinwarp.csv"
    user.dialogs.unsaved, user.dialogs.saves = answer, [saved]
    gate.set()
    user.settle()
    assert user.dialogs.unsaved_questions == 1
    if answer is Answer.CANCEL:
        assert (user.session.landmarks, user.editor.path) == (mine, None)
        assert user.window.statusBar().currentMessage() == "Nothing was opened: this session stays"
    else:
        assert user.editor.path == sample_copy
    if answer is Answer.SAVE:
        assert len(read_session(saved).landmarks) == len(mine)


def test_a_session_read_while_nothing_is_done_asks_nothing(user, sample_copy, slow_reading):
    user.open_sample()
    gate = slow_reading()
    for _ in range(2):
        user.window.parts.documents.open_session(sample_copy)
    gate.set()
    user.settle()
    assert user.dialogs.unsaved_questions == 0
    assert user.editor.path == sample_copy
