"""What the monkey does: one event, or one drag, at a time."""

from __future__ import annotations

import random
from collections.abc import Callable

import numpy as np
from qtpy.QtCore import QEvent, QMimeData, QPoint, QPointF, Qt, QUrl
from qtpy.QtGui import QAction, QDropEvent, QKeySequence, QMouseEvent, QWheelEvent
from qtpy.QtTest import QTest
from qtpy.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QDockWidget,
    QHeaderView,
    QLineEdit,
    QMenuBar,
    QSlider,
    QSplitter,
    QTabBar,
    QToolBar,
    QWidget,
)
from tests.gui.monkey.answers import TEXTS, Answers, type_text
from tests.gui.monkey.files import Files

from pinwarp.core.landmarks import Side
from pinwarp.gui.window.main_window import MainWindow

_LEFT, _MIDDLE, _RIGHT = (
    Qt.MouseButton.LeftButton,
    Qt.MouseButton.MiddleButton,
    Qt.MouseButton.RightButton,
)
_BUTTONS = (_LEFT, _LEFT, _LEFT, _MIDDLE, _RIGHT)
_NONE = Qt.KeyboardModifier.NoModifier
_SHIFT, _CTRL = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.ControlModifier
_MODIFIERS = (_NONE, _NONE, _NONE, _SHIFT, _CTRL, _SHIFT | _CTRL)
# Mostly small: every pixel is drawn by the processor here.
_SIZES = (*3 * ((620, 460), (560, 500), (760, 420)), (300, 200), (1300, 800), (1900, 300))
_NAMED_KEYS = (
    "Left Right Up Down Return Escape Tab Backtab Space Backspace Home End PageUp PageDown "
    "F2 F10 Delete A Z 1 9 Period Minus"
)
_KEYS = tuple(getattr(Qt.Key, f"Key_{name}") for name in _NAMED_KEYS.split(" "))
_TOUCHABLE = (
    QAbstractButton, QAbstractItemView, QAbstractSpinBox, QComboBox, QDockWidget, QHeaderView,
    QLineEdit, QMenuBar, QSlider, QSplitter, QTabBar, QToolBar,
)  # fmt: skip


class Hands:
    """Does random things to a window; each says what it did.

    Parameters
    ----------
    window
        Returns the window as it is now: it may have been closed and opened again.
    files
        Some of them are dropped onto the window.
    answers
        Is told what is held.
    """

    def __init__(self, window: Callable[[], MainWindow], files: Files, answers: Answers) -> None:
        self._window = window
        self._files = files
        self._answers = answers
        things = {
            self._shortcut: 22,
            self._key: 8,
            self._click_view: 16,
            self._drag_view: 14,
            self._wheel: 4,
            self._cell: 12,
            self._menu: 8,
            self._widget: 12,
            self._slide: 4,
            self._dock: 2,
            self._resize: 1,
            self._drop: 1,
        }
        self._things, self._weights = list(things), list(things.values())

    def act(self, rng: random.Random) -> str:
        """Do something, and say what."""
        window = self._window()
        if QApplication.activeWindow() is not window and rng.random() < 0.7:
            # Without a window manager nobody gives the keyboard back after a dialog or a dock.
            window.activateWindow()
            QTest.qWaitForWindowActive(window, 1000)
        (thing,) = rng.choices(self._things, self._weights)
        return f"{thing.__name__.strip('_')} {thing(rng)}"

    # Keys

    def _shortcut(self, rng: random.Random) -> str:
        # Of the actions themselves, so that new ones are pressed too.
        shortcuts = sorted(
            {
                (sequence.toString(), action.objectName())
                for action in self._window().findChildren(QAction)
                for sequence in action.shortcuts()
            }
        )
        sequence, name = rng.choice(shortcuts)
        QTest.keySequence(self._window().windowHandle(), QKeySequence(sequence))
        return f"{sequence} ({name})"

    def _key(self, rng: random.Random) -> str:
        handle = self._window().windowHandle()
        if rng.random() < 0.1:
            # Held a moment: the previous penalty is shown meanwhile.
            QTest.keyPress(handle, Qt.Key.Key_B)
            QTest.qWait(rng.randrange(30))
            QTest.keyRelease(handle, Qt.Key.Key_B)
            return "B held"
        key, modifier = rng.choice(_KEYS), rng.choice(_MODIFIERS)
        times = rng.choice((1, 1, 1, 3))
        for _ in range(times):
            QTest.keyClick(handle, key, modifier)
        return f"{key.name} {modifier.name} x{times}"

    # The views

    def _place(self, rng: random.Random) -> tuple[QWidget, QPoint]:
        """A place in a view: on a landmark, on the bone, or anywhere."""
        viewport = self._window().viewports[rng.choice(list(Side))]
        chance, width, height = rng.random(), max(viewport.width(), 1), max(viewport.height(), 1)
        places = [(x, y) for x, y in viewport.layer.places() if 0 <= x < width and 0 <= y < height]
        if chance < 0.4 and places:
            x, y = rng.choice(places)
            return viewport, QPointF(float(x), float(y)).toPoint()
        at = QPoint(rng.randrange(width), rng.randrange(height))
        for _ in range(20 if chance < 0.9 else 0):
            if viewport.pick(QPointF(at)) is not None:
                break
            at = QPoint(rng.randrange(width), rng.randrange(height))
        return viewport, at

    def _click_view(self, rng: random.Random) -> str:
        viewport, at = self._place(rng)
        button, modifier = rng.choice(_BUTTONS), rng.choice(_MODIFIERS)
        twice = rng.random() < 0.15
        self._click(viewport, at, button, modifier, twice=twice)
        return f"{viewport.side.value} {at.toTuple()} {button.name} {modifier.name} {twice=}"

    def _click(
        self,
        widget: QWidget,
        at: QPoint,
        button: Qt.MouseButton = _LEFT,
        modifier: Qt.KeyboardModifier = _NONE,
        *,
        twice: bool = False,
    ) -> None:
        """Click through the window system's way in, which knows modal windows and popups."""
        handle = widget.window().windowHandle()
        place = widget.mapTo(widget.window(), at)
        QTest.mouseMove(handle, place)
        self._answers.hold(widget, at)
        (QTest.mouseDClick if twice else QTest.mouseClick)(handle, button, modifier, place)
        self._answers.hold(None)

    def _drag_view(self, rng: random.Random) -> str:
        viewport, at = self._place(rng)
        button, modifier = rng.choice(_BUTTONS), rng.choice(_MODIFIERS)
        reach = rng.choice((3, 20, 80, 2000))
        path = [
            at + QPoint(rng.randint(-reach, reach), rng.randint(-reach, reach))
            for _ in range(rng.randrange(1, 5))
        ]
        escape = rng.random() < 0.1
        self._drag(viewport, [at, *path], button, modifier, escape=escape)
        ends = [place.toTuple() for place in (at, *path)]
        return f"{viewport.side.value} {ends} {button.name} {modifier.name} {escape=}"

    def _drag(
        self,
        widget: QWidget,
        path: list[QPoint],
        button: Qt.MouseButton = _LEFT,
        modifier: Qt.KeyboardModifier = _NONE,
        *,
        escape: bool = False,
    ) -> None:
        window = widget.window()
        handle = window.windowHandle()
        QTest.mousePress(handle, button, modifier, widget.mapTo(window, path[0]))
        for at in path[1:]:
            self._answers.hold(widget, at)
            event = QMouseEvent(
                QEvent.Type.MouseMove,
                QPointF(at),
                QPointF(widget.mapToGlobal(at)),
                Qt.MouseButton.NoButton,
                button,
                modifier,
            )
            QApplication.sendEvent(widget, event)
            QApplication.processEvents()
        self._answers.hold(None)
        if escape:
            QTest.keyClick(handle, Qt.Key.Key_Escape)
        QTest.mouseRelease(handle, button, modifier, widget.mapTo(window, path[-1]))

    def _wheel(self, rng: random.Random) -> str:
        viewport, at = self._place(rng)
        widget = viewport if rng.random() < 0.8 else rng.choice(self._touchables())
        notches = rng.choice((-20, -3, -1, 1, 3, 20))
        for _ in range(abs(notches)):
            event = QWheelEvent(
                QPointF(at),
                QPointF(widget.mapToGlobal(at)),
                QPoint(),
                QPoint(0, 120 if notches > 0 else -120),
                Qt.MouseButton.NoButton,
                rng.choice(_MODIFIERS),
                Qt.ScrollPhase.NoScrollPhase,
                False,
            )
            QApplication.sendEvent(widget, event)
        return f"{type(widget).__name__} {notches}"

    # The table, menus and other widgets

    def _cell(self, rng: random.Random) -> str:
        table = self._window().parts.table.table
        if not table.isVisible():
            dock = self._window().findChild(QDockWidget, "landmarks")
            dock.show()
            dock.raise_()
            QApplication.processEvents()
        if not table.isVisible() or not table.model().rowCount():
            return "no table"
        columns = [c for c in range(table.model().columnCount()) if not table.isColumnHidden(c)]
        row, column = rng.randrange(table.model().rowCount()), rng.choice(columns)
        index = table.model().index(row, column)
        table.scrollTo(index)
        at = table.visualRect(index).center()
        chance = rng.random()
        if chance < 0.15:
            self._click(table.viewport(), at, _RIGHT)
            return f"{row, column} menu"
        if chance < 0.3:
            to = at + QPoint(rng.randint(-30, 30), rng.randint(-150, 150))
            self._drag(table.viewport(), [at, at + QPoint(0, 15), to, to])
            return f"{row, column} dragged by {(to - at).toTuple()}"
        if chance < 0.5:
            self._click(table.viewport(), at, modifier=rng.choice(_MODIFIERS))
            return f"{row, column}"
        self._click(table.viewport(), at)
        self._click(table.viewport(), at, twice=True)
        text, end = rng.choice(TEXTS), rng.choice(("Return", "Tab", "Escape", "Up"))
        handle = table.window().windowHandle()
        type_text(handle, text)
        QTest.keyClick(handle, getattr(Qt.Key, f"Key_{end}"))
        return f"{row, column} edited to {text!r}, {end}"

    def _menu(self, rng: random.Random) -> str:
        bar = self._window().menuBar()
        action = rng.choice(bar.actions())
        if rng.random() < 0.5:
            self._click(bar, bar.actionGeometry(action).center())
        else:
            letter = action.text()[action.text().index("&") + 1].upper()
            QTest.keySequence(self._window().windowHandle(), QKeySequence(f"Alt+{letter}"))
        return action.text()

    def _touchables(self) -> list[QWidget]:
        return [
            widget
            for widget in self._window().findChildren(QWidget)
            if isinstance(widget, _TOUCHABLE) and widget.isVisible() and not widget.size().isEmpty()
        ]

    def _widget(self, rng: random.Random) -> str:
        widget = rng.choice(self._touchables())
        at = QPoint(rng.randrange(widget.width()), rng.randrange(widget.height()))
        button = rng.choice(_BUTTONS)
        target = widget.viewport() if isinstance(widget, QAbstractItemView) else widget
        name = widget.objectName() or widget.accessibleName() or getattr(widget, "text", str)()
        typed = ""
        self._click(target, at, button, rng.choice(_MODIFIERS), twice=rng.random() < 0.1)
        if isinstance(widget, (QLineEdit, QAbstractSpinBox)):
            typed = rng.choice(TEXTS)
            type_text(widget.window().windowHandle(), typed)
            QTest.keyClick(widget, rng.choice((Qt.Key.Key_Return, Qt.Key.Key_Escape)))
        return f"{type(widget).__name__} {name!r} {at.toTuple()} {button.name} {typed!r}"

    def _slide(self, rng: random.Random) -> str:
        sliders = [w for w in self._touchables() if isinstance(w, QSlider) and w.isEnabled()]
        if not sliders:
            return "no slider"
        slider = rng.choice(sliders)
        path = [
            QPoint(rng.randrange(slider.width()), slider.height() // 2)
            for _ in range(rng.randrange(2, 6))
        ]
        self._drag(slider, path, escape=rng.random() < 0.1)
        return f"{slider.accessibleName()!r} {[place.x() for place in path]}"

    def _dock(self, rng: random.Random) -> str:
        dock = rng.choice(self._window().findChildren(QDockWidget))
        if not dock.isVisible() or dock.window().windowHandle() is None:
            dock.toggleViewAction().trigger()
            return f"{dock.objectName()} toggled"
        self._click(dock, QPoint(min(40, dock.width() - 1), 8), twice=True)
        return f"{dock.objectName()} floating={dock.isFloating()}"

    def _resize(self, rng: random.Random) -> str:
        size = rng.choice(_SIZES)
        self._window().resize(*size)
        return str(size)

    def _drop(self, rng: random.Random) -> str:
        viewport = self._window().viewports[rng.choice(list(Side))]
        kind = rng.choice(("Sessions", "Meshes", "Landmarks", ""))
        paths = [self._files.to_open(kind, rng) for _ in range(rng.randrange(1, 3))]
        mime = QMimeData()
        mime.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
        event = QDropEvent(
            QPointF(*np.array((viewport.width(), viewport.height())) / 2),
            Qt.DropAction.CopyAction,
            mime,
            _LEFT,
            _NONE,
        )
        QApplication.sendEvent(viewport, event)
        return str([path.name for path in paths])
