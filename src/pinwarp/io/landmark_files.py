"""Landmark files of every program: which format a file is in, reading and writing it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Protocol

from pinwarp.core.errors import FileFormatError, LandmarkError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.atomic import write_atomically
from pinwarp.io.landmark_formats import (
    bigwarp,
    idav,
    meshlab,
    mni_tag,
    morphologika,
    opensim_creator,
    slicer_fcsv,
    slicer_json,
    tps,
)
from pinwarp.io.landmark_formats.reading import MOST, LandmarkReading, SkippedLine
from pinwarp.io.landmark_formats.sliders import with_sliders
from pinwarp.io.landmark_formats.writing import Written
from pinwarp.io.text import read_text, refuse_binary

__all__ = [
    "FORMATS",
    "LANDMARK_SUFFIXES",
    "LandmarkFormat",
    "LandmarkReading",
    "SkippedLine",
    "format_of",
    "read_landmarks",
    "write_landmarks",
]

# Far more than anybody clicks; a larger file is another kind of file, and would fill the memory.
_LARGEST = 8 << 20
_HEAD = 4096


class LandmarkFormat(Protocol):
    """What every module of :mod:`pinwarp.io.landmark_formats` with a format offers."""

    @property
    def NAME(self) -> str:
        """What the format is called."""

    @property
    def SUFFIXES(self) -> tuple[str, ...]:
        """The ends of its files' names, in lower case, the usual one first."""

    @property
    def HOLDS_PAIRS(self) -> bool:
        """Whether both sides go into one file; every format holds one side."""

    def matches(self, head: str, /) -> bool:
        """Whether a text that begins like this is in this format."""

    def read(self, path: str | Path, text: str, side: Side, /) -> LandmarkReading:
        """Read a text; ``path`` is for the messages."""

    def text_of(
        self, landmarks: Sequence[Landmark], side: Side | None, unit: str, title: str, /
    ) -> Written:
        """Return the text of one side, or of pairs where ``side`` is None."""


# The tables without a mark of their own come last: any format above may look like one.
FORMATS: tuple[LandmarkFormat, ...] = (
    slicer_json,
    slicer_fcsv,
    meshlab,
    mni_tag,
    idav,
    tps,
    morphologika,
    bigwarp,
    opensim_creator,
)

_TABLES: LandmarkFormat = opensim_creator

LANDMARK_SUFFIXES = tuple(
    dict.fromkeys(suffix for known in reversed(FORMATS) for suffix in known.SUFFIXES)
)
"""Every suffix of a landmark file, OpenSim Creator's first."""


def read_landmarks(path: str | Path, side: Side) -> LandmarkReading:
    r"""Read a landmark file of any format, told by what is in it.

    Parameters
    ----------
    path
        The file. Its suffix decides only where its content leaves it open.
    side
        The side that a file of one side belongs to; a file of pairs fills both.

    Returns
    -------
    LandmarkReading
        With positions as they are stored: nothing is turned, and nothing converted. Points of
        curves and patches are among the landmarks. Beside a TPS file geomorph's tables of
        sliders are looked for.

    Raises
    ------
    FileFormatError
        When the file is missing, not text, larger than 8 MB or 20,000 lines, a session, or
        no landmark could be read.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "skull.txt")
    ...     _ = path.write_text("Version 1.0\n1\nS000 1 2 3\n")
    ...     reading = read_landmarks(path, Side.SOURCE)
    >>> reading.format, reading.names
    ('IDAV Landmark .pts', ('S000',))
    """
    text = read_text(path, "landmark", _LARGEST)
    refuse_binary(path, text)
    lines = text.count("\n") + text.count("\r") - text.count("\r\n")
    if lines > MOST:
        raise FileFormatError(
            path,
            f"It has {lines:,} lines, and a landmark file at most {MOST:,}. "
            "Check that it is the right file.",
        )
    if text.lstrip('" ').startswith("# pinwarp-session"):
        raise FileFormatError(
            path, "This is a session with its own meshes: open it instead of importing it."
        )
    known = _format_in(path, text)
    reading = known.read(path, text, side)
    return with_sliders(Path(path), reading) if known is tps else reading


def recognised(text: str) -> LandmarkFormat | None:
    """Return the format a text is in, as far as its beginning tells.

    Examples
    --------
    >>> found = recognised("LM3=1")
    >>> found.NAME if found else None
    'TPS'
    """
    head = text[:_HEAD]
    return next((known for known in FORMATS if known.matches(head)), None)


def _format_in(path: str | Path, text: str) -> LandmarkFormat:
    found, by_suffix = recognised(text), _format_by_suffix(path)
    # Slicer 3 wrote tables without any mark.
    if found is None or (found is _TABLES and by_suffix is slicer_fcsv):
        return by_suffix or _TABLES
    return found


def _format_by_suffix(path: str | Path) -> LandmarkFormat | None:
    """Return the format whose suffix the file has; the longest suffix counts."""
    name = Path(path).name.lower()
    found = [(len(s), known) for known in FORMATS for s in known.SUFFIXES if name.endswith(s)]
    return max(found, key=lambda item: item[0])[1] if found else None


def format_of(path: str | Path) -> LandmarkFormat:
    """Return the format a file is written in, by its suffix.

    Parameters
    ----------
    path
        The file; the longest suffix counts.

    Raises
    ------
    FileFormatError
        When the suffix is that of no format.

    Examples
    --------
    >>> format_of("femur.csv").NAME, format_of("femur.bigwarp.csv").NAME
    ('OpenSim Creator CSV', 'BigWarp CSV')
    """
    known = _format_by_suffix(path)
    if known is None:
        raise FileFormatError(
            path,
            f"Landmarks of the type {Path(path).suffix or 'without a suffix'!r} are not "
            f"supported. Choose one of {', '.join(LANDMARK_SUFFIXES)}.",
        )
    return known


def write_landmarks(
    path: str | Path,
    landmarks: Iterable[Landmark],
    side: Side | None,
    *,
    unit: str = "",
    known: LandmarkFormat | None = None,
) -> tuple[str, ...]:
    r"""Write landmarks in the format of the file's suffix, all of them or nothing.

    Parameters
    ----------
    path
        The file; ``.csv`` is OpenSim Creator's format, ``.bigwarp.csv`` is BigWarp's.
    landmarks
        The landmarks, their names different.
    side
        The side to write, or None to write both as pairs.
    unit
        The unit the positions are in, for formats that are in millimetres (3D Slicer's); the
        others have no unit and get the numbers as they are.
    known
        The format; without it, that of the file's suffix.

    Returns
    -------
    tuple of str
        What the format could not hold, as sentences for the user.

    Raises
    ------
    FileFormatError
        When the suffix is that of no format, the format holds no pairs, or positions cannot be
        converted.
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "femur.tps")
    ...     notes = write_landmarks(path, [Landmark("fovea", (1, 2, 3))], Side.SOURCE)
    ...     path.read_text()
    'LM3=1\n1.0 2.0 3.0\nID=femur\n'
    """
    known = known or format_of(path)
    if side is None and not known.HOLDS_PAIRS:
        both = ", ".join(x.SUFFIXES[0] for x in reversed(FORMATS) if x.HOLDS_PAIRS)
        raise FileFormatError(
            path,
            f"{known.NAME} holds one side only. Export source and destination to a file each, "
            f"or choose a format of pairs ({both}).",
        )
    title = Path(path).name.partition(".")[0]
    try:
        written = known.text_of(tuple(landmarks), side, unit, title)
    except LandmarkError as error:
        raise FileFormatError(path, str(error)) from error
    write_atomically(path, written.text)
    return written.notes
