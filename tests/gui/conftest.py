"""A real window for every test, and a look at what it leaves behind."""

from __future__ import annotations

import gc
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from qtpy.QtCore import QEvent, QPoint, QPointF, QSettings, Qt, QTimer
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication
from tests.gui.guesses import Guesser
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkRenderWindowInteractor

from pinwarp.core.landmarks import Side
from pinwarp.gui.app import make_application
from pinwarp.gui.files.file_dialogs import Answer, OpenTwice, Overwrite
from pinwarp.gui.files.lost_work_dialog import LostAnswer
from pinwarp.gui.importing.dialog import ImportDialog
from pinwarp.gui.importing.specimen_dialog import SpecimenDialog
from pinwarp.gui.tasks.dialogs import Existing
from pinwarp.gui.views import canvas
from pinwarp.gui.window.main_window import MainWindow
from pinwarp.io.samples import assets_folder, sample_session
from pinwarp.session.keeping.recovery import LostWork
from pinwarp.session.model.warped import WarpedModel

# Software draws in the test's own thread: the other cores have tests of their own.
os.environ.setdefault("LP_NUM_THREADS", "0")


@pytest.fixture(scope="session")
def qapp_cls():
    return QApplication


@pytest.fixture(scope="session")
def qapp():
    return make_application()


@pytest.fixture(scope="session", autouse=True)
def plain_edges():
    """Leave edges as they are: smoothing is half of every frame, and one test sees it done."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(canvas, "SMOOTH_EDGES", False)
        yield


class ScriptedDialogs:
    """Answers as the test told it to, and remembers what was said."""

    def __init__(self) -> None:
        self.opens: list[Path] = []
        self.opens_many: list[list[Path]] = []
        self.folders: list[Path] = []
        self.existing = Existing.CANCEL
        self.existing_questions: list[list[str]] = []
        self.saves: list[Path] = []
        self.texts: list[str] = []
        self.unsaved = Answer.DISCARD
        self.unsaved_questions = 0
        self.unsaved_reasons: list[str] = []
        self.missing: Path | None = None
        self.missing_questions: list[tuple[str, Path, Path | None]] = []
        self.lost: list[LostAnswer] = []
        self.lost_offers: list[list[LostWork]] = []
        self.open_twice = OpenTwice.CANCEL
        self.open_twice_questions: list[tuple[str, str]] = []
        self.overwrite = Overwrite.CANCEL
        self.overwrite_questions: list[tuple[str, str]] = []
        # What a user does with each import dialog that opens; it is rejected after that.
        self.at_import: list[Callable[[ImportDialog], None]] = []
        self.at_specimen: list[Callable[[SpecimenDialog], None]] = []
        self.choices: list[int] = []
        self.dry_runs: list[WarpedModel] = []
        self.export_model = True
        self.choice_questions: list[tuple[str, str, str, list[str]]] = []
        self.errors: list[tuple[str, str]] = []
        self.told: list[tuple[str, str, str]] = []

    def ask_open(self, _title, _filters, _folder):
        return self.opens.pop(0) if self.opens else None

    def ask_open_many(self, _title, _filters, _folder):
        return self.opens_many.pop(0) if self.opens_many else []

    def ask_folder(self, _title, _folder):
        return self.folders.pop(0) if self.folders else None

    def ask_existing(self, existing):
        self.existing_questions.append([path.name for path in existing])
        return self.existing

    def ask_save(self, _title, _filters, _proposal):
        return self.saves.pop(0) if self.saves else None

    def ask_unsaved(self, _name, reason=""):
        self.unsaved_questions += 1
        self.unsaved_reasons.append(reason)
        return self.unsaved

    def ask_text(self, _title, _question, _proposal):
        return self.texts.pop(0) if self.texts else None

    def ask_missing_mesh(self, side, path, other):
        self.missing_questions.append((side, path, other))
        return self.missing

    def ask_lost_work(self, found):
        self.lost_offers.append(list(found))
        return (self.lost.pop(0) if self.lost else LostAnswer.LATER), found[0]

    def ask_open_twice(self, name, where):
        self.open_twice_questions.append((name, where))
        return self.open_twice

    def ask_overwrite(self, name, reason):
        self.overwrite_questions.append((name, reason))
        return self.overwrite

    def ask_import(self, session, arriving, rulers):
        assert self.at_import, "nobody expected to be asked about an import"
        dialog = ImportDialog(session, arriving, rulers, QApplication.activeWindow())
        return dialog.choice if self._is_accepted(dialog, self.at_import.pop(0)) else None

    def ask_specimen(self, arriving):
        assert self.at_specimen, "nobody expected to be asked for a specimen"
        dialog = SpecimenDialog(arriving, QApplication.activeWindow())
        return dialog.chosen if self._is_accepted(dialog, self.at_specimen.pop(0)) else None

    def _is_accepted(self, dialog, use):
        """Show a dialog, use it as a test wants, and say how it was left."""

        def act():
            try:
                use(dialog)
            finally:
                # Else a failed test would wait for ever.
                dialog.done(dialog.result())

        QTimer.singleShot(50, dialog, act)
        accepted = dialog.exec()
        dialog.deleteLater()
        return accepted

    def ask_choice(self, title, text, more, labels):
        self.choice_questions.append((title, text, more, list(labels)))
        return self.choices.pop(0) if self.choices else len(labels) - 1

    def ask_dry_run(self, warped):
        self.dry_runs.append(warped)
        return self.export_model

    def tell_error(self, title, text):
        self.errors.append((title, text))

    def tell(self, title, text, details=""):
        self.told.append((title, text, details))


class Driver:
    """A user: clicks, drags and types into a real window."""

    def __init__(self, window: MainWindow, dialogs: ScriptedDialogs, qtbot) -> None:
        self.window = window
        self.dialogs = dialogs
        self.qtbot = qtbot

    @property
    def editor(self):
        return self.window.editor

    @property
    def session(self):
        return self.window.editor.session

    def settle(self) -> None:
        """Wait until what was asked for is done and painted."""
        self.qtbot.waitUntil(lambda: self.window.is_settled, timeout=30_000)
        for _ in range(3):
            QApplication.processEvents()

    def open_sample(self) -> None:
        self.window.actions_by_key["open_sample"].trigger()
        self.settle()

    def open_sample_meshes(self) -> None:
        """The two sample femurs without any landmarks."""
        for side, name in (
            (Side.SOURCE, "femur_generic.ply"),
            (Side.DESTINATION, "femur_subject.ply"),
        ):
            self.window.parts.documents.open_mesh(side, assets_folder() / name)
        self.settle()

    def place_of(self, side: Side, position) -> QPoint:
        """Where a position is on the screen of a viewport."""
        ((x, y),) = self.window.viewports[side].project(np.array([position]))
        return QPointF(x, y).toPoint()

    def places_down_the_bone(self, side: Side, count: int):
        """Positions on the surface where the bone is widest across, row by row down the view."""
        viewport = self.window.viewports[side]
        places = []
        for i in range(count):
            y = viewport.height() * (0.16 + 0.72 * i / (count - 1))
            hits = [
                x for x in range(0, viewport.width(), 4) if viewport.pick(QPointF(x, y)) is not None
            ]
            x = hits[len(hits) // 2] + (i % 2) * 4
            places.append(viewport.pick(QPointF(x, y)).tolist())
        return places

    def free_place(self, side: Side) -> QPoint:
        """A place on the bone, away from every landmark."""
        layer = self.window.viewports[side].layer
        for position in self.places_down_the_bone(side, 30):
            at = self.place_of(side, position)
            if all(np.hypot(x - at.x(), y - at.y()) > 25 for x, y in layer.places()):
                return at
        raise AssertionError("no free place on the bone")

    def click(self, side: Side, at: QPoint, modifier=Qt.KeyboardModifier.NoModifier) -> None:
        viewport = self.window.viewports[side]
        QTest.mouseMove(viewport, at)
        QTest.mouseClick(viewport, Qt.MouseButton.LeftButton, modifier, at)
        self.settle()

    def click_position(self, side: Side, position) -> None:
        self.click(side, self.place_of(side, position))

    def drag(self, widget, start: QPoint, end: QPoint, steps: int = 6, button=None, release=True):
        button = button or Qt.MouseButton.LeftButton
        QTest.mousePress(widget, button, Qt.KeyboardModifier.NoModifier, start)
        for i in range(1, steps + 1):
            at = start + (end - start) * (i / steps)
            event_at = QPointF(at)
            self.move_with(widget, event_at, button)
        if release:
            QTest.mouseRelease(widget, button, Qt.KeyboardModifier.NoModifier, end)
        self.settle()

    def drag_a_landmark(self, release: bool = True) -> None:
        """Drag the first landmark of the destination that can be seen and moved."""
        there = self.window.viewports[Side.DESTINATION]
        marker = next(
            m
            for m, hidden in zip(there.layer.markers, there.layer.hidden(), strict=True)
            if not hidden and m.movable
        )
        start = self.place_of(Side.DESTINATION, marker.position)
        self.drag(there, start, start + QPoint(0, 25), release=release)

    @staticmethod
    def move_with(widget, at: QPointF, button, modifiers=Qt.KeyboardModifier.NoModifier) -> None:
        """Move the mouse with a button held (QTest.mouseMove forgets the buttons)."""
        from qtpy.QtCore import QEvent
        from qtpy.QtGui import QMouseEvent

        event = QMouseEvent(
            QEvent.Type.MouseMove,
            at,
            QPointF(widget.mapToGlobal(at.toPoint())),
            Qt.MouseButton.NoButton,
            button,
            modifiers,
        )
        QApplication.sendEvent(widget, event)
        QApplication.processEvents()

    def press(self, key, modifier=Qt.KeyboardModifier.NoModifier, widget=None) -> None:
        self.wait_until_in_front(widget or self.window)
        QTest.keyClick(widget or self.window, key, modifier)
        self.settle()

    @staticmethod
    def wait_until_in_front(widget) -> None:
        """Wait until keys come to a window, as after a dialog: before that no user's key does."""
        window = widget.window()
        if QApplication.activeModalWidget() is None and not window.isActiveWindow():
            window.activateWindow()
            assert QTest.qWaitForWindowActive(window)

    def trigger(self, key: str) -> None:
        self.window.actions_by_key[key].trigger()
        self.settle()


RENDERING = (vtkRenderWindow, vtkRenderWindowInteractor, vtkRenderer)


def rendering_objects() -> list[str]:
    """The VTK render windows, renderers and interactors that are alive, of this test alone."""
    gc.collect()
    return [type(x).__name__ for x in gc.get_objects() if isinstance(x, RENDERING)]


@pytest.fixture
def dialogs():
    return ScriptedDialogs()


@pytest.fixture
def nothing_leaks(qapp, request):
    """Torn down after the window: by then its widgets and VTK objects must be gone."""
    failures = request.session.testsfailed
    # What is there by now is looked through no more, neither here nor by any other collection:
    # the third of a million things that modules are made of cost more than the window.
    gc.collect()
    gc.freeze()
    yield
    if request.session.testsfailed > failures:
        return  # its traceback holds everything; the test has failed anyway
    # pytest keeps the test's arguments a little longer than it needs them.
    request.node.funcargs.clear()
    # Nothing is collected while Qt takes the widgets apart: a worker has died of that.
    gc.collect()
    gc.disable()
    try:
        qapp.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        qapp.processEvents()
    finally:
        gc.enable()
    assert [type(w).__name__ for w in qapp.topLevelWidgets() if isinstance(w, MainWindow)] == []
    assert rendering_objects() == []


@pytest.fixture
def state_folder(tmp_path_factory) -> Path:
    """Where the windows of a test keep their unsaved work: never in the user's own folder."""
    return tmp_path_factory.mktemp("state")


def open_window(dialogs: ScriptedDialogs, folder: Path, state_folder: Path) -> MainWindow:
    """Show an empty window that remembers its layout in a folder."""
    settings = QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)
    window = MainWindow(settings, dialogs, state_folder)
    window.resize(1280, 800)
    window.show()
    window.activateWindow()
    assert QTest.qWaitForWindowActive(window)
    return window


def close_window(window: MainWindow, dialogs: ScriptedDialogs) -> None:
    """Close a window without saving."""
    dialogs.unsaved = Answer.DISCARD
    window.close()
    window.deleteLater()


@pytest.fixture
def window(nothing_leaks, qtbot, dialogs, tmp_path, state_folder):
    """An empty window."""
    window = open_window(dialogs, tmp_path, state_folder)
    yield window
    close_window(window, dialogs)


@pytest.fixture
def another_user(nothing_leaks, qtbot, tmp_path, state_folder):
    """A second window on the same state folder."""
    dialogs = ScriptedDialogs()
    window = open_window(dialogs, tmp_path, state_folder)
    driver = Driver(window, dialogs, qtbot)
    driver.settle()
    yield driver
    close_window(window, dialogs)


@pytest.fixture
def user(window, dialogs, qtbot):
    driver = Driver(window, dialogs, qtbot)
    driver.settle()
    return driver


@pytest.fixture
def sample_copy(tmp_path) -> Path:
    """The sample session with its meshes, in a folder of its own."""
    folder = tmp_path / "sample"
    folder.mkdir()
    for name in ("femur_generic.ply", "femur_subject.ply"):
        shutil.copy(assets_folder() / name, folder / name)
    return Path(shutil.copy(sample_session(), folder))


@pytest.fixture
def guesser(monkeypatch) -> Guesser:
    """Answers in place of the first guess, which takes seconds."""
    guesser = Guesser()
    monkeypatch.setattr("pinwarp.gui.suggesting.run.suggest", guesser)
    return guesser
