"""User stories: the program dies, and nothing is lost."""

from __future__ import annotations

import errno
import shutil
import threading
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

import pytest
from qtpy.QtCore import Qt
from qtpy.QtTest import QTest
from tests.gui.conftest import Driver, ScriptedDialogs, close_window, open_window

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.gui.app import begin
from pinwarp.gui.files import session_meshes
from pinwarp.gui.files.documents import Opening
from pinwarp.gui.files.file_dialogs import Answer
from pinwarp.gui.files.lost_work_dialog import (
    LostAnswer,
    LostWorkDialog,
    moment_in_words,
    question_about,
    words_about,
)
from pinwarp.io.meshes import read_mesh
from pinwarp.io.samples import assets_folder
from pinwarp.io.session_file import MeshReference, SessionRecord
from pinwarp.io.work_file import UnsavedWork, read_work
from pinwarp.session import edits
from pinwarp.session.keeping import journal
from pinwarp.session.keeping.journal import WORK
from pinwarp.session.keeping.recovery import LostWork
from pinwarp.session.session import to_record

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


@contextmanager
def next_start(user, folder: Path, *answers: LostAnswer, opening: Opening | None = None):
    """The program is started again, with the answers to its offers."""
    dialogs = ScriptedDialogs()
    dialogs.lost = list(answers)
    window = open_window(dialogs, folder, folder / "state")
    driver = Driver(window, dialogs, user.qtbot)
    begin(window, opening or Opening())
    driver.settle()
    try:
        yield driver
    finally:
        close_window(window, dialogs)


def work_files(state_folder: Path) -> list[Path]:
    return list(state_folder.glob(f"windows/*/{WORK}"))


def wait_until_kept(user, state_folder: Path) -> None:
    user.qtbot.waitUntil(lambda: bool(work_files(state_folder)), timeout=10_000)


def killed(state_folder: Path, tmp_path: Path) -> Path:
    """The disk as it is when the power goes: a folder in which no process holds a lock."""
    folder = tmp_path / "after"
    shutil.copytree(state_folder, folder / "state")
    return folder


def click_a_new_landmark(user) -> None:
    user.click(SOURCE, user.free_place(SOURCE))


@pytest.fixture
def crashed(user, sample_copy, state_folder, tmp_path):
    """The folder that is left when the window dies with a click that was not saved."""
    user.window.parts.documents.open_session(sample_copy)
    user.settle()
    click_a_new_landmark(user)
    wait_until_kept(user, state_folder)
    return killed(state_folder, tmp_path)


def test_after_a_crash_the_unsaved_work_is_restored_as_unsaved(user, crashed, sample_copy):
    before = sample_copy.read_bytes()
    with next_start(user, crashed, LostAnswer.RESTORE) as again:
        ((lost,),) = again.dialogs.lost_offers
        assert (lost.name, lost.pairs, lost.work.label) == ("femur_sample", 16, "Place landmark_0")
        assert to_record(again.session) == to_record(user.session)
        assert again.editor.is_dirty
        assert again.window.isWindowModified()
        assert again.window.windowTitle() == "femur_sample[*] – pinwarp"
        assert sample_copy.read_bytes() == before
        assert "Restored femur_sample" in again.window.statusBar().currentMessage()
        # Only now, and to the file it came from.
        again.press(Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
        assert again.dialogs.overwrite_questions == []
        assert len(sample_copy.read_text().splitlines()) == len(before.splitlines()) + 1


def test_the_guide_asks_on_where_it_was_and_stays_away_where_it_was_ended(
    user, sample_copy, state_folder, tmp_path
):
    user.window.parts.documents.open_session(sample_copy)
    user.settle()
    click_a_new_landmark(user)
    user.click(SOURCE, user.free_place(DESTINATION))

    def wait_until_guide_is_kept(name):
        def is_kept():
            return any(read_work(file).guided == name for file in work_files(state_folder))

        user.qtbot.waitUntil(is_kept, timeout=10_000)

    user.press(Qt.Key.Key_G)
    bar = user.window.parts.guidance.bar
    QTest.mouseClick(bar.skip, Qt.MouseButton.LeftButton)
    assert user.editor.view.guided == "landmark_1"
    wait_until_guide_is_kept("landmark_1")
    with next_start(user, killed(state_folder, tmp_path), LostAnswer.RESTORE) as again:
        assert again.editor.view.guided == "landmark_1"
        assert again.window.parts.guidance.bar.isVisible()
    # Ended, then restored in a window that asks for landmarks of its own.
    QTest.mouseClick(bar.end, Qt.MouseButton.LeftButton)
    wait_until_guide_is_kept(None)
    folder = killed(state_folder, tmp_path / "ended")
    with next_start(user, folder, LostAnswer.LATER) as again:
        again.open_sample()
        session = edits.remove_side(again.session, "fovea_capitis", DESTINATION)
        again.editor.commit(session, "Remove one")
        again.press(Qt.Key.Key_G)
        assert again.editor.view.guided == "fovea_capitis"
        again.dialogs.lost = [LostAnswer.RESTORE]
        again.trigger("restore")
        assert len(again.session.landmarks) == len(user.session.landmarks)
        assert again.editor.view.guided is None
        assert not again.window.parts.guidance.bar.isVisible()


def test_restored_work_survives_a_second_crash(user, crashed, tmp_path):
    with next_start(user, crashed, LostAnswer.RESTORE) as again:
        again.qtbot.waitUntil(
            lambda: len(list((crashed / "state" / "windows").iterdir())) == 1, timeout=10_000
        )
        (work,) = work_files(crashed / "state")
        twice = killed(crashed / "state", tmp_path / "second")
        assert work.parent.exists()
    assert work_files(crashed / "state") == []
    with next_start(user, twice, LostAnswer.RESTORE) as once_more:
        assert to_record(once_more.session) == to_record(user.session)


def test_work_done_while_lost_work_is_read_stays_when_the_user_says_so(user, crashed, monkeypatch):
    gate = threading.Event()
    with next_start(user, crashed, LostAnswer.LATER) as driver:
        driver.open_sample()
        at = driver.free_place(SOURCE)
        monkeypatch.setattr(
            session_meshes, "read_any_mesh", lambda *a, **k: gate.wait(30) and read_mesh(*a, **k)
        )
        driver.dialogs.lost, driver.dialogs.unsaved = [LostAnswer.RESTORE], Answer.CANCEL
        driver.window.actions_by_key["restore"].trigger()
        QTest.mouseClick(driver.window.viewports[SOURCE], Qt.MouseButton.LeftButton, pos=at)
        driver.qtbot.waitUntil(lambda: driver.editor.is_dirty)
        mine = driver.session.landmarks
        gate.set()
        driver.settle()
        assert driver.dialogs.unsaved_questions == 1
        assert (driver.session.landmarks, driver.editor.path) == (mine, None)
        driver.dialogs.lost, driver.dialogs.unsaved = [LostAnswer.RESTORE], Answer.DISCARD
        driver.trigger("restore")
        assert driver.editor.path is not None, "the lost work was still there to be restored"
        assert driver.editor.is_dirty


def test_discarded_work_is_gone_and_the_named_file_opens(user, crashed, sample_copy):
    opening = Opening(session=sample_copy)
    with next_start(user, crashed, LostAnswer.DISCARD, opening=opening) as again:
        assert work_files(crashed / "state") == []
        assert not again.editor.is_dirty
        assert len(again.session.pairs) == 16


def test_what_is_put_off_is_offered_again_from_the_menu(user, crashed):
    with next_start(user, crashed, LostAnswer.LATER, LostAnswer.RESTORE) as again:
        assert again.session.landmarks == ()
        assert len(work_files(crashed / "state")) == 1
        again.trigger("restore")
        assert to_record(again.session) == to_record(user.session)


def test_restored_work_comes_before_the_file_that_the_command_line_names(user, crashed):
    opening = Opening(source=assets_folder() / "femur_subject.ply")
    with next_start(user, crashed, LostAnswer.RESTORE, opening=opening) as again:
        assert to_record(again.session) == to_record(user.session)
        assert "not opened: femur_subject.ply" in again.window.statusBar().currentMessage()


def test_a_window_that_closes_properly_leaves_nothing_to_offer(user, state_folder):
    user.open_sample()
    click_a_new_landmark(user)
    wait_until_kept(user, state_folder)
    user.window.close()
    assert list((state_folder / "windows").iterdir()) == []


def test_a_living_window_is_not_offered_and_the_menu_says_so(user, another_user, state_folder):
    user.open_sample()
    click_a_new_landmark(user)
    wait_until_kept(user, state_folder)
    another_user.trigger("restore")
    assert another_user.dialogs.lost_offers == []
    assert another_user.dialogs.told[0][0] == "Nothing to restore"


def test_a_mesh_gone_since_the_crash_is_asked_for(user, crashed, sample_copy):
    (sample_copy.parent / "femur_generic.ply").unlink()
    with next_start(user, crashed, LostAnswer.RESTORE) as again:
        assert again.dialogs.missing_questions[0][0] == "source"
        assert to_record(again.session) == to_record(user.session)


def test_when_the_disk_is_full_it_is_said_once(user, monkeypatch):
    def full(_path, _work):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(journal, "write_work", full)
    monkeypatch.setattr(journal, "_RETRY", 0.01)
    user.open_sample()
    click_a_new_landmark(user)
    user.qtbot.waitUntil(lambda: bool(user.dialogs.errors), timeout=10_000)
    QTest.qWait(100)
    ((title, text),) = user.dialogs.errors
    assert title == "Unsaved work is not being kept"
    assert "save often" in text


def test_without_a_place_to_keep_work_the_window_works_and_says_so(user, tmp_path):
    (tmp_path / "after").mkdir()
    (tmp_path / "after" / "state").write_text("a file where a folder should be")
    with next_start(user, tmp_path / "after") as other:
        assert other.dialogs.errors[0][0] == "Unsaved work is not being kept"
        other.open_sample()
        assert len(other.session.pairs) == 16


# The dialog


def lost_work(folder: Path, name: str, label: str | None, path: Path | None = None) -> LostWork:
    record = SessionRecord(
        (Landmark("fovea", (1, 2, 3), (4, 5, 6)), Landmark("tip", (1, 2, 3))),
        source_mesh=MeshReference(Path("/bones/left.stl"), "ab", 3),
    )
    edited = datetime(datetime.now().year, 11, 22, 14, 3).astimezone()
    place = path or Path("/bones", f"{name}.pinwarp.csv")
    return LostWork(folder, UnsavedWork(record, place, "cd", label, edited))


def test_the_offer_says_what_would_be_restored_and_when_it_was_made(tmp_path):
    lost = lost_work(tmp_path, "femur", "Move landmark_4")
    assert question_about(lost) == (
        "pinwarp did not close properly on 22 November at 14:03.\n"
        "Restore femur (1 pair, last: Move landmark_4)?"
    )
    assert words_about(lost).splitlines()[0] == "2 landmarks on left.stl"
    assert "is gone" in words_about(lost)
    changed = tmp_path / "femur.pinwarp.csv"
    changed.write_text("another")
    assert "has changed since" in words_about(lost_work(tmp_path, "femur", None, changed))


def test_a_moment_of_another_year_names_it():
    assert moment_in_words(datetime(2019, 2, 3, 4, 5).astimezone()) == "3 February 2019 at 04:05"


@pytest.mark.parametrize(
    ("button", "answer"),
    [
        ("restore", LostAnswer.RESTORE),
        ("discard", LostAnswer.DISCARD),
        ("later", LostAnswer.LATER),
    ],
)
def test_each_button_means_what_it_says(qtbot, tmp_path, button, answer):
    dialog = LostWorkDialog([lost_work(tmp_path, "femur", None)])
    qtbot.addWidget(dialog)
    dialog.show()
    assert not dialog.list.isVisible()
    qtbot.mouseClick(getattr(dialog, button), Qt.MouseButton.LeftButton)
    assert dialog.answer is answer
    assert not dialog.isVisible()


def test_escape_puts_it_off_and_return_restores(qtbot, tmp_path):
    for key, answer in (
        (Qt.Key.Key_Escape, LostAnswer.LATER),
        (Qt.Key.Key_Return, LostAnswer.RESTORE),
    ):
        dialog = LostWorkDialog([lost_work(tmp_path, "femur", None)])
        qtbot.addWidget(dialog)
        dialog.show()
        QTest.keyClick(dialog, key)
        assert dialog.answer is answer


def test_of_several_the_chosen_one_is_restored(qtbot, tmp_path):
    found = [lost_work(tmp_path, name, "Move tip") for name in ("femur", "tibia", "pelvis")]
    dialog = LostWorkDialog(found)
    qtbot.addWidget(dialog)
    dialog.show()
    assert dialog.list.topLevelItemCount() == 3
    row = dialog.list.visualItemRect(dialog.list.topLevelItem(1))
    qtbot.mouseClick(dialog.list.viewport(), Qt.MouseButton.LeftButton, pos=row.center())
    assert "Restore tibia" in dialog.question.text()
    qtbot.mouseClick(dialog.restore, Qt.MouseButton.LeftButton)
    assert dialog.chosen is found[1]


def test_several_crashes_are_offered_until_all_are_dealt_with(user, crashed):
    (folder,) = (crashed / "state" / "windows").iterdir()
    shutil.copytree(folder, folder.with_name("another"))
    with next_start(user, crashed, LostAnswer.DISCARD, LostAnswer.RESTORE) as again:
        assert [len(found) for found in again.dialogs.lost_offers] == [2, 1]
        assert to_record(again.session) == to_record(user.session)
