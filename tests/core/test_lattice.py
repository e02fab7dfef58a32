from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.lattice import READABLE, box_lattice, plane_lattice
from pinwarp.core.spline import factorise, solve

extents = st.lists(st.floats(1e-3, 1e3), min_size=3, max_size=3).map(np.array)
corners = st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3).map(np.array)


def crossings(lines, axis):
    """Where the lines of other directions stand along an axis."""
    across = lines[np.ptp(lines[:, :, axis], axis=1) == 0]
    return np.unique(across[:, 0, axis])


@given(corners, extents, st.integers(1, 15))
def test_the_lattice_is_straight_lines_around_the_box_and_five_percent_larger(low, extent, cells):
    high = low + extent
    lines = box_lattice(low, high, cells)
    assert len(lines) <= READABLE
    box = lines.reshape(-1, 3)
    size = np.abs([low, high]).max()
    assert np.allclose(box.min(axis=0), low - 0.025 * (high - low), atol=1e-12 * size)
    assert np.allclose(box.max(axis=0), high + 0.025 * (high - low), atol=1e-12 * size)
    # Each line runs along one axis, evenly, from one side of the lattice to the other.
    ways = np.ptp(lines, axis=1)
    along = ways.argmax(axis=1)
    assert (np.count_nonzero(ways, axis=1) == 1).all()
    assert (np.diff(along) >= 0).all()
    assert np.allclose(ways.max(axis=1), 1.05 * (high - low)[along], atol=1e-11 * size)
    steps = np.diff(lines, axis=1)
    assert np.allclose(steps, steps.mean(axis=1, keepdims=True), atol=1e-11 * size)
    # No line is drawn twice.
    starts_and_ends = lines[:, [0, -1]].reshape(len(lines), 6)
    assert len(np.unique(starts_and_ends, axis=0)) == len(lines)


@given(extents, st.integers(1, 15))
def test_cells_are_as_near_to_cubes_as_fit(extent, cells):
    lines = box_lattice([0, 0, 0], extent, cells)
    places = [crossings(lines, axis) for axis in range(3)]
    counts = np.array([len(place) - 1 for place in places])
    assert counts[extent.argmax()] <= cells
    side = extent.max() / counts.max()
    own = extent / counts
    # Thinner than a cell the box is one cell thick.
    assert ((own <= 1.51 * side) & ((counts == 1) | (own >= 0.66 * side))).all()
    for place in places:
        assert np.allclose(np.diff(place), np.ptp(place) / (len(place) - 1))


def test_a_long_bone_has_the_cells_asked_for_and_a_cube_fewer():
    assert len(crossings(box_lattice([0, 0, 0], [60, 60, 200], 12), 2)) == 13
    cube = box_lattice([0, 0, 0], [1, 1, 1], 12)
    assert len(crossings(cube, 0)) == 9
    assert len(cube) == 3 * 81


def test_lines_are_sampled_finely_enough_to_look_smooth_when_bent():
    rng = np.random.default_rng(0)
    source = rng.uniform(-1, 1, (20, 3)) * [30, 30, 100]
    destination = source + 5 * np.sin(source[:, [1, 2, 0]] / 20)
    lines = box_lattice(source.min(axis=0), source.max(axis=0))
    warp = solve(factorise(source), destination)
    warped = warp.evaluate(lines.reshape(-1, 3)).reshape(lines.shape)
    assert np.ptp(warped - lines, axis=(0, 1)).max() > 2
    ways = np.diff(warped, axis=1)
    ways /= np.linalg.norm(ways, axis=2, keepdims=True)
    turns = np.degrees(np.arccos(np.clip(np.sum(ways[:, 1:] * ways[:, :-1], axis=2), -1, 1)))
    assert np.percentile(turns, 99) < 6


@given(corners, extents, st.sampled_from("xyz"), st.floats(0, 1), st.integers(1, 30))
def test_a_plane_crosses_its_axis_at_the_share_of_the_depth(low, extent, axis, share, cells):
    high = low + extent
    lines = plane_lattice(low, high, axis, share, cells)
    across = "xyz".index(axis)
    size = np.abs([low, high]).max()
    assert np.allclose(lines[:, :, across], low[across] + share * extent[across], atol=1e-12 * size)
    others = [0, 1, 2]
    others.remove(across)
    box = lines.reshape(-1, 3)[:, others]
    grown = 0.025 * (high - low)[others]
    assert np.allclose(box.min(axis=0), low[others] - grown, atol=1e-12 * size)
    assert np.allclose(box.max(axis=0), high[others] + grown, atol=1e-12 * size)
    counts = [len(crossings(lines, other)) - 1 for other in others]
    assert max(counts) == cells
    assert len(lines) == sum(counts) + 2
    assert (np.count_nonzero(np.ptp(lines, axis=1), axis=1) == 1).all()


def test_flat_boxes_have_the_lines_of_a_plane_and_places_none():
    flat = box_lattice([0, 0, 5], [4, 2, 5], 4)
    assert np.array_equal(flat, plane_lattice([0, 0, 0], [4, 2, 10], "z", 0.5, 4))
    assert len(box_lattice([0, 0, 0], [4, 0, 0])) == 1
    assert box_lattice([1, 1, 1], [1, 1, 1]).shape[::2] == (0, 3)


@pytest.mark.parametrize(
    ("low", "high", "cells"),
    [
        ([0, 0, 0], [1, 1, 1], 0),
        ([0, 0, 0], [1, -1, 1], 3),
        ([0, 0, np.nan], [1, 1, 1], 3),
        ([0, 0, 0], [1, np.inf, 1], 3),
    ],
)
def test_what_is_no_box_is_refused(low, high, cells):
    with pytest.raises(ValueError, match=r"no lines|no box"):
        box_lattice(low, high, cells)
    with pytest.raises(ValueError, match=r"no lines|no box"):
        plane_lattice(low, high, "x", cells=cells)


def test_another_axis_is_refused():
    with pytest.raises(ValueError, match="substring"):
        plane_lattice([0, 0, 0], [1, 1, 1], "w")
