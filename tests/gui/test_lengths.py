"""Round numbers for axes, short ones for figures."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.lengths import format_number
from pinwarp.gui.style.lengths import ticks


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
