"""One repeat of a set of landmarks, from a file of any format or a session."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Position, Side
from pinwarp.core.words import counted
from pinwarp.io.file_names import is_session
from pinwarp.io.landmark_files import LandmarkReading, located, read_landmarks
from pinwarp.io.session_file import read_session


@dataclass(frozen=True)
class Repeat:
    """The landmarks of one file on one side.

    Attributes
    ----------
    path
        The file, with ``#SPECIMEN`` behind it where it holds several.
    places
        Where they are by name, in the order of the file.
    unit, frame
        What the file says of its positions; empty where it says nothing.
    notes
        What the user should know about the file, as sentences.
    """

    path: Path
    places: Mapping[str, Position]
    unit: str = ""
    frame: str = ""
    notes: tuple[str, ...] = ()


def read_repeat(path: str | Path, side: Side | None = None) -> Repeat:
    r"""Read the landmarks of one side, as they are stored.

    Parameters
    ----------
    path
        A landmark file of any format (``FILE#SPECIMEN`` takes one of several), or a session.
    side
        The side that is meant where the file holds both; of a file of one side it says nothing.

    Raises
    ------
    PinwarpError
        When the file cannot be read, no landmark in it has a place, or it holds both sides and
        none was chosen.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "femur.csv")
    ...     _ = path.write_text("name,x,y,z\nfovea,1,2,3\n")
    ...     read_repeat(path).places
    {'fovea': (1.0, 2.0, 3.0)}
    """
    path = Path(path)
    if is_session(path):
        record = read_session(path)
        reading = LandmarkReading(record.landmarks, True, (), unit=record.unit)
    else:
        reading = read_landmarks(path, side or Side.SOURCE)
    if reading.is_pairs and side is None:
        raise PinwarpError(
            f"{path.name} holds both sides: choose the one that was digitised again, source or "
            "destination."
        )
    meant = side if reading.is_pairs and side is not None else side or Side.SOURCE
    places = {x.name: at for x in reading.single if (at := x.position(meant)) is not None}
    if not places:
        where = f" on the {meant.value}" if reading.is_pairs else ""
        raise PinwarpError(f"No landmark of {path.name} has a place{where}.")
    notes = [*reading.doubts, *reading.notes]
    if reading.skipped:
        notes.append(f"{counted(len(reading.skipped), 'line')} could not be used.")
    if len(reading.specimens) > 1 and not located(path)[1]:
        notes.append(
            f"It holds {len(reading.specimens)} specimens, and the first was taken: "
            f"{path.name}#NAME takes another."
        )
    if left := len(reading.landmarks) - len(reading.single):
        notes.append(f"{counted(left, 'point')} of curves and patches left out: they slide.")
    return Repeat(path, places, reading.unit, reading.frame, tuple(notes))
