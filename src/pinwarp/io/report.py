"""The report: one HTML file that needs nothing beside it, and a CSV of the same numbers."""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from pinwarp.io.atomic import write_atomically
from pinwarp.io.chart import SVG
from pinwarp.io.csv_cells import numeral
from pinwarp.io.csv_text import csv_line

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #2b2f36; background: #fff;
       max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: 0; } h2 { font-size: 1.15rem; margin: 2rem 0 .5rem; }
.quiet { color: #6c7480; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .9rem; }
th, td { padding: .2rem .8rem .2rem 0; text-align: right; border-bottom: 1px solid #e6e9ed; }
th:first-child, td:first-child, td.words { text-align: left; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; margin: .5rem 0; }
dt { color: #6c7480; } dd { margin: 0; overflow-wrap: anywhere; }
figure { display: inline-block; margin: .5rem .5rem 0 0; vertical-align: top; width: 48%; }
figure img { width: 100%; border: 1px solid #e6e9ed; border-radius: 6px; }
figcaption { color: #6c7480; font-size: .85rem; }
svg { max-width: 100%; height: auto; }
@media print { body { margin: 0; } h2 { break-after: avoid; } figure { break-inside: avoid; } }
"""
_CSV_HEADER = ("section", "item", "quantity", "value", "unit")


@dataclass(frozen=True)
class ReportRow:
    """One number: what it is of, what it says, and its unit; NaN where there is none."""

    section: str
    item: str
    quantity: str
    value: float
    unit: str = ""


@dataclass(frozen=True)
class Picture:
    """A PNG and what it shows."""

    caption: str
    png: bytes


@dataclass(frozen=True)
class Report:
    """What a report says.

    Parameters
    ----------
    title
        The session's name.
    made
        When and by what, in words.
    facts
        What the numbers belong to: keys and texts, such as the meshes and their hashes.
    findings
        Sentences.
    figures
        The numbers; those of one section become a table with a row for each item.
    remarks
        A few words below the title of a section.
    chart
        An ``<svg>`` of the penalty curve, or nothing.
    methods
        What a paper says about it, a paragraph each.
    """

    title: str
    made: str
    facts: tuple[tuple[str, str], ...]
    findings: tuple[str, ...]
    figures: tuple[ReportRow, ...]
    remarks: tuple[tuple[str, str], ...] = ()
    chart: str = ""
    methods: tuple[str, ...] = ()


def write_report(path: str | Path, report: Report, pictures: Sequence[Picture] = ()) -> None:
    """Write a report as one HTML file with everything in it.

    Parameters
    ----------
    path
        The file.
    report
        What it says.
    pictures
        What it shows.

    Raises
    ------
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile
    >>> report = Report("femur", "today", (("Pairs", "16"),), (), (ReportRow("A", "b", "c", 1.5),))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_report(Path(folder, "femur.html"), report)
    ...     "<h1>femur</h1>" in Path(folder, "femur.html").read_text()
    True
    """
    html = ET.Element("html", lang="en")
    head = ET.SubElement(html, "head")
    ET.SubElement(head, "meta", charset="utf-8")
    ET.SubElement(head, "meta", name="viewport", content="width=device-width")
    ET.SubElement(head, "title").text = f"{report.title} – pinwarp report"
    ET.SubElement(head, "style").text = _STYLE
    body = ET.SubElement(html, "body")
    ET.SubElement(body, "h1").text = report.title
    ET.SubElement(body, "div", {"class": "quiet"}).text = report.made
    _add_facts(body, report.facts)
    for picture in pictures:
        figure = ET.SubElement(body, "figure")
        data = base64.b64encode(picture.png).decode("ascii")
        ET.SubElement(figure, "img", src=f"data:image/png;base64,{data}", alt=picture.caption)
        ET.SubElement(figure, "figcaption").text = picture.caption
    remarks = dict(report.remarks)
    _heading(body, "To check")
    _add_remark(body, remarks.get("To check"))
    if report.findings:
        bullets = ET.SubElement(body, "ul")
        for finding in report.findings:
            ET.SubElement(bullets, "li").text = finding
    else:
        ET.SubElement(body, "p").text = "Nothing stands out."
    if report.chart:
        _heading(body, "Warping penalty")
        _add_remark(body, remarks.get("Warping penalty"))
        # Inside HTML an <svg> has no namespace of its own; ElementTree would prefix every tag.
        chart = report.chart.replace(f' xmlns="{SVG}"', "", 1)
        ET.SubElement(body, "div").append(ET.fromstring(chart))
    for section in dict.fromkeys(figure.section for figure in report.figures):
        _heading(body, section)
        _add_remark(body, remarks.get(section))
        _add_table(body, [figure for figure in report.figures if figure.section == section])
    if report.methods:
        _heading(body, "Methods")
        for paragraph in report.methods:
            ET.SubElement(body, "p").text = paragraph
    text = ET.tostring(html, encoding="unicode", method="html")
    write_atomically(path, "<!DOCTYPE html>\n" + _printable(text) + "\n")


def write_figures(path: str | Path, figures: Sequence[ReportRow]) -> None:
    """Write the numbers of a report as CSV, one a row, with all their digits.

    Raises
    ------
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     row = ReportRow("Pairs", "fovea", "residual", 0.25, "mm")
    ...     write_figures(Path(folder, "a.csv"), [row])
    ...     print(Path(folder, "a.csv").read_text(), end="")
    section,item,quantity,value,unit
    Pairs,fovea,residual,0.25,mm
    """
    lines = [csv_line(_CSV_HEADER)]
    for figure in figures:
        value = "" if math.isnan(figure.value) else numeral(repr(float(figure.value)))
        lines.append(csv_line((figure.section, figure.item, figure.quantity, value, figure.unit)))
    write_atomically(path, "".join(lines))


def _heading(body: ET.Element, text: str) -> None:
    ET.SubElement(body, "h2").text = text


def _add_remark(body: ET.Element, words: str | None) -> None:
    if words:
        ET.SubElement(body, "p", {"class": "quiet"}).text = words


def _add_facts(body: ET.Element, facts: Sequence[tuple[str, str]]) -> None:
    pairs = ET.SubElement(body, "dl")
    for key, text in facts:
        ET.SubElement(pairs, "dt").text = key
        ET.SubElement(pairs, "dd").text = text


def _add_table(body: ET.Element, figures: Sequence[ReportRow]) -> None:
    """Make a table with a row for each item and a column for each quantity."""
    quantities = list(dict.fromkeys(figure.quantity for figure in figures))
    units = {figure.quantity: figure.unit for figure in figures}
    table = ET.SubElement(body, "table")
    row = ET.SubElement(ET.SubElement(table, "thead"), "tr")
    ET.SubElement(row, "th")
    for quantity in quantities:
        unit = f" ({units[quantity]})" if units[quantity] else ""
        ET.SubElement(row, "th").text = quantity + unit
    values: dict[str, dict[str, float]] = {}
    for figure in figures:
        values.setdefault(figure.item, {})[figure.quantity] = figure.value
    rows = ET.SubElement(table, "tbody")
    for item, found in values.items():
        row = ET.SubElement(rows, "tr")
        ET.SubElement(row, "td").text = item
        for quantity in quantities:
            ET.SubElement(row, "td").text = _shown(found.get(quantity, math.nan))


def _shown(value: float) -> str:
    if math.isnan(value):
        return "–"
    return f"{value:,.0f}" if value == round(value) and abs(value) < 1e9 else f"{value:.4g}"


def _printable(text: str) -> str:
    """Leave out control characters, which HTML has no way to write."""
    return "".join(letter for letter in text if letter >= " " or letter in "\n\t")
