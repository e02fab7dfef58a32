"""The part of the views that a picture shows: what the bones fill."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from qtpy.QtCore import QRectF
from qtpy.QtGui import QFontMetricsF

from pinwarp.core.landmarks import Side
from pinwarp.gui.exporting.offscreen import whole_of
from pinwarp.gui.exporting.picture import PictureOrder
from pinwarp.gui.painted.legend import MARGIN, PADDING, TITLE_WIDTH
from pinwarp.gui.painted.scale_bar import LONGEST
from pinwarp.gui.scene.drawables import Legend, Markers, Overlay
from pinwarp.gui.views.canvas import Canvas

# The longer side of a proposed picture.
LONG_SIDE = 2400
# Around the bones, in logical pixels; lines of text for the caption above and the bar below.
_AROUND = 16
_LINES_ABOVE, _LINES_BELOW = 2.6, 2.4
# A few thousand places tell what a bone covers.
_SAMPLE = 5000


def regions_of(order: PictureOrder, views: Mapping[Side, Canvas]) -> dict[Side, QRectF]:
    """Return what of each view is in a picture, in its logical pixels, all of one height.

    One height, so that a length in one view is as long as it is in the window beside the other.
    """
    found = {side: _region(order, views[side]) for side in order.sides}
    height = max(region.height() for region in found.values())
    for region in found.values():
        more = (height - region.height()) / 2
        region.adjust(0, -more, 0, more)
    return found


def proposed(order: PictureOrder, views: Mapping[Side, Canvas]) -> PictureOrder:
    """Return an order in the shape of what it shows, where nobody chose another."""
    if order.is_sized:
        return order
    if not order.filled:
        usual = PictureOrder()
        return replace(order, width=usual.width, height=usual.height)
    regions = list(regions_of(order, views).values())
    aspect = sum(region.width() for region in regions) / regions[0].height()
    width, height = (1.0, 1 / aspect) if aspect > 1 else (aspect, 1.0)
    # Round numbers, which are read at a glance.
    return replace(
        order,
        width=max(100, 10 * round(LONG_SIDE * width / 10)),
        height=max(100, 10 * round(LONG_SIDE * height / 10)),
    )


def _region(order: PictureOrder, view: Canvas) -> QRectF:
    whole = whole_of(view)
    places = _places_on_screen(order, view)
    places = places[np.isfinite(places).all(axis=1)]
    if not len(places):
        return whole
    (left, top), (right, bottom) = places.min(axis=0), places.max(axis=0)
    # Who looks at a part of a bone pictures that part.
    region = QRectF(left, top, right - left, bottom - top) & whole
    if region.isEmpty():
        return whole
    metrics = QFontMetricsF(view.font())
    words = metrics.height()
    region.adjust(-_AROUND, -_AROUND, _AROUND, _AROUND)
    if order.landmarks and order.names:
        names = [marker.name for marker in _markers(view)]
        longest = max(map(metrics.horizontalAdvance, names), default=0)
        region.adjust(-longest, 0, longest, 0)
    if order.framed:
        region.adjust(0, -_LINES_ABOVE * words, 0, _LINES_BELOW * words)
        if view.scene.of(Legend) is not None:
            region.setRight(region.right() + TITLE_WIDTH + 2 * PADDING + MARGIN)
        # The scale bar, and the words of the caption.
        short = LONGEST + 2 * _AROUND - region.width()
        if short > 0:
            region.adjust(-short / 2, 0, short / 2, 0)
    return region


def _places_on_screen(order: PictureOrder, view: Canvas) -> np.ndarray:
    """Return where a view shows what it is of: (n, 2) logical pixels."""
    seen = [np.zeros((0, 3))]
    if view.bone is not None:
        seen.append(np.asarray(view.bone.points))
    overlay = view.scene.of(Overlay)
    if overlay is not None and overlay.visible and overlay.full is not None:
        seen.append(np.asarray(overlay.full.vertices, np.float64))
    if order.landmarks and _markers(view):
        seen.append(np.array([marker.position for marker in _markers(view)]))
    thinned = [points[:: max(1, len(points) // _SAMPLE)] for points in seen]
    return view.project(np.vstack(thinned)) if any(map(len, thinned)) else np.zeros((0, 2))


def _markers(view: Canvas) -> tuple:
    signs = view.scene.of(Markers)
    return signs.markers if signs is not None else ()
