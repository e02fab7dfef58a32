"""JSON as it comes from strangers: keys that are there twice are told."""

from __future__ import annotations

import json
from typing import Any


def read_json(text: str, *, whole_as_float: bool = False) -> tuple[Any, tuple[str, ...]]:
    """Parse JSON, and say which keys an object has more than once.

    Parameters
    ----------
    text
        All of it.
    whole_as_float
        Whether whole numbers become floats; those of thousands of digits cannot become an int.

    Returns
    -------
    value
        As of :func:`json.loads`: of a key that is there twice, the last value.
    repeated
        Those keys, each once.

    Raises
    ------
    json.JSONDecodeError
        When it is not JSON.
    RecursionError
        When its lists are nested too deeply.

    Examples
    --------
    >>> read_json('{"unit": "mm", "unit": "m"}')
    ({'unit': 'm'}, ('unit',))
    """
    repeated: dict[str, None] = {}

    def gather(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            seen: set[str] = set()
            for key, _ in pairs:
                if key in seen:
                    repeated[key] = None
                seen.add(key)
        return found

    value = json.loads(text, object_pairs_hook=gather, parse_int=float if whole_as_float else None)
    return value, tuple(repeated)
