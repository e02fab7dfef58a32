"""Line charts as SVG."""

from __future__ import annotations

from xml.etree import ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.io.chart import SVG, Line, Mark, line_chart, tick_values

TICKS = [(0.0, "0"), (10.0, "10")]


def drawn(*lines, **options):
    chart = line_chart(lines, x_title="x", y_title="y", x_ticks=TICKS, **options)
    return ET.fromstring(chart)


def paths(svg):
    return [path.get("d") for path in svg.iter(f"{{{SVG}}}path")]


def words(svg):
    return [text.text for text in svg.iter(f"{{{SVG}}}text")]


def test_a_line_runs_from_the_left_to_the_right_edge_and_up():
    path, _in_legend = paths(drawn(Line("a", "#000", [0, 10], [0, 5])))
    start, end = (part.split() for part in path[1:].replace("L", "M").split("M"))
    assert [float(x) for x in start] == [64, 300 - 46]
    assert [float(x) for x in end] == [720 - 20, 34]


def test_a_line_is_broken_where_there_is_no_value():
    path, _in_legend = paths(drawn(Line("a", "#000", [0, 2, 4, 6, 8], [1, 2, float("nan"), 2, 1])))
    assert path.count("M") == 2


def test_names_titles_ticks_and_marks_are_written_and_escaped():
    svg = drawn(Line("a < b", "#000", [0, 10], [0, 5]), marks=[Mark(4, "here & there")])
    assert {"a < b", "here & there", "x", "y", "0", "10"} <= set(words(svg))


def test_a_mark_beside_the_axis_is_left_out():
    assert "far" not in words(drawn(Line("a", "#000", [0, 1], [0, 1]), marks=[Mark(11, "far")]))


@pytest.mark.parametrize("values", [[0.0, 0.0], [float("nan")] * 2])
def test_nothing_to_scale_by_is_no_trouble(values):
    assert drawn(Line("a", "#000", [0, 10], values)) is not None


@given(st.floats(1e-12, 1e12))
def test_ticks_are_few_round_and_within(highest):
    ticks = tick_values(highest)
    assert ticks[0] == 0
    assert 3 <= len(ticks) <= 6
    assert ticks[-1] <= highest * (1 + 1e-8)
