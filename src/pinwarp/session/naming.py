"""New names for landmarks, many at once, how they sort and how several are spoken of."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Sequence

from pinwarp.core.errors import LandmarkError
from pinwarp.core.words import counted

NAME_PATTERN = "landmark_{n}"
PASSENGER_PATTERN = "passenger_{n}"

_FIELD = re.compile(r"\{([^{}]*)\}")
_AUTOMATIC = re.compile(r"(landmark|passenger)_\d+")
_NUMBERED = re.compile(r"(.*_)(\d{1,9})", re.DOTALL)
_NUMBER = re.compile(r"n(?::0?(\d))?")


def is_automatic(name: str) -> bool:
    """Whether a name is one that nobody chose.

    Examples
    --------
    >>> is_automatic("landmark_7"), is_automatic("fovea")
    (True, False)
    """
    return _AUTOMATIC.fullmatch(name) is not None


def free_names(names: Iterable[str], taken: Iterable[str]) -> list[str]:
    """Return names that are not taken: where one is, it counts on behind its last underscore.

    Examples
    --------
    >>> free_names(["fovea", "head", "landmark_0"], ["fovea", "landmark_0", "landmark_1"])
    ['fovea_2', 'head', 'landmark_2']
    """
    used, last = set(taken), dict[str, int]()
    found = []
    for name in names:
        if name in used:
            match = _NUMBERED.fullmatch(name)
            stem, number = (match[1], int(match[2])) if match else (f"{name}_", 1)
            number = max(number, last.get(stem, 0))
            while name in used:
                number += 1
                name = f"{stem}{number}"
            last[stem] = number
        used.add(name)
        found.append(name)
    return found


def names_by_pattern(names: Sequence[str], pattern: str, first: int = 1) -> dict[str, str]:
    """Return a new name for each by a pattern.

    Parameters
    ----------
    names
        The names as they are, in order.
    pattern
        ``{name}`` stands for the name as it is, ``{n}`` for a number that counts up, and
        ``{n:02}`` for one of two digits.
    first
        The first number.

    Raises
    ------
    LandmarkError
        When there are braces that mean nothing.

    Examples
    --------
    >>> names_by_pattern(["head", "neck"], "{name}_l")
    {'head': 'head_l', 'neck': 'neck_l'}
    >>> names_by_pattern(["head", "neck"], "point_{n:02}", first=9)
    {'head': 'point_09', 'neck': 'point_10'}
    """
    for inside in _FIELD.findall(pattern):
        if inside != "name" and not _NUMBER.fullmatch(inside):
            raise LandmarkError(
                f"{{{inside}}} means nothing here: use {{name}}, {{n}} or {{n:02}}."
            )
    if set("{}") & set(_FIELD.sub("", pattern)):
        raise LandmarkError("A brace is open: use {name}, {n} or {n:02}.")
    return {
        name: _FIELD.sub(functools.partial(_filled, name, number), pattern).strip()
        for number, name in enumerate(names, first)
    }


def _filled(name: str, number: int, found: re.Match[str]) -> str:
    if found[1] == "name":
        return name
    digits = _NUMBER.fullmatch(found[1])
    return f"{number:0{int(digits[1] or 0) if digits else 0}d}"


def names_by_replacing(names: Sequence[str], find: str, replacement: str) -> dict[str, str]:
    """Return the names with every occurrence of a text replaced.

    Examples
    --------
    >>> names_by_replacing(["head_r", "neck_r"], "_r", "_l")
    {'head_r': 'head_l', 'neck_r': 'neck_l'}
    """
    if not find:
        return {name: name for name in names}
    return {name: name.replace(find, replacement).strip() for name in names}


def in_words(names: Iterable[str]) -> str:
    """Return the one name, or how many there are.

    Examples
    --------
    >>> in_words(["fovea"]), in_words(["fovea", "head"])
    ('fovea', '2 landmarks')
    """
    names = list(names)
    return names[0] if len(names) == 1 else counted(len(names), "landmark")


@functools.lru_cache(maxsize=4096)
def natural(text: str) -> tuple[tuple[int, int, str], ...]:
    """Return a key that sorts numbers in names as numbers.

    Examples
    --------
    >>> sorted(["p10", "p9", "P1"], key=natural)
    ['P1', 'p9', 'p10']
    """
    parts = re.findall(r"[0-9]+|[^0-9]+", text.casefold())
    return tuple((0, int(p), "") if p.isascii() and p.isdigit() else (1, 0, p) for p in parts)
