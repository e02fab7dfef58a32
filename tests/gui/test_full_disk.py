"""The disk is full: what was there stays, nothing half written is left, and the file is named."""

from __future__ import annotations

import errno
import os

import pytest
from qtpy.QtCore import Qt

from pinwarp.gui.exporting.picture_dialogs import AnimationDialog, PictureDialog
from pinwarp.session import edits
from pinwarp.session.keeping import journal
from pinwarp.session.keeping.journal import WORK


def full(*_args):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.fixture(params=["fsync", "replace"])
def fill_the_disk(request, monkeypatch):
    """Let writing fail from now on: at the last of the content, or at the folder's entry."""
    return lambda: monkeypatch.setattr(os, request.param, full)


def content_of(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def told(user, name):
    """What the user reads; the name of the file is in it, and no other file's."""
    ((title, text),) = user.dialogs.errors
    assert name in title
    assert "No space left on device" in text
    assert ".pinwarp-" not in title + text
    return title + text


def test_saving_leaves_the_file_and_the_work(user, sample_copy, fill_the_disk):
    user.window.parts.documents.open_session(sample_copy)
    user.settle()
    before = content_of(sample_copy.parent)
    user.editor.commit(edits.set_penalty(user.session, 7.0), "Change penalty")
    user.settle()
    fill_the_disk()
    user.press(Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
    assert "Nothing was lost" in told(user, sample_copy.name)
    assert content_of(sample_copy.parent) == before
    assert user.editor.is_dirty
    assert user.session.settings.penalty == 7.0


@pytest.mark.parametrize(
    ("action", "name"),
    [
        ("export_report", "report.html"),
        ("export_mesh", "bone.stl"),
        ("export_mesh", "bone.vtk"),
        ("export_coefficients", "warp.json"),
        ("export_script", "warp.py"),
        ("export_pairs", "pairs.csv"),
        ("export_animation", "turn.gif"),
        ("export_picture", "views.png"),
    ],
)
def test_an_export_leaves_what_was_there(user, tmp_path, fill_the_disk, action, name):
    user.open_sample()
    folder = tmp_path / "exports"
    folder.mkdir()
    (folder / name).write_text("what was there")
    fill_the_disk()
    user.dialogs.saves = [folder / name]
    user.trigger(action)
    for kind in (AnimationDialog, PictureDialog):
        for dialog in user.window.findChildren(kind):
            for box in (dialog.image_width, dialog.image_height, getattr(dialog, "frames", None)):
                if box is not None:
                    box.setValue(box.minimum())
            dialog.export.click()
            user.settle()
    told(user, name)
    assert content_of(folder) == {name: b"what was there"}


def test_work_that_found_no_room_is_kept_once_there_is_some(user, state_folder, monkeypatch):
    monkeypatch.setattr(journal, "_RETRY", 0.1)
    user.open_sample()
    windows = state_folder / "windows"
    with monkeypatch.context() as disk:
        disk.setattr(os, "fsync", full)
        user.editor.commit(edits.set_penalty(user.session, 7.0), "Change penalty")
        user.qtbot.waitUntil(lambda: bool(user.dialogs.errors), timeout=10_000)
        # It is tried again and again, and said once.
        user.qtbot.wait(500)
        assert [title for title, _ in user.dialogs.errors] == ["Unsaved work is not being kept"]
        assert not list(windows.glob(f"*/{WORK}"))
    user.qtbot.waitUntil(lambda: bool(list(windows.glob(f"*/{WORK}"))), timeout=10_000)
