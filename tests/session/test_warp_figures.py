"""The warp taken apart into figures."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.core.femur import femur_landmarks
from tests.session.test_quality import made_up, quality, session_of

from pinwarp.core.alignment import decompose
from pinwarp.core.components import Components
from pinwarp.core.factor import factorise
from pinwarp.core.quality import bending_energy
from pinwarp.core.spline import solve
from pinwarp.session.judging.warp_figures import (
    determined_in_words,
    figures_table,
    rms_text,
    warp_figures,
)


def rows_of(judged, unit="mm"):
    return {row.title: row.figures for row in warp_figures(judged, unit)}


def texts(figures):
    return [figure.text for figure in figures]


def test_the_figures_are_those_of_the_affine_fit_and_of_the_warp():
    source, destination = made_up(14)
    judged = quality(session_of(source, destination))
    factor = factorise(source)
    parts = decompose(solve(factor, destination, math.inf).affine, source.mean(axis=0))
    energy = bending_energy(solve(factor, destination))
    rows = rows_of(judged)
    for title, expected in (
        ("Translation", [*parts.translation, np.linalg.norm(parts.translation)]),
        ("Rotation", [parts.angle]),
        ("Rotation axis", parts.axis),
        ("Scale", 100 * parts.scales),
        ("Shear", 100 * parts.shears),
        ("Principal stretch", 100 * parts.principal),
        ("Bending energy", [*energy, energy.sum()]),
    ):
        assert [x.value for x in rows[title]] == pytest.approx(list(expected)), title


def test_a_known_map_is_found_again_in_words():
    source, _ = made_up(9)
    turn = Rotation.from_rotvec([0, 0, math.radians(30)])
    centre = source.mean(axis=0)
    moved = turn.apply((source - centre) * [1.1, 0.9, 1.0]) + centre + [3, -4, 0]
    rows = rows_of(quality(session_of(source, moved)), "cm")
    assert texts(rows["Translation"]) == ["3.000 cm", "-4.000 cm", "0.000 cm", "5.000 cm"]
    assert texts(rows["Rotation"]) == ["30.00°"]
    assert texts(rows["Rotation axis"]) == ["0.000", "0.000", "1.000"]
    assert texts(rows["Scale"]) == ["110.0%", "90.0%", "100.0%"]
    assert texts(rows["Shear"]) == ["0.0%", "0.0%", "0.0%"]
    assert texts(rows["Principal stretch"]) == ["110.0%", "100.0%", "90.0%"]
    assert texts(rows["Mirrored"]) == ["no"]
    assert texts(rows["Bending energy"]) == ["0 cm"] * 4, "rounding is not shown"


def test_a_mirrored_bone_is_called_so():
    source, destination = made_up(14)
    rows = rows_of(quality(session_of(source, destination * [-1, 1, 1])))
    assert texts(rows["Mirrored"]) == ["yes"]
    assert rows["Principal stretch"][2].value < 0


def test_what_the_full_warp_leaves_at_penalty_0_is_shown_as_nothing(shared_data):
    names, source, destination = femur_landmarks(shared_data)
    judged = quality(session_of(source, destination, names))
    left = judged.rms_by_components
    assert left[Components.FULL] > 0, "rounding"
    assert rms_text(left[Components.FULL], judged, "mm") == "0 mm"
    assert rms_text(left[Components.RIGID], judged, "mm") == "29.65 mm"


def test_the_table_holds_every_figure_in_full_between_tabs():
    judged = quality(session_of(*made_up(14)))
    lines = [line.split("\t") for line in figures_table(judged, "mm").splitlines()]
    assert lines[0] == ["quantity", "part", "value", "unit"]
    assert {len(line) for line in lines} == {4}
    found = {(quantity, part): (float(value), unit) for quantity, part, value, unit in lines[1:]}
    for row in warp_figures(judged, "mm"):
        for figure in row.figures:
            value, unit = found.pop((row.title, figure.name))
            assert value == pytest.approx(figure.value, rel=1e-9)
            assert unit == figure.unit
    assert {quantity for quantity, _ in found} == {"RMS left"}
    assert [value for value, _ in found.values()] == pytest.approx(
        [judged.rms_by_components[part] for part in Components], abs=1e-9
    )


@pytest.mark.parametrize(
    ("count", "words"),
    [(1, "One place"), (2, "on one line"), (3, "in one plane"), (4, "from five pairs on")],
)
def test_few_pairs_are_told_what_they_leave_open(count, words):
    judged = quality(session_of(*made_up(count)))
    assert words in determined_in_words(judged)
    assert warp_figures(judged, "mm"), "what is determined is still shown"


def test_many_pairs_in_one_plane_leave_the_direction_across_it_open():
    source, destination = made_up(9)
    source[:, 2] = 0
    assert "in one plane" in determined_in_words(quality(session_of(source, destination)))


def test_five_pairs_in_space_leave_nothing_to_say():
    assert determined_in_words(quality(session_of(*made_up(5)))) == ""
    assert determined_in_words(None).startswith("No pair yet")
