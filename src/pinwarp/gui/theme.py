"""Colours and the few measures that make the window one piece.

The palette of the landmarks is that of Okabe and Ito, which colour-blind people can tell apart;
every state has its own shape as well.
"""

from __future__ import annotations

from qtpy.QtGui import QColor, QGuiApplication, QPalette

from pinwarp.core.landmarks import LandmarkState

SOURCE_COLOUR = "#e9dcc3"  # warm ivory
DESTINATION_COLOUR = "#b4bcc6"  # cool grey
OVERLAY_COLOUR = "#3f8fd2"  # translucent blue

BACKGROUND_BOTTOM = "#e3e7eb"
BACKGROUND_TOP = "#f8f9fb"
INK = "#2b2f36"
QUIET_INK = "#6c7480"
OUTLINE = "#20242b"
PAPER = "#ffffff"

STATE_COLOURS = {
    LandmarkState.PAIRED: "#009E73",
    LandmarkState.SOURCE_ONLY: "#D55E00",
    LandmarkState.DESTINATION_ONLY: "#D55E00",
    LandmarkState.PASSENGER: "#CC79A7",
    LandmarkState.DISABLED: "#8b919a",
    LandmarkState.EMPTY: "#8b919a",
}
SELECTED_COLOUR = "#F0E442"
GHOST_COLOUR = "#0072B2"
WARNING_COLOUR = "#D55E00"
# Numbers as bars, and the arrows from where a landmark is carried to where it belongs.
BAR_COLOUR = "#0072B2"
ARROW_COLOUR = "#20242b"
LEFT_OUT_COLOUR = "#D55E00"

SPACE = 8


def is_dark() -> bool:
    """Whether the window is light on dark."""
    colour = QGuiApplication.palette().color(QPalette.ColorRole.Window)
    return colour.lightness() < 128


def text_colour() -> QColor:
    """Return the colour of text on the window."""
    return QGuiApplication.palette().color(QPalette.ColorRole.WindowText)


def quiet_text_colour() -> QColor:
    """Return the colour of text on the window that may be overlooked."""
    return text_colour() if is_dark() else QColor(QUIET_INK)


def selected_text_colour() -> QColor:
    """Return the colour of text on selected rows."""
    return QGuiApplication.palette().color(QPalette.ColorRole.HighlightedText)
