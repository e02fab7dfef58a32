"""The colours are told apart by people who see no red, no green or no blue (simulated)."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from pinwarp.gui.style import theme

# Machado, Oliveira and Fernandes (IEEE TVCG 15, 2009), severity 1, on linear RGB.
KINDS = {
    "none": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "tritanopia": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
# Of CIELAB: about 2.3 can just be told; across a window it takes more.
APART = 12.0
_WHITE = np.array([0.95047, 1.0, 1.08883])
_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def lab(colour: str, kind: str) -> np.ndarray:
    """Return how a colour is seen: lightness, and two axes of colour."""
    values = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    linear = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    xyz = _TO_XYZ @ np.clip(KINDS[kind] @ linear, 0, 1) / _WHITE
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def apart(one: str, other: str, kind: str) -> float:
    return float(np.linalg.norm(lab(one, kind) - lab(other, kind)))


@pytest.fixture(params=KINDS)
def kind(request) -> str:
    return request.param


def test_states_of_landmarks_differ(kind):
    colours = sorted({*theme.STATE_COLOURS.values(), theme.SELECTED_COLOUR})
    for one, other in combinations(colours, 2):
        assert apart(one, other, kind) > APART, (one, other)


def test_bones_overlay_and_folds_differ(kind):
    bones = (theme.SOURCE_COLOUR, theme.DESTINATION_COLOUR, theme.OVERLAY_COLOUR, theme.FOLD_COLOUR)
    for one, other in combinations(bones[1:], 2):
        assert apart(one, other, kind) > APART, (one, other)


def test_what_warns_differs_from_what_does_not(kind):
    for one, other in (
        (theme.WARNING_COLOUR, theme.BAR_COLOUR),
        (theme.LEFT_OUT_COLOUR, theme.ARROW_COLOUR),
        (theme.GHOST_COLOUR, theme.FOLD_COLOUR),
    ):
        assert apart(one, other, kind) > 2 * APART, (one, other)


def test_a_map_of_lengths_goes_from_dark_to_light(kind):
    lightness = [lab(colour, kind)[0] for colour in theme.SEQUENTIAL_COLOURS]
    assert min(np.diff(lightness)) > 3


def test_a_map_of_ratios_tells_shrinking_from_growing(kind):
    colours = theme.DIVERGING_COLOURS
    middle = len(colours) // 2
    for away in range(1, middle + 1):
        below, above = colours[middle - away], colours[middle + away]
        assert apart(below, above, kind) > APART, (below, above)
    for half in (colours[: middle + 1], colours[: middle - 1 : -1]):
        assert min(np.diff([lab(colour, kind)[0] for colour in half])) > 3


def test_curves_and_patches_next_to_one_another_differ(kind):
    for one, other in zip(theme.GROUP_COLOURS, theme.GROUP_COLOURS[1:], strict=False):
        assert apart(one, other, kind) > APART, (one, other)


def test_axes_of_frames_differ(kind):
    for one, other in combinations(theme.AXIS_COLOURS, 2):
        assert apart(one, other, kind) > APART, (one, other)
