"""Numbers and lists as sentences say them."""

from __future__ import annotations

from collections.abc import Sequence

# So many are told by name, the others counted.
NAMED = 3


def counted(count: int, one: str, many: str = "") -> str:
    """Return a number with its noun; the plural is only given where it is not made by an s.

    Examples
    --------
    >>> counted(1, "pair"), counted(12345, "vertex", "vertices")
    ('1 pair', '12,345 vertices')
    """
    return f"{count:,} {one if count == 1 else many or f'{one}s'}"


def with_article(word: str) -> str:
    """Return a word behind its a or an; a name of capitals is spelt.

    Examples
    --------
    >>> with_article("Angle"), with_article("curve"), with_article("STL file"), with_article("PLY")
    ('an Angle', 'a curve', 'an STL file', 'a PLY')
    """
    # An S that is spelt is an "ess", a U a "you".
    vowels = "AEFHILMNORSX" if word.split(" ")[0].isupper() else "AEIOaeiou"
    return f"{'an' if word.startswith(tuple(vowels)) else 'a'} {word}"


def listed(words: Sequence[str]) -> str:
    """Say one or several.

    Examples
    --------
    >>> listed(["apex"]), listed(["apex", "tip", "base"])
    ('apex', 'apex, tip and base')
    """
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


def some_of(words: Sequence[str]) -> str:
    """Say the first few, and how many more there are.

    Examples
    --------
    >>> some_of(["a", "b"]), some_of(["a", "b", "c", "d", "e"])
    ('a, b', 'a, b, c and 2 more')
    """
    told = ", ".join(words[:NAMED])
    return f"{told} and {len(words) - NAMED} more" if len(words) > NAMED else told
