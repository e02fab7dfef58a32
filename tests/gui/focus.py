"""What somebody meets who has a keyboard and no eyes for the screen."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from qtpy.QtCore import QPoint, Qt
from qtpy.QtGui import QAccessible
from qtpy.QtTest import QTest
from qtpy.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLabel,
    QLineEdit,
    QPushButton,
    QRadioButton,
    QTabBar,
    QWidget,
)

MOST_STEPS = 200


def name_of(widget: QWidget) -> str:
    """Return what a screen reader says of a widget."""
    if isinstance(widget, QComboBox):
        # On Linux Qt reads out what is chosen, which does not say what it is chosen for.
        labels = widget.window().findChildren(QLabel)
        labelled = next((x.text() for x in labels if x.buddy() is widget), "")
        return widget.accessibleName() or labelled
    told = QAccessible.queryAccessibleInterface(widget)
    return told.text(QAccessible.Text.Name).strip() if told is not None else ""


def words_about(widget: QWidget) -> str:
    """Say which widget it is, to whoever has to mend it."""
    return f"{type(widget).__name__} {name_of(widget)!r} in {type(widget.parent()).__name__}"


def takes_focus(widget: QWidget) -> bool:
    """Whether a widget can be used; a spin box or a choice speaks for the field inside it."""
    return (
        widget.focusPolicy() != Qt.FocusPolicy.NoFocus
        and widget.isVisible()
        and widget.isEnabled()
        and widget.focusProxy() is None
        and not isinstance(widget.parent(), QAbstractSpinBox | QComboBox)
    )


def nameless(window: QWidget) -> list[str]:
    """Return all that can be used in a window and does not say what it is."""
    return [
        words_about(widget)
        for widget in window.findChildren(QWidget)
        if widget.isVisible()
        and (takes_focus(widget) or isinstance(widget, QAbstractButton))
        # What can be selected and copied is its own name, where there is any.
        and not isinstance(widget, QLabel)
        and not name_of(widget)
        # Inside a widget of Qt's.
        and not widget.objectName().startswith("qt_")
        and not isinstance(widget.parent(), QLineEdit)
    ]


def tabbed(window: QWidget) -> list[QWidget]:
    """Return what the Tab key goes to, from the first focus until it has been round."""
    met: list[QWidget] = []
    for _ in range(MOST_STEPS):
        at = QApplication.focusWidget()
        if at is None or at in met:
            break
        met.append(at)
        QTest.keyClick(at, Qt.Key.Key_Tab)
    return met


def _top(widget: QWidget, window: QWidget) -> int:
    return widget.mapTo(window, QPoint(0, 0)).y()


def _bottom(widget: QWidget, window: QWidget) -> int:
    return _top(widget, window) + widget.height()


def _same_choice(one: QWidget, other: QWidget) -> bool:
    """Whether arrows lead from one radio button to another."""
    return (
        isinstance(one, QRadioButton)
        and isinstance(other, QRadioButton)
        and one.group() is not None
        and one.group() is other.group()
    )


def not_reached(window: QWidget, met: Sequence[QWidget] | None = None) -> list[str]:
    """Return all in a window that Tab does not lead to from where the focus is."""
    met = tabbed(window) if met is None else met
    return [
        f"not reached: {words_about(widget)}"
        for widget in window.findChildren(QWidget)
        if takes_focus(widget)
        and widget.focusPolicy().value & Qt.FocusPolicy.TabFocus.value
        and widget.window() is window
        and widget not in met
        and not any(_same_choice(widget, other) for other in met)
    ]


def faults_of(window: QWidget) -> list[str]:
    """Return what is in the way of somebody in a window that is in front."""
    faults = [f"no name: {words}" for words in nameless(window)]
    first = QApplication.focusWidget()
    if first is None:
        return [*faults, "nothing has the focus at first"]
    met = tabbed(window)
    faults += not_reached(window, met)
    faults += [
        f"not the chosen one: {words_about(x)}"
        for x in met
        if isinstance(x, QRadioButton) and not x.isChecked()
    ]
    above = [x for x in met if _bottom(x, window) < _top(first, window)]
    if above and not isinstance(first, QPushButton) and not isinstance(above[0], QTabBar):
        faults.append(f"begins at {words_about(first)}, below {words_about(above[0])}")
    for one, after in pairwise(met):
        if _bottom(after, window) < _top(one, window) and not isinstance(one, QPushButton):
            faults.append(f"goes up: {words_about(one)} to {words_about(after)}")
    return faults
