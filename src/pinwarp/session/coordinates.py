"""Coordinates as people read and type them."""

from __future__ import annotations

import re

from pinwarp.core.errors import LandmarkError
from pinwarp.core.landmarks import Landmark, Position, Side, as_position
from pinwarp.core.lengths import Ruler
from pinwarp.io.csv_cells import as_sentence, number_of

_AS_STORED = Ruler()


def position_text(position: Position | None, ruler: Ruler) -> str:
    """Return a position for people."""
    if position is None:
        return "not placed"
    numbers = ", ".join(ruler.number(x, 5) for x in position)
    return f"({numbers}) {ruler.unit}".rstrip()


def typed_position(
    landmark: Landmark, side: Side, axis: int, text: str, ruler: Ruler = _AS_STORED
) -> Position:
    """Return where a landmark is after a number was typed for one axis, or three for all.

    The numbers are in the unit that the ruler shows.

    Raises
    ------
    LandmarkError
        With the reason why this is no position.

    Examples
    --------
    >>> typed_position(Landmark("fovea", (1, 2, 3)), Side.SOURCE, 2, "4,5")
    (1.0, 2.0, 4.5)
    >>> typed_position(Landmark("fovea"), Side.SOURCE, 0, "1 2 3")
    (1.0, 2.0, 3.0)
    """
    cells = re.split(r"[;\s]+", text.strip().removesuffix(ruler.unit).strip(" \t;()[]"))
    before = landmark.position(side)
    try:
        numbers = [ruler.stored(number_of(cell, ";")) for cell in cells]
    except ValueError as error:
        raise LandmarkError(f"{as_sentence(str(error))} Type one such as 12.5.") from None
    if len(numbers) == 3:
        return as_position(numbers)
    if len(numbers) != 1:
        raise LandmarkError("Type one number, or three for x, y and z.")
    if before is None:
        raise LandmarkError(
            f"{landmark.name} is not placed on the {side.value} yet: type all three, as in 1 2 3."
        )
    return as_position([numbers[0] if i == axis else before[i] for i in range(3)])
