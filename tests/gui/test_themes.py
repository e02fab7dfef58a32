"""Both themes, measured on pictures: what there is to read and to press can be seen."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from unittest.mock import Mock

import numpy as np
import pytest
from qtpy.QtCore import QPointF, Qt
from qtpy.QtGui import QColor, QImage, QPainter, QPalette
from qtpy.QtTest import QTest
from qtpy.QtWidgets import (
    QAbstractButton,
    QApplication,
    QCheckBox,
    QDockWidget,
    QLabel,
    QLineEdit,
    QProgressBar,
    QPushButton,
    QRadioButton,
    QSlider,
    QStyle,
    QStyleOptionSlider,
    QStyleOptionTab,
    QTabBar,
    QToolButton,
    QWidget,
)

from pinwarp.core.findings import FindingKind
from pinwarp.core.landmarks import LandmarkState, Side
from pinwarp.gui.painted.arrows import paint_arrow
from pinwarp.gui.painted.markers import (
    GHOST_RADIUS,
    draw_crosshair,
    draw_ghost,
    draw_star,
    marker_pixmap,
)
from pinwarp.gui.painted.model_elements import ModelPainter
from pinwarp.gui.painted.semilandmarks import SemilandmarkPainter, dot_pixmap, handle_pixmap
from pinwarp.gui.scene.drawables import DotKind, PathLine, Paths, Slides
from pinwarp.gui.scene.model_drawables import ElementLine, ModelElements
from pinwarp.gui.style.theme import (
    DESTINATION_COLOUR,
    GROUP_COLOURS,
    SOURCE_COLOUR,
    backgrounds,
)
from pinwarp.gui.table.columns import finding_icon
from pinwarp.session.model.elements import OutlineKind

# Of text, and of what is pressed or moved, against what is around (WCAG 2.2, 1.4.3 and 1.4.11).
READABLE, VISIBLE = 4.5, 3.0
WITH_WORDS = (QLabel, QAbstractButton)
DARK = {
    QPalette.ColorRole.Window: "#2b2b2b",
    QPalette.ColorRole.WindowText: "#dddddd",
    QPalette.ColorRole.Base: "#1e1e1e",
    QPalette.ColorRole.AlternateBase: "#262626",
    QPalette.ColorRole.Text: "#dddddd",
    QPalette.ColorRole.Button: "#333333",
    QPalette.ColorRole.ButtonText: "#dddddd",
    QPalette.ColorRole.Highlight: "#2a6fb0",
    QPalette.ColorRole.HighlightedText: "#ffffff",
    QPalette.ColorRole.PlaceholderText: "#9a9a9a",
}


def dark_palette() -> QPalette:
    palette = QPalette()
    for role, colour in DARK.items():
        palette.setColor(role, QColor(colour))
    return palette


@pytest.fixture(params=["light", "dark"])
def theme(request, qapp):
    """The name of a theme that windows made from now on have."""
    before = qapp.palette()
    if request.param == "dark":
        qapp.setPalette(dark_palette())
    yield request.param
    qapp.setPalette(before)


@pytest.fixture
def sample(theme, request):
    user = request.getfixturevalue("user")
    user.open_sample()
    return user


def pixels(widget: QWidget) -> np.ndarray:
    """(h, w, 3) colours of a widget as it is painted in its window, from 0 to 1."""
    top = widget.window()
    rect = widget.rect().translated(widget.mapTo(top, widget.rect().topLeft()))
    return colours_of(top.grab(rect).toImage().convertToFormat(QImage.Format.Format_RGB888))


def colours_of(image: QImage) -> np.ndarray:
    """(h, w, 3) colours of a picture in RGB, from 0 to 1."""
    data = np.frombuffer(image.constBits(), np.uint8)
    rows = data.reshape(image.height(), image.bytesPerLine())[:, : 3 * image.width()]
    return rows.reshape(image.height(), image.width(), 3) / 255


def luminances(colours: np.ndarray) -> np.ndarray:
    """Relative luminances, as WCAG defines them."""
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


def contrast(one: float, other: float) -> float:
    low, high = sorted((float(one), float(other)))
    return (high + 0.05) / (low + 0.05)


def greatest_contrast(colours: np.ndarray) -> float:
    """Of anything in a picture against its most common colour."""
    flat = colours.reshape(-1, 3)
    kinds, counts = np.unique(np.round(flat * 255), axis=0, return_counts=True)
    around = luminances(kinds[np.argmax(counts)] / 255)
    return max(contrast(value, around) for value in luminances(kinds / 255))


def shown(window: QWidget, kind: type) -> list:
    return [
        widget
        for widget in window.findChildren(kind)
        if widget.isVisible() and widget.isEnabled() and not widget.visibleRegion().isEmpty()
    ]


def test_all_words_can_be_read(sample):
    pale = {}
    for dock in sample.window.findChildren(QDockWidget):
        dock.raise_()
        sample.settle()
        for label in (word for kind in WITH_WORDS for word in shown(sample.window, kind)):
            if label.text().strip() and min(label.width(), label.height()) > 5:
                measured = greatest_contrast(pixels(label))
                if measured < READABLE:
                    pale[label.text()] = measured
    assert pale == {}


def test_the_buttons_of_a_panels_title_stand_out(sample):
    names = ("qt_dockwidget_floatbutton", "qt_dockwidget_closebutton")
    docks = [x for x in sample.window.findChildren(QDockWidget) if x.titleBarWidget() is None]
    assert docks
    for dock in docks:
        for button in (dock.findChild(QAbstractButton, name) for name in names):
            assert button.isVisible()
            assert greatest_contrast(pixels(button)) >= VISIBLE, button.objectName()


class Sheet:
    """A flat sheet before which nothing is hidden: a position's x and y are its pixels."""

    @staticmethod
    def view_key():
        return 0

    @staticmethod
    def behind_surface(positions):
        return np.zeros(len(positions), dtype=bool)

    @staticmethod
    def project(positions):
        return np.asarray(positions, dtype=float)[:, :2]


SLANTED = np.array([[8.0, 11.0, 0.0], [30.0, 17.0, 0.0], [52.0, 48.0, 0.0]])
MIDDLE = QPointF(30, 30)


def paint_model(kind: OutlineKind, is_chosen: bool = False):
    line = ElementLine(SLANTED, kind, is_chosen)
    nothing = np.zeros(0, dtype=bool)
    elements = ModelElements(np.zeros((0, 3)), nothing, nothing, (line,))
    return lambda painter: ModelPainter(Sheet, Sheet.project).paint(painter, elements)


def paint_element_point(of_muscle: bool):
    elements = ModelElements(
        np.array([[30.0, 30.0, 0.0]]), np.array([of_muscle]), np.array([False]), ()
    )
    return lambda painter: ModelPainter(Sheet, Sheet.project).paint(painter, elements)


def paint_group(colour: int, is_ghost: bool):
    paths = Paths((PathLine(SLANTED, colour, is_ghost),))
    return lambda painter: SemilandmarkPainter(Sheet, Sheet.project).paint_paths(painter, paths)


def paint_slide(colour: int):
    slides = Slides(SLANTED[:1], SLANTED[2:], np.array([colour]))
    return lambda painter: SemilandmarkPainter(Sheet, Sheet.project).paint_slides(painter, slides)


def paint_pixmap(pixmap):
    return lambda painter: painter.drawPixmap(MIDDLE - QPointF(13, 13), pixmap())


def painted() -> dict[str, Callable[[QPainter], object]]:
    """All that is painted over bones, each by what paints it in the window."""
    start, end = QPointF(8, 11), QPointF(52, 48)
    things = {
        "ghost": lambda painter: draw_ghost(painter, MIDDLE, GHOST_RADIUS),
        "star": lambda painter: draw_star(painter, MIDDLE),
        "crosshair": lambda painter: draw_crosshair(painter, MIDDLE),
        "residual": lambda painter: paint_arrow(painter, start, end, 0),
        "left out": lambda painter: paint_arrow(painter, start, end, 0, left_out=True),
        "path point": paint_element_point(True),
        "marker": paint_element_point(False),
    }
    for kind in OutlineKind:
        things[kind.value] = paint_model(kind)
        things[f"chosen {kind.value}"] = paint_model(kind, is_chosen=True)
    # What is not placed is nowhere.
    for state in set(LandmarkState) - {LandmarkState.EMPTY}:
        things[state.value] = paint_pixmap(partial(marker_pixmap, state, False, False, 1.0))
    for row in range(len(GROUP_COLOURS)):
        things[f"curve {row}"] = paint_group(row, False)
        things[f"expected curve {row}"] = paint_group(row, True)
        things[f"slide {row}"] = paint_slide(row)
        for is_ghost in (False, True):
            pixmap = partial(handle_pixmap, row, is_ghost, False, 1.0)
            things[f"handle {row} {is_ghost}"] = paint_pixmap(pixmap)
        for kind in DotKind:
            pixmap = partial(dot_pixmap, row, kind, False, 1.0)
            things[f"dot {row} {kind.name}"] = paint_pixmap(pixmap)
    return things


@pytest.mark.parametrize("bone", [SOURCE_COLOUR, DESTINATION_COLOUR])
def test_all_that_is_painted_stands_out_from_either_bone(qapp, bone):
    pale = {name: measured for name, measured in contrasts(bone).items() if measured < VISIBLE}
    assert pale == {}


@pytest.mark.parametrize("background", [*backgrounds(False), *backgrounds(True)])
def test_what_reaches_beyond_the_bone_stands_out_from_the_background(qapp, background):
    # Slides end on the bone, and excluded points stay there.
    pale = {
        name: measured
        for name, measured in contrasts(background).items()
        if measured < VISIBLE and not name.startswith("slide") and "EXCLUDED" not in name
    }
    assert pale == {}


def contrasts(around: str) -> dict[str, float]:
    """The greatest contrast of each painted thing with a colour that is all around it."""
    found = {}
    for name, paint in painted().items():
        image = QImage(60, 60, QImage.Format.Format_RGB888)
        image.fill(QColor(around))
        with QPainter(image) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            paint(painter)
        found[name] = greatest_contrast(colours_of(image))
    return found


def test_no_title_of_a_panel_is_cut_at_the_size_in_which_a_window_opens(sample):
    model = next(x for x in sample.window.findChildren(QDockWidget) if x.objectName() == "model")
    model.show()
    sample.settle()
    tabs = next(
        bar for bar in sample.window.findChildren(QTabBar) if bar.isVisible() and bar.count() == 6
    )
    # The front one needs most: each in turn.
    for row in range(tabs.count()):
        QTest.mouseClick(tabs, Qt.MouseButton.LeftButton, pos=tabs.tabRect(row).center())
        sample.settle()
        for other in range(tabs.count()):
            words = tabs.fontMetrics().horizontalAdvance(tabs.tabText(other))
            room = QStyleOptionTab()
            tabs.initStyleOption(room, other)
            assert room.text == tabs.tabText(other), "shortened"
            assert tabs.tabRect(other).width() >= words + 16


def test_the_handle_of_every_slider_stands_out_from_its_groove(sample):
    sample.press(Qt.Key.Key_X)
    sliders = shown(sample.window, QSlider)
    assert len(sliders) >= 3
    for slider in sliders:
        slider.setValue((slider.minimum() + slider.maximum()) // 2)
        option = QStyleOptionSlider()
        slider.initStyleOption(option)
        handle = slider.style().subControlRect(
            QStyle.ComplexControl.CC_Slider, option, QStyle.SubControl.SC_SliderHandle, slider
        )
        # From the handle's middle outwards: some part of it is unlike what is around.
        row = pixels(slider)[handle.center().y()]
        values = luminances(row[max(0, handle.left() - 2) : handle.right() + 3])
        around = luminances(pixels(slider)[0, 0])
        assert max(contrast(value, around) for value in values) >= VISIBLE, slider.accessibleName()


@pytest.mark.parametrize("kind", [FindingKind.SWAPPED, FindingKind.DISPLACED, FindingKind.ISOLATED])
def test_the_signs_of_what_was_found_are_seen_in_the_list_and_in_the_table(theme, kind):
    around = QApplication.palette().color(QPalette.ColorRole.Base)
    finding = Mock(kind=kind, is_grave=kind is FindingKind.SWAPPED)
    image = QImage(20, 20, QImage.Format.Format_RGB888)
    image.fill(around)
    with QPainter(image) as painter:
        finding_icon([Mock(finding=finding)]).paint(painter, image.rect())
    assert greatest_contrast(colours_of(image)) >= VISIBLE


@pytest.mark.parametrize("share", [0, 50, 100])
def test_the_words_of_a_progress_bar_can_be_read_however_far_it_is(sample, share):
    bar = QProgressBar(sample.window)
    bar.setFormat("%v of %m")
    bar.setValue(share)
    bar.setGeometry(100, 300, 110, 22)
    bar.show()
    middle = pixels(bar)[4:-4, 35:75]
    assert greatest_contrast(middle) >= READABLE
    bar.setParent(None)
    bar.deleteLater()


@pytest.mark.parametrize("kind", [QCheckBox, QRadioButton])
def test_ticks_and_dots_are_seen_and_so_are_empty_boxes(sample, kind):
    button = kind("", sample.window)
    button.setGeometry(100, 300, 40, 30)
    button.setAutoFillBackground(True)
    button.show()
    pictures = []
    for checked in (False, True):
        button.setChecked(checked)
        picture = pixels(button)
        pictures.append(luminances(picture))
        assert greatest_contrast(picture) >= VISIBLE
    differences = [
        contrast(off, on) for off, on in zip(*(x.ravel() for x in pictures), strict=True)
    ]
    assert max(differences) >= VISIBLE
    button.setParent(None)
    button.deleteLater()


@pytest.mark.parametrize("kind", [QPushButton, QToolButton, QLineEdit, QRadioButton, QCheckBox])
def test_what_cannot_be_used_is_paler_than_what_can(sample, kind):
    widget = kind(sample.window)
    widget.setText("Words")
    widget.setGeometry(100, 300, 120, 30)
    widget.setAutoFillBackground(True)
    widget.show()
    measured = []
    for enabled in (True, False):
        widget.setEnabled(enabled)
        measured.append(greatest_contrast(pixels(widget)[6:-6, 22:-6]))
    assert measured[0] >= READABLE
    assert 1.5 < measured[1] < 0.6 * measured[0]
    widget.setParent(None)
    widget.deleteLater()


@pytest.mark.parametrize("kind", [QToolButton, QPushButton])
def test_a_pressed_in_button_is_unlike_one_that_is_not(sample, kind):
    button = kind(sample.window)
    button.setCheckable(True)
    button.setGeometry(100, 300, 60, 30)
    button.show()
    values = []
    for checked in (False, True):
        button.setChecked(checked)
        values.append(np.median(luminances(pixels(button))))
    assert contrast(*values) >= 1.2
    button.setParent(None)
    button.deleteLater()


def test_the_background_of_the_views_follows_the_theme_or_the_menu(sample, theme):
    canvas = sample.window.viewports[Side.DESTINATION]

    def brightness() -> float:
        return float(np.median(luminances(pixels(canvas)[60:90, 5:60])))

    is_dark = theme == "dark"
    assert (brightness() < 0.1) == is_dark
    caption = pixels(canvas)[5:40, 8:120]
    assert greatest_contrast(caption) >= READABLE
    sample.trigger("background_light" if is_dark else "background_dark")
    assert (brightness() < 0.1) == (not is_dark)
    caption = pixels(canvas)[5:40, 8:120]
    assert greatest_contrast(caption) >= READABLE
    sample.trigger("background_theme")
    assert (brightness() < 0.1) == is_dark


def test_an_open_window_follows_another_theme(user, qapp):
    user.open_sample()
    canvas = user.window.viewports[Side.DESTINATION]
    before, light = qapp.palette(), user.window.styleSheet()
    try:
        qapp.setPalette(dark_palette())
        user.settle()
        assert user.window.styleSheet() != light
        assert np.median(luminances(pixels(canvas)[60:90, 5:60])) < 0.1
    finally:
        qapp.setPalette(before)
    user.settle()
    assert user.window.styleSheet() == light
    assert np.median(luminances(pixels(canvas)[60:90, 5:60])) > 0.5
