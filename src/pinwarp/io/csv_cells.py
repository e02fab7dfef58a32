"""The cells of a table: numbers, positions, and text that a spreadsheet must not run."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from pinwarp.core.landmarks import Position

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)
YES_NO = {"1": True, "true": True, "yes": True, "": True, "0": False, "false": False, "no": False}
"""What a cell that is on or off may say, in lower case; an empty one is on."""

# The wide forms are what an input method writes for the others.
_STARTS = r"[=+\-@\t\r\n＝＋－＠]"
_FORMULA = re.compile(f"'*{_STARTS}")
_QUOTED_FORMULA = re.compile(f"''*{_STARTS}")


def number_of(cell: str, separator: str) -> float:
    """Read a number; decimal commas count where semicolons separate the cells.

    Parameters
    ----------
    cell
        The text of the cell.
    separator
        What separates the cells of this table.

    Returns
    -------
    float
        A finite number.

    Raises
    ------
    ValueError
        With the reason as its message.

    Examples
    --------
    >>> number_of(" 1,5 ", ";"), number_of("-2e-3", ",")
    (1.5, -0.002)
    """
    text = cell.strip()
    if separator == ";" and "." not in text:
        text = text.replace(",", ".", 1)
    if not _NUMBER.fullmatch(text):
        if not text:
            raise ValueError("a number is missing")
        if _NOT_FINITE.fullmatch(text):
            raise ValueError(f"{shortened(text)} is not a finite number")
        raise ValueError(f"{shortened(text)} is not a number")
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{shortened(text)} is not a finite number")
    return value


def is_number(cell: str, separator: str) -> bool:
    """Whether a cell is meant as a number, a finite one or not."""
    try:
        number_of(cell, separator)
    except ValueError:
        return _NOT_FINITE.fullmatch(cell.strip()) is not None
    return True


class Numeral(str):
    """The text of a number in a cell that holds one: it stays a number to a spreadsheet.

    A name may look the same, such as ``-7``, and is text.
    """

    __slots__ = ()


def numeral(text: str) -> str:
    """Return a cell that is meant as a number as one, if it is one.

    Examples
    --------
    >>> [type(numeral(text)).__name__ for text in ("-1.5e3", "-1.5e3+cmd", "-inf")]
    ['Numeral', 'str', 'str']
    """
    return Numeral(text) if _NUMBER.fullmatch(text) else text


def formula_quoted(text: str) -> str:
    """Put a single quote before text that a spreadsheet would run as a formula.

    Examples
    --------
    >>> formula_quoted("=1+1"), formula_quoted("femur"), formula_quoted("'=1+1")
    ("'=1+1", 'femur', "''=1+1")
    """
    return f"'{text}" if _FORMULA.match(text) else text


def formula_unquoted(text: str) -> str:
    """Take back what :func:`formula_quoted` did.

    Examples
    --------
    >>> formula_unquoted("'=1+1"), formula_unquoted("'femur'")
    ('=1+1', "'femur'")
    """
    return text[1:] if _QUOTED_FORMULA.match(text) else text


def coordinates_text(position: Sequence[float] | None) -> tuple[str, str, str]:
    """Return the fewest digits that read back exactly, or three empty cells.

    Examples
    --------
    >>> coordinates_text((0.1, -0.0, 3)), coordinates_text(None)
    (('0.1', '-0.0', '3.0'), ('', '', ''))
    """
    if position is None:
        return ("", "", "")
    x, y, z = (numeral(repr(float(value))) for value in position)
    return (x, y, z)


def position_of(cells: Sequence[str], separator: str) -> Position | None:
    """Read three cells as a position, or None where all three are empty.

    Parameters
    ----------
    cells
        Three cells.
    separator
        What separates the cells of this table.

    Raises
    ------
    ValueError
        With the reason as its message; a position is never read in part.

    Examples
    --------
    >>> position_of(["1", "2", "3"], ","), position_of(["", "", ""], ",")
    ((1.0, 2.0, 3.0), None)
    """
    if not any(cell.strip() for cell in cells):
        return None
    x, y, z = (number_of(cell, separator) for cell in cells)
    return (x, y, z)


def shortened(text: str) -> str:
    """Return text in quotes, cut where it is too long for a message.

    Examples
    --------
    >>> shortened("femur")
    "'femur'"
    """
    return repr(text if len(text) <= 60 else text[:57] + "...")


def as_sentence(text: str) -> str:
    """Return text with a capital first letter and a full stop.

    Examples
    --------
    >>> as_sentence("it was cut off")
    'It was cut off.'
    """
    return text[:1].upper() + text[1:] + ("" if text.endswith(".") else ".")
