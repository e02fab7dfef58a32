"""Files that are removed while a window has them open: nothing is lost in silence."""

from __future__ import annotations

import shutil

import pytest
from qtpy.QtCore import Qt

from pinwarp.core.landmarks import Side
from pinwarp.gui.files.file_dialogs import Answer
from pinwarp.io.meshes import read_mesh
from pinwarp.io.session_file import read_session
from pinwarp.io.work_file import read_work
from pinwarp.session import edits
from pinwarp.session.keeping.journal import WORK


@pytest.fixture
def saved(user, sample_copy):
    """A window on a session without unsaved changes."""
    user.window.parts.documents.open_session(sample_copy)
    user.settle()
    return user


def save(user):
    user.press(Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)


def change(user):
    session = edits.set_penalty(user.session, user.session.settings.penalty + 1)
    user.editor.commit(session, "Change penalty")
    user.settle()


def test_closing_asks_when_the_only_file_of_the_session_is_gone(saved, sample_copy):
    before = read_session(sample_copy)
    sample_copy.unlink()
    saved.dialogs.unsaved = Answer.CANCEL
    saved.window.close()
    assert saved.window.isVisible()
    assert saved.dialogs.unsaved_reasons == [
        f"{sample_copy.name} is not in {sample_copy.parent} any more."
    ]
    assert saved.window.isWindowModified()
    save(saved)
    assert read_session(sample_copy) == before
    saved.window.close()
    assert not saved.window.isVisible()
    assert saved.dialogs.unsaved_questions == 1


def test_closing_asks_nothing_while_the_file_is_there(saved):
    saved.window.close()
    assert not saved.window.isVisible()
    assert saved.dialogs.unsaved_questions == 0


def test_work_that_cannot_go_back_into_its_folder_is_kept_in_the_journal(
    saved, sample_copy, state_folder
):
    shutil.rmtree(sample_copy.parent)
    save(saved)
    ((title, text),) = saved.dialogs.errors
    assert sample_copy.name in title + text
    assert "No such file or directory" in text
    assert saved.editor.is_dirty
    windows = state_folder / "windows"
    saved.qtbot.waitUntil(lambda: any(windows.glob(f"*/{WORK}")), timeout=10_000)
    (work,) = windows.glob(f"*/{WORK}")
    assert read_work(work).record.landmarks == saved.session.landmarks


def test_a_mesh_that_is_gone_is_told_when_the_session_is_saved(saved, sample_copy, tmp_path):
    (sample_copy.parent / "femur_generic.ply").unlink()
    change(saved)
    save(saved)
    message = saved.window.statusBar().currentMessage()
    assert message.startswith(f"Saved {sample_copy.name}, but its mesh femur_generic.ply is not in")
    assert read_session(sample_copy).settings.penalty == saved.session.settings.penalty
    # What was read is still there to be warped.
    saved.dialogs.saves = [tmp_path / "warped.stl"]
    saved.trigger("export_mesh")
    assert len(read_mesh(tmp_path / "warped.stl").mesh.faces) == len(
        saved.session.mesh(Side.SOURCE).faces
    )
