"""What the writers of landmark files have in common."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pinwarp.core.errors import LandmarkError
from pinwarp.core.landmarks import Landmark, Position, Role, Side, scaled
from pinwarp.core.words import counted, some_of
from pinwarp.io.landmark_formats.lines import one_line
from pinwarp.io.landmark_formats.reading import ReadGroup

_MILLIMETRES = {"µm": 0.001, "um": 0.001, "mm": 1.0, "cm": 10.0, "m": 1000.0}


@dataclass(frozen=True)
class Holds:
    """What a format has a place for, beside positions on one side.

    Parameters
    ----------
    pairs
        Both sides in one file.
    names
        A name for each landmark, not only its place in the order.
    empty
        A landmark that is not placed.
    notes, locks, switches
        A landmark's note, whether it is locked, and whether it is enabled.
    curves, patches
        Points that belong to a curve, or to a patch.
    frame, unit
        The only ones that its positions can be in; empty where it says none.
    """

    pairs: bool = False
    names: bool = True
    empty: bool = True
    notes: bool = False
    locks: bool = False
    switches: bool = False
    curves: bool = False
    patches: bool = False
    frame: str = ""
    unit: str = ""


@dataclass(frozen=True)
class Outgoing:
    """What is written to a landmark file.

    Parameters
    ----------
    landmarks
        Their names different.
    side
        The side to write, or None for pairs.
    unit
        The unit the positions are in; empty where it is not known.
    title
        What the specimen is called, where the format has a place for it.
    groups
        The curves and patches that some of the landmarks are points of; what the format has no
        place for is left out before.
    remarks
        A line each for people, such as what made the file; formats with comments have them.
    """

    landmarks: tuple[Landmark, ...]
    side: Side | None = Side.SOURCE
    unit: str = ""
    title: str = ""
    groups: tuple[ReadGroup, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def places(self) -> list[Position | None]:
        """Where each landmark lies on the side that is written.

        Examples
        --------
        >>> Outgoing((Landmark("a", (1.0, 2.0, 3.0)), Landmark("b"))).places
        [(1.0, 2.0, 3.0), None]
        """
        assert self.side is not None, "pairs are refused before"
        return [landmark.position(self.side) for landmark in self.landmarks]

    def commented(self, mark: str) -> str:
        r"""Return the remarks as comments of a format, a line each.

        Parameters
        ----------
        mark
            What a comment begins with.

        Examples
        --------
        >>> Outgoing((), remarks=("Made by\nhand",)).commented("# ")
        '# Made by hand\n'
        """
        return "".join(f"{mark}{one_line(remark)}\n" for remark in self.remarks)

    @property
    def title_or_side(self) -> str:
        """What the specimen is called, or else the side."""
        return self.title or (self.side.value if self.side is not None else "pairs")


@dataclass(frozen=True)
class Written:
    """The text of a landmark file.

    Parameters
    ----------
    text
        All of it.
    notes
        What the format could not hold, as sentences for the user.
    """

    text: str
    notes: tuple[str, ...] = ()


def in_millimetres(landmarks: Iterable[Landmark], unit: str) -> tuple[Landmark, ...]:
    """Convert positions to the unit of programs that know only millimetres.

    Parameters
    ----------
    landmarks
        Positions in ``unit``.
    unit
        ``"mm"``, ``"cm"``, ``"m"`` or ``"µm"``; where it is not known (empty), the numbers
        stay as they are.

    Raises
    ------
    LandmarkError
        For another unit, or when a coordinate becomes too large for a number.

    Examples
    --------
    >>> in_millimetres([Landmark("fovea", source=(0.5, 0.25, 0.0))], "m")[0].source
    (500.0, 250.0, 0.0)
    """
    factor = _MILLIMETRES.get(unit, 1.0)
    if unit and unit not in _MILLIMETRES:
        raise LandmarkError(
            f"This format is in millimetres, and how many make one {unit} is not known. "
            "Choose mm, cm or m as the unit first."
        )
    return tuple(landmarks) if factor == 1.0 else scaled(landmarks, factor)


def placed_only(
    landmarks: Iterable[Landmark], side: Side
) -> tuple[list[tuple[str, Position]], tuple[str, ...]]:
    """Return name and position of those that are placed, and a note about the others.

    Examples
    --------
    >>> placed_only([Landmark("a", (1.0, 2.0, 3.0)), Landmark("b")], Side.SOURCE)
    ([('a', (1.0, 2.0, 3.0))], ('1 landmark that is not placed was left out.',))
    """
    placed, missing = [], 0
    for landmark in landmarks:
        position = landmark.position(side)
        if position is None:
            missing += 1
        else:
            placed.append((landmark.name, position))
    return placed, left_out(missing, "is not placed", "are not placed")


def left_out(count: int, one: str, many: str) -> tuple[str, ...]:
    """Say how many landmarks were left out and why, if any.

    Examples
    --------
    >>> left_out(2, "has no place", "have no place")
    ('2 landmarks that have no place were left out.',)
    """
    if not count:
        return ()
    if count == 1:
        return (f"1 landmark that {one} was left out.",)
    return (f"{count} landmarks that {many} were left out.",)


def lost(holds: Holds, outgoing: Outgoing) -> tuple[str, ...]:
    """Say what of the landmarks a format has no place for.

    Parameters
    ----------
    holds
        What it has a place for.
    outgoing
        All that is there.

    Returns
    -------
    tuple of str
        A sentence for each kind. What becomes of landmarks without a position, each format
        says itself.

    Examples
    --------
    >>> lost(Holds(), Outgoing((Landmark("a", (1, 2, 3), note="worn"),)))
    ('The format has no place for notes: those of a were left out.',)
    """
    marks = outgoing.landmarks
    notes = []
    if not holds.names and marks:
        notes.append("The format has no names for landmarks: only their order was kept.")
    for has_place, what, names in (
        (holds.notes, "notes: those of", [x.name for x in marks if x.note]),
        (holds.locks, "locks: those of", [x.name for x in marks if x.locked]),
        (
            False,
            "spreads: those of",
            [x.name for x in marks if any(x.spread(side) is not None for side in Side)],
        ),
        (
            holds.switches,
            "what is disabled: the switches of",
            [
                x.name
                for x in marks
                # Half a pair takes no part in any case.
                if not x.enabled and (outgoing.side is not None or x.is_complete)
            ],
        ),
    ):
        if names and not has_place:
            were = "were left out"
            notes.append(f"The format has no place for {what} {some_of(names)} {were}.")
    if passengers := [x.name for x in marks if x.role is Role.PASSENGER]:
        what = counted(len(passengers), "passenger")
        notes.append(
            f"The format has no passengers: {what} ({some_of(passengers)}) became landmarks."
        )
    left = [x.name for x in outgoing.groups if not (holds.curves if x.is_curve else holds.patches)]
    if left:
        notes.append(f"{some_of(left)}: points of curves and patches were taken for landmarks.")
    return tuple(notes)


def names_of_one_word(names: Iterable[str]) -> tuple[list[str], tuple[str, ...]]:
    """Return names without blanks, each there once, and a note where some had any.

    Examples
    --------
    >>> names_of_one_word(["left tragus", "left_tragus"])
    (['left_tragus', 'left_tragus_2'], ('2 names with blanks got underscores.',))
    """
    taken: dict[str, None] = {}
    changed = 0
    for name in names:
        stem = free = "_".join(one_line(name).split()) or "_"
        count = 2
        while free in taken:
            free, count = f"{stem}_{count}", count + 1
        taken[free] = None
        changed += free != name
    notes = f"{counted(changed, 'name')} with blanks got underscores."
    return list(taken), (notes,) if changed else ()


def numbers_text(position: Sequence[float] | None, missing: str) -> str:
    """Return three numbers with the fewest digits that read back exactly, or three words.

    Examples
    --------
    >>> numbers_text((0.1, -0.0, 3), "NA"), numbers_text(None, "NA")
    ('0.1 -0.0 3.0', 'NA NA NA')
    """
    if position is None:
        return " ".join([missing] * 3)
    return " ".join(repr(float(value)) for value in position)
