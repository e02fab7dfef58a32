"""What reading a landmark file gives, whichever program wrote it, and how it is put together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ParamSpec

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark
from pinwarp.core.names import look_alike_notes
from pinwarp.core.words import some_of
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
        Names of its landmarks, in order; filled in by :class:`Gathering`.
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
    points: tuple[str, ...] = ()
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
    doubts
        Why this may be no file of landmarks at all, as sentences.
    specimens
        The specimens of the file, where it may hold several; the landmarks are of one of them.
    specimen
        The one that was read.
    """

    landmarks: tuple[Landmark, ...]
    is_pairs: bool
    skipped: tuple[SkippedLine, ...]
    format: str = ""
    frame: str = ""
    unit: str = ""
    notes: tuple[str, ...] = ()
    groups: tuple[ReadGroup, ...] = ()
    doubts: tuple[str, ...] = ()
    specimens: tuple[str, ...] = ()
    specimen: str = ""

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


class DefaultName(str):
    """The name of a row that has none: where another row bears it, that one keeps it."""

    __slots__ = ()

    @classmethod
    def of(cls, row: int) -> DefaultName:
        """Return the name of a row, counted from 0.

        Examples
        --------
        >>> DefaultName.of(0)
        'landmark_0'
        """
        return cls(f"landmark_{row}")


@dataclass(frozen=True)
class _Group:
    """A curve or patch as it is found: points by their number, None for one that was skipped."""

    group: ReadGroup
    numbers: tuple[int | None, ...]
    anchors: frozenset[int]


class Gathering:
    """Takes landmarks one by one, skips those that cannot be used, and sums up.

    Names are free text in most programs: of landmarks of one name all are kept, with numbers behind
    it, and a row without a name never takes one that another row bears.

    Parameters
    ----------
    path
        The file, for the message when there is nothing in it.

    Examples
    --------
    >>> gathering = Gathering("a.txt")
    >>> for number, name in enumerate([DefaultName.of(0), "landmark_0", "F", "F"]):
    ...     _ = gathering.take(number, name, Landmark, name)
    >>> reading = gathering.reading("Text", "fovea")
    >>> reading.names, reading.notes[0]
    (('landmark_0_2', 'landmark_0', 'F', 'F_2'), \
"2 landmarks are called 'F': numbers were put behind the name.")
    """

    def __init__(self, path: str | Path) -> None:
        self._path = path
        self._found: list[tuple[Landmark, bool]] = []
        self._skipped: list[SkippedLine] = []
        self._groups: list[_Group] = []

    def take(
        self,
        line: int,
        text: str,
        make: Callable[P, Landmark],
        *args: P.args,
        **kwargs: P.kwargs,
    ) -> int | None:
        """Take the landmark that is made, or skip the line where making it raises ValueError.

        Returns
        -------
        int or None
            Its number, for :meth:`add_group`; None where the line was skipped.

        Raises
        ------
        FileFormatError
            When there are too many of them for a landmark file.
        """
        number = None
        try:
            landmark = make(*args, **kwargs)
            number = len(self._found)
            self._found.append((landmark, isinstance(landmark.name, DefaultName)))
        except ValueError as error:
            self.skip(line, text, str(error))
        if len(self._found) + len(self._skipped) > MOST:
            raise FileFormatError(
                self._path,
                f"It has more than {MOST:,} entries, which are no landmarks. "
                "Check that it is the right file.",
                line,
            )
        return number

    def skip(self, line: int, text: str, reason: str) -> None:
        """Leave a line out, with the reason."""
        self._skipped.append(SkippedLine(line, text.strip()[:_LONGEST_TEXT], reason))

    def add_group(
        self,
        group: ReadGroup,
        numbers: Iterable[int | None],
        anchors: Iterable[int | None] = (),
    ) -> None:
        """Say that landmarks belong together.

        Parameters
        ----------
        group
            What they make; its points and anchors are filled in when the names are settled.
        numbers
            What :meth:`take` returned for each, in order; skipped ones belong to no group.
        anchors
            Those of them that are landmarks of their own.
        """
        kept = frozenset(number for number in anchors if number is not None)
        self._groups.append(_Group(group, tuple(numbers), kept))

    def reading(
        self,
        name: str,
        expected: str,
        *,
        is_pairs: bool = False,
        frame: str = "",
        unit: str = "",
        notes: Sequence[str] = (),
        doubts: Sequence[str] = (),
    ) -> LandmarkReading:
        """Sum up.

        Parameters
        ----------
        name
            What the format is called.
        expected
            What a line should look like, for the message when no landmark was found.
        is_pairs, frame, unit, notes, doubts
            As in :class:`LandmarkReading`.

        Raises
        ------
        FileFormatError
            When there is no landmark at all.
        """
        skipped = tuple(sorted(self._skipped, key=lambda line: line.line))
        if not self._found:
            reason = f" (line {skipped[0].line}: {skipped[0].reason})" if skipped else ""
            doubt = f" {doubts[0]}" if doubts and skipped else ""
            raise FileFormatError(
                self._path, f"No landmark could be read{reason}.{doubt} Expected are {expected}"
            )
        names, repeated = self._names()
        landmarks = tuple(
            # Plain text, also where it was a default.
            replace(landmark, name=name)
            for (landmark, _), name in zip(self._found, names, strict=True)
        )
        groups = tuple(
            replace(
                group,
                points=tuple(names[number] for number in numbers if number is not None),
                anchors=frozenset(names[number] for number in anchors),
            )
            for group, numbers, anchors in ((x.group, x.numbers, x.anchors) for x in self._groups)
        )
        unplaced = sum(x.source is None and x.destination is None for x in landmarks)
        if unplaced:
            what = "landmark without a position is" if unplaced == 1 else "landmarks have no"
            tail = "a name" if unplaced == 1 else "position: they are names"
            repeated = (*repeated, f"{unplaced} {what} {tail} still to be placed.")
        told = (*notes, *repeated, *look_alike_notes(names))
        return LandmarkReading(
            landmarks, is_pairs, skipped, name, frame, unit, told, groups, tuple(doubts)
        )

    def _names(self) -> tuple[list[str], tuple[str, ...]]:
        """Return a name for each that no other has, and what was done about those that had one."""
        given = Counter(x.name for x, is_default in self._found if not is_default)
        # Points along a curve are often called as the curve is.
        along = {x for one in self._groups for x in one.numbers if x is not None}
        taken = set(given)
        seen: set[str] = set()
        counts: Counter[str] = Counter()
        repeated: dict[str, None] = {}
        names = []
        for number, (landmark, is_default) in enumerate(self._found):
            name = stem = str(landmark.name)
            if stem in (taken if is_default else seen):
                if not is_default and number not in along:
                    repeated[stem] = None
                counts[stem] = max(counts[stem], 1)
                while name in taken:
                    counts[stem] += 1
                    name = f"{stem}_{counts[stem]}"
                taken.add(name)
            elif is_default:
                taken.add(name)
            seen.add(name)
            names.append(name)
        if len(repeated) == 1:
            (stem,) = repeated
            note = f"{given[stem]} landmarks are called {shortened(stem)}: numbers were put behind "
            return names, (f"{note}the name.",)
        if repeated:
            told = some_of([shortened(stem) for stem in repeated])
            note = f"{len(repeated)} names are there more than once ({told}): numbers were put "
            return names, (f"{note}behind them.",)
        return names, ()
