"""Landmarks from one program's file into another's, meaning the same places."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Landmark, Side, flipped, positions
from pinwarp.core.words import counted, some_of
from pinwarp.io.file_names import is_session
from pinwarp.io.landmark_files import (
    LandmarkFormat,
    LandmarkReading,
    format_of,
    read_landmarks,
    write_landmarks,
)
from pinwarp.io.landmark_formats.reading import ReadGroup
from pinwarp.io.session_file import read_session
from pinwarp.session.mesh_units import LARGEST_IN_METRES

FRAMES = ("LPS", "RAS")


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
    specimens
        How many the file holds.
    """

    count: int
    read_as: str
    written_as: str
    notes: tuple[str, ...]
    specimens: int = 1


@dataclass(frozen=True)
class Meant:
    """What is said about a file that it does not say itself.

    Parameters
    ----------
    unit, frame
        Of its positions; empty where nobody says.
    landmarks
        Whether it holds landmarks, however little it looks like it.
    """

    unit: str = ""
    frame: str = ""
    landmarks: bool = False


def convert_landmarks(
    source: Path,
    output: Path,
    *,
    side: Side | None = None,
    known: LandmarkFormat | None = None,
    meant: Meant = Meant(),
) -> Conversion:
    r"""Write a file's landmarks in another format.

    Parameters
    ----------
    source
        A landmark file of any format, or a session. Of several specimens the first is taken, or
        the one that is named: ``FILE#SPECIMEN``.
    output
        The file.
    side
        Which side of pairs is written; without it both are, where the format holds pairs.
    known
        The format to write; without it the output's suffix tells it.
    meant
        What the file itself does not say. Where the format is in one unit and one frame only,
        both must be known: nothing is guessed, but that numbers too large for metres are
        millimetres.

    Raises
    ------
    PinwarpError
        When the file cannot be read or may hold no landmarks, its unit or frame is needed and not
        known, or the format cannot hold what is in it.
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
    of_session = is_session(source)
    reading = (
        _session_reading(source) if of_session else read_landmarks(source, side or Side.SOURCE)
    )
    if reading.doubts and not meant.landmarks:
        raise PinwarpError(
            f"{source.name}: Are these landmarks? {' '.join(reading.doubts)} If they are, use "
            "--force."
        )
    if reading.is_pairs and side is None and not target.HOLDS.pairs:
        raise PinwarpError(
            f"{source.name} holds both sides, and {target.NAME} holds one: "
            "choose it by --side source or --side destination."
        )
    written = side if reading.is_pairs else side or Side.SOURCE
    sides = tuple(Side) if written is None else (written,)
    if not target.HOLDS.empty and not any(
        x.position(one) for x in reading.landmarks for one in sides
    ):
        raise PinwarpError(
            f"No landmark of {source.name} has a position, and {target.NAME} holds no names alone."
        )
    said, notes = _said(source.name, reading, target, meant, of_session=of_session, sides=sides)
    told = write_in_frame(
        output,
        reading.landmarks,
        written,
        frame=said.frame,
        unit=said.unit,
        known=target,
        groups=reading.groups,
    )
    skipped = tuple(f"Line {x.line} was skipped: {x.reason}." for x in reading.skipped)
    return Conversion(
        len(reading.landmarks),
        reading.format,
        target.NAME,
        (*reading.doubts, *skipped, *reading.notes, *notes, *told),
        max(1, len(reading.specimens)),
    )


def convert_specimens(
    source: Path, output_of: Callable[[str], Path], convert: Callable[[Path, Path], Conversion]
) -> dict[Path, Conversion]:
    """Convert every specimen of a file to a file of its own.

    Parameters
    ----------
    source
        A landmark file of several specimens.
    output_of
        Gives the file of a specimen by its name.
    convert
        Converts one, named behind the file, to its output.

    Returns
    -------
    dict
        What was written, by file.

    Raises
    ------
    PinwarpError
        When the file cannot be read or holds no specimens, or two would go into one file.
    """
    specimens = read_landmarks(source, Side.SOURCE).specimens
    if not specimens:
        raise PinwarpError(f"{source.name} holds no specimens: leave out '#all'.")
    outputs = {name: output_of(name) for name in specimens}
    # Many systems take upper and lower case for one.
    if len({str(output).casefold() for output in outputs.values()}) < len(outputs):
        raise PinwarpError(
            f"Two specimens of {source.name} would be written to one file: rename one of "
            f"{some_of(specimens)}."
        )
    return {
        output: convert(source.with_name(f"{source.name}#{name}"), output)
        for name, output in outputs.items()
    }


def _said(
    name: str,
    reading: LandmarkReading,
    target: LandmarkFormat,
    meant: Meant,
    *,
    of_session: bool,
    sides: Sequence[Side],
) -> tuple[Meant, tuple[str, ...]]:
    """Return unit and frame of what was read, and what was taken for granted."""
    frame = meant.frame.upper()
    if frame and frame not in FRAMES:
        raise PinwarpError(f"The frame {meant.frame!r} is not known: choose LPS or RAS.")
    for what, said, own in (("unit", meant.unit, reading.unit), ("frame", frame, reading.frame)):
        if said and own and said != own:
            raise PinwarpError(f"{name} says that its {what} is {own}: leave out --{what} {said}.")
    unit, frame = reading.unit or meant.unit, reading.frame or frame
    missing, notes = [], []
    if target.HOLDS.unit and not unit:
        if _reach(reading.landmarks, sides) < LARGEST_IN_METRES:
            missing.append(f"its unit (--unit mm, cm or m; {target.NAME} is in millimetres)")
        else:
            unit = "mm"
            notes.append("Its numbers are too large for metres: they were taken for millimetres.")
    if target.HOLDS.frame and not frame:
        if of_session:
            frame = target.HOLDS.frame
            notes.append(
                f"The positions are said to be in {frame}, which 3D Slicer takes a mesh without a "
                "frame to be in: they stay on the mesh."
            )
        else:
            missing.append(
                "its frame (--frame LPS keeps the numbers, --frame RAS negates x and y; "
                f"{target.NAME} is in {target.HOLDS.frame})"
            )
    if missing:
        raise PinwarpError(f"{name} does not say {' nor '.join(missing)}.")
    return replace(meant, unit=unit, frame=frame), tuple(notes)


def _reach(landmarks: Iterable[Landmark], sides: Sequence[Side]) -> float:
    """Return how far the landmarks of a side reach; of one alone, how far it is from nowhere."""
    reach = 0.0
    for side in sides:
        places = positions([x for x in landmarks if x.position(side) is not None], side)
        if len(places):
            extent = np.ptp(places, axis=0) if len(places) > 1 else places[0]
            reach = max(reach, float(np.linalg.norm(extent)))
    return reach


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
    groups: Iterable[ReadGroup] = (),
    remarks: tuple[str, ...] = (),
) -> tuple[str, ...]:
    """Write landmarks such that the file's own frame is true of them.

    Parameters
    ----------
    path, landmarks, side, unit, known, groups, remarks
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
    fixed = target.HOLDS.frame
    notes: tuple[str, ...] = ()
    if frame and fixed and frame != fixed and side is not None:
        landmarks = flipped(landmarks, side)
        notes = (f"The positions were turned from {frame} to {fixed}.",)
    elif frame and not fixed:
        notes = (f"The positions are in {frame}, and {target.NAME} cannot say so.",)
    written = write_landmarks(
        path, landmarks, side, unit=unit, known=target, groups=groups, remarks=remarks
    )
    return (*notes, *written)


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
