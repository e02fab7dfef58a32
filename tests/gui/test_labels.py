"""The names of landmarks: beside their signs, and never one over another."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from qtpy.QtCore import QPoint, QPointF, QRectF, QSizeF, Qt
from qtpy.QtGui import QImage, QPainter
from qtpy.QtTest import QTest

from pinwarp.core.landmarks import Side
from pinwarp.gui.painted import labels
from pinwarp.gui.painted.labels import Labels

SHEET = QSizeF(420, 550)


@pytest.fixture
def painter(qapp):
    image = QImage(420, 550, QImage.Format.Format_RGB32)
    painter = QPainter(image)
    yield painter
    painter.end()


def laid_out(painter, names, places, known=None, legend=None):
    """Where names stand: a rectangle each, empty where there was no room."""
    known = known or Labels()
    known.begin(painter, SHEET, legend)
    known.spare(np.array(places, float), 6.0)
    return [
        known.draw(painter, name, QPointF(*at), always=False)
        for name, at in zip(names, places, strict=True)
    ]


def overlaps(plates):
    seen = [plate for plate in plates if not plate.isEmpty()]
    return [(a, b) for i, a in enumerate(seen) for b in seen[:i] if a.intersects(b)]


def test_names_of_close_landmarks_stand_apart_and_none_is_lost(painter):
    places = [(200, 300), (206, 304), (200, 312), (190, 306)]
    plates = laid_out(painter, ["head", "neck", "notch", "groove"], places)
    assert not any(plate.isEmpty() for plate in plates)
    assert overlaps(plates) == []


def test_in_a_crowd_the_first_keep_their_names_and_none_covers_another(painter):
    places = np.random.default_rng(3).normal((210, 275), 40, (300, 2)).tolist()
    names = [f"landmark_{i}" for i in range(300)]
    plates = laid_out(painter, names, places)
    assert not any(plate.isEmpty() for plate in plates[:4])
    assert 20 < sum(not plate.isEmpty() for plate in plates) < 300
    assert overlaps(plates) == []


def test_a_name_covers_no_other_sign_where_there_is_room_elsewhere(painter):
    (plate, _) = laid_out(painter, ["condyle", "notch"], [(200, 300), (240, 300)])
    assert not plate.intersects(QRectF(234, 294, 12, 12))


def test_names_keep_from_the_legend_and_inside_the_sheet(painter):
    legend = QRectF(300, 20, 110, 200)
    places = [(280, 100), (415, 400), (5, 400), (200, 1), (200, 549)]
    plates = laid_out(painter, ["lateral_epicondyle"] * 5, places, legend=legend)
    sheet = QRectF(0, 0, SHEET.width(), SHEET.height())
    for plate in plates:
        assert sheet.contains(plate)
        assert not plate.intersects(legend)


def test_a_name_stays_on_its_side_while_the_bone_is_turned(painter):
    """The other comes nearer and goes again, to and fro about where it is in the way."""
    known, sides = Labels(), []
    for x in [20, *range(40, 60), *range(60, 40, -1)]:
        names = ["tip", "lateral_epicondyle"]
        plates = laid_out(painter, names, [(200, 300), (x, 300)], known)
        sides.append(plates[1].center().x() > x)
        assert overlaps(plates) == []
    assert sum(a != b for a, b in pairwise(sides)) <= 1


def test_names_of_the_condyles_stand_apart_in_the_window_and_the_one_pointed_at_is_there(
    user, monkeypatch
):
    user.open_sample()
    view = user.window.viewports[Side.SOURCE]
    written = {}
    draw = labels.draw_plate

    def remembered(painter, plate, text):
        written[text] = QRectF(plate)
        draw(painter, plate, text)

    monkeypatch.setattr(labels, "draw_plate", remembered)
    names = [pair.name for pair in user.session.pairs][-8:]
    user.editor.select(*names)
    user.settle()
    for turned in range(1, 5):
        user.drag(view, QPoint(60, 300), QPoint(60 + 40 * turned, 300))
        written.clear()
        view.layer.grab()
        assert set(written) <= set(names)
        assert len(written) >= 6
        assert overlaps(written.values()) == []
    seen = np.flatnonzero(~view.layer.hidden())
    marker = next(view.layer.markers[i] for i in seen if view.layer.markers[i].name in names)
    at = user.place_of(Side.SOURCE, marker.position)
    QTest.mouseMove(view, at + QPoint(0, 40))
    user.move_with(view, QPointF(at), Qt.MouseButton.NoButton)
    user.settle()
    written.clear()
    view.layer.grab()
    assert next(iter(written)) == marker.name, "it chooses its place first"
