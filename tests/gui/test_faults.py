"""User stories: something in the window fails, and the work goes on."""

from __future__ import annotations

import logging
import sys
import threading

import numpy as np
import pytest
from qtpy.QtCore import QPointF, QSettings, Qt
from qtpy.QtGui import QGuiApplication
from qtpy.QtTest import QTest
from tests.gui.conftest import ScriptedDialogs, close_window, open_window
from tests.two_spheres import pairs, two_spheres

from pinwarp.core.landmarks import Side, as_position
from pinwarp.gui import app
from pinwarp.gui.painted import marker_layer as painted
from pinwarp.gui.scene.drawables import FoldedSurface
from pinwarp.gui.warp import warps as presenter
from pinwarp.gui.window.faults import LOG, LOG_SIZE, MOST_REPORTS, Faults
from pinwarp.io.mesh_formats.ply import write_ply
from pinwarp.io.work_file import read_work
from pinwarp.session import edits
from pinwarp.session.session import Session, to_record

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


@pytest.fixture
def spheres(user, tmp_path):
    """Two spheres in one mesh on both sides, the smaller one mirrored by its pairs."""
    for side in Side:
        path = tmp_path / f"{side.value}.ply"
        write_ply(path, two_spheres())
        user.window.parts.documents.open_mesh(side, path)
    user.settle()
    user.editor.commit(edits.import_pairs(user.session, pairs()), "Import pairs")
    user.settle()
    return user


def kept_work(user, state_folder):
    """The unsaved work on the disk, once it is the session's."""
    wanted = to_record(user.editor.committed)

    def there():
        files = list(state_folder.glob("windows/*/work.pinwarp.csv"))
        return bool(files) and read_work(files[0]).record == wanted

    user.qtbot.waitUntil(there, timeout=10_000)
    return next(iter(state_folder.glob("windows/*/work.pinwarp.csv")))


# A closed part of the source that folds as a whole


def test_a_part_that_folds_as_a_whole_is_drawn_without_a_rim(spheres):
    view = spheres.window.viewports[DESTINATION]
    small = (two_spheres().vertices[two_spheres().faces][:, :, 2] > 90).all(axis=1)
    assert len(view.drawn(FoldedSurface).faces) == np.count_nonzero(small)
    assert {"folds", "hidden folds"} <= set(view.renderer.actors)
    assert "rim of the folds" not in view.renderer.actors
    assert "fold" in spheres.window.parts.findings.fold_note.text()


def test_work_on_it_is_kept_marked_and_labelled(spheres, state_folder):
    for i in range(3):
        name = spheres.session.landmarks[i].name
        moved = np.add(spheres.session.landmarks[i].destination, 0.1)
        spheres.editor.commit(
            edits.move(spheres.session, name, DESTINATION, as_position(moved)), f"Move {name}"
        )
        spheres.settle()
    kept_work(spheres, state_folder)
    assert spheres.window.isWindowModified()
    assert spheres.window.actions_by_key["undo"].text() == "&Undo Move p2"
    spheres.trigger("undo")
    assert spheres.window.actions_by_key["redo"].text() == "&Redo Move p2"


def test_a_rim_goes_when_a_fold_without_one_takes_its_place(spheres):
    view = spheres.window.viewports[DESTINATION]
    whole = spheres.session
    # Two neighbours on the large sphere exchange their places: that fold has a rim.
    swapped = edits.move(whole, "p6", DESTINATION, whole.landmark("p10").destination)
    swapped = edits.move(swapped, "p10", DESTINATION, whole.landmark("p6").destination)
    spheres.editor.commit(swapped, "Exchange")
    spheres.settle()
    assert "rim of the folds" in view.renderer.actors
    spheres.trigger("undo")
    spheres.settle()
    assert "folds" in view.renderer.actors
    assert "rim of the folds" not in view.renderer.actors


@pytest.mark.parametrize(
    ("source", "destination"),
    [
        ("opensim-creator-femur/femur_r.obj", "opensim-creator-femur/subject_femur_r.obj"),
        (
            "msk-morph-pelvis/template_pelvis_r.stl",
            "msk-morph-pelvis/target_pelvis_r.stl",
        ),
    ],
    ids=["femur", "pelvis"],
)
def test_landmarks_dragged_far_off_real_bones_fold_them_and_nothing_fails(
    user, shared_data, state_folder, source, destination
):
    for side, name in ((SOURCE, source), (DESTINATION, destination)):
        user.window.parts.documents.open_mesh(side, shared_data / name)
    user.settle()
    for places in zip(*(user.places_down_the_bone(side, 8) for side in Side), strict=True):
        for side, place in zip(Side, places, strict=True):
            user.click_position(side, place)
    assert len(user.session.pairs) == 8
    viewport, rng = user.window.viewports[DESTINATION], np.random.default_rng(4)
    folded = 0
    for landmark in user.session.pairs:
        start = user.place_of(DESTINATION, landmark.destination)
        QTest.mousePress(viewport, Qt.MouseButton.LeftButton, pos=start)
        for _ in range(3):
            at = QPointF(start) + QPointF(*rng.uniform(-150, 150, 2))
            user.move_with(
                viewport, at, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ShiftModifier
            )
        QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, pos=at.toPoint())
        user.settle()
        folded += viewport.drawn(FoldedSurface) is not None
    assert folded
    assert user.window.actions_by_key["undo"].text().startswith("&Undo Move")
    kept_work(user, state_folder)


# A view that fails


@pytest.fixture
def broken(user, monkeypatch):
    """The sample in a window whose table cannot show any session, as the program runs it."""
    user.open_sample()

    def fail(_session):
        raise ZeroDivisionError("the panel fails")

    user.window.editor.session_changed.connect(fail, priority=2)
    with user.window.faults.taken_over():
        yield user
    # What was taken over came from nowhere else.
    assert all("the panel fails" in report for report in user.window.faults.reports)


def move_one(user, by):
    landmark = user.session.pairs[0]
    place = as_position(np.add(landmark.destination, by))
    user.editor.commit(
        edits.move(user.session, landmark.name, DESTINATION, place), f"Move {landmark.name}"
    )
    user.settle()


def test_a_view_that_fails_is_told_once_and_the_work_is_kept(broken, state_folder, capsys):
    window, said = broken.window, []
    window.statusBar().messageChanged.connect(said.append)
    before = window.viewports[DESTINATION].overlay_points
    for i in range(3):
        move_one(broken, i + 1.0)
    assert sum("ZeroDivisionError" in message for message in said) == 1
    assert "Help > Copy Details" in next(m for m in said if "ZeroDivisionError" in m)
    assert window.parts.help.fault_note.isVisible()
    assert capsys.readouterr().err.count("Traceback") == 1
    assert (state_folder / LOG).read_text("utf-8").count("Traceback") == 1
    assert window.faults.count == 3
    # All others have shown the session.
    kept_work(broken, state_folder)
    assert window.isWindowModified()
    assert window.actions_by_key["undo"].text().startswith("&Undo Move")
    assert not np.allclose(window.viewports[DESTINATION].overlay_points, before)


def test_what_there_is_to_report_is_copied_from_the_status_bar_or_the_menu(broken):
    move_one(broken, 1.0)
    window = broken.window
    QTest.mouseClick(window.parts.help.fault_note, Qt.MouseButton.LeftButton)
    text = QGuiApplication.clipboard().text()
    for words in ("pinwarp 0.1", "Python 3.", "Graphics: ", "vtk ", "Faults: 1", "in fail"):
        assert words in text
    graphics = next(line for line in text.splitlines() if line.startswith("Graphics: "))
    assert "unknown" not in graphics
    assert not window.parts.help.fault_note.isVisible()
    QGuiApplication.clipboard().clear()
    broken.trigger("copy_details")
    assert QGuiApplication.clipboard().text() == text


def test_without_a_fault_the_versions_are_copied(user):
    user.trigger("copy_details")
    assert QGuiApplication.clipboard().text().endswith("Faults: 0")
    assert not user.window.parts.help.fault_note.isVisible()


def test_broken_graphics_do_not_keep_the_details_from_being_copied(user, monkeypatch):
    def fail():
        raise RuntimeError("no context")

    monkeypatch.setattr(user.window.parts.help.fault_note, "_graphics", fail)
    user.trigger("copy_details")
    assert "Graphics: unknown (no context)" in QGuiApplication.clipboard().text()


def test_a_warp_that_cannot_be_computed_leaves_no_old_one_and_the_next_is_drawn(
    user, monkeypatch, state_folder
):
    user.open_sample()
    window, there = user.window, user.window.viewports[DESTINATION]
    with window.faults.taken_over(), monkeypatch.context() as patched:
        patched.setattr(window.parts.warps.solver, "solve", lambda _inputs: 1 / 0)
        move_one(user, 1.0)
        assert there.overlay_points is None
        assert "could not be computed" in window.parts.warps.result.problem
        kept_work(user, state_folder)
    assert window.faults.count == 1
    move_one(user, 1.0)
    assert there.overlay_points is not None


def test_figures_that_cannot_be_computed_leave_no_old_ones(user, monkeypatch):
    user.open_sample()

    def fail(_result):
        raise ZeroDivisionError

    monkeypatch.setattr(presenter, "quality_of", lambda _result: None)
    monkeypatch.setattr(user.window.parts.quality._judge, "_function", fail)
    with user.window.faults.taken_over():
        move_one(user, 1.0)
        user.settle()
    assert user.window.faults.count >= 1
    assert user.window.parts.quality.quality is None


def test_an_overlay_that_cannot_be_drawn_keeps_no_figures_from_being_shown(user, monkeypatch):
    user.open_sample()
    heard = []
    user.window.parts.warps.result_changed.connect(lambda *values: heard.append(values[0]))

    def fail(_scene):
        raise ZeroDivisionError

    with user.window.faults.taken_over(), monkeypatch.context() as patched:
        patched.setattr(user.window.viewports[DESTINATION], "show_scene", fail)
        move_one(user, 1.0)
        user.settle()
    assert len(user.window.faults.reports) == 1
    assert heard[-1].inputs.destination[0] == user.session.pairs[0].destination


def test_a_picture_that_fails_half_painted_does_not_end_the_program(user, monkeypatch):
    user.open_sample()
    layer = user.window.viewports[SOURCE].layer

    def fail(*_arguments):
        raise ZeroDivisionError

    with user.window.faults.taken_over(), monkeypatch.context() as patched:
        patched.setattr(painted.MarkerLayer, "markers", property(fail))
        for number in range(1, 4):
            layer.update()
            user.qtbot.waitUntil(lambda number=number: user.window.faults.count >= number)
    assert len(user.window.faults.reports) == 1
    layer.repaint()


def test_a_slot_of_qt_and_a_thread_that_fail_are_told_too(user, state_folder):
    def fail(*_arguments):
        raise LookupError("nobody caught it")

    window = user.window
    window.actions_by_key["fit"].triggered.connect(fail)
    with window.faults.taken_over():
        user.trigger("fit")
        thread = threading.Thread(target=fail)
        thread.start()
        thread.join()
        user.qtbot.waitUntil(lambda: window.faults.count == 2)
    assert len(window.faults.reports) == 2, "they failed in different places"
    assert (state_folder / LOG).read_text("utf-8").count("Traceback") == 2


def test_the_hooks_are_as_before_once_the_window_is_done(user):
    before = sys.excepthook, threading.excepthook
    with user.window.faults.taken_over():
        assert sys.excepthook != before[0]
    assert (sys.excepthook, threading.excepthook) == before


# The log


def take(faults, text):
    try:
        exec(text)
    except Exception as error:
        faults.take(type(error), error, error.__traceback__)


def test_the_log_and_the_report_stay_small_whatever_happens(qapp, tmp_path, capsys):
    faults = Faults(tmp_path)
    for i in range(40):
        take(faults, "\n" * i + f"raise ValueError({'x' * 20_000!r})")
    faults.shut_down()
    assert faults.count == 40
    assert len(faults.reports) == MOST_REPORTS
    logs = sorted(path.name for path in tmp_path.iterdir())
    assert logs == [LOG, f"{LOG}.1"]
    assert all((tmp_path / name).stat().st_size < LOG_SIZE for name in logs)


def test_a_log_that_cannot_be_written_is_no_further_fault(qapp, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(logging, "raiseExceptions", True)
    (tmp_path / "file").write_text("")
    faults, told = Faults(tmp_path / "file"), []
    faults.told.connect(told.append)
    take(faults, "raise ValueError('first')")
    faults.shut_down()
    assert len(told) == 1
    assert "Logging error" not in capsys.readouterr().err


# Folders that cannot be made


def hopeless(tmp_path, kind):
    """A home folder below which nothing can be made."""
    if kind == "proc":
        return "/proc/1"
    file = tmp_path / "file"
    file.write_text("")
    return str(file / "home")


@pytest.fixture(params=["proc", "file"])
def home(request, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", hopeless(tmp_path, request.param))
    for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME", "XDG_DATA_HOME"):
        monkeypatch.delenv(name, raising=False)
    return request.param


@pytest.mark.skipif(sys.platform != "linux", reason="other systems name these folders otherwise")
def test_the_window_opens_without_folders_to_remember_in_and_says_so(nothing_leaks, home, qtbot):
    dialogs = ScriptedDialogs()
    window = app.user_window(dialogs)
    window.show()
    assert QTest.qWaitForWindowExposed(window)
    assert "Settings are not remembered" in window.statusBar().currentMessage()
    qtbot.waitUntil(lambda: bool(dialogs.errors))
    assert [title for title, _ in dialogs.errors] == ["Unsaved work is not being kept"]
    app.begin(window, app.Opening(), demo=True)
    qtbot.waitUntil(lambda: window.is_settled and bool(window.editor.session.pairs), timeout=30_000)
    window.parts.documents.open_session(app.sample_session())
    qtbot.waitUntil(lambda: window.is_settled, timeout=30_000)
    window.parts.documents.recent_menu.aboutToShow.emit()
    with window.faults.taken_over():
        window.faults.take(ValueError, ValueError("x"), None)
    assert window.faults.count == 1
    close_window(window, dialogs)


def test_settings_of_which_nothing_makes_sense_are_not_followed(
    nothing_leaks, dialogs, tmp_path, state_folder, qtbot
):
    settings = QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat)
    for key, value in (("recent_sessions", 3), ("geometry", "x"), ("layout", [1, 2])):
        settings.setValue(key, value)
    settings.sync()
    window = open_window(dialogs, tmp_path, state_folder)
    window.parts.documents.recent_menu.aboutToShow.emit()
    assert [action.text() for action in window.parts.documents.recent_menu.actions()] == [
        "Nothing yet"
    ]
    close_window(window, dialogs)


def test_an_unknown_home_folder_is_told_as_well(monkeypatch, nothing_leaks, dialogs, qtbot):
    def unknown(*_arguments, **_more):
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(app.platformdirs, "user_config_path", unknown)
    monkeypatch.setattr(app.platformdirs, "user_state_path", unknown)
    window = app.user_window(dialogs)
    assert "Could not determine home directory" in window.statusBar().currentMessage()
    assert Session() == window.editor.session
    close_window(window, dialogs)
