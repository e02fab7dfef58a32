"""Semilandmarks for other programs: which format a file is in, and writing it with its fellows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import FileFormatError, LandmarkError
from pinwarp.io.atomic import write_atomically
from pinwarp.io.landmark_formats.lines import one_line
from pinwarp.io.semilandmark_formats.for_r import geomorph_files, morpho_files
from pinwarp.io.semilandmark_formats.morphometrics import (
    idav_files,
    morphologika_files,
    tps_curves_files,
)
from pinwarp.io.semilandmark_formats.points import OutputFile, PointSet
from pinwarp.io.semilandmark_formats.slicer import slicer_files

Files = tuple[list[OutputFile], list[str]]


@dataclass(frozen=True)
class SemilandmarkFormat:
    """A format: what it is called, the suffix of its first file, and what makes the files."""

    name: str
    suffix: str
    files: Callable[[PointSet, str], Files]


FORMATS = (
    SemilandmarkFormat("geomorph: TPS with sliders", ".tps", geomorph_files),
    SemilandmarkFormat("TPS with curves", ".curves.tps", tps_curves_files),
    SemilandmarkFormat("Morpho: R and points", ".R", morpho_files),
    SemilandmarkFormat("IDAV Landmark", ".pts", idav_files),
    SemilandmarkFormat("Morphologika", ".morphologika.txt", morphologika_files),
    SemilandmarkFormat("3D Slicer markups", ".mrk.json", slicer_files),
)
SEMILANDMARK_SUFFIXES = tuple(known.suffix for known in FORMATS)
"""Every suffix, the usual one first."""


def format_of_semilandmarks(path: Path) -> SemilandmarkFormat:
    """Return the format of a file by its suffix; the longest counts.

    Raises
    ------
    FileFormatError
        When it is that of no format.

    Examples
    --------
    >>> format_of_semilandmarks(Path("femur.curves.tps")).name
    'TPS with curves'
    """
    name = path.name.lower()
    fitting = [known for known in FORMATS if name.endswith(known.suffix.lower())]
    if not fitting:
        known = ", ".join(SEMILANDMARK_SUFFIXES)
        raise FileFormatError(
            path,
            f"Semilandmarks of the type {path.suffix or 'without a suffix'!r} are not supported. "
            f"Choose one of {known}.",
        )
    return max(fitting, key=lambda known: len(known.suffix))


def semilandmark_files(
    path: Path, points: PointSet, known: SemilandmarkFormat | None = None
) -> tuple[dict[Path, str], tuple[str, ...]]:
    """Return all files that a path stands for, and what they could not hold; none is written.

    Parameters
    ----------
    path
        The first file; the others are called as it is, with other suffixes.
    points
        What they hold.
    known
        The format; without it that of the file's suffix.

    Raises
    ------
    FileFormatError
        When the suffix is that of no format, or positions cannot be converted.

    Examples
    --------
    >>> points = PointSet((("tip", (0.0, 0.0, 0.0)),), 1)
    >>> [x.name for x in semilandmark_files(Path("femur.R"), points)[0]]
    ['femur.R', 'femur.points.csv']
    """
    known = known or format_of_semilandmarks(path)
    has_suffix = path.name.lower().endswith(known.suffix.lower())
    stem = path.name[: -len(known.suffix)] if has_suffix else path.stem
    try:
        files, notes = known.files(points, one_line(stem).strip() or "specimen")
    except LandmarkError as error:
        raise FileFormatError(path, str(error)) from error
    first, *others = files
    texts = {path: first.text}
    texts |= {path.with_name(stem + file.suffix): file.text for file in others}
    return texts, tuple(notes)


def write_all(texts: dict[Path, str]) -> None:
    """Write files, the first one last: where it is there, all are.

    Raises
    ------
    OSError
        When one cannot be written.
    """
    for path, text in reversed(texts.items()):
        write_atomically(path, text)
