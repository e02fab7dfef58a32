"""Names that look alike, though they are not the same."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable

from pinwarp.core.words import NAMED

_LONGEST_NAME = 60
# Letters by their kind, but nobody sees anything of them.
_UNSEEN_LETTERS = frozenset("\u034f\u115f\u1160\u17b4\u17b5\u3164\uffa0")
# Marks that choose among the shapes of the letter before them.
_SHAPES = ("\u180b", "\u180f"), ("\ufe00", "\ufe0f"), ("\U000e0100", "\U000e01ef")
_UNSEEN_KINDS = frozenset(["Cc", "Cf"])
_EMPTY_LETTER = "\u2800"


def visible(name: str) -> str:
    r"""Return what is seen of a name: two names that look alike give the same.

    Parameters
    ----------
    name
        Any text.

    Returns
    -------
    str
        Composed, without characters of no width, each run of blanks of any kind as one blank.

    Examples
    --------
    >>> visible("fovea\u200b  capitis\u00a0"), visible("te\u0301te") == visible("t\xe9te")
    ('fovea capitis', True)
    """
    if name.isascii() and name.isprintable():
        return " ".join(name.split())
    words = " ".join(name.replace(_EMPTY_LETTER, " ").split())
    seen = "".join(letter for letter in words if not _is_unseen(letter))
    return " ".join(unicodedata.normalize("NFC", seen).split())


def look_alikes(names: Iterable[str]) -> tuple[tuple[str, ...], ...]:
    r"""Return the names that differ only in what cannot be seen, those of one look together.

    Examples
    --------
    >>> look_alikes(["fovea", "head", "fovea\u200b", "head"])
    (('fovea', 'fovea\u200b'),)
    """
    groups: dict[str, dict[str, None]] = {}
    for name in names:
        groups.setdefault(visible(name), {})[name] = None
    return tuple(tuple(group) for group in groups.values() if len(group) > 1)


def look_alike_notes(names: Iterable[str]) -> tuple[str, ...]:
    r"""Return a sentence for each look that several names have, the first few of them.

    Examples
    --------
    >>> print(*look_alike_notes(["fovea", "fovea\u200b"]))
    'fovea' and 'fovea\u200b' look alike and are two names: rename one where they mean the same.
    """
    groups = look_alikes(names)
    notes = [
        f"{_told(group[0])} and {_told(group[1])} look alike and are two names: "
        "rename one where they mean the same."
        for group in groups[:NAMED]
    ]
    if len(groups) > NAMED:
        notes.append(f"{len(groups) - NAMED} more names look like another one.")
    return tuple(notes)


def _told(name: str) -> str:
    """Return a name with what cannot be seen of it written out, cut where it is too long."""
    text = ascii(name)
    return text if len(text) <= _LONGEST_NAME else f"{text[: _LONGEST_NAME - 3]}..."


def _is_unseen(letter: str) -> bool:
    return (
        unicodedata.category(letter) in _UNSEEN_KINDS
        or letter in _UNSEEN_LETTERS
        or any(first <= letter <= last for first, last in _SHAPES)
    )
