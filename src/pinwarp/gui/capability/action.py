"""Something that can be asked for: its words, keys and icon, where it stands, what it does."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from qtpy.QtCore import QObject
from qtpy.QtGui import QAction, QActionGroup, QKeySequence
from qtpy.QtWidgets import QHBoxLayout, QSizePolicy, QWidget, QWidgetAction

from pinwarp.gui.style.icons import icon as icon_named

# The property of any QAction that says where it stands.
PLACES = "places"
# The property that says what it does, for the sheet of shortcuts.
DEED = "deed"


class Action(QAction):
    """An action that knows when it is possible, and what is checked, by asking.

    Parameters
    ----------
    key
        Its name in the program.
    text
        What it is called in a menu.
    does
        Called when it is asked for.
    switches
        Called instead with whether it is to be on: for what is on or off.
    at
        Where it stands, such as ``"File.12 tools.3"``: in the File menu, and in the toolbar. The
        numbers are an order; where their tens differ, a line stands between.
    keys
        Its shortcuts, the one that is told first.
    icon
        Of the project's own.
    tip
        What it does, in more words than its text.
    deed
        What it does, from a verb on, where its text has none: a menu's title or a tick says it
        there, the sheet of shortcuts has neither.
    button
        What it is called on a button.
    possible
        Says whether it can be asked for as things are; always where there is none.
    checked
        Says whether it is on, for what is on or off or one of several.
    """

    def __init__(
        self,
        key: str,
        text: str,
        does: Callable[[], object] | None = None,
        *,
        switches: Callable[[bool], object] | None = None,
        at: str = "",
        keys: str = "",
        icon: str = "",
        tip: str = "",
        deed: str = "",
        button: str = "",
        possible: Callable[[], object] | None = None,
        checked: Callable[[], object] | None = None,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(text, parent)
        self.setObjectName(key)
        self.setProperty(PLACES, at)
        self.setProperty(DEED, deed)
        self.setShortcuts([QKeySequence(one) for one in keys.split()])
        self._tip = tip
        self.reword(text)
        if button:
            self.setIconText(button)
        if icon:
            self.setIcon(icon_named(icon))
        self._does, self._switches = does, switches
        self._possible, self._checked = possible, checked
        self.setCheckable(checked is not None)
        self.triggered.connect(self._on_triggered)
        self.renew()

    @property
    def keys(self) -> str:
        """Its first shortcut in words, empty without one."""
        return str(self.shortcut().toString(QKeySequence.SequenceFormat.NativeText))

    def reword(self, text: str, tip: str | None = None) -> None:
        """Call it something else; what its tip says names its key."""
        self.setText(text)
        self._tip = self._tip if tip is None else tip
        words = self._tip or text.replace("&", "").rstrip("…")
        self.setToolTip(f"{words} ({self.keys})" if self.keys else words)

    def renew(self) -> None:
        """Be possible and checked as things are now."""
        if self._possible is not None:
            self.setEnabled(bool(self._possible()))
        if self._checked is not None:
            self.setChecked(bool(self._checked()))

    def _on_triggered(self, on: bool) -> None:
        if self._switches is not None:
            self._switches(on)
        elif self._does is not None:
            self._does()
        # What Qt has switched stays only where what it stands for has changed, too.
        self.renew()


def name_and_held(action: QAction) -> tuple[str, str]:
    """Return what an action is called, and the key that is held for it, behind a tab."""
    name, _, held = action.text().replace("&", "").partition("\t")
    return name, held


def one_of(actions: Iterable[QAction], parent: QObject) -> list[QAction]:
    """Return actions of which one is checked at a time."""
    group = QActionGroup(parent)
    return [group.addAction(action) for action in actions]


def placed(action: QAction, at: str) -> QAction:
    """Return an action that Qt made, a menu's or a widget's, with the places where it stands."""
    action.setProperty(PLACES, at)
    return action


def tool(widget: QWidget, at: str) -> QAction:
    """Return an action that is a widget in a toolbar, no wider than it wants to be."""
    holder = QWidget()
    row = QHBoxLayout(holder)
    row.setContentsMargins(4, 0, 8, 0)
    row.addWidget(widget)
    holder.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)
    action = QWidgetAction(None)
    action.setDefaultWidget(holder)
    return placed(action, at)
