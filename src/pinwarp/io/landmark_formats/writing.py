"""What the writers of landmark files have in common."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pinwarp.core.errors import LandmarkError
from pinwarp.core.landmarks import Landmark, Position, Side, scaled

_MILLIMETRES = {"µm": 0.001, "um": 0.001, "mm": 1.0, "cm": 10.0, "m": 1000.0}


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
