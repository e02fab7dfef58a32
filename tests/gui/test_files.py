"""User stories: files in and out of the window."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt, QUrl
from qtpy.QtGui import QFileOpenEvent
from qtpy.QtWidgets import QApplication
from tests.gui.dropping import drop

from pinwarp.core.landmarks import Side
from pinwarp.gui.app import take_files
from pinwarp.gui.files import session_meshes
from pinwarp.gui.files.documents import Opening
from pinwarp.gui.files.file_dialogs import Answer
from pinwarp.gui.scene.drawables import Hint
from pinwarp.io.meshes import read_mesh
from pinwarp.io.samples import assets_folder
from pinwarp.io.session_file import read_session

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


def test_an_empty_window_says_what_to_do_next(user):
    assert "source mesh" in user.window.viewports[SOURCE].drawn(Hint).words
    assert "destination mesh" in user.window.viewports[DESTINATION].drawn(Hint).words
    assert "Open the source mesh" in user.window.parts.guidance.hint.text()
    assert not user.window.actions_by_key["export_mesh"].isEnabled()


def test_the_sample_opens_as_a_new_session_that_needs_no_saving(user):
    user.open_sample()
    assert len(user.session.pairs) == 16
    assert user.editor.path is None
    assert user.window.windowTitle() == "Untitled[*] – pinwarp"
    assert not user.window.isWindowModified()


def test_a_mesh_dropped_on_a_viewport_opens_on_that_side(user):
    drop(user.window.viewports[DESTINATION], assets_folder() / "femur_subject.ply")
    user.settle()
    assert user.session.destination.path.name == "femur_subject.ply"
    assert user.session.source is None


def test_two_meshes_dropped_together_fill_both_sides(user):
    folder = assets_folder()
    drop(user.window.viewports[SOURCE], folder / "femur_generic.ply", folder / "femur_subject.ply")
    user.settle()
    assert user.session.source.path.name == "femur_generic.ply"
    assert user.session.destination.path.name == "femur_subject.ply"


def test_a_landmark_file_dropped_on_a_viewport_belongs_to_that_side(user, tmp_path):
    path = tmp_path / "bone.landmarks.csv"
    path.write_text("name,x,y,z\nfovea,1,2,3\n")
    drop(user.window.viewports[DESTINATION], path)
    user.settle()
    assert user.session.landmark("fovea").destination == (1, 2, 3)
    assert user.editor.undo_label == "Import destination landmarks"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("bone.pts", "Version 1.0\n1\nfovea 1 2 3\n"),
        (
            "bone.mrk.json",
            '{"markups": [{"controlPoints": [{"label": "fovea", "position": [1, 2, 3]}]}]}',
        ),
        ("BONE.FCSV", "# columns = label,x,y,z,sel,vis\nfovea,1,2,3,1,1\n"),
    ],
)
def test_landmarks_of_other_programs_are_dropped_likewise(user, tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text)
    drop(user.window.viewports[SOURCE], path)
    user.settle()
    assert user.session.landmark("fovea").source == (1, 2, 3)
    assert user.dialogs.errors == []


def test_a_session_dropped_on_a_viewport_is_opened(user, sample_copy):
    drop(user.window.viewports[SOURCE], sample_copy)
    user.settle()
    assert user.editor.path == sample_copy
    assert user.window.windowTitle() == "femur_sample[*] – pinwarp"


def test_what_the_desktop_hands_to_the_program_is_opened(user, sample_copy, qapp):
    take_files(qapp, user.window)
    QApplication.sendEvent(qapp, QFileOpenEvent(QUrl.fromLocalFile(str(sample_copy))))
    user.settle()
    assert user.editor.path == sample_copy
    assert len(user.session.pairs) == 16


def test_a_dropped_file_of_another_kind_gets_a_message(user, tmp_path):
    path = tmp_path / "notes.docx"
    path.write_text("no mesh")
    drop(user.window.viewports[SOURCE], path)
    user.settle()
    assert "notes.docx" in user.dialogs.errors[0][1]


def test_a_bad_mesh_gives_a_message_and_changes_nothing(user, tmp_path):
    user.open_sample()
    before = user.session
    path = tmp_path / "broken.stl"
    path.write_bytes(b"\x00" * 80 + (1000).to_bytes(4, "little") + b"\x01" * 60)
    user.dialogs.opens = [path]
    user.trigger("open_source")
    assert "broken.stl" in user.dialogs.errors[0][1]
    assert user.session == before


def test_a_session_whose_mesh_is_gone_keeps_landmarks_and_path(user, sample_copy):
    (sample_copy.parent / "femur_generic.ply").unlink()
    user.dialogs.opens = [sample_copy]
    user.trigger("open_session")
    assert len(user.session.pairs) == 16
    assert user.session.mesh(SOURCE) is None
    user.press(Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
    again = read_session(sample_copy)
    assert again.source_mesh.path.name == "femur_generic.ply"


def test_a_mesh_that_moved_can_be_located(user, sample_copy):
    moved = sample_copy.parent / "elsewhere.ply"
    (sample_copy.parent / "femur_generic.ply").rename(moved)
    user.dialogs.missing = moved
    user.dialogs.opens = [sample_copy]
    user.trigger("open_session")
    assert user.session.source.path == moved


def test_a_damaged_session_is_refused_and_changes_nothing(user, tmp_path):
    user.open_sample()
    before = user.session
    path = tmp_path / "damaged.pinwarp.csv"
    path.write_text("# pinwarp-session: 99\n")
    user.dialogs.opens = [path]
    user.trigger("open_session")
    assert "newer" in user.dialogs.errors[0][1]
    assert user.session == before


@pytest.mark.parametrize("answer", [Answer.CANCEL, Answer.DISCARD, Answer.SAVE])
def test_closing_with_unsaved_changes_asks(user, answer, tmp_path):
    user.open_sample_meshes()
    viewport = user.window.viewports[SOURCE]
    user.click(SOURCE, QPoint(viewport.width() // 2, viewport.height() // 2))
    assert user.window.isWindowModified()
    path = tmp_path / "kept.pinwarp.csv"
    user.dialogs.unsaved, user.dialogs.saves = answer, [path]
    user.window.close()
    assert user.dialogs.unsaved_questions == 1
    assert user.window.isVisible() == (answer is Answer.CANCEL)
    assert path.exists() == (answer is Answer.SAVE)


def test_a_session_that_cannot_be_saved_loses_nothing(user, tmp_path):
    user.open_sample_meshes()
    blocker = tmp_path / "file"
    blocker.write_text("")
    user.dialogs.saves = [blocker / "inside.pinwarp.csv"]
    user.trigger("save")
    assert user.dialogs.errors
    assert user.editor.is_dirty


def test_saving_adds_the_suffix_and_remembers_the_file(user, tmp_path):
    user.open_sample()
    user.dialogs.saves = [tmp_path / "left femur.csv"]
    user.trigger("save_as")
    path = tmp_path / "left femur.pinwarp.csv"
    assert path.is_file()
    user.window.parts.documents.recent_menu.aboutToShow.emit()
    assert user.window.parts.documents.recent_menu.actions()[0].text() == path.name
    user.window.parts.documents.recent_menu.actions()[0].trigger()
    user.settle()
    assert user.editor.path == path


def test_the_warped_mesh_is_exported_as_it_is_shown(user, tmp_path):
    user.open_sample()
    path = tmp_path / "warped.ply"
    user.dialogs.saves = [path]
    user.press(Qt.Key.Key_E, Qt.KeyboardModifier.ControlModifier)
    exported = read_mesh(path).mesh
    shown = user.window.viewports[DESTINATION].overlay_points
    assert np.allclose(exported.vertices, shown, atol=1e-3)
    assert (
        "Exported warped.ply: the full warp (16 pairs, penalty 0 mm)"
        in user.window.statusBar().currentMessage()
    )


@pytest.mark.parametrize("which", ["source", "destination", "pairs"])
def test_exported_landmarks_come_back_by_import(user, tmp_path, which):
    user.open_sample()
    before = user.session
    path = tmp_path / "out.csv"
    user.dialogs.saves = [path]
    user.trigger(f"export_{which}")
    user.dialogs.opens = [path]
    user.trigger(f"import_{which}")
    assert user.session.landmarks == before.landmarks
    assert user.dialogs.errors == []


def test_the_suffix_of_an_export_is_its_format_and_what_it_cannot_hold_is_said(user, tmp_path):
    user.open_sample()
    user.dialogs.saves = [tmp_path / "out.tps"]
    user.trigger("export_source")
    assert (tmp_path / "out.tps").read_text().startswith("LM3=20\n")
    assert "only their order was kept" in user.window.statusBar().currentMessage()


def test_an_export_that_no_format_holds_says_which_do(user, tmp_path):
    user.open_sample()
    user.dialogs.saves = [tmp_path / "out.pts"]
    user.trigger("export_pairs")
    title, text = user.dialogs.errors[0]
    assert title == "Cannot write out.pts"
    assert "one side only" in text
    assert "another folder" not in text
    assert list(tmp_path.glob("out*")) == []


def test_a_side_file_is_not_taken_for_pairs(user, tmp_path):
    path = tmp_path / "side.csv"
    path.write_text("name,x,y,z\nfovea,1,2,3\n")
    user.dialogs.opens = [path]
    user.trigger("import_pairs")
    assert "one mesh only" in user.dialogs.errors[0][1]
    assert user.session.landmarks == ()


@pytest.fixture
def held_reading(monkeypatch):
    """Meshes are read once this is set."""
    go = threading.Event()

    def read_later(path, progress):
        go.wait(30)
        return read_mesh(path, progress=progress)

    monkeypatch.setattr(session_meshes, "read_any_mesh", read_later)
    yield go
    go.set()


def test_opening_a_large_mesh_shows_progress_and_leaves_the_window_alive(
    user, tmp_path, held_reading
):
    import pyvista as pv

    path = tmp_path / "large.ply"
    pv.Plane(i_resolution=500, j_resolution=500).triangulate().save(path)
    turns = 0

    def count():
        nonlocal turns
        turns += 1

    from qtpy.QtCore import QTimer

    timer = QTimer(user.window)
    timer.timeout.connect(count)
    timer.start(5)
    user.window.parts.documents.open_mesh(SOURCE, path)
    user.qtbot.waitUntil(user.window.progress.isVisible)
    assert user.window.cancel.isVisible()
    turns = 0
    held_reading.set()
    user.settle()
    timer.stop()
    assert turns > 3
    assert not user.window.progress.isVisible()
    assert len(user.session.source.mesh.faces) == 500_000


def test_cancelling_a_long_read_changes_nothing(user, held_reading):
    user.window.parts.documents.open_mesh(SOURCE, assets_folder() / "femur_generic.ply")
    user.qtbot.waitUntil(user.window.cancel.isVisible)
    user.qtbot.mouseClick(user.window.cancel, Qt.MouseButton.LeftButton)
    held_reading.set()
    user.settle()
    assert user.session.source is None
    assert user.dialogs.errors == []
    assert "Cancelled" in user.window.statusBar().currentMessage()


def test_the_real_femur_pairs_by_name_and_exports_the_known_mesh(user, shared_data, tmp_path):
    folder = shared_data / "opensim-creator-femur"
    user.window.parts.documents.open(
        Opening(
            source=folder / "femur_r.obj",
            destination=folder / "subject_femur_r.obj",
            source_landmarks=folder / "femur_r_warp.landmarks.csv",
            destination_landmarks=folder / "subject_femur_r.landmarks.csv",
        )
    )
    user.settle()
    assert len(user.session.pairs) == 20
    assert user.session.unit == "m"
    path = tmp_path / "warped.stl"
    user.dialogs.saves = [path]
    user.trigger("export_mesh")
    exported = read_mesh(path).mesh.vertices
    assert len(exported) == 456
    known = (-0.081480174, -0.071508095, -0.049135411)
    assert np.abs(exported.mean(axis=0) - known).max() < 1e-6
