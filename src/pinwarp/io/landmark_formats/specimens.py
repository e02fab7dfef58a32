"""Files of several specimens: which of them is meant, and what is said about the others."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.words import some_of
from pinwarp.io.csv_cells import shortened

FIRST = ""
"""Nobody said which: the first, with a note."""


def named_specimens(names: Sequence[str]) -> tuple[str, ...]:
    """Return what specimens are called: each by its own name, or else by its number.

    Examples
    --------
    >>> named_specimens(["femur", "", "femur"])
    ('femur', '2', 'femur_2')
    """
    taken: dict[str, None] = {}
    for number, name in enumerate(names, 1):
        stem = free = " ".join(name.split()) or str(number)
        count = 2
        while free in taken:
            free, count = f"{stem}_{count}", count + 1
        taken[free] = None
    return tuple(taken)


def chosen(path: str | Path, names: Sequence[str], which: str) -> int:
    """Return the number of the specimen that is meant, from 0.

    Parameters
    ----------
    path
        The file, for the message.
    names
        What they are called.
    which
        A name, in upper or lower case; where none is called so, a number from 1; or nothing:
        the first.

    Raises
    ------
    FileFormatError
        When there is none of that name or number.

    Examples
    --------
    >>> chosen("a.tps", ["femur", "tibia"], "Tibia"), chosen("a.tps", ["femur", "tibia"], "1")
    (1, 0)
    """
    if which == FIRST:
        return 0
    if which in names:
        return list(names).index(which)
    lower = [name.casefold() for name in names]
    if which.casefold() in lower:
        return lower.index(which.casefold())
    if re.fullmatch("[0-9]{1,9}", which) and 1 <= int(which) <= len(names):
        return int(which) - 1
    raise FileFormatError(
        path,
        f"There is no specimen {shortened(which)} in it. Choose by name or number, from 1 to "
        f"{len(names)}: {some_of(names)}.",
    )


def specimen_notes(names: Sequence[str], which: str) -> tuple[str, ...]:
    """Say that there are others, where nobody chose.

    Examples
    --------
    >>> specimen_notes(["femur", "tibia"], FIRST)
    ('2 specimens: the first was read (femur).',)
    """
    if len(names) < 2 or which != FIRST:
        return ()
    return (f"{len(names)} specimens: the first was read ({names[0]}).",)
