"""Where the names of landmarks stand, so that none covers another."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Container

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QPointF, QRectF, QSizeF, Qt
from qtpy.QtGui import QColor, QFontMetricsF, QPainter, QPen

from pinwarp.gui.painted.markers import RADIUS
from pinwarp.gui.scene.drawables import Markers
from pinwarp.gui.style import theme

# Between a sign and its name, between names, and between a name and the edge of the sheet.
_BESIDE = 7.0
_APART = 2.0
_EDGE = 2.0
# Where a name may stand from its sign, the usual first: to the right or left, and how far down in
# heights of a plate; 0 is above or below the sign's middle.
_PLACES = (
    (1, 0.0),
    (-1, 0.0),
    (1, -0.8),
    (1, 0.8),
    (-1, -0.8),
    (-1, 0.8),
    (0, -1.0),
    (0, 1.0),
    (1, -1.6),
    (1, 1.6),
    (-1, -1.6),
    (-1, 1.6),
)
_Box = tuple[float, float, float, float]
_Bands = defaultdict[int, list[_Box]]
_LEFTWARDS = tuple(sorted(_PLACES, key=lambda place: (abs(place[1]), place[0])))


class Labels:
    """Gives names their places, the more important first; one that finds none is left out.

    A name stays where it stood in the picture before as long as it can, so that none jumps while
    the bone is turned.
    """

    def __init__(self) -> None:
        self._sheet = QSizeF()
        self._legend: QRectF | None = None
        # Plates that stand, in bands of one height: only neighbours are compared.
        self._band = 1.0
        self._plates: _Bands = defaultdict(list)
        # Of signs, which a name covers only where it finds no other place.
        self._signs: _Bands = defaultdict(list)
        self._stood: dict[str, tuple[int, float]] = {}
        self._stand: dict[str, tuple[int, float]] = {}

    def begin(self, painter: QPainter, sheet: QSizeF, legend: QRectF | None) -> None:
        """Begin another picture.

        Parameters
        ----------
        painter
            Whose font names are written in.
        sheet
            How large it is.
        legend
            Names keep from under it.
        """
        self._sheet, self._legend = sheet, legend
        self._band = QFontMetricsF(painter.font()).height() + 4 + _APART
        self._plates.clear()
        self._signs.clear()
        self._stood, self._stand = self._stand, {}

    def keep_free(self, plate: QRectF) -> None:
        """Let no name stand on a plate."""
        box = (plate.left(), plate.top(), plate.right(), plate.bottom())
        self._add(self._plates, box)

    def spare(self, places: NDArray, radius: float) -> None:
        """Let names stand on signs only where they find no other place.

        Parameters
        ----------
        places
            (n, 2) middles of the signs.
        radius
            Of all of them.
        """
        for x, y in places.tolist():
            if math.isfinite(x + y):
                self._add(self._signs, (x - radius, y - radius, x + radius, y + radius))

    def _add(self, bands: _Bands, box: _Box) -> None:
        for band in range(int(box[1] // self._band), int(box[3] // self._band) + 1):
            bands[band].append(box)

    def draw_names(
        self,
        painter: QPainter,
        shown: Markers,
        places: NDArray,
        hidden: NDArray[np.bool_],
        from_right: Container[str],
    ) -> None:
        """Write the names of landmarks that have them, as far as there is room.

        Parameters
        ----------
        painter
            On the sheet.
        shown
            The landmarks.
        places, hidden
            (n, 2) where they are on the sheet, and (n,) whether the bone hides them.
        from_right
            Those whose names are better on the left.
        """
        markers, radius = shown.markers, shown.radius
        named = [i for i, marker in enumerate(markers) if marker.labelled]
        if named:
            self.spare(places[~hidden], radius)
        # What is pointed at keeps its name in a crowd, what lies behind the bone least of all.
        for i in sorted(named, key=lambda i: (not markers[i].pointed_at, hidden[i])):
            name, at, always = markers[i].name, QPointF(*places[i]), markers[i].pointed_at
            painter.setOpacity(0.5 if hidden[i] else 1.0)
            leftwards = name in from_right
            self.draw(painter, name, at, radius, leftwards=leftwards, always=always)
        painter.setOpacity(1.0)

    def draw(
        self,
        painter: QPainter,
        text: str,
        at: QPointF,
        radius: float = RADIUS,
        *,
        leftwards: bool = False,
        always: bool = True,
    ) -> QRectF:
        """Write a name beside a sign, on a paper plate so that it reads on any bone.

        Parameters
        ----------
        painter
            On the sheet.
        text
            The name.
        at, radius
            Of the sign.
        leftwards
            Whether the left of it is better.
        always
            Whether it is written even where it covers another.

        Returns
        -------
        QRectF
            Where it stands; empty where there was no room.
        """
        metrics = painter.fontMetrics()
        size = (metrics.horizontalAdvance(text) + 12.0, metrics.height() + 4.0)
        place = (at.x(), at.y())
        usual = _LEFTWARDS if leftwards else _PLACES
        before = self._stood.get(text)
        # The first that is free, or else the first that covers only signs.
        second: tuple[tuple[int, float], _Box] | None = None
        for where in usual if before is None else (before, *usual):
            plate = self._plate(where, place, size, radius)
            if self._is_inside(plate) and self._is_free(self._plates, plate):
                if self._is_free(self._signs, plate):
                    self._stand[text] = where
                    break
                second = second or (where, plate)
        else:
            if second is not None:
                self._stand[text], plate = second
            else:
                plate = self._pushed_inside(usual[0], place, size, radius)
                if not always and not self._is_free(self._plates, plate):
                    return QRectF()
        found = QRectF(plate[0], plate[1], size[0], size[1])
        self.keep_free(found)
        draw_plate(painter, found, text)
        return found

    def _plate(
        self,
        where: tuple[int, float],
        at: tuple[float, float],
        size: tuple[float, float],
        radius: float,
    ) -> _Box:
        """Return the left, top, right and bottom of a plate."""
        across, down = where
        (x, y), (width, height) = at, size
        beside = radius + _BESIDE
        if across:
            left = x + beside if across > 0 else x - beside - width
            top = y + down * height - height / 2
        else:
            left = x - width / 2
            top = y + beside - 2 if down > 0 else y - beside + 2 - height
        return left, top, left + width, top + height

    def _pushed_inside(
        self,
        where: tuple[int, float],
        at: tuple[float, float],
        size: tuple[float, float],
        radius: float,
    ) -> _Box:
        """Return a plate beside a sign, within the sheet."""
        _, top, right, bottom = plate = self._plate(where, at, size, radius)
        room = self._room(top, bottom) - _EDGE
        if right > room or where[0] < 0:
            # Never beyond the left edge, where a long name would lose its beginning.
            right = max(min(at[0] - radius - _BESIDE, room), size[0] + _EDGE)
            return right - size[0], top, right, bottom
        return plate

    def _room(self, top: float, bottom: float) -> float:
        """Return how far right something may reach."""
        legend = self._legend
        if legend is None or bottom < legend.top() or top > legend.bottom():
            return self._sheet.width()
        return legend.left()

    def _is_inside(self, plate: _Box) -> bool:
        left, top, right, bottom = plate
        return (
            left >= _EDGE
            and top >= 0
            and bottom <= self._sheet.height()
            and right <= self._room(top, bottom) - _EDGE
        )

    def _is_free(self, bands: _Bands, plate: _Box) -> bool:
        left, top, right, bottom = plate
        for band in range(int(top // self._band), int(bottom // self._band) + 1):
            for box in bands.get(band, ()):
                if (
                    left < box[2] + _APART
                    and right > box[0] - _APART
                    and top < box[3] + _APART
                    and bottom > box[1] - _APART
                ):
                    return False
        return True


def draw_label_below(
    painter: QPainter, text: str, at: QPointF, room: float, radius: float
) -> QRectF:
    """Write a long label below a place, within the picture's width; return where it stands."""
    metrics = painter.fontMetrics()
    width = metrics.horizontalAdvance(text) + 12
    left = max(min(at.x() - width / 2, room - width - 2), 2.0)
    plate = QRectF(left, at.y() + radius + 5, width, metrics.height() + 4)
    draw_plate(painter, plate, text)
    return plate


def draw_plate(painter: QPainter, plate: QRectF, text: str) -> None:
    """Write words on a paper plate."""
    paper = QColor(theme.PAPER)
    paper.setAlphaF(0.88)
    painter.setPen(QPen(QColor(0, 0, 0, 40), 1))
    painter.setBrush(paper)
    painter.drawRoundedRect(plate, 4, 4)
    painter.setPen(QColor(theme.INK))
    painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, text)
