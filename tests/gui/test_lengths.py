"""Round numbers for axes, short ones for figures."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from qtpy.QtCore import Qt
from qtpy.QtTest import QTest

from pinwarp.core.landmarks import Side
from pinwarp.core.lengths import Ruler, format_number
from pinwarp.core.maps import MapKind
from pinwarp.gui.scene.drawables import Legend, ScaleBar
from pinwarp.gui.style.colour_scale import ColourScale
from pinwarp.gui.style.lengths import ticks
from pinwarp.gui.table.columns import column_number
from pinwarp.session import edits
from pinwarp.session.mesh_units import scale_side


@given(st.floats(1e-6, 1e6))
def test_an_axis_has_a_few_round_lengths_evenly_apart(largest):
    found = ticks(largest)
    assert found[0] == 0
    assert 2 <= len(found) <= 4
    step = found[1]
    assert float(f"{step:.0e}") == pytest.approx(step), "one digit: 1, 2 or 5 times a power of ten"
    assert f"{step:.0e}"[0] in "125"
    assert found == pytest.approx([step * i for i in range(len(found))])
    assert found[-1] <= largest < found[-1] + step * 1.001


@given(st.floats(0, 1e12))
def test_a_figure_is_right_to_three_digits(value):
    assert float(format_number(value)) == pytest.approx(value, rel=6e-3)


def in_metres(user):
    user.open_sample()
    session = user.session
    for side in Side:
        session = scale_side(session, side, 0.001)
    user.editor.commit(edits.set_unit(session, "m"), "Metres")
    user.settle()


def test_bones_in_metres_are_shown_and_typed_in_millimetres_and_stay_in_metres(user):
    in_metres(user)
    window = user.window
    panel, model = window.parts.penalty.panel, window.parts.table.model
    assert user.session.unit == "m"
    assert "3.67 mm" in panel.figures.left_out.text()
    assert "0 mm" in panel.figures.residual.text(), "what is only rounding is 0"
    left_out = column_number("left_out")
    assert model.title(left_out) == "Left out\nmm"
    assert model.index(0, left_out).data() == "3.01"
    assert window.viewports[Side.SOURCE].drawn(ScaleBar).ruler.unit == "mm"
    user.trigger("map_distance")
    legend = window.viewports[Side.DESTINATION].drawn(Legend)
    assert legend.note == "in mm"
    ticks = ColourScale(legend.kind, legend.range, legend.factor).ticks()
    assert [tick.text for tick in ticks][:3] == ["0", "0.5", "1"]
    assert " mm" in window.parts.maps.panel.figures.text()
    for typed, penalty in (("5", 0.005), ("0.5 cm", 0.005), ("2 m", 2.0)):
        panel.value.selectAll()
        QTest.keyClicks(panel.value, typed)
        QTest.keyClick(panel.value, Qt.Key.Key_Return)
        user.settle()
        assert user.session.settings.penalty == pytest.approx(penalty, rel=1e-12)
    x = column_number("source_x")
    name = model.landmarks[0].name
    model.setData(model.index(0, x), "12.5", Qt.ItemDataRole.EditRole)
    assert user.session.landmark(name).source[0] == 0.0125
    assert model.index(0, x).data() == "12.5"


def test_landmarks_far_off_are_asked_about_in_the_unit_that_is_shown(user, tmp_path):
    in_metres(user)
    path = tmp_path / "lps.csv"
    rows = [(x.name, *x.source) for x in user.session.pairs]
    path.write_text("name,x,y,z\n" + "".join(f"{n},{-x},{-y},{z}\n" for n, x, y, z in rows))
    seen = []

    def look(dialog):
        seen.extend(label.text() for label in dialog.findChildren(type(dialog.outcome)))
        seen.append(dialog.model.headerData(1, Qt.Orientation.Horizontal))

    user.dialogs.at_import = [look]
    user.window.parts.imports.bring_in(path, Side.SOURCE)
    user.settle()
    assert any("mm from the source mesh in the median" in words for words in seen)
    assert "x (m)" in seen, "the file's own numbers keep their unit"


def test_the_unit_of_lengths_is_chosen_in_the_menu_and_everything_follows(user):
    in_metres(user)
    panel, model = user.window.parts.penalty.panel, user.window.parts.table.model
    for key, text, unit in (
        ("lengths_cm", "0.367 cm", "cm"),
        ("lengths_file", "0.00367 m", "m"),
        ("lengths_mm", "3.67 mm", "mm"),
    ):
        user.trigger(key)
        assert text in panel.figures.left_out.text()
        assert model.title(column_number("left_out")) == f"Left out\n{unit}"
        assert user.window.viewports[Side.SOURCE].drawn(ScaleBar).ruler.unit == unit
        assert user.window.actions_by_key[key].isChecked()
    assert user.session.unit == "m", "what is saved keeps its unit"


@pytest.mark.parametrize("text", ["", "five", "5 furlongs", "mm"])
def test_what_is_no_length_is_refused(text):
    with pytest.raises(ValueError, match="could not convert"):
        Ruler("mm").length(text)


def test_a_unit_cannot_be_told_where_that_of_the_files_is_unknown():
    with pytest.raises(ValueError, match="unknown unit"):
        Ruler().length("5 mm")


@given(st.floats(0.3, 0.99), st.floats(1.01, 9.0))
def test_every_legend_of_ratios_has_at_least_three_numbers_apart(low, high):
    for ends in ((low, high), (low, 1.0), (1.0, high), (1 - 1e-9, 1 + 1e-9)):
        texts = [tick.text for tick in ColourScale(MapKind.VOLUME, ends).ticks()]
        assert len(set(texts)) == len(texts) >= 3
