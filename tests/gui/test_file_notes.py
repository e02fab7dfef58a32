"""User stories: what was left out of a mesh stays to be read, by the mesh's name."""

from __future__ import annotations

import pytest
from qtpy.QtCore import QPoint, Qt
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication
from tests.gui.test_files import drop

from pinwarp.core.landmarks import Side
from pinwarp.io.samples import assets_folder

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
# A pyramid on a square, with a point and a line that belong to nothing.
PYRAMID = (
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nv 9 9 9\n"
    "f 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nl 1 2\n"
)
NOTES = (
    "1 line or point dropped.",
    "1 polygon of more than 3 corners cut into triangles.",
    "1 loose point dropped.",
)


def open_pyramid(user, tmp_path, side=SOURCE):
    path = tmp_path / "pyramid.obj"
    path.write_text(PYRAMID)
    user.window.parts.documents.open_mesh(side, path)
    user.settle()
    return user.window.viewports[side].file_notes


def click(widget):
    QTest.mouseClick(
        widget, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, QPoint(8, 8)
    )
    QApplication.processEvents()


def test_the_notes_on_a_mesh_stay_by_its_name_and_a_click_opens_them(user, tmp_path):
    notes = open_pyramid(user, tmp_path)
    message = user.window.statusBar().currentMessage()
    assert message == "pyramid.obj: 5 vertices, 6 triangles. " + " ".join(NOTES)
    user.window.say("something else")
    assert notes.isVisible()
    assert notes.button.text() == "3 notes on this file"
    assert not notes.label.isVisible()
    click(notes.button)
    assert notes.label.isVisible()
    assert notes.label.text() == "\n".join(f"• {note}" for note in NOTES)
    # All of it can be read, inside its viewport.
    assert notes.label.height() >= 3 * notes.fontMetrics().height()
    assert notes.parentWidget().rect().contains(notes.geometry())
    click(notes.button)
    assert not notes.label.isVisible()
    # No click went through to the bone.
    assert user.session.landmarks == ()
    assert user.window.viewports[DESTINATION].file_notes.isHidden()


def test_the_notes_go_with_the_mesh(user, tmp_path):
    notes = open_pyramid(user, tmp_path)
    click(notes.button)
    user.window.parts.documents.open_mesh(SOURCE, assets_folder() / "femur_generic.ply")
    user.settle()
    assert notes.isHidden()
    user.trigger("undo")
    assert notes.isVisible()
    assert not notes.is_open


def test_the_notes_fit_into_a_narrow_viewport(user, tmp_path):
    notes = open_pyramid(user, tmp_path)
    click(notes.button)
    view = user.window.viewports[SOURCE]
    view.resize(200, view.height())
    QApplication.processEvents()
    assert notes.geometry().right() < 200
    assert notes.label.height() > 4 * notes.fontMetrics().height()


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("scan.nrrd", b"NRRD0005\ntype: short\n", "This is an NRRD volume: segment the bone"),
        ("notes.qqq", b"anything", "'.qqq' are not supported"),
    ],
)
def test_what_is_dropped_and_no_mesh_is_named(user, tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    drop(user.window.viewports[SOURCE], tmp_path / name)
    user.settle()
    ((title, text),) = user.dialogs.errors
    assert title == f"Reading {name} failed"
    assert words in text


def test_a_mesh_of_a_new_kind_is_dropped_and_opened(user, tmp_path):
    (tmp_path / "pyramid.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    drop(user.window.viewports[DESTINATION], tmp_path / "pyramid.off")
    user.settle()
    assert user.session.destination.path.name == "pyramid.off"
    assert "3 vertices, 1 triangle" in user.window.statusBar().currentMessage()
