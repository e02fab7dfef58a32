"""The report: HTML that needs nothing beside it, and the same numbers as CSV."""

from __future__ import annotations

import base64
import csv
import math
from html.parser import HTMLParser

import pytest

from pinwarp.io.chart import Line, line_chart
from pinwarp.io.report import Picture, Report, ReportRow, write_figures, write_report

LINE = Line("left out", "#000", [0, 1], [1, 2])
CHART = line_chart([LINE], x_title="x", y_title="y", x_ticks=[(0, "0"), (1, "1")])


def report(**changes):
    fields = {
        "title": "left <femur> & hip",
        "made": "today",
        "facts": (("Source mesh", "a.stl"),),
        "findings": ("a & b are 1 mm apart.",),
        "figures": (
            ReportRow("Pairs", "fovea", "residual", 0.123456789, "mm"),
            ReportRow("Pairs", "=cmd()", "residual", math.nan, "mm"),
            ReportRow("Distances", "forward", "mean", 2.0, "mm"),
        ),
        "chart": CHART,
    }
    return Report(**fields | changes)


class Reader(HTMLParser):
    """Collects tags, texts, and everything a browser would fetch."""

    def __init__(self):
        super().__init__()
        self.tags, self.texts, self.links = [], [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.links += [value for key, value in attrs if key in ("src", "href")]

    def handle_data(self, data):
        self.texts.append(data)


def written(tmp_path, *args):
    path = tmp_path / "report.html"
    write_report(path, *args)
    reader = Reader()
    reader.feed(path.read_text(encoding="utf-8"))
    return reader


def test_a_report_shows_everything_and_fetches_nothing(tmp_path):
    picture = Picture("the destination", b"\x89PNG not really")
    page = written(tmp_path, report(), [picture])
    for text in ("left <femur> & hip", "a & b are 1 mm apart.", "fovea", "0.1235", "residual (mm)"):
        assert text in page.texts
    assert all(link.startswith("data:") for link in page.links)
    (data,) = page.links
    assert base64.b64decode(data.partition(",")[2]) == picture.png


def test_the_curve_is_drawn_inside_the_page(tmp_path):
    page = written(tmp_path, report())
    assert "svg" in page.tags
    assert "path" in page.tags


def test_names_cannot_smuggle_tags_into_the_page(tmp_path):
    evil = ReportRow("Pairs", "<script>alert(1)</script>", "residual", 1.0)
    page = written(tmp_path, report(figures=(evil,), title="</title><script>", findings=("<b>",)))
    assert "script" not in page.tags
    assert "b" not in page.tags


def test_without_findings_or_chart_the_report_says_so(tmp_path):
    page = written(tmp_path, report(findings=(), chart=""))
    assert "Nothing stands out." in page.texts
    assert "svg" not in page.tags


def test_what_is_missing_in_a_table_is_a_dash(tmp_path):
    assert "–" in written(tmp_path, report()).texts


def test_the_csv_holds_every_digit_and_no_formula(tmp_path):
    path = tmp_path / "report.csv"
    write_figures(path, report().figures)
    rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    assert float(rows[0]["value"]) == 0.123456789
    assert rows[1]["item"] == "'=cmd()"
    assert rows[1]["value"] == ""
    assert [row["section"] for row in rows] == ["Pairs", "Pairs", "Distances"]


def test_a_folder_that_is_not_there_is_an_os_error(tmp_path):
    with pytest.raises(OSError, match="nowhere"):
        write_report(tmp_path / "nowhere" / "report.html", report())
    with pytest.raises(OSError, match="nowhere"):
        write_figures(tmp_path / "nowhere" / "report.csv", report().figures)
