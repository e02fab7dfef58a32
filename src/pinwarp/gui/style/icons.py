"""Icons of the project's own."""

from __future__ import annotations

import functools

from qtpy.QtCore import QByteArray, QSize, Qt
from qtpy.QtGui import QIcon, QPainter, QPixmap
from qtpy.QtSvg import QSvgRenderer

from pinwarp.gui.style import theme
from pinwarp.io.samples import assets_folder


def icon(name: str, colour: str = "") -> QIcon:
    """Return an icon of the project's own, in the colour of the window's text or in another.

    Drawn once for each colour.
    """
    normal = colour or theme.text_colour().name()
    return _drawn(name, normal, theme.selected_text_colour().name())


@functools.cache
def _drawn(name: str, normal: str, selected: str) -> QIcon:
    text = (assets_folder() / "icons" / f"{name}.svg").read_text(encoding="utf-8")
    result = QIcon()
    for mode, ink, opacity in (
        (QIcon.Mode.Normal, normal, 1.0),
        (QIcon.Mode.Selected, selected, 1.0),
        (QIcon.Mode.Disabled, normal, 0.35),
    ):
        renderer = QSvgRenderer(QByteArray(text.replace("currentColor", ink).encode()))
        for size in (20, 40, 64):
            pixmap = QPixmap(QSize(size, size))
            pixmap.fill(Qt.GlobalColor.transparent)
            with QPainter(pixmap) as painter:
                painter.setOpacity(opacity)
                renderer.render(painter)
            result.addPixmap(pixmap, mode)
    return result
