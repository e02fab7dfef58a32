"""A picture of the views at any size: bones rendered for it, landmarks painted over them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from qtpy.QtCore import QPoint, QRect, QRectF, Qt
from qtpy.QtGui import QColor, QImage, QLinearGradient, QPainter, QRegion
from qtpy.QtWidgets import QWidget

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.gui.exporting.offscreen import Offscreen, Tile, whole_of
from pinwarp.gui.painted.legend import PaintedLegend
from pinwarp.gui.painted.marker_layer import MarkerLayer
from pinwarp.gui.scene.drawables import (
    Arrows,
    Caption,
    Dots,
    Legend,
    Markers,
    Paths,
    ScaleBar,
    Slides,
)
from pinwarp.gui.scene.model_drawables import ModelElements
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.style import theme
from pinwarp.gui.tasks.stepped_job import Steps
from pinwarp.gui.views.canvas import Canvas

# Qt paints no further than this in either direction.
LARGEST = 16_384
# 800 MB while it is made.
MOST_PIXELS = 200_000_000
FORMAT = QImage.Format.Format_RGBA8888_Premultiplied


@dataclass(frozen=True)
class PictureOrder:
    """What a picture shows.

    Parameters
    ----------
    width, height
        In pixels.
    sides
        The views, from left to right.
    landmarks
        Whether landmarks are painted, and their arrows where the window shows them.
    names
        Whether those in front of the bone have their names beside them.
    framed
        Whether titles, scale bars and the legend of a map are painted.
    transparent
        Whether there is nothing behind the bones, else the window's background.
    filled
        Whether it is cut to the bones, else all that the views show is in it.
    is_sized
        Whether somebody chose the size, else it follows what is shown.
    """

    width: int = 2400
    height: int = 1800
    sides: tuple[Side, ...] = tuple(Side)
    landmarks: bool = True
    names: bool = False
    framed: bool = True
    transparent: bool = False
    filled: bool = True
    is_sized: bool = False


def picture_steps(
    order: PictureOrder, views: Mapping[Side, Canvas], regions: Mapping[Side, QRectF]
) -> Steps:
    """Make a picture in small steps.

    Parameters
    ----------
    order
        What it shows.
    views
        What is pictured; copied at the first step.
    regions
        The part of each that is shown, in its logical pixels.

    Yields
    ------
    share, stage

    Returns
    -------
    QImage

    Raises
    ------
    PinwarpError
        When there is too little memory for it.
    """
    image = QImage(order.width, order.height, FORMAT)
    if image.isNull():
        raise _too_large(order)
    image.fill(Qt.GlobalColor.transparent)
    places = _places(order, regions)
    for side, place in places.items():
        paint_signs(image, views[side], _painted(order, views[side]), place, regions[side])
    copies = {
        side: Offscreen(views[side], views[side].scene, region=regions[side])
        for side in order.sides
    }
    yield 0.0, "rendering"
    try:
        for number, (side, place) in enumerate(places.items()):
            for tile in copies[side].tiles(place.width(), place.height()):
                _paint_below(image, place, tile)
                yield (number + tile.share) / len(places), "rendering"
    except MemoryError as error:
        raise _too_large(order) from error
    finally:
        for copy in copies.values():
            copy.close()
    if not order.transparent:
        _paint_background(image)
    return image


def picture_of(view: Canvas, scene: Scene, width: int, height: int) -> QImage:
    """Return a small picture of another scene than a view shows, seen from where that is seen.

    Parameters
    ----------
    view
        From where.
    scene
        What is rendered and painted.
    width, height
        In pixels.
    """
    image = QImage(width, height, FORMAT)
    image.fill(Qt.GlobalColor.transparent)
    paint_signs(image, view, scene, image.rect())
    copy = Offscreen(view, scene)
    try:
        for tile in copy.tiles(width, height):
            _paint_below(image, image.rect(), tile)
    finally:
        copy.close()
    _paint_background(image)
    return image


def _paint_background(image: QImage) -> None:
    with _below(image) as painter:
        painter.fillRect(image.rect(), background(image.height()))


def _below(image: QImage) -> QPainter:
    """Return a painter whose strokes come to lie below what is there already."""
    painter = QPainter(image)
    painter.setCompositionMode(QPainter.CompositionMode.CompositionMode_DestinationOver)
    return painter


def _paint_below(image: QImage, place: QRect, tile: Tile) -> None:
    rows, columns = tile.pixels.shape[:2]
    rendered = QImage(tile.pixels.data, columns, rows, 4 * columns, FORMAT)
    with _below(image) as painter:
        painter.setClipRect(place)
        painter.drawImage(place.topLeft() + QPoint(tile.left, tile.top), rendered)


def background(height: int) -> QLinearGradient:
    """Return what the window shows behind the bones, for a picture of a height."""
    gradient = QLinearGradient(0, 0, 0, height)
    gradient.setColorAt(0, QColor(theme.BACKGROUND_TOP))
    gradient.setColorAt(1, QColor(theme.BACKGROUND_BOTTOM))
    return gradient


def _too_large(order: PictureOrder) -> PinwarpError:
    size = f"{order.width:,} × {order.height:,}"
    return PinwarpError(f"There is too little memory for {size} pixels: choose a smaller size.")


def _places(order: PictureOrder, regions: Mapping[Side, QRectF]) -> dict[Side, QRect]:
    """Return where in the picture each view is: as wide as what it shows."""
    widths = [regions[side].width() for side in order.sides]
    edges = np.round(np.cumsum([0.0, *widths]) / sum(widths) * order.width).astype(int).tolist()
    return {
        side: QRect(left, 0, right - left, order.height)
        for side, left, right in zip(order.sides, edges, edges[1:], strict=False)
    }


def paint_signs(
    image: QImage, view: Canvas, scene: Scene, place: QRect, region: QRectF | None = None
) -> None:
    """Paint what a scene holds for the sheet over a place in a picture.

    Parameters
    ----------
    image, place
        Where.
    view
        From where it is seen.
    scene
        What is painted: landmarks, title, scale bar, legend.
    region
        The part of the view that the place shows, in logical pixels; all of it when None.
    """
    region = whole_of(view) if region is None else region
    width, height = region.width(), region.height()
    scale = min(place.width() / width, place.height() / height)
    layer = MarkerLayer(view, view)
    layer.resize(round(place.width() / scale), round(place.height() / scale))
    layer.offset = (
        (layer.width() - width) / 2 - region.left(),
        (layer.height() - height) / 2 - region.top(),
    )
    layer.pixels_per_pixel = scale / layer.devicePixelRatioF()
    # Colours without it say little.
    legend = PaintedLegend(layer)
    legend.show_content(scene.of(Legend))
    layer.give_way_to(legend)
    layer.show_scene(scene)
    with QPainter(image) as painter:
        painter.translate(place.topLeft())
        painter.scale(scale, scale)
        layer.render(painter, QPoint(), QRegion(), QWidget.RenderFlag.DrawChildren)
    layer.deleteLater()


def _painted(order: PictureOrder, view: Canvas) -> Scene:
    """Return what is painted into a picture, of all that a view shows."""
    framing = (Caption, ScaleBar, Legend) if order.framed else ()
    placed = (Markers, Arrows, Dots, Paths, Slides, ModelElements) if order.landmarks else ()
    scene = view.scene.only(*framing, *placed)
    signs = scene.of(Markers)
    if signs is None:
        return scene
    # What is selected just now is of no interest later; names behind the bone cover others.
    markers = tuple(
        replace(marker, selected=False, pointed_at=False, labelled=order.names and not hidden)
        for marker, hidden in zip(signs.markers, view.layer.hidden().tolist(), strict=True)
    )
    return scene.with_(replace(signs, markers=markers))
