"""geomorph's tables of sliders, which lie beside a file of landmarks without names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.words import counted
from pinwarp.io.csv_text import rows_of
from pinwarp.io.landmark_formats.reading import LandmarkReading, ReadGroup
from pinwarp.io.text import lines_of, read_text

_LARGEST = 8 << 20
CURVES, SURFACE = ".sliders.csv", ".surfslide.csv"


def with_sliders(path: Path, reading: LandmarkReading) -> LandmarkReading:
    """Return a reading with the curves and the patch that tables beside its file tell of.

    Parameters
    ----------
    path
        The file that was read: the tables of ``femur.tps`` are ``femur.sliders.csv`` (before,
        slide, after) and ``femur.surfslide.csv``, rows counted from 1.
    reading
        What was in it.

    Raises
    ------
    FileFormatError
        When a table that is there cannot be read; the message names its line.
    """
    curves, surface = (path.with_name(path.stem + suffix) for suffix in (CURVES, SURFACE))
    names, groups = reading.names, list(reading.groups)
    found = []
    if curves.is_file():
        sliders = _rows(curves, 3, len(names))
        sliding = {names[row] for _, row, _ in sliders}
        for number, (chain, is_closed) in enumerate(_chains(sliders)):
            points = tuple(names[row] for row in chain)
            groups.append(
                ReadGroup(
                    f"curve_{number}",
                    points,
                    is_closed=is_closed,
                    # What does not slide is a landmark.
                    anchors=frozenset(points) - sliding,
                )
            )
        found.append(curves.name)
    if surface.is_file():
        points = tuple(names[row] for (row,) in _rows(surface, 1, len(names)))
        groups.append(ReadGroup("patch_0", points, is_curve=False))
        found.append(surface.name)
    if not found:
        return reading
    note = f"What slides was read from {' and '.join(found)}."
    return replace(reading, notes=(*reading.notes, note), groups=tuple(groups))


def _rows(path: Path, width: int, most: int) -> list[tuple[int, ...]]:
    """Return the rows of a table of row numbers, counted from 0."""
    rows: list[tuple[int, ...]] = []
    for row in rows_of(lines_of(read_text(path, "slider", _LARGEST)), ","):
        if row.is_blank:
            continue
        cells = [cell.strip() for cell in row.cells]
        if not rows and row.line == 1 and not any(map(str.isdigit, cells)):
            continue
        if len(cells) != width or not all(re.fullmatch("[0-9]{1,9}", cell) for cell in cells):
            raise FileFormatError(
                path, f"Expected {counted(width, 'row number')}: {row.text[:60]!r}.", row.line
            )
        numbers = tuple(int(cell) - 1 for cell in cells)
        if not all(0 <= number < most for number in numbers):
            raise FileFormatError(
                path, f"There are {most} landmarks, counted from 1: {row.text[:60]!r}.", row.line
            )
        rows.append(numbers)
    return rows


def _chains(sliders: Sequence[Sequence[int]]) -> list[tuple[list[int], bool]]:
    """Join sliders to curves: each goes on where the one before ends; and whether it closes."""
    chains: list[tuple[list[int], bool]] = []
    chain: list[int] = []
    for before, row, after in sliders:
        if chain[-2:] == [before, row]:
            chain.append(after)
            continue
        if chain:
            chains.append(_closed(chain))
        chain = [before, row, after]
    return [*chains, _closed(chain)] if chain else chains


def _closed(chain: list[int]) -> tuple[list[int], bool]:
    # All around, the last slider leads to the first one: last, first, ..., last, first.
    if len(chain) > 4 and chain[:2] == chain[-2:]:
        return chain[1:-1], True
    # Round from a landmark and back to it.
    if len(chain) > 3 and chain[0] == chain[-1]:
        return chain[:-1], True
    return chain, False
