"""Line charts as SVG: for reports and the documentation, readable by any browser."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as ET

SVG = "http://www.w3.org/2000/svg"
INK, QUIET_INK, GRID = "#2b2f36", "#6c7480", "#dfe3e8"
_MARGINS = (64.0, 34.0, 20.0, 46.0)  # left, top, right, bottom


@dataclass(frozen=True)
class Line:
    """One line of a chart.

    Parameters
    ----------
    name
        What the legend calls it.
    colour
        As CSS writes it.
    x, y
        Its places; the line is broken where y is not finite.
    dashed
        Whether it is drawn in dashes.
    """

    name: str
    colour: str
    x: Sequence[float]
    y: Sequence[float]
    dashed: bool = False


@dataclass(frozen=True)
class Mark:
    """A vertical line at one x, with a few words; an empty colour is a quiet one."""

    x: float
    words: str = ""
    colour: str = ""


@dataclass(frozen=True)
class Band:
    """A part of the x axis, shaded over the whole height."""

    low: float
    high: float
    colour: str


def line_chart(
    lines: Sequence[Line],
    *,
    x_title: str,
    y_title: str,
    x_ticks: Sequence[tuple[float, str]],
    highest: float | None = None,
    marks: Sequence[Mark] = (),
    band: Band | None = None,
    size: tuple[int, int] = (720, 300),
) -> str:
    """Draw lines over an x axis with given ticks; y begins at 0.

    Parameters
    ----------
    lines
        What is drawn.
    x_title, y_title
        What the axes show, with their units.
    x_ticks
        Places and words on the x axis, whose ends are the first and the last of them.
    highest
        Where y ends; without it at the highest value. Lines leave the picture there.
    marks
        Vertical lines.
    band
        What is shaded behind all.
    size
        Width and height in pixels.

    Returns
    -------
    str
        An ``<svg>`` element.

    Examples
    --------
    >>> rising = Line("speed", "#0072B2", [0, 1], [0, 3])
    >>> chart = line_chart([rising], x_title="s", y_title="m", x_ticks=[(0, "0"), (1, "1")])
    >>> chart.startswith("<svg"), "speed" in chart
    (True, True)
    """
    width, height = size
    left, top, right, bottom = _MARGINS
    low, high = x_ticks[0][0], x_ticks[-1][0]
    finite = [y for line in lines for y in line.y if math.isfinite(y)]
    ceiling = highest if highest is not None else max(finite, default=1.0)
    ceiling = ceiling if ceiling > 0 else 1.0
    steps = tick_values(ceiling)

    def across(x: float) -> float:
        return left + (x - low) / ((high - low) or 1.0) * (width - left - right)

    def up(y: float) -> float:
        return height - bottom - y / ceiling * (height - top - bottom)

    svg = ET.Element(
        "svg",
        {
            "xmlns": SVG,
            "viewBox": f"0 0 {width} {height}",
            "width": str(width),
            "height": str(height),
            "font-family": "system-ui, sans-serif",
            "font-size": "12",
        },
    )
    # A background of its own: pages in a dark theme show it too.
    ET.SubElement(svg, "rect", width=str(width), height=str(height), fill="#ffffff")
    clip = ET.SubElement(ET.SubElement(svg, "clipPath", id="plot"), "rect")
    plot = {"x": left, "y": top, "width": width - left - right, "height": height - top - bottom}
    clip.attrib.update({key: f"{value:g}" for key, value in plot.items()})
    if band is not None:
        ends = [min(max(x, low), high) for x in sorted((band.low, band.high))]
        shade = plot | {"x": across(ends[0]), "width": across(ends[1]) - across(ends[0])}
        look = {key: f"{value:.1f}" for key, value in shade.items()}
        ET.SubElement(svg, "rect", look | {"fill": band.colour, "fill-opacity": "0.12"})
    for y in steps:
        _rule(svg, left, up(y), width - right, up(y), GRID)
        _text(svg, left - 8, up(y) + 4, f"{y:g}", anchor="end")
    for x, words in x_ticks:
        _rule(svg, across(x), height - bottom, across(x), height - bottom + 4, QUIET_INK)
        _text(svg, across(x), height - bottom + 18, words)
    for mark in marks:
        if low <= mark.x <= high:
            colour = mark.colour or QUIET_INK
            _rule(svg, across(mark.x), top, across(mark.x), height - bottom, colour, "3 3")
            _text(svg, across(mark.x), top - 4, mark.words, colour=colour)
    drawing = ET.SubElement(svg, "g", {"clip-path": "url(#plot)"})
    for line in lines:
        _draw(drawing, line, [(across(x), up(y)) for x, y in zip(line.x, line.y, strict=True)])
    _text(svg, (left + width - right) / 2, height - 8, x_title)
    _text(svg, 8, 16, y_title, anchor="start")
    _legend(svg, lines, width - right)
    return ET.tostring(svg, encoding="unicode")


def tick_values(highest: float) -> list[float]:
    """Return about five round numbers from 0 to below the highest.

    Examples
    --------
    >>> tick_values(9.4)
    [0.0, 2.0, 4.0, 6.0, 8.0]
    """
    rough = highest / 5
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * nice for nice in (1, 2, 5, 10) if power * nice >= rough)
    # Rounded, so that 3 x 0.1 reads as 0.3.
    return [float(f"{i * step:.10g}") for i in range(int(highest / step * (1 + 1e-9)) + 1)]


def _draw(parent: ET.Element, line: Line, places: Sequence[tuple[float, float]]) -> None:
    path, pen_down = [], False
    for x, y in places:
        if math.isfinite(y):
            path.append(f"{'L' if pen_down else 'M'}{x:.1f} {y:.1f}")
        pen_down = math.isfinite(y)
    look = {"d": " ".join(path), "fill": "none", "stroke": line.colour, "stroke-width": "2"}
    if line.dashed:
        look["stroke-dasharray"] = "6 4"
    ET.SubElement(parent, "path", look)


def _rule(
    parent: ET.Element, x1: float, y1: float, x2: float, y2: float, colour: str, dashes: str = ""
) -> None:
    ends = {"x1": x1, "y1": y1, "x2": x2, "y2": y2}
    look = {key: f"{value:.1f}" for key, value in ends.items()} | {"stroke": colour}
    ET.SubElement(parent, "line", look | ({"stroke-dasharray": dashes} if dashes else {}))


def _text(
    parent: ET.Element, x: float, y: float, words: str, anchor: str = "middle", colour: str = INK
) -> None:
    look = {"x": f"{x:.1f}", "y": f"{y:.1f}", "text-anchor": anchor, "fill": colour}
    ET.SubElement(parent, "text", look).text = words


def _legend(svg: ET.Element, lines: Sequence[Line], end: float) -> None:
    """Name the lines above the plot, from the right; a letter is about 6.6 pixels wide."""
    x = end
    for line in reversed(lines):
        x -= 6.6 * len(line.name)
        _text(svg, x, 16, line.name, anchor="start")
        _draw(svg, line, [(x - 30, 12), (x - 6, 12)])
        x -= 40
