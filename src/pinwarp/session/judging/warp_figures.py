"""The warp taken apart into figures: for the eye, and as a table for a spreadsheet."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.basis import Basis
from pinwarp.core.components import Components
from pinwarp.core.lengths import ROUNDING, Ruler, rounding_among
from pinwarp.io.csv_cells import numeral
from pinwarp.io.csv_text import csv_line
from pinwarp.session.judging.quality import LEAST_PAIRS, Quality
from pinwarp.session.warp.component_words import COMPONENT_WORDS

_SIGNIFICANT = 4

_OPEN_DIRECTIONS = {
    0: "One place tells how far to move, and nothing else: turn and size stay as they are.",
    1: "Pairs on one line tell how far to move, the size, and one direction: the turn about the "
    "line is the smallest that fits, and nothing is sheared.",
    2: "Pairs in one plane say nothing about the direction across it: there the size is that of "
    "the similarity fit.",
}


@dataclass(frozen=True)
class Figure:
    """One number.

    Parameters
    ----------
    name
        Which one of its row: an axis, or what it is; empty where it is alone.
    value, unit
        The number as it is.
    text
        The number and its unit as they are shown.
    """

    name: str
    value: float
    unit: str
    text: str


@dataclass(frozen=True)
class FigureRow:
    """Figures that belong together, what they are called and what they mean."""

    title: str
    figures: tuple[Figure, ...]
    meaning: str


def determined_in_words(quality: Quality | None) -> str:
    """Say what the pairs leave open, and how to determine it; nothing where all is determined.

    Examples
    --------
    >>> determined_in_words(None)[:12]
    'No pair yet:'
    """
    if quality is None:
        return "No pair yet: place a landmark on both bones to see what the warp does."
    if quality.rank < 3:
        return f"{_OPEN_DIRECTIONS[quality.rank]} Four pairs that span space determine the rest."
    if len(quality.inputs.source) < LEAST_PAIRS:
        return "Four pairs are met by an affine map: the warp bends from five pairs on."
    return ""


def warp_figures(quality: Quality, unit: Ruler | str) -> tuple[FigureRow, ...]:
    """Return the affine fit and the bending of a warp as figures with their units.

    Parameters
    ----------
    quality
        Of the warp.
    unit
        The unit of the meshes, or how lengths are told.

    Returns
    -------
    tuple of FigureRow
        Translation of the middle of the source landmarks, rotation, scale along the source's
        axes, shear between them, principal stretches, mirroring, and bending energy (in
        destination units squared per source unit, so that it is a length; with the basis
        ``r^2 log r`` per source unit squared, a number).

    Examples
    --------
    >>> from pinwarp.session import edits
    >>> from pinwarp.session.judging.quality import quality_of
    >>> from pinwarp.session.warp.result import WarpInputs
    >>> from pinwarp.session.warp.solver import WarpSolver
    >>> from pinwarp.session.session import Session
    >>> from pinwarp.core.landmarks import Landmark
    >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    >>> pairs = tuple(Landmark(f"p{i}", at, (2 * at[0], at[1], at[2] + 3))
    ...               for i, at in enumerate(corners))
    >>> judged = quality_of(WarpSolver().solve(WarpInputs.of(Session(landmarks=pairs))))
    >>> [figure.text for figure in warp_figures(judged, "mm")[3].figures]
    ['200.0%', '100.0%', '100.0%']
    """
    parts, noise, ruler = quality.affine, _noise(quality), Ruler.of(unit)
    is_length = quality.inputs.settings.basis is Basis.R
    energy = (ruler, noise) if is_length else (Ruler(), ROUNDING)
    squared = "" if is_length else " squared"
    length = float(np.linalg.norm(parts.translation))
    axis = [
        Figure(name, at, "", _plain(at, 3))
        for name, at in zip("xyz", parts.axis.tolist(), strict=True)
    ]
    largest_stretch = float(np.abs(parts.principal).max())
    return (
        FigureRow(
            "Translation",
            _figures([*"xyz", "length"], [*parts.translation, length], ruler, noise),
            "How far the middle of the source landmarks moves",
        ),
        FigureRow(
            "Rotation",
            (Figure("", parts.angle, "°", f"{_plain(parts.angle, 2)}°"),),
            "Right-handed about the rotation axis",
        ),
        FigureRow("Rotation axis", tuple(axis), "A unit vector"),
        FigureRow(
            "Scale",
            _percents("xyz", parts.scales, largest_stretch),
            "How lengths along the source's axes grow",
        ),
        FigureRow(
            "Shear",
            _percents(("xy", "xz", "yz"), parts.shears, largest_stretch),
            "How far each of these axes leans towards the other",
        ),
        FigureRow(
            "Principal stretch",
            _percents(("1", "2", "3"), parts.principal, largest_stretch),
            "How lengths grow along the three directions at right angles that stay so",
        ),
        FigureRow(
            "Mirrored",
            (Figure("", float(parts.mirrored), "", "yes" if parts.mirrored else "no"),),
            "Whether it makes a left bone of a right one",
        ),
        FigureRow(
            "Bending energy",
            _figures([*"xyz", "total"], [*quality.energy, quality.energy.sum()], *energy),
            f"Of the {_warp_of(quality)}, in destination units squared per source unit{squared}",
        ),
    )


def rms_text(rms: float, quality: Quality, unit: Ruler | str) -> str:
    """Return what a part of the warp leaves between the pairs, as it is shown."""
    largest, noise = max(quality.rms_by_components.values()), _noise(quality)
    ruler = Ruler.of(unit)
    k = ruler.factor
    ((_, text),) = _texts([k * rms], k * largest if rms > noise else 0.0, k * noise)
    return f"{text} {ruler.unit}"


def figures_table(quality: Quality, unit: str) -> str:
    r"""Return all figures as spreadsheets take them: a header, then a number a row, between tabs.

    Numbers are in full, a point for the decimals.
    """
    rows = [("quantity", "part", "value", "unit")]
    for part in Components:
        rms = quality.rms_by_components[part]
        tidy = rms if rms > _noise(quality) else 0.0
        rows.append(("RMS left", COMPONENT_WORDS[part].noun, numeral(f"{tidy:.10g}"), unit))
    for row in warp_figures(quality, unit):
        rows += [(row.title, x.name, numeral(f"{x.value:.10g}"), x.unit) for x in row.figures]
    return "".join(csv_line(row, "\t") for row in rows)


def _warp_of(quality: Quality) -> str:
    refined = quality.inputs.refinement is not None
    return "refined warp, fitted places included" if refined else "full warp at this penalty"


def _noise(quality: Quality) -> float:
    """Return the length below which there is only rounding."""
    inputs = quality.inputs
    return rounding_among(inputs.source, inputs.destination)


def _figures(
    names: Sequence[str], values: Sequence[float], ruler: Ruler, noise: float
) -> tuple[Figure, ...]:
    """Return lengths, all with as many decimals as the largest of them deserves."""
    k = ruler.factor
    texts = _texts([k * x for x in values], k * max(abs(value) for value in values), k * noise)
    return tuple(
        Figure(name, value, ruler.unit, f"{text} {ruler.unit}".rstrip())
        for name, (value, text) in zip(names, texts, strict=True)
    )


def _percents(
    names: Iterable[str], shares: NDArray[np.float64], largest: float
) -> tuple[Figure, ...]:
    texts = _texts([100 * share for share in shares.tolist()], 100 * largest, 0.0)
    return tuple(
        Figure(name, value, "%", f"{text}%")
        for name, (value, text) in zip(names, texts, strict=True)
    )


def _texts(values: Sequence[float], largest: float, noise: float) -> list[tuple[float, str]]:
    """Return each value without noise, and as text to the precision that suits the largest."""
    if not largest > noise:
        return [(0.0, "0") for _ in values]
    decimals = max(0, _SIGNIFICANT - 1 - math.floor(math.log10(largest)))
    tidy = [0.0 if abs(value) <= noise else float(value) for value in values]
    return [(value, _plain(value, decimals)) for value in tidy]


def _plain(value: float, decimals: int) -> str:
    """Return a number with so many decimals; no minus before a zero."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}"
