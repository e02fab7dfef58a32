"""Landmarks from one program's file into another's, meaning the same places."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Landmark, Side, flipped
from pinwarp.core.words import counted, some_of
from pinwarp.io.file_names import is_session
from pinwarp.io.landmark_files import (
    LandmarkFormat,
    LandmarkReading,
    format_of,
    read_landmarks,
    write_landmarks,
)
from pinwarp.io.landmark_formats import slicer_fcsv, slicer_json
from pinwarp.io.session_file import read_session

# What these write is said to be in LPS.
_IN_LPS: tuple[LandmarkFormat, ...] = (slicer_fcsv, slicer_json)


@dataclass(frozen=True)
class Conversion:
    """What was converted.

    Attributes
    ----------
    count
        How many landmarks were read.
    read_as, written_as
        What the formats are called.
    notes
        What was skipped, turned or could not be held, as sentences.
    """

    count: int
    read_as: str
    written_as: str
    notes: tuple[str, ...]


def convert_landmarks(
    source: Path,
    output: Path,
    *,
    side: Side | None = None,
    known: LandmarkFormat | None = None,
    unit: str = "",
) -> Conversion:
    r"""Write a file's landmarks in another format.

    Parameters
    ----------
    source
        A landmark file of any format, or a session.
    output
        The file.
    side
        Which side of pairs is written; without it both are, where the format holds pairs.
    known
        The format to write; without it the output's suffix tells it.
    unit
        The unit of the positions, where the file itself says none: 3D Slicer's files are in
        millimetres.

    Raises
    ------
    PinwarpError
        When the file cannot be read, or the format cannot hold what is in it.
    OSError
        When the output cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     source, output = Path(folder, "femur.csv"), Path(folder, "femur.pp")
    ...     _ = source.write_text("name,x,y,z\nfovea,1,2,3\n")
    ...     convert_landmarks(source, output).written_as
    'MeshLab .pp'
    """
    target = known or format_of(output)
    reading = (
        _session_reading(source)
        if is_session(source)
        else read_landmarks(source, side or Side.SOURCE)
    )
    if reading.is_pairs and side is None and not target.HOLDS.pairs:
        raise PinwarpError(
            f"{source.name} holds both sides, and {target.NAME} holds one: "
            "choose it by --side source or --side destination."
        )
    written = side if reading.is_pairs else side or Side.SOURCE
    notes = write_in_frame(
        output,
        reading.landmarks,
        written,
        frame=reading.frame,
        unit=reading.unit or unit,
        known=target,
    )
    skipped = tuple(f"Line {x.line} was skipped: {x.reason}." for x in reading.skipped)
    return Conversion(
        len(reading.landmarks),
        reading.format,
        target.NAME,
        (*skipped, *reading.notes, *_group_notes(reading), *notes),
    )


def _group_notes(reading: LandmarkReading) -> tuple[str, ...]:
    names = [group.name for group in reading.groups]
    if not names:
        return ()
    return (f"{some_of(names)}: points of curves and patches were taken for landmarks.",)


def _session_reading(path: Path) -> LandmarkReading:
    record = read_session(path)
    notes: tuple[str, ...] = ()
    if record.groups:
        names = some_of([group.name for group in record.groups])
        notes = (
            f"{counted(len(record.groups), 'curve or patch', 'curves and patches')} left out "
            f"({names}): --semilandmarks writes them, too.",
        )
    return LandmarkReading(
        record.landmarks, True, (), "pinwarp session", unit=record.unit, notes=notes
    )


def write_in_frame(
    path: Path,
    landmarks: Iterable[Landmark],
    side: Side | None,
    *,
    frame: str,
    unit: str = "",
    known: LandmarkFormat | None = None,
) -> tuple[str, ...]:
    """Write landmarks such that the file's own frame is true of them.

    Parameters
    ----------
    path, landmarks, side, unit, known
        As in :func:`~pinwarp.io.landmark_files.write_landmarks`.
    frame
        The frame the positions are in, ``"RAS"``, ``"LPS"`` or empty where nobody knows.

    Returns
    -------
    tuple of str
        What was done about it, and what the format could not hold.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "skull.fcsv")
    ...     write_in_frame(path, [Landmark("nasion", (1, 2, 3))], Side.SOURCE, frame="RAS")
    ('The positions were turned from RAS to LPS.',)
    """
    target = known or format_of(path)
    notes: tuple[str, ...] = ()
    if frame == "RAS" and side is not None and target in _IN_LPS:
        landmarks = flipped(landmarks, side)
        notes = ("The positions were turned from RAS to LPS.",)
    elif frame and target not in _IN_LPS:
        notes = (f"The positions are in {frame}, and {target.NAME} cannot say so.",)
    return (*notes, *write_landmarks(path, landmarks, side, unit=unit, known=target))


def frame_notes(reading: LandmarkReading, unit: str) -> tuple[str, ...]:
    """Return what the user should know about landmarks that meet a mesh as they are stored.

    Parameters
    ----------
    reading
        The landmarks.
    unit
        The unit of the mesh.

    Examples
    --------
    >>> frame_notes(LandmarkReading((), False, (), frame="RAS", unit="mm"), "mm")
    ('The positions are in RAS and were taken as they are.',)
    """
    notes = [*_group_notes(reading)]
    if reading.frame == "RAS":
        notes.append("The positions are in RAS and were taken as they are.")
    if reading.unit and reading.unit != unit:
        notes.append(
            f"The positions are in {reading.unit}, the mesh is in {unit}: nothing was converted."
        )
    return tuple(notes)
