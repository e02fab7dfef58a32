"""User story: digitise a set three times, and learn what that says of landmarks and penalty."""

from __future__ import annotations

import numpy as np
import pytest
from qtpy.QtCore import QPoint, Qt
from qtpy.QtTest import QTest
from tests.gui.dropping import drop

from pinwarp.core.landmarks import Side
from pinwarp.gui.repeat.spread_table import LANDMARK, SPREAD
from pinwarp.gui.table.columns import column_number
from pinwarp.io.landmark_files import write_landmarks
from pinwarp.io.samples import sample_session
from pinwarp.session.keeping.files import read_session


@pytest.fixture
def files(tmp_path):
    """Three repeats of the sample's destination; in the third one landmark is far off."""
    rng = np.random.default_rng(0)
    paths = [tmp_path / name for name in ("a.csv", "b.csv", "c.csv")]
    for path in paths:
        marks = [
            x.placed(Side.DESTINATION, np.add(x.destination, 0.4 * rng.normal(size=3)))
            for x in read_session(sample_session(), meshes=()).pairs
        ]
        if path.name == "c.csv":
            marks[2] = marks[2].placed(Side.DESTINATION, np.add(marks[2].destination, 9))
        write_landmarks(path, marks, Side.DESTINATION)
    return paths


def click(widget):
    QTest.mouseClick(widget, Qt.MouseButton.LeftButton)


def tick(box):
    QTest.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(8, box.height() // 2))


def opened(user):
    """Open the dialog."""
    user.window.actions_by_key["landmark_precision"].trigger()
    return user.window.parts.precision.dialog


def column_of(table, column):
    return [table.topLevelItem(row).text(column) for row in range(table.topLevelItemCount())]


def tip_of(user, name, column):
    model = user.window.parts.table.model
    row = [x.name for x in model.landmarks].index(name)
    return model.index(row, column_number(column)).data(Qt.ItemDataRole.ToolTipRole)


def test_repeats_say_what_is_imprecise_and_which_penalty_belongs_to_that(user, files, tmp_path):
    user.open_sample()
    names = [pair.name for pair in user.session.pairs]
    # Files in millimetres are told as the menu says.
    user.trigger("lengths_cm")
    dialog = opened(user)
    assert not dialog.use.isEnabled()
    assert not dialog.keep.isEnabled()
    # One file has nothing to compare with.
    user.dialogs.opens_many = [files[:1]]
    click(dialog.add)
    user.settle()
    assert "nothing to compare with" in dialog.notes.toPlainText()
    drop(dialog, *files[1:])
    user.settle()
    # The worst come first, and a click on a header sorts otherwise.
    assert dialog.table.topLevelItem(0).text(LANDMARK) == names[2]
    assert not dialog.table.topLevelItem(0).icon(LANDMARK).isNull()
    assert f"{names[2]} stands out" in dialog.notes.toPlainText()
    assert "c.csv has it farthest" in dialog.notes.toPlainText()
    spreads = [float(x) for x in column_of(dialog.table, SPREAD)]
    assert spreads == sorted(spreads, reverse=True)
    header = dialog.table.header()
    at = QPoint(header.sectionPosition(LANDMARK) + 20, header.height() // 2)
    QTest.mouseClick(header.viewport(), Qt.MouseButton.LeftButton, pos=at)
    assert column_of(dialog.table, LANDMARK) == sorted(names)
    # Without the file that is off, what it says goes, too.
    QTest.mouseClick(
        dialog.files.viewport(),
        Qt.MouseButton.LeftButton,
        pos=dialog.files.visualItemRect(dialog.files.item(2)).center(),
    )
    click(dialog.remove)
    user.settle()
    assert "stands out" not in dialog.notes.toPlainText()
    # The penalty is one step, and is not offered again.
    before = user.session.settings.penalty
    click(dialog.use)
    penalty = user.session.settings.penalty
    assert penalty > 0
    assert f"{penalty / 10:.3g} cm" in dialog.penalty.text()
    assert " cm (95%: 0.0" in dialog.spread.text()
    assert dialog.table.headerItem().text(SPREAD) == "Spread (cm)"
    assert max(spreads) < 2
    assert not dialog.use.isEnabled()
    click(dialog.keep)
    assert "are kept with the session" in dialog.done_words.text()
    assert all(pair.destination_spread for pair in user.session.pairs)
    click(dialog.buttons.buttons()[0])
    user.settle()
    assert user.window.parts.precision.dialog is None
    assert "× its spread" in tip_of(user, names[0], "residual")
    assert "× its spread" in tip_of(user, names[0], "left_out")
    # They follow a name, go with their landmark and come back with it; a file keeps them.
    user.editor.select(names[0])
    user.dialogs.saves = [tmp_path / "kept.pinwarp.csv"]
    user.trigger("save")
    assert read_session(tmp_path / "kept.pinwarp.csv").landmarks == user.session.landmarks
    kept = user.session.landmark(names[0])
    user.press(Qt.Key.Key_Delete, Qt.KeyboardModifier.ControlModifier)
    assert user.session.landmark(names[0]) is None
    user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert user.session.landmark(names[0]) == kept
    user.trigger("remove_spreads")
    assert not user.window.actions_by_key["remove_spreads"].isEnabled()
    assert "spread" not in tip_of(user, names[0], "residual")
    for _ in range(3):
        user.press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert user.session.settings.penalty == before
    assert not any(pair.destination_spread for pair in user.session.pairs)


def test_another_frame_the_wrong_side_and_the_sessions_own_landmarks_are_told(user, files):
    user.open_sample()
    turned = files[1].with_name("turned.csv")
    marks = [
        x.placed(Side.DESTINATION, np.multiply(x.destination, [-1, -1, 1]))
        for x in user.session.pairs
    ]
    write_landmarks(turned, marks, Side.DESTINATION)
    dialog = opened(user)
    drop(dialog, files[0], turned)
    user.settle()
    assert "Tick “Bring all to the frame and unit of the first”" in dialog.notes.toPlainText()
    assert dialog.table.topLevelItemCount() == 0
    tick(dialog.adapt)
    user.settle()
    assert dialog.table.topLevelItemCount() == len(user.session.pairs)
    assert "with x and y negated" in dialog.notes.toPlainText()
    assert dialog.keep.isEnabled()
    tick(dialog.sides[Side.SOURCE])
    user.settle()
    assert "is it the destination that was digitised again?" in dialog.notes.toPlainText()
    tick(dialog.sides[Side.DESTINATION])
    tick(dialog.with_session)
    user.settle()
    assert "this session and turned.csv hold the same positions" in dialog.notes.toPlainText()
    # What closes the window closes the dialog.
    user.window.close()
