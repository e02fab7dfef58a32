"""Landmark files of every program: which format a file is in, reading and writing it."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from pinwarp.core.errors import FileFormatError, LandmarkError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.atomic import write_atomically
from pinwarp.io.landmark_formats import (
    amira,
    bigwarp,
    bigwarp_json,
    blank_table,
    idav,
    meshlab,
    mni_tag,
    morphologika,
    nts,
    opensim_creator,
    particles,
    slicer_fcsv,
    slicer_json,
    slicer_table,
    specimen_table,
    tps,
)
from pinwarp.io.landmark_formats.reading import MOST, LandmarkReading, ReadGroup, SkippedLine
from pinwarp.io.landmark_formats.sliders import with_sliders
from pinwarp.io.landmark_formats.specimens import FIRST
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written, lost
from pinwarp.io.reading import read_content
from pinwarp.io.strangers import refuse_stranger
from pinwarp.io.text import decoded, refuse_binary

__all__ = [
    "FORMATS",
    "LANDMARK_SUFFIXES",
    "LandmarkFormat",
    "LandmarkReading",
    "SkippedLine",
    "format_of",
    "located",
    "read_landmarks",
    "write_landmarks",
]

ALL = "all"
"""Behind a file: every specimen of it."""

# Far more than anybody clicks; a larger file is another kind of file, and would fill the memory.
_LARGEST = 8 << 20
_HEAD = 1 << 16


class LandmarkFormat(Protocol):
    """What every module of :mod:`pinwarp.io.landmark_formats` with a format offers."""

    @property
    def NAME(self) -> str:
        """What the format is called."""

    @property
    def SUFFIXES(self) -> tuple[str, ...]:
        """The ends of its files' names, in lower case, the usual one first."""

    @property
    def HOLDS(self) -> Holds:
        """What it has a place for, beside positions on one side."""

    def matches(self, head: str, /) -> bool:
        """Whether a text that begins like this is in this format."""

    def read(self, path: str | Path, text: str, side: Side, /) -> LandmarkReading:
        """Read a text; ``path`` is for the messages."""

    def text_of(self, outgoing: Outgoing, /) -> Written:
        """Return the text of one side, or of pairs."""


class SpecimenFormat(LandmarkFormat, Protocol):
    """A format whose files may hold several specimens."""

    def read_specimen(
        self, path: str | Path, text: str, side: Side, which: str, /
    ) -> LandmarkReading:
        """Read one of them, by its name or number."""


# The tables without a mark of their own come last: any format above may look like one.
FORMATS: tuple[LandmarkFormat, ...] = (
    bigwarp_json,
    slicer_json,
    slicer_fcsv,
    meshlab,
    mni_tag,
    amira,
    idav,
    tps,
    nts,
    morphologika,
    bigwarp,
    slicer_table,
    specimen_table,
    particles,
    blank_table,
    opensim_creator,
)
_OF_SPECIMENS: tuple[SpecimenFormat, ...] = (tps, morphologika, nts, specimen_table)

_TABLES: LandmarkFormat = opensim_creator
# Tables that look like others, and the suffix of those, which then settles it.
_SETTLED: tuple[tuple[LandmarkFormat, LandmarkFormat], ...] = (
    (opensim_creator, slicer_fcsv),  # Slicer 3 wrote tables without any mark.
    (blank_table, idav),
    (blank_table, particles),
)

LANDMARK_SUFFIXES = tuple(
    dict.fromkeys(suffix for known in reversed(FORMATS) for suffix in known.SUFFIXES)
)
"""Every suffix of a landmark file, OpenSim Creator's first."""


def located(path: str | Path) -> tuple[Path, str]:
    """Return the file that is meant, and which specimen in it, where ``FILE#SPECIMEN`` says so.

    Parameters
    ----------
    path
        A file whose own name has a ``#`` in it is meant as it is.

    Examples
    --------
    >>> located("skulls.tps#fem01")[1], located("skulls.tps")[1]
    ('fem01', '')
    """
    path = Path(path)
    file, mark, which = path.name.rpartition("#")
    if not mark or not file or path.exists():
        return path, FIRST
    return path.with_name(file), which


def read_landmarks(path: str | Path, side: Side) -> LandmarkReading:
    r"""Read a landmark file of any format, told by what is in it.

    Parameters
    ----------
    path
        The file. Its suffix decides only where its content leaves it open. Of a file of several
        specimens the first is read, or the one that is named: ``FILE#SPECIMEN``.
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
    path, which = located(path)
    text = _text_of(path)
    known = _format_in(path, text)
    several = next((x for x in _OF_SPECIMENS if x is known), None)
    if several is not None:
        reading = several.read_specimen(path, text, side, which)
    elif which != FIRST:
        raise FileFormatError(
            path, f"It holds one specimen: leave out '#{which}'. Its format is {known.NAME}."
        )
    else:
        reading = known.read(path, text, side)
    return with_sliders(path, reading) if known is tps else reading


def _text_of(path: Path) -> str:
    """Return what is in a file, as far as it can be one of landmarks."""
    try:
        data = read_content(path, what="landmark", largest=_LARGEST).data
    except FileFormatError:
        # What is too large is told by what it is, where that is known.
        if path.is_file():
            with contextlib.suppress(OSError), path.open("rb") as file:
                refuse_stranger(path, file.read(_HEAD))
        raise
    refuse_stranger(path, data)
    text = decoded(data)
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
    return text


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
    if found is None or (found, by_suffix) in _SETTLED:
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
    groups: Iterable[ReadGroup] = (),
    remarks: tuple[str, ...] = (),
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
    groups
        The curves and patches that some of them are points of.
    remarks
        A line each for people, such as what made the file; formats with comments have them.

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
    holds = known.HOLDS
    if side is None and not holds.pairs:
        both = ", ".join(x.SUFFIXES[0] for x in reversed(FORMATS) if x.HOLDS.pairs)
        raise FileFormatError(
            path,
            f"{known.NAME} holds one side only. Export source and destination to a file each, "
            f"or choose a format of pairs ({both}).",
        )
    title = Path(path).name.partition(".")[0]
    outgoing = Outgoing(tuple(landmarks), side, unit, title, tuple(groups), remarks)
    kept = tuple(x for x in outgoing.groups if (holds.curves if x.is_curve else holds.patches))
    try:
        written = known.text_of(replace(outgoing, groups=kept))
    except LandmarkError as error:
        raise FileFormatError(path, str(error)) from error
    write_atomically(path, written.text)
    return (*lost(holds, outgoing), *written.notes)
