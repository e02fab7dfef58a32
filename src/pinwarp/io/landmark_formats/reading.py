"""What reading a landmark file gives, whichever program wrote it, and how it is put together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ParamSpec

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark
from pinwarp.core.names import look_alike_notes
from pinwarp.io.csv_cells import shortened

P = ParamSpec("P")

MOST = 20_000
"""More landmarks, or lines, than any landmark file has: a file with more is another kind."""

_LONGEST_TEXT = 120


@dataclass(frozen=True)
class SkippedLine:
    """A line that could not be used.

    Parameters
    ----------
    line
        Its number, counted from 1.
    text
        What it says.
    reason
        Why it was skipped.
    """

    line: int
    text: str
    reason: str


@dataclass(frozen=True)
class ReadGroup:
    """Landmarks of a file that are points of a curve, or of a patch.

    Parameters
    ----------
    name
        What the file calls it, or a name made of its number.
    points
        Names of its landmarks, in order.
    is_curve
        Whether they lie along a curve, or on a surface.
    is_closed
        Whether the curve goes on from the last to the first.
    are_handles
        Whether they are what the curve was drawn through, rather than points along it.
    anchors
        Those of them that are landmarks of their own.
    """

    name: str
    points: tuple[str, ...]
    is_curve: bool = True
    is_closed: bool = False
    are_handles: bool = False
    anchors: frozenset[str] = frozenset()


@dataclass(frozen=True)
class LandmarkReading:
    """What was found in a landmark file: all that a preview of an import shows.

    Parameters
    ----------
    landmarks
        In the order of the file; a file of one side fills that side only. Positions are those
        of the file; a landmark without one is a name still to be placed.
    is_pairs
        Whether the file holds both sides.
    skipped
        The lines that could not be used; blank lines and comments are not among them.
    format
        What the format is called, such as ``"3D Slicer .fcsv"``.
    frame
        The frame the file says its positions are in, ``"LPS"`` or ``"RAS"``; empty where it
        says nothing. LPS and RAS differ by the signs of x and y.
    unit
        The unit of length the file or its format says; empty where it says nothing.
    notes
        What else the user should know, as sentences.
    groups
        The curves and patches that some of the landmarks are points of.
    """

    landmarks: tuple[Landmark, ...]
    is_pairs: bool
    skipped: tuple[SkippedLine, ...]
    format: str = ""
    frame: str = ""
    unit: str = ""
    notes: tuple[str, ...] = ()
    groups: tuple[ReadGroup, ...] = ()

    @property
    def single(self) -> tuple[Landmark, ...]:
        """The landmarks that are no points of a curve or patch."""
        grouped = {x for group in self.groups for x in group.points if x not in group.anchors}
        return tuple(x for x in self.landmarks if x.name not in grouped)

    @property
    def count(self) -> int:
        """How many landmarks there are, those without a position included."""
        return len(self.landmarks)

    @property
    def names(self) -> tuple[str, ...]:
        """Their names, in the order of the file."""
        return tuple(landmark.name for landmark in self.landmarks)


class Gathering:
    """Takes landmarks one by one, skips those that cannot be used, and sums up.

    Parameters
    ----------
    path
        The file, for the message when there is nothing in it.

    Examples
    --------
    >>> gathering = Gathering("a.txt")
    >>> gathering.take(1, "fovea", Landmark, "fovea")
    >>> gathering.take(2, "fovea", Landmark, "fovea")
    >>> gathering.reading("Text", "fovea").skipped[0].reason
    "the name 'fovea' was used before"
    """

    def __init__(self, path: str | Path) -> None:
        self._path = path
        self._found: dict[str, Landmark] = {}
        self._skipped: list[SkippedLine] = []

    def take(
        self,
        line: int,
        text: str,
        make: Callable[P, Landmark],
        *args: P.args,
        **kwargs: P.kwargs,
    ) -> None:
        """Take the landmark that is made, or skip the line where making it raises ValueError.

        Raises
        ------
        FileFormatError
            When there are too many of them for a landmark file.
        """
        try:
            landmark = make(*args, **kwargs)
            if landmark.name in self._found:
                raise ValueError(f"the name {shortened(landmark.name)} was used before")
            self._found[landmark.name] = landmark
        except ValueError as error:
            self.skip(line, text, str(error))
        if len(self._found) + len(self._skipped) > MOST:
            raise FileFormatError(
                self._path,
                f"It has more than {MOST:,} entries, which are no landmarks. "
                "Check that it is the right file.",
                line,
            )

    def skip(self, line: int, text: str, reason: str) -> None:
        """Leave a line out, with the reason."""
        self._skipped.append(SkippedLine(line, text.strip()[:_LONGEST_TEXT], reason))

    def reading(
        self,
        name: str,
        expected: str,
        *,
        is_pairs: bool = False,
        frame: str = "",
        unit: str = "",
        notes: Sequence[str] = (),
        groups: Sequence[ReadGroup] = (),
    ) -> LandmarkReading:
        """Sum up.

        Parameters
        ----------
        name
            What the format is called.
        expected
            What a line should look like, for the message when no landmark was found.
        is_pairs, frame, unit, notes, groups
            As in :class:`LandmarkReading`.

        Raises
        ------
        FileFormatError
            When there is no landmark at all.
        """
        skipped = tuple(sorted(self._skipped, key=lambda line: line.line))
        landmarks = tuple(self._found.values())
        if not landmarks:
            reason = f" (line {skipped[0].line}: {skipped[0].reason})" if skipped else ""
            raise FileFormatError(
                self._path, f"No landmark could be read{reason}. Expected are {expected}"
            )
        unplaced = sum(x.source is None and x.destination is None for x in landmarks)
        if unplaced:
            what = "landmark without a position is" if unplaced == 1 else "landmarks have no"
            tail = "a name" if unplaced == 1 else "position: they are names"
            notes = (*notes, f"{unplaced} {what} {tail} still to be placed.")
        notes = (*notes, *look_alike_notes(self._found))
        # Points that were skipped are those of no group.
        read = [replace(x, points=tuple(p for p in x.points if p in self._found)) for x in groups]
        return LandmarkReading(
            landmarks, is_pairs, skipped, name, frame, unit, tuple(notes), tuple(read)
        )
