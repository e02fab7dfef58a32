"""Whatever waits for an answer gets one: dialogs, menus, lists that pop up, drags of rows."""

from __future__ import annotations

import random
import time
from collections.abc import Callable

from qtpy.QtCore import QObject, QPoint, Qt, QTimer
from qtpy.QtGui import QWindow
from qtpy.QtTest import QTest
from qtpy.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QDialog,
    QFileDialog,
    QLineEdit,
    QMenu,
    QMessageBox,
    QSpinBox,
    QTabBar,
    QWidget,
)
from tests.gui.monkey.files import Files

EVERY_MS = 5
MOST_POKES = 8
STUCK_SECONDS = 1.5
SMALL = (0, 2, 3, 5, 64, 90)
TEXTS = (
    "", "a", "hip", "GT", "L{n}", "{name}_{n:02}", "{", "3", "-1", "1e400", "nan", "0", "2.5",
    "1,5", "x" * 300, "ä ö ü", "=1+1", "\u200b", "a,b;c\"d'",
)  # fmt: skip
_Key = Qt.Key


class Answers(QObject):
    """Answers at random what the window asks while the monkey is busy in an event of its own.

    Parameters
    ----------
    files
        What file dialogs are answered with.
    rng
        Returns the random numbers of the step under way.
    """

    def __init__(self, files: Files, rng: Callable[[], random.Random]) -> None:
        super().__init__()
        self._files = files
        self._rng = rng
        self._of: QWidget | None = None
        self._pokes = 0
        self._held: tuple[QWidget, QPoint, float] | None = None
        self.given: list[str] = []
        self._stopped = False
        self._answer()

    def stop(self) -> None:
        """Answer nothing any more."""
        self._stopped = True

    def hold(self, widget: QWidget | None, at: QPoint | None = None) -> None:
        """Remember that a button is held: a drag of rows waits for its release in a loop."""
        self._held = None if widget is None or at is None else (widget, at, time.monotonic())

    @staticmethod
    def is_asked() -> bool:
        """Whether something waits for an answer."""
        return QApplication.activePopupWidget() is not None or (
            QApplication.activeModalWidget() is not None
        )

    def _answer(self) -> None:
        if self._stopped:
            return
        # A new timer each time: one that repeats is dead while an answer leads to a question.
        QTimer.singleShot(EVERY_MS, self, self._answer)
        asking = QApplication.activePopupWidget() or QApplication.activeModalWidget()
        if asking is None:
            self._of = None
            self._let_go()
            return
        if asking is not self._of:
            self._of, self._pokes = asking, 0
        self._pokes += 1
        rng = self._rng()
        if self._pokes > MOST_POKES:
            self.given.append(f"close {type(asking).__name__}")
            if isinstance(asking, QDialog):
                asking.reject()
            else:
                asking.close()
        elif isinstance(asking, QMenu):
            self._in_menu(asking, rng)
        elif isinstance(asking, QFileDialog):
            self._name_a_file(asking, rng)
        elif isinstance(asking, QMessageBox):
            self._press(asking, rng)
        elif isinstance(asking, QDialog):
            self._fill_in(asking, rng)
        else:
            self._in_list(asking, rng)

    def _let_go(self) -> None:
        if self._held is None or time.monotonic() - self._held[2] < STUCK_SECONDS:
            return
        widget, at, _ = self._held
        self._held = None
        self.given.append("let go of the drag")
        handle = widget.window().windowHandle()
        if self._rng().random() < 0.3:
            QTest.keyClick(handle, _Key.Key_Escape)
        QTest.mouseMove(handle, widget.mapTo(widget.window(), at))
        QTest.mouseRelease(handle, Qt.MouseButton.LeftButton, pos=widget.mapTo(widget.window(), at))

    def _in_menu(self, menu: QMenu, rng: random.Random) -> None:
        actions = [action for action in menu.actions() if not action.isSeparator()]
        chance = rng.random()
        if not actions or chance < 0.1:
            self._key(menu, _Key.Key_Escape)
        elif chance < 0.6:
            action = rng.choice(actions)
            self.given.append(f"click {action.text()!r}")
            QTest.mouseClick(
                menu, Qt.MouseButton.LeftButton, pos=menu.actionGeometry(action).center()
            )
        else:
            for _ in range(rng.randrange(1, len(actions) + 1)):
                self._key(menu, rng.choice((_Key.Key_Down, _Key.Key_Down, _Key.Key_Up)))
            self._key(menu, rng.choice((_Key.Key_Return, _Key.Key_Right, _Key.Key_Left)))

    def _in_list(self, popup: QWidget, rng: random.Random) -> None:
        view = popup.findChild(QAbstractItemView) or popup
        for _ in range(rng.randrange(4)):
            self._key(view, rng.choice((_Key.Key_Down, _Key.Key_Up)))
        self._key(view, rng.choice((_Key.Key_Return, _Key.Key_Escape)))

    def _key(self, widget: QWidget, key: Qt.Key) -> None:
        self.given.append(key.name)
        QTest.keyClick(widget, key)

    def _name_a_file(self, dialog: QFileDialog, rng: random.Random) -> None:
        if rng.random() < 0.1:
            self._key(dialog, _Key.Key_Escape)
            return
        filters = " ".join(dialog.nameFilters())
        if dialog.fileMode() == QFileDialog.FileMode.Directory:
            text = str(self._files.folder / rng.choice(("sub folder", "nowhere")))
        elif dialog.acceptMode() == QFileDialog.AcceptMode.AcceptSave:
            text = str(self._files.to_save(rng))
        elif dialog.fileMode() == QFileDialog.FileMode.ExistingFiles:
            paths = [self._files.to_open(filters, rng) for _ in range(rng.randrange(1, 4))]
            text = " ".join(f'"{path}"' for path in paths)
        else:
            text = str(self._files.to_open(filters, rng))
        self.given.append(f"file {text}")
        edit = dialog.findChild(QLineEdit, "fileNameEdit")
        edit.setText(text)
        QTest.keyClick(edit, _Key.Key_Return)

    def _press(self, box: QMessageBox, rng: random.Random) -> None:
        if not box.buttons() or rng.random() < 0.1:
            self._key(box, _Key.Key_Escape)
            return
        button = rng.choice(box.buttons())
        self.given.append(f"{box.windowTitle()!r} {box.text()[:200]!r}: {button.text()!r}")
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)

    def _fill_in(self, dialog: QDialog, rng: random.Random) -> None:
        """Type, tick, choose and click in a dialog, small numbers above all."""
        kinds = (
            QLineEdit, QAbstractSpinBox, QComboBox, QAbstractButton, QTabBar, QAbstractItemView,
        )  # fmt: skip
        widgets = [
            widget
            for widget in dialog.findChildren(QWidget)
            if isinstance(widget, kinds) and widget.isVisible() and widget.isEnabled()
        ]
        if self._pokes == 1:
            # Pictures and animations of the size proposed would take most of the monkey's time.
            for box in dialog.findChildren(QSpinBox):
                _type_over(box, str(rng.choice(SMALL)))
        if not widgets or rng.random() < 0.1:
            self._key(dialog, rng.choice((_Key.Key_Escape, _Key.Key_Return)))
            return
        widget = rng.choice(widgets)
        self.given.append(f"{dialog.windowTitle()!r}: {type(widget).__name__}")
        if isinstance(widget, QAbstractSpinBox) or isinstance(widget.parent(), QAbstractSpinBox):
            _type_over(widget, str(rng.choice(SMALL)))
        elif isinstance(widget, QLineEdit):
            text = rng.choice(TEXTS)
            self.given.append(repr(text))
            widget.selectAll()
            type_text(widget, text)
            if rng.random() < 0.5:
                QTest.keyClick(widget, _Key.Key_Return)
        else:
            at = QPoint(rng.randrange(widget.width()), rng.randrange(widget.height()))
            target = widget.viewport() if isinstance(widget, QAbstractItemView) else widget
            QTest.mouseClick(target, Qt.MouseButton.LeftButton, pos=at)


def type_text(target: QWidget | QWindow, text: str) -> None:
    """Type letters of any alphabet: QTest's own typing knows Latin-1 alone."""
    for letter in text:
        QTest.sendKeyEvent(
            QTest.KeyAction.Click, target, _Key.Key_unknown, letter, Qt.KeyboardModifier.NoModifier
        )


def _type_over(widget: QWidget, text: str) -> None:
    QTest.keyClick(widget, _Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    type_text(widget, text)
