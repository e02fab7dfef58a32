"""Radio buttons: one of several."""

from __future__ import annotations

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QButtonGroup


def lead_tab_to_checked(group: QButtonGroup) -> None:
    """Let Tab go to the button of a group that is checked, as Qt does once one had the focus.

    Before that it goes to the first one: it would be read as what is chosen.
    """
    for button in group.buttons():
        policies = Qt.FocusPolicy
        button.setFocusPolicy(policies.StrongFocus if button.isChecked() else policies.ClickFocus)
