"""Coefficients in files that a stranger can evaluate."""

from __future__ import annotations

import json
import math
import os
import re
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.components import Components, applied
from pinwarp.core.errors import FileFormatError
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import PenaltyConvention, Spline, factorise, solve
from pinwarp.io.coefficients import (
    COEFFICIENT_SUFFIXES,
    Coefficients,
    read_coefficients,
    write_coefficients,
)

finite = st.floats(allow_nan=False, allow_infinity=False)
in_files = pytest.mark.parametrize("suffix", COEFFICIENT_SUFFIXES)


def solved(penalty: float = 0.25, components: Components = Components.FULL) -> Coefficients:
    rng = np.random.default_rng(3)
    source, destination = rng.normal(size=(7, 3)), rng.normal(size=(7, 3))
    factor = factorise(source)
    spline = solve(factor, destination, penalty)
    return Coefficients(
        applied(spline, factor, destination, components),
        names=tuple(f"p{i}" for i in range(7)),
        unit="µm",
        settings=WarpSettings(penalty, components=components),
        source_sha256="ab" * 32,
        source_mirrored="x",
        source_scaled=1000.0,
        version="0.1.0",
    )


def assert_same(a: Coefficients, b: Coefficients) -> None:
    for field in fields(Coefficients):
        if field.name != "spline":
            assert getattr(a, field.name) == getattr(b, field.name), field.name
    for name in ("source", "weights", "affine"):
        assert getattr(a.spline, name).tobytes() == getattr(b.spline, name).tobytes()
    assert (a.spline.penalty, a.spline.convention) == (b.spline.penalty, b.spline.convention)


@in_files
@pytest.mark.parametrize("penalty", [0.0, 0.1, math.inf])
def test_a_round_trip_is_exact(tmp_path, suffix, penalty):
    path = tmp_path / f"warp{suffix}"
    settings = WarpSettings(penalty, blend=0.3, planar=True)
    written = replace(solved(penalty), settings=settings)
    write_coefficients(path, written)
    assert_same(read_coefficients(path), written)


@in_files
@given(
    numbers=st.lists(finite, min_size=18, max_size=18),
    names=st.lists(
        st.text(st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"]), min_size=1),
        min_size=1,
        max_size=1,
    ),
)
def test_every_number_and_name_survives(tmp_path_factory, suffix, numbers, names):
    path = tmp_path_factory.mktemp("any") / f"warp{suffix}"
    values = np.array(numbers).reshape(6, 3)
    spline = Spline(values[:1], values[1:2], values[2:], 0.0, PenaltyConvention.OPYNSIM)
    settings = WarpSettings(convention=PenaltyConvention.OPYNSIM)
    written = Coefficients(spline, tuple(names), settings=settings)
    write_coefficients(path, written)
    assert_same(read_coefficients(path), written)


@pytest.mark.parametrize("components", [Components.FULL, Components.WITHOUT_POSE])
def test_the_equation_in_the_file_can_be_evaluated_by_a_stranger(tmp_path, components):
    """With nothing but json, a loop, and what the file says."""
    coefficients = solved(components=components)
    path = tmp_path / "warp.json"
    write_coefficients(path, coefficients)
    found = json.loads(path.read_text(encoding="utf-8"))
    assert re.match(
        r"f\(v\) = a1 \+ a2 \* v_x \+ .* sum over i of w_i \* \|u_i - v\|", found["equation"]
    )
    v = (0.3, -1.2, 0.7)
    a1, a2, a3, a4 = found["affine"]
    result = [
        a1[c] + a2[c] * v[0] + a3[c] * v[1] + a4[c] * v[2]
        + sum(
            w[c] * math.dist(u, v)
            for u, w in zip(found["source_landmarks"], found["weights"], strict=True)
        )
        for c in range(3)
    ]  # fmt: skip
    assert np.allclose(result, coefficients.spline.evaluate([v])[0], rtol=0, atol=1e-13)


def test_a_file_of_arrays_needs_no_pickles(tmp_path):
    path = tmp_path / "warp.npz"
    written = solved()
    write_coefficients(path, written)
    with np.load(path, allow_pickle=False) as file:
        assert file["weights"].shape == (7, 3)
        assert file["names"].tolist() == list(written.names)
        assert str(file["unit"]) == "µm"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("{", "no coefficients"),
        ("[]", "not an object"),
        ("{}", "'format' is missing"),
        ('{"format": "other"}', "'other'"),
        ('{"format": "pinwarp-coefficients", "format_version": 99}', "newer pinwarp"),
    ],
)
def test_other_files_are_refused_with_the_reason(tmp_path, text, reason):
    path = tmp_path / "warp.json"
    path.write_text(text)
    with pytest.raises(FileFormatError, match=reason):
        read_coefficients(path)


@pytest.mark.parametrize("key", ["weights", "affine", "names", "unit", "warping_penalty"])
def test_a_file_with_a_part_missing_is_refused(tmp_path, key):
    path = tmp_path / "warp.json"
    write_coefficients(path, solved())
    found = json.loads(path.read_text(encoding="utf-8"))
    del found[key]
    path.write_text(json.dumps(found))
    with pytest.raises(FileFormatError, match=f"'{key}' is missing"):
        read_coefficients(path)


def test_rows_that_do_not_belong_together_are_refused(tmp_path):
    path = tmp_path / "warp.json"
    write_coefficients(path, solved())
    found = json.loads(path.read_text(encoding="utf-8"))
    found["weights"].pop()
    path.write_text(json.dumps(found))
    with pytest.raises(FileFormatError, match=r"\(6, 3\) instead of \(7, 3\)"):
        read_coefficients(path)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 cut off", b"\x93NUMPY\x01\x00"])
def test_a_damaged_archive_is_refused(tmp_path, content):
    path = tmp_path / "warp.npz"
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match=r"[Ee]xport .* again"):
        read_coefficients(path)


def test_a_missing_file_and_another_suffix_are_said(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read_coefficients(tmp_path / "warp.json")
    with pytest.raises(FileFormatError, match=r"\.json, \.npz"):
        write_coefficients(tmp_path / "warp.xml", solved())
    assert os.listdir(tmp_path) == []
