"""User story: a report for the supervisor."""

from __future__ import annotations

import csv

from qtpy.QtCore import Qt

CTRL_SHIFT = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier


def test_a_report_is_one_page_with_both_views_and_the_numbers_lie_beside_it(user, tmp_path):
    user.open_sample()
    path = tmp_path / "femur.html"
    user.dialogs.saves = [path]
    user.press(Qt.Key.Key_E, CTRL_SHIFT)
    page = path.read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,iVBOR") == 2
    assert "lateral_epicondyle" in page
    assert user.session.source.sha256 in page
    assert "<svg" in page
    rows = list(csv.DictReader((tmp_path / "femur.csv").read_text(encoding="utf-8").splitlines()))
    left_out = {row["item"]: float(row["value"]) for row in rows if row["quantity"] == "left out"}
    assert set(left_out) == {pair.name for pair in user.session.pairs}
    assert user.window.parts.quality.quality.left_out.distances.tolist() == [*left_out.values()]
    far = {row["item"]: row["value"] for row in rows if row["quantity"] == "maximum"}
    assert set(far) == {"source to destination", "destination to source"}
    assert "femur.csv" in user.window.statusBar().currentMessage()


def test_a_report_that_cannot_be_written_is_told_and_leaves_nothing(user, tmp_path):
    user.open_sample()
    user.dialogs.saves = [tmp_path / "nowhere" / "femur.html"]
    user.press(Qt.Key.Key_E, CTRL_SHIFT)
    ((title, text),) = user.dialogs.errors
    assert "femur.html" in title
    assert "No such file" in text
    assert not [*tmp_path.rglob("*.html"), *tmp_path.rglob("*.csv")]


def test_without_pairs_there_is_nothing_to_report(user):
    assert not user.window.actions_by_key["export_report"].isEnabled()
