"""Colours and the few measures that make the window one piece.

The palette of the landmarks is that of Okabe and Ito, which colour-blind people can tell apart;
every state has its own shape as well.
"""

from __future__ import annotations

from qtpy.QtGui import QColor, QGuiApplication, QPalette
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import LandmarkState

SOURCE_COLOUR = "#e9dcc3"  # warm ivory
DESTINATION_COLOUR = "#b4bcc6"  # cool grey
OVERLAY_COLOUR = "#3f8fd2"  # translucent blue

BACKGROUND_BOTTOM = "#e3e7eb"
BACKGROUND_TOP = "#f8f9fb"
INK = "#2b2f36"
QUIET_INK = "#59616c"
OUTLINE = "#20242b"
PAPER = "#ffffff"

STATE_COLOURS = {
    LandmarkState.PAIRED: "#009E73",
    LandmarkState.SUGGESTED: "#0072B2",
    LandmarkState.SOURCE_ONLY: "#D55E00",
    LandmarkState.DESTINATION_ONLY: "#D55E00",
    LandmarkState.PASSENGER: "#CC79A7",
    LandmarkState.DISABLED: "#6f757e",
    LandmarkState.EMPTY: "#6f757e",
}
SELECTED_COLOUR = "#F0E442"
GHOST_COLOUR = "#0068a3"
WARNING_COLOUR = "#D55E00"
# Numbers as bars, and the arrows from where a landmark is carried to where it belongs.
BAR_COLOUR = "#0072B2"
ARROW_COLOUR = "#20242b"
LEFT_OUT_COLOUR = "#a84800"

# Of curves and patches, one after the other: told apart from one another, from bones and landmarks.
GROUP_COLOURS = ("#7a3fb0", "#b03d28", "#0b6e77", "#b02f72", "#2b4fa8", "#5c6410")

FOLD_COLOUR = "#D55E00"

# What stands on a body of a model: muscles, markers, wraps, and the axes of frames.
MUSCLE_COLOUR = "#a3262a"
MODEL_MARKER_COLOUR = "#0b6e77"
WRAP_COLOUR = "#4453b4"
AXIS_COLOURS = ("#ad4100", "#00703f", "#1f4fa8")

# Maps of lengths: even steps of lightness from dark to light, told apart without red and green.
SEQUENTIAL_COLOURS = (
    "#4b2a7f",
    "#45519c",
    "#3777a3",
    "#2a98a0",
    "#3cb887",
    "#94d858",
    "#fde725",
)
# Maps of ratios: blue shrinks, orange grows, in between nothing changes.
DIVERGING_COLOURS = (
    "#08306b",
    "#1f66ad",
    "#6aaedb",
    "#f4f1ea",
    "#f2b55a",
    "#c9720d",
    "#6d3404",
)

SPACE = 8
# How far the words of what is disabled fade into what is around.
DISABLED = 0.55


def backgrounds(dark: bool) -> tuple[str, str]:
    """Return the colours behind bones at the bottom and at the top."""
    return ("#1b1e23", "#30353d") if dark else (BACKGROUND_BOTTOM, BACKGROUND_TOP)


def inks(dark: bool) -> tuple[QColor, QColor]:
    """Return the colours of words before such a background, and of those in the second place."""
    return (QColor("#eef0f3"), QColor("#b8bfc9")) if dark else (QColor(INK), QColor(QUIET_INK))


def group_colour(row: int) -> QColor:
    """Return the colour of a curve or patch by its place in the list of groups."""
    return QColor(GROUP_COLOURS[row % len(GROUP_COLOURS)])


def is_dark() -> bool:
    """Whether the window is light on dark."""
    colour = QGuiApplication.palette().color(QPalette.ColorRole.Window)
    return colour.lightness() < 128


def with_disabled_apart(palette: QPalette) -> QPalette:
    """Return a palette in which what is disabled is paler than what is not.

    Plain palettes have one colour for both; others are returned as they are.
    """
    result, groups, roles = QPalette(palette), QPalette.ColorGroup, QPalette.ColorRole
    for words, around in (
        (roles.WindowText, roles.Window),
        (roles.Text, roles.Base),
        (roles.ButtonText, roles.Button),
    ):
        ink, paper = (palette.color(groups.Active, role) for role in (words, around))
        if palette.color(groups.Disabled, words) == ink:
            mixed = (
                (1 - DISABLED) * one + DISABLED * other
                for one, other in zip(ink.getRgbF()[:3], paper.getRgbF()[:3], strict=True)
            )
            result.setColor(groups.Disabled, words, QColor.fromRgbF(*mixed))
    return result


def text_colour() -> QColor:
    """Return the colour of text on the window."""
    return QGuiApplication.palette().color(QPalette.ColorRole.WindowText)


def selected_text_colour() -> QColor:
    """Return the colour of text on selected rows."""
    return QGuiApplication.palette().color(QPalette.ColorRole.HighlightedText)


def quiet_text_colour() -> QColor:
    """Return the colour of text on the window that need not be read."""
    return QColor("#b3bac4") if is_dark() else QColor(QUIET_INK)


def warning_text_colour() -> QColor:
    """Return the colour of words that warn: as dark, or as light, as words have to be."""
    return QColor("#ff9a52") if is_dark() else QColor("#a84800")


def make_quiet(label: QWidget) -> None:
    """Write a label in the colour of what need not be read."""
    palette = label.palette()
    palette.setColor(label.foregroundRole(), quiet_text_colour())
    label.setPalette(palette)


def leave_one_out_colour() -> QColor:
    """Return the colour of leave-one-out errors in plots."""
    return QColor("#56B4E9") if is_dark() else QColor("#0072B2")


def residual_colour() -> QColor:
    """Return the colour of residuals in plots."""
    return quiet_text_colour()
