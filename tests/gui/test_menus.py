"""Where actions stand, and that they are checked as things are."""

from __future__ import annotations

import pytest
from qtpy.QtWidgets import QMenu

from pinwarp.gui.capability.action import Action
from pinwarp.gui.window.menus import fill, shortcut_groups


@pytest.fixture
def menu(qapp):
    menu = QMenu()
    yield menu
    menu.deleteLater()


def test_a_line_stands_between_the_tens_of_the_places_and_nowhere_else(menu):
    places = {"last": "Warp.21", "second": "Warp.12", "first": "Edit.1 Warp.11", "none": "Edit.9"}
    fill(menu, [Action(key, key, at=at, parent=menu) for key, at in places.items()], "Warp")
    assert [x.text() or "-" for x in menu.actions()] == ["first", "second", "-", "last"]


def test_the_sheet_lists_what_is_in_an_inner_menu_where_that_menu_stands(menu):
    places = {"quit": "File.99", "meshes": "export.11", "open": "File.11", "tables": "export.12"}
    made = [Action(key, key, at=at, parent=menu) for key, at in places.items()]
    (title, actions), *others = shortcut_groups(made)
    assert title == "File"
    assert [x.text() for x in actions] == ["open", "meshes", "tables", "quit"]
    assert not any(actions for _, actions in others)


def test_a_switch_that_changes_nothing_is_not_checked(menu):
    asked = []
    action = Action("guide", "Guide", switches=asked.append, checked=lambda: False, parent=menu)
    action.trigger()
    assert asked == [True]
    assert not action.isChecked()
