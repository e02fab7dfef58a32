"""Names and positions as the lines of a landmark file hold them."""

from __future__ import annotations

import re
from collections.abc import Sequence

from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.io.csv_cells import number_of
from pinwarp.io.csv_text import LONGEST_CELL
from pinwarp.io.landmark_formats.reading import DefaultName

# Control characters, line ends of every kind, and halves of characters.
_NOT_IN_A_LINE = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]+")


def landmark_on(side: Side, name: str, position: Position | None) -> Landmark:
    r"""Make a landmark of one side, with a name that fits into a line.

    Parameters
    ----------
    side
        Where it lies.
    name
        As the file says it.
    position
        Where, or None where it is still to be placed.

    Raises
    ------
    ValueError
        When the name is too long to be kept, or a coordinate is not finite.

    Examples
    --------
    >>> landmark_on(Side.SOURCE, " lesser\ttrochanter", (1.0, 2.0, 3.0)).name
    'lesser trochanter'
    """
    return Landmark(checked_name(name)).placed(side, position)


def checked_name(name: str) -> str:
    """Return a name as it is kept: on one line, without blanks around it.

    Raises
    ------
    ValueError
        When it is too long to be kept in a session.

    Examples
    --------
    >>> checked_name("  left tragus ")
    'left tragus'
    """
    if isinstance(name, DefaultName):
        return name
    if len(name) > LONGEST_CELL:
        raise ValueError(f"its name is longer than {LONGEST_CELL:,} characters")
    return one_line(name).strip()


def one_line(text: str) -> str:
    r"""Replace what cannot stand in a line of text, such as line ends, by blanks.

    Examples
    --------
    >>> one_line("left\r\ntragus")
    'left tragus'
    """
    return _NOT_IN_A_LINE.sub(" ", text)


def three_numbers(words: Sequence[str], missing: str = "") -> Position | None:
    """Read three words as a position, or None where each of them says that it is missing.

    Parameters
    ----------
    words
        The words.
    missing
        What stands for a coordinate that is not there, in lower case; numbers are compared
        by their value.

    Raises
    ------
    ValueError
        With the reason as its message; a position is never read in part.

    Examples
    --------
    >>> three_numbers(["1", "2", "3e1"]), three_numbers(["NA", "NA", "NA"], "na")
    ((1.0, 2.0, 30.0), None)
    """
    if len(words) != 3:
        raise ValueError(f"it needs three coordinates and has {len(words)}")
    if missing and all(word.lower() == missing for word in words):
        return None
    x, y, z = (number_of(word, ",") for word in words)
    # 9999 may have decimals.
    if missing.isdigit() and x == y == z == float(missing):
        return None
    return (x, y, z)
