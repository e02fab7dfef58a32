"""A view that fails stops neither the other views nor the journal."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from tests.session.test_journal import eventually
from tests.two_spheres import pairs, two_spheres

from pinwarp.core.landmarks import Landmark
from pinwarp.io.work_file import read_work
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.judging.survey import Surveyor
from pinwarp.session.keeping.journal import WORK, Journal
from pinwarp.session.session import Session, to_record
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver


@pytest.fixture
def told(monkeypatch):
    """What went to the hook for what nobody caught."""
    errors: list[BaseException] = []
    monkeypatch.setattr(sys, "excepthook", lambda _kind, error, _where: errors.append(error))
    return errors


def broken(_value: object = None) -> None:
    raise ZeroDivisionError("a view fails")


def test_listeners_after_one_that_raises_hear_every_signal_of_the_editor(told):
    editor, heard = Editor(), []
    for name in ("session_changed", "selection_changed", "view_changed", "saved"):
        signal = getattr(editor, name)
        signal.connect(broken)
        signal.connect(lambda *_, name=name: heard.append(name))
    editor.commit(Session(landmarks=(Landmark("a"),)), "Add")
    editor.select("a")
    editor.look(arrows=False)
    editor.replace_all(Session(), None)
    assert heard == [
        "session_changed",
        "selection_changed",
        "view_changed",
        "selection_changed",
        "session_changed",
        "saved",
    ]
    assert [type(error) for error in told] == [ZeroDivisionError] * len(heard)


def test_a_listener_that_commits_and_one_that_raises_leave_the_last_session_to_all(told):
    editor, heard = Editor(), []

    def corrects(session: Session) -> None:
        if session.unit == "m":
            editor.commit(edits.set_unit(session, "cm"), "Correct")

    for listener in (broken, corrects, lambda session: heard.append(session.unit)):
        editor.session_changed.connect(listener)
    editor.commit(edits.set_unit(editor.session, "m"), "Change unit")
    assert editor.session.unit == "cm"
    assert set(heard) == {"cm", "m"}
    assert len(told) == 2


def test_control_c_in_a_listener_is_not_held_back():
    editor = Editor()

    def interrupted(_session: Session) -> None:
        raise KeyboardInterrupt

    editor.session_changed.connect(interrupted)
    with pytest.raises(KeyboardInterrupt):
        editor.commit(edits.set_unit(editor.session, "m"), "Change unit")


def test_the_journal_hears_of_a_change_before_any_view_whoever_came_first(tmp_path, monkeypatch):
    order = []
    note = Journal._note
    monkeypatch.setattr(
        Journal, "_note", lambda self, _=None: (order.append("journal"), note(self))[1]
    )
    editor = Editor()
    editor.session_changed.connect(lambda: order.append("view"))
    journal = Journal(editor, tmp_path, failed=pytest.fail)
    order.clear()
    editor.commit(edits.set_unit(editor.session, "m"), "Change unit")
    journal.close()
    assert order == ["journal", "view"]


def test_work_is_on_the_disk_though_every_view_fails(tmp_path, told):
    editor = Editor()
    editor.session_changed.connect(broken)
    journal = Journal(editor, tmp_path, failed=pytest.fail)
    editor.session_changed.connect(broken)
    editor.commit(Session(landmarks=pairs()), "Add pairs")
    assert eventually((journal.folder / WORK).exists)
    kept = read_work(journal.folder / WORK)
    journal.close()
    assert kept.record == to_record(editor.committed)
    assert kept.label == "Add pairs"
    assert len(told) == 2


def test_the_small_sphere_folds_as_a_whole_and_the_large_one_not_at_all():
    mesh = two_spheres()
    inputs = WarpInputs.of(Session(landmarks=pairs()))
    result = WarpSolver().solve(WarpInputs(**(vars(inputs) | {"mesh": mesh})))
    folds = Surveyor().survey(result, None, None).folds
    small = mesh.vertices[:, 2] > 90
    assert np.array_equal(folds.is_folded, small)
    assert len(folds.patches) == 1
