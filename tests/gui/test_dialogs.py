"""Every dialog tells those who do not see it what its parts are, and needs no mouse."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from qtpy.QtCore import QObject, Qt, QTimer
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication, QDialog, QInputDialog, QMessageBox
from tests.gui.focus import faults_of
from tests.gui.guesses import bones
from tests.gui.test_recovery import lost_work
from tests.osim_models import copied_model, session_on

from pinwarp.core.first_guess import Verdict
from pinwarp.core.landmarks import Side
from pinwarp.gui.window.window_dialogs import WindowDialogs
from pinwarp.io.landmark_files import write_landmarks
from pinwarp.io.osim.reading import read_model
from pinwarp.session.model.study import ModelStudy, StudyBody
from pinwarp.session.model.warped import warped_model

# The system's own.
OF_FILES = {"ask_open", "ask_open_many", "ask_folder", "ask_save"}


class Asking(WindowDialogs):
    """Asks for real, except for files: those are named beforehand."""

    def __init__(self) -> None:
        self.opens: list[Path] = []
        self.unsaved = None
        self.asked: set[str] = set()

    def __getattribute__(self, name: str):
        if name.startswith(("ask_", "tell")):
            object.__getattribute__(self, "asked").add(name)
        return super().__getattribute__(name)

    def ask_open(self, _title, _filters, _folder):
        return self.opens.pop(0) if self.opens else None

    def ask_open_many(self, _title, _filters, _folder):
        return []

    def ask_folder(self, _title, _folder):
        return None

    def ask_save(self, _title, _filters, _proposal):
        return None

    def ask_unsaved(self, name, reason=""):
        return super().ask_unsaved(name, reason) if self.unsaved is None else self.unsaved


class Reader(QObject):
    """Looks at every dialog that opens, and puts it off by Escape."""

    def __init__(self) -> None:
        super().__init__()
        self.faults: dict[str, list[str]] = {}
        self.kinds: set[type[QDialog]] = set()
        self._timer = QTimer(self, interval=10, timeout=self._look)
        self._timer.start()

    def _look(self) -> None:
        dialog = QApplication.activeModalWidget()
        # The first focus is given when the window has come to the front.
        if dialog is None or not dialog.isActiveWindow():
            return
        self.kinds.add(type(dialog))
        self.faults.setdefault(dialog.windowTitle(), []).extend(faults_of(dialog))
        QTest.keyClick(dialog, Qt.Key.Key_Escape)

    def stop(self) -> None:
        self._timer.stop()


@pytest.fixture
def dialogs():
    return Asking()


@pytest.fixture
def reader(window, dialogs):
    dialogs.window = window
    reader = Reader()
    yield reader
    reader.stop()


def trigger(user, key: str) -> None:
    """Ask for something, and wait until whatever it asks was answered."""
    user.window.actions_by_key[key].trigger()
    user.settle()
    user.qtbot.waitUntil(lambda: QApplication.activeModalWidget() is None)


def every_kind(of: type[QDialog]) -> set[type[QDialog]]:
    found = {kind for one in of.__subclasses__() for kind in every_kind(one) | {one}}
    return {x for x in found if x.__module__.startswith("pinwarp") and not x.__subclasses__()}


def test_every_dialog_names_its_parts_and_is_used_by_tab_alone(
    user, dialogs, reader, guesser, tmp_path
):
    user.open_sample()
    user.editor.select(*(pair.name for pair in user.session.pairs[:3]))
    asking = [key for key, x in user.window.actions_by_key.items() if x.text().endswith("…")]
    for key in [*asking, "about", "cite"]:
        trigger(user, key)

    # What is asked about files.
    text = ""
    for side in Side:
        path = tmp_path / f"{side.value}.tps"
        # In another unit, so that there is a question, too.
        marks = [replace(x, source=tuple(1000 * v for v in x.source)) for x in user.session.pairs]
        write_landmarks(path, marks, Side.SOURCE, unit="mm")
        text += path.read_text()
    (tmp_path / "two.tps").write_text(text)
    dialogs.opens = [tmp_path / "source.tps"]
    trigger(user, "import_source")
    dialogs.opens = [tmp_path / "two.tps"]
    trigger(user, "import_source")
    broken = tmp_path / "broken.ply"
    broken.write_text("no mesh")
    dialogs.opens = [broken]
    trigger(user, "open_source")

    # What is asked about what others or the machine have done.
    dialogs.ask_missing_mesh("source", broken, tmp_path / "other" / "broken.ply")
    dialogs.ask_open_twice("femur", "in another window")
    dialogs.ask_overwrite("femur", "was changed by another program")
    dialogs.ask_existing([broken, tmp_path / "source.tps"])
    dialogs.ask_unsaved("femur")
    dialogs.ask_choice("A choice", "Which?", "More.", ["This", "That", "Cancel"])
    dialogs.tell("Told", "A sentence.", "And\nmore.")
    dialogs.ask_lost_work([lost_work(tmp_path, name, "Move tip") for name in ("a", "b")])
    leg = copied_model("leg", tmp_path / "leg")
    thigh = StudyBody("/bodyset/thigh", session_on(leg, "thigh"))
    dialogs.ask_dry_run(warped_model(ModelStudy(read_model(leg), (thigh,))))

    # Which hand is meant.
    guesser.verdict, guesser.both_hands = Verdict.ASK, True
    dialogs.unsaved = None
    dialogs.opens = [bones(tmp_path)]
    trigger(user, "open_session")
    trigger(user, "suggest_all")

    assert reader.kinds >= every_kind(QDialog) | {QMessageBox, QInputDialog}, "all were looked at"
    methods = {x for x in dir(WindowDialogs) if x.startswith(("ask_", "tell"))}
    assert dialogs.asked >= methods - OF_FILES
    assert not any(reader.faults.values()), reader.faults
