"""What we rely on in the toolkit, found out the hard way."""

from __future__ import annotations

import sys

from qtpy.QtCore import QPointF


def test_calls_into_qt_lose_no_reference_to_none(qapp):
    """PySide 6.12.0 did on Python 3.11: the program died in the middle of long work."""
    point = QPointF()
    before = sys.getrefcount(None)
    for _ in range(1000):
        point.setX(1.0)
    assert sys.getrefcount(None) > before - 500


def test_a_window_opens_without_a_warning_of_qt(user, qtlog):
    user.open_sample()
    assert [record.message for record in qtlog.records] == []
