"""User stories: curves and patches leave for other programs, and come in from them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from qtpy.QtWidgets import QLabel
from tests.gui.test_importing import press

from pinwarp.core.curves import PathFinder
from pinwarp.core.groups import Curve, Handle
from pinwarp.core.landmarks import Side
from pinwarp.core.surface import Surface
from pinwarp.gui.tasks.dialogs import Existing
from pinwarp.io.landmark_files import read_landmarks
from pinwarp.session import edits

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


@pytest.fixture
def grouped(user):
    """The sample with a curve between two landmarks, and a small patch."""
    user.open_sample()
    session = user.session
    finder = PathFinder(Surface(session.mesh(SOURCE)))
    ends = [session.landmark(x) for x in ("greater_trochanter_tip", "lesser_trochanter_tip")]
    handles = [Handle(end.source, landmark=end.name) for end in ends]
    session, _ = edits.add_curve(session, handles, finder, count=7, name="crest")
    session, _ = edits.add_patch(session, finder, count=20, name="shaft")
    user.editor.commit(session, "Draw")
    user.settle()
    return user


def said(user):
    return user.window.statusBar().currentMessage()


def test_semilandmarks_leave_with_all_files_of_a_format(grouped, tmp_path):
    grouped.dialogs.saves = [tmp_path / "bone.tps"]
    grouped.trigger("export_destination_semilandmarks")
    grouped.settle()
    assert grouped.dialogs.errors == []
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["bone.sliders.csv", "bone.surfslide.csv", "bone.tps"]
    assert said(grouped).startswith("Exported bone.tps, bone.sliders.csv, bone.surfslide.csv: 16")
    assert len((tmp_path / "bone.sliders.csv").read_text().splitlines()) == 8


@pytest.mark.parametrize("answer", [Existing.CANCEL, Existing.REPLACE])
def test_a_file_beside_is_not_replaced_unasked(grouped, tmp_path, answer):
    other = tmp_path / "bone.sliders.csv"
    other.write_text("mine")
    grouped.dialogs.saves = [tmp_path / "bone.tps"]
    grouped.dialogs.existing = answer
    grouped.trigger("export_source_semilandmarks")
    grouped.settle()
    assert grouped.dialogs.existing_questions == [["bone.sliders.csv"]]
    assert (other.read_text() == "mine") == (answer is Existing.CANCEL)
    assert (tmp_path / "bone.tps").exists() == (answer is Existing.REPLACE)


def test_without_curves_and_patches_there_is_nothing_to_export(user):
    user.open_sample()
    for side in Side:
        assert not user.window.actions_by_key[f"export_{side.value}_semilandmarks"].isEnabled()


def test_a_curve_comes_in_is_looked_at_first_and_one_undo_takes_it_back(grouped, tmp_path):
    grouped.dialogs.saves = [tmp_path / "bone.mrk.json"]
    grouped.trigger("export_source_semilandmarks")
    grouped.settle()
    grouped.editor.commit(replace(grouped.session, groups=()), "Remove")
    before = grouped.session

    def look(dialog):
        assert grouped.session is before
        words = " ".join(label.text() for label in dialog.findChildren(QLabel))
        assert "1 curve in bone.crest.mrk.json" in words
        assert "crest: a curve through 9 places, anchored at 2 landmarks" in words
        press(dialog)

    grouped.dialogs.opens = [tmp_path / "bone.crest.mrk.json"]
    grouped.dialogs.at_import = [look]
    grouped.trigger("import_source")
    grouped.settle()
    assert grouped.dialogs.at_import == []
    crest = grouped.session.group("crest")
    assert isinstance(crest, Curve)
    assert [x.landmark for x in crest.anchors] == [
        "greater_trochanter_tip",
        "lesser_trochanter_tip",
    ]
    assert grouped.session.landmarks == before.landmarks
    assert "crest: a curve through 9 places" in said(grouped)
    grouped.trigger("undo")
    assert grouped.session == before


def test_a_curve_drawn_elsewhere_draws_the_one_on_the_destination(grouped, tmp_path):
    grouped.dialogs.saves = [tmp_path / "bone.mrk.json"]
    grouped.trigger("export_destination_semilandmarks")
    grouped.settle()
    assert not grouped.session.group("crest").is_drawn
    path = tmp_path / "bone.crest.mrk.json"
    points = [x.destination for x in read_landmarks(path, DESTINATION).landmarks]
    grouped.dialogs.opens = [path]
    grouped.dialogs.at_import = [press]
    grouped.trigger("import_destination")
    grouped.settle()
    crest = grouped.session.group("crest")
    assert crest.is_drawn
    np.testing.assert_allclose(crest.handles[0].destination, points[0])
    assert "drawn on the destination" in said(grouped)
