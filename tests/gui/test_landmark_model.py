"""The model of the table: what it tells its views, and that it keeps Qt's rules."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from qtpy.QtCore import Qt
from qtpy.QtTest import QAbstractItemModelTester, QTest
from qtpy.QtWidgets import QTableView

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.gui.table.columns import COLUMNS, column_number
from pinwarp.gui.table.model import LandmarkModel
from pinwarp.gui.table.order import LandmarkOrder
from pinwarp.session import edits
from pinwarp.session.session import Session


def session_of(names):
    return Session(
        landmarks=tuple(
            Landmark(name, (i, 0.0, 0.0), (i, 1.0, 0.0)) for i, name in enumerate(names)
        )
    )


@pytest.fixture
def model(qapp):
    return LandmarkModel()


@pytest.fixture
def changes(model):
    """What the model tells: signals with their rows and columns."""
    heard = []
    model.dataChanged.connect(
        lambda a, b, _roles: heard.append(("changed", a.row(), b.row(), a.column(), b.column()))
    )
    for signal, word in (
        (model.modelReset, "reset"),
        (model.layoutChanged, "sorted"),
        (model.rowsInserted, "inserted"),
        (model.rowsRemoved, "removed"),
    ):
        signal.connect(lambda *rows, word=word: heard.append((word, *rows[1:3])))
    return heard


LAST = len(COLUMNS) - 1


def test_only_the_rows_that_differ_are_announced(model, changes):
    session = session_of("abcdefgh")
    model.show_session(session)
    changes.clear()
    model.show_session(edits.move(session, "c", Side.SOURCE, (9, 9, 9)))
    assert changes == [("changed", 2, 2, 0, LAST)]
    changes.clear()
    session = edits.set_enabled(session, ["b", "c", "f"], False)
    model.show_session(edits.move(session, "c", Side.SOURCE, (9, 9, 9)))
    assert changes == [("changed", 1, 2, 0, LAST), ("changed", 5, 5, 0, LAST)]
    changes.clear()
    model.show_values("residual", {"d": 1.0})
    column = column_number("residual")
    of_row, of_bars = ("changed", 3, 3, column, column), ("changed", 0, 7, column, column)
    assert changes == [of_row, of_bars], "all bars are measured by the longest"
    changes.clear()
    model.show_values("residual", {"d": 1.0, "e": 0.5})
    assert changes == [("changed", 4, 4, column, column)]


def test_rows_come_go_and_move_without_a_reset(model, changes):
    session = session_of("abcdef")
    model.show_session(session)
    changes.clear()
    model.show_session(edits.remove(session, ["b", "c", "f"]))
    assert changes == [("removed", 5, 5), ("removed", 1, 2)]
    changes.clear()
    model.show_session(session)
    assert changes == [("inserted", 1, 2), ("inserted", 5, 5)]
    changes.clear()
    model.show_session(edits.reorder(session, ["e"], 0))
    assert [change[0] for change in changes] == ["sorted"]
    model.show_session(session)
    changes.clear()
    model.show_session(edits.rename(session, "a", "apex"))
    assert changes == [("changed", 0, 0, 0, LAST)]


def test_selection_and_scroll_position_outlast_changes(model, qtbot):
    view = QTableView()
    qtbot.addWidget(view)
    view.setModel(model)
    view.resize(300, 200)
    view.show()
    session = session_of([f"p{i}" for i in range(500)])
    model.show_session(session)
    view.selectRow(250)
    view.scrollTo(model.index(250, 0))
    QTest.qWait(20)
    before = view.verticalScrollBar().value()
    session = edits.move(session, "p3", Side.SOURCE, (9, 9, 9))
    model.show_session(edits.rename(session, "p7", "apex"))
    assert view.verticalScrollBar().value() == before
    (index,) = view.selectionModel().selectedRows()
    assert index.data() == "p250"
    model.show_session(edits.reorder(edits.remove(session, ["p0"]), ["p250"], 0))
    (index,) = view.selectionModel().selectedRows()
    assert (index.row(), index.data()) == (0, "p250")


names = st.lists(st.sampled_from("abcdefgh"), unique=True, max_size=8)


@settings(max_examples=60, deadline=None)
@given(
    orders=st.lists(names, min_size=2, max_size=5),
    text=st.sampled_from(["", "a", "paired", "x"]),
)
def test_the_models_keep_the_rules_of_qt_from_any_session_to_any_other(qapp, orders, text):
    model = LandmarkModel()
    order = LandmarkOrder(model)
    fatal = QAbstractItemModelTester.FailureReportingMode.Fatal
    testers = [QAbstractItemModelTester(thing, fatal) for thing in (model, order)]
    order.set_filter(text)
    order.sort(0, Qt.SortOrder.DescendingOrder)
    for found in orders:
        session = session_of(found)
        model.show_session(session)
        assert [model.index(row, 0).data() for row in range(model.rowCount())] == found
        shown = [order.index(row, 0).data() for row in range(order.rowCount())]
        wanted = [name for name in found if text == "paired" or text in name]
        assert shown == sorted(wanted, reverse=True)
    assert len(testers) == 2


def test_a_pair_keeps_its_residual_under_another_name(user):
    user.open_sample()
    user.editor.commit(edits.set_penalty(user.session, 50.0), "Change penalty")
    user.settle()
    a, b = (x.name for x in user.session.pairs[:2])
    model, column = user.window.parts.table.model, column_number("residual")
    before = model.index(0, column).data()
    assert float(before) > 0
    user.editor.commit(edits.rename_many(user.session, {a: b, b: a}), "Rename")
    user.settle()
    assert model.index(0, 0).data() == b
    assert model.index(0, column).data() == before
