"""JSON of landmarks, whichever program wrote it: read with care, as values that may be anything."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, TypeVar

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Position
from pinwarp.io.csv_cells import shortened
from pinwarp.io.json_text import read_json
from pinwarp.io.landmark_formats.reading import MOST

T = TypeVar("T")

_MOST_NAMED = 3


def json_root(path: str | Path, text: str) -> tuple[Any, list[str]]:
    """Return what the JSON says, and what the user should know about how it was understood.

    Raises
    ------
    FileFormatError
        When it is not JSON, or has far more in it than landmarks have.

    Examples
    --------
    >>> json_root("a.json", '{"unit": "mm", "unit": "m"}')
    ({'unit': 'm'}, ["A key is there twice, and the last counts: 'unit'."])
    """
    # A point has three lists and a dozen keys; more than memory holds are quickly written.
    for what, count, most in (
        ("lists", text.count("{") + text.count("["), 10 * MOST),
        ("keys", text.count(":"), 30 * MOST),
    ):
        if count > most:
            raise FileFormatError(
                path,
                f"It has {count:,} {what}, far more than landmarks. Check that it is the right "
                "file.",
                1,
            )
    try:
        root, repeated = read_json(text, whole_as_float=True)
    except json.JSONDecodeError as error:
        raise FileFormatError(
            path,
            f"This is not JSON, or it was cut off ({error.msg}). Save it again in the program "
            "that wrote it.",
            error.lineno,
        ) from None
    except RecursionError:
        raise FileFormatError(
            path,
            "Its lists are nested too deeply for landmarks. Check that it is the right file.",
            1,
        ) from None
    few = ", ".join(shortened(key) for key in repeated[:_MOST_NAMED])
    more = f" and {len(repeated) - _MOST_NAMED} more" if len(repeated) > _MOST_NAMED else ""
    if repeated:
        return root, [f"A key is there twice, and the last counts: {few}{more}."]
    return root, []


def part(value: object, key: str, kind: type[T]) -> T | None:
    """Return what stands under a key, if anything of that kind does; alone in a list or not.

    Examples
    --------
    >>> part({"label": ["nasion"]}, "label", str), part({"label": 3.0}, "label", str)
    ('nasion', None)
    """
    found = value.get(key) if isinstance(value, dict) else None
    if not isinstance(found, kind):
        # R writes every value as a list of one.
        found = alone(found)
    return found if isinstance(found, kind) else None


def alone(value: object) -> object:
    """Return the one value of a list, or what is no such list as it is.

    Examples
    --------
    >>> alone([["mm"]]), alone([1, 2])
    ('mm', [1, 2])
    """
    while isinstance(value, list) and len(value) == 1:
        value = value[0]
    return value


def word(value: object) -> str:
    """Return text from a file that may hold anything, short enough for a message."""
    value = alone(value)
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    return (value if isinstance(value, str) else repr(value))[:20]


def place(value: object) -> Position | None:
    """Return three numbers as a position; what is empty is none.

    Raises
    ------
    ValueError
        With the reason as its message.

    Examples
    --------
    >>> place([1.0, 2.0, 3.0]), place("")
    ((1.0, 2.0, 3.0), None)
    """
    value = alone(value)
    if value in (None, "", []):
        return None
    if not isinstance(value, list) or len(value) != 3:
        raise ValueError("its position is not a list of three numbers")
    numbers = []
    for number in map(alone, value):
        if not isinstance(number, float):
            raise ValueError(f"{shortened(str(number))} is not a number")
        if not math.isfinite(number):
            raise ValueError(f"'{number}' is not a finite number")
        numbers.append(number)
    x, y, z = numbers
    return (x, y, z)
