"""What the columns of a table of landmarks are, by the words of its header."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from pinwarp.core.landmarks import Side
from pinwarp.io.csv_cells import formula_unquoted

# What stands behind the axis: a word that says nothing more, and the unit ("z_pos", "z (mm)").
_TAIL = re.compile(
    r"(?P<more>[\s._-]*(?:coordinate|coord|position|pos))?"
    r"\s*(?:[\[(]\s*(?P<unit>µm|um|mm|cm|m)\s*[\])]|_(?P<last>mm|cm|m))?$",
    re.IGNORECASE,
)
_LONGEST_TAIL = 30
_NUMBERED = re.compile(r"(?P<axis>[xyz])[\s._-]?(?P<number>\d{1,9})", re.IGNORECASE)
_SIDES = {
    **dict.fromkeys(("source", "src", "moving", "from"), Side.SOURCE),
    **dict.fromkeys(("dest", "destination", "dst", "target", "fixed", "to"), Side.DESTINATION),
}
# What an axis may belong to where the table is of one side.
_PLAIN = frozenset(
    ("", "p", "pos", "position", "coord", "coords", "coordinate", "point", "pt", "location", "loc")
)
_NAMES = ("name", "label", "landmark", "landmark_name", "landmark name", "names", "labels", "point")
_IDS = ("id", "index", "number", "nr", "no", "#", "n", "")
SPECIMENS = ("id", "specimen", "sample", "sample_name", "individual", "subject", "ids", "file")
TIMES = frozenset(("time", "t", "timestamp", "frame", "seconds", "time (s)", "time_s", "ms"))
_OTHERS = {
    "kind": ("type", "role", "kind"),
    "note": ("note", "notes", "description", "desc", "comment"),
    "locked": ("locked", "lock"),
    "enabled": ("enabled", "selected", "active"),
}

Triple = tuple[int, int, int]


@dataclass(frozen=True)
class Columns:
    """Where in a row of a table everything stands, counted from 0; None where it does not.

    Parameters
    ----------
    places
        The columns of x, y and z: of one side, or of source and destination.
    name, kind, note, locked, enabled
        The columns of those.
    unit
        The unit that the header says; empty where it says none.
    over_time
        The word that makes the table look like a recording; empty where none does.
    """

    places: tuple[Triple, ...]
    name: int | None = None
    kind: int | None = None
    note: int | None = None
    locked: int | None = None
    enabled: int | None = None
    unit: str = ""
    over_time: str = ""

    @property
    def is_pairs(self) -> bool:
        """Whether both sides are there."""
        return len(self.places) == 2

    def behind(self, shift: int) -> Columns:
        """Return the same for rows with so many cells more in front, the name first of them."""
        places = tuple((x + shift, y + shift, z + shift) for x, y, z in self.places)
        return Columns(
            places,
            0,
            kind=_behind(self.kind, shift),
            note=_behind(self.note, shift),
            locked=_behind(self.locked, shift),
            enabled=_behind(self.enabled, shift),
            unit=self.unit,
            over_time=self.over_time,
        )


def _behind(column: int | None, shift: int) -> int | None:
    return None if column is None else column + shift


@dataclass(frozen=True)
class Axes:
    """The columns of x, y and z of one thing in a header.

    Parameters
    ----------
    of
        What they belong to, as the header says it.
    places
        The columns.
    is_numbered
        Whether it is only a number behind the axes.
    """

    of: str
    places: Triple
    is_numbered: bool = False


def words_of(cells: Sequence[str]) -> list[str]:
    """Return the words of a header as they are meant."""
    return [formula_unquoted(cell.strip()).strip() for cell in cells]


def axes_in(words: Sequence[str]) -> tuple[tuple[Axes, ...], str]:
    """Find all that has x, y and z in a header, in order, and the unit that all of them say.

    Parameters
    ----------
    words
        Its words; x, y and z stand behind what they belong to (source.x, LM1x, "nasion y"), or
        before its number (x1).

    Examples
    --------
    >>> [axes.of for axes in axes_in(["Id", "LM1x", "LM1y", "LM1z", "LM2x", "LM2y", "LM2z"])[0]]
    ['LM1', 'LM2']
    >>> axes_in(["Z (mm)", "Y (mm)", "X (mm)"])
    ((Axes(of='', places=(2, 1, 0), is_numbered=False),), 'mm')
    """
    found: dict[tuple[str, bool], dict[str, int]] = {}
    units: set[str] = set()
    for column, word in enumerate(words):
        if parts := _axis_in(word):
            of, axis, unit, is_numbered = parts
            found.setdefault((of, is_numbered), {}).setdefault(axis, column)
            units.add(unit)
    whole = tuple(
        Axes(of, (at["x"], at["y"], at["z"]), is_numbered)
        for (of, is_numbered), at in found.items()
        if len(at) == len("xyz")
    )
    return whole, units.pop() if len(units) == 1 else ""


def _axis_in(word: str) -> tuple[str, str, str, bool] | None:
    """Return what an axis belongs to, the axis, its unit, and whether it stands before a number."""
    if numbered := _NUMBERED.fullmatch(word):
        return numbered["number"], numbered["axis"].lower(), "", True
    start = max(0, len(word) - _LONGEST_TAIL)
    for end in range(len(word), start, -1):
        axis = word[end - 1].lower()
        tail = _TAIL.match(word, end) if axis in "xyz" else None
        if tail:
            # One sign stands between, and blanks.
            of = word[: end - 1].rstrip()
            of = of[:-1].rstrip() if of.endswith((".", "_", ":", "-")) else of
            return of, axis, (tail["unit"] or tail["last"] or "").lower(), False
    return None


def columns_of(cells: Sequence[str]) -> Columns | None:
    """Understand the header of a table with a row for each landmark, or return None.

    Parameters
    ----------
    cells
        The first row.

    Examples
    --------
    >>> columns_of(["name", "z", "y", "x"])
    Columns(places=((3, 2, 1),), name=0, kind=None, note=None, locked=None, enabled=None, \
unit='', over_time='')
    >>> columns_of(["dest.x", "dest.y", "dest.z", "source.x", "source.y", "source.z"]).places
    ((3, 4, 5), (0, 1, 2))
    """
    found, unit = axes_in(words_of(cells))
    sides = {side: axes for axes in found if (side := _SIDES.get(axes.of.strip().lower()))}
    words = [word.lower() for word in words_of(cells)]
    plain = [axes for axes in found if axes.of.strip().lower() in _PLAIN and not axes.is_numbered]
    if len(sides) == len(Side):
        places: tuple[Triple, ...] = tuple(sides[side].places for side in Side)
    elif plain:
        places = (plain[0].places,)
    elif len(found) == len(Side) and not _of_specimens(words):
        places = tuple(axes.places for axes in found)
    elif len(found) == 1:
        places = (found[0].places,)
    else:
        return None
    used = {column for place in places for column in place}
    free = {word: n for n, word in reversed(list(enumerate(words))) if n not in used}
    names = [free[word] for word in (*_NAMES, *_IDS) if word in free]
    # Whatever stands first is most likely a name.
    name = names[0] if names else min((n for n in free.values() if n < min(used)), default=None)
    others = {
        field: next((free[word] for word in known if word in free), None)
        for field, known in _OTHERS.items()
    }
    over_time = next((word for word in words if word in TIMES), "")
    return Columns(places, name, unit=unit, over_time=over_time, **others)


def specimens_of(cells: Sequence[str]) -> tuple[Axes, ...]:
    """Return the landmarks of a table with a row for each specimen; none where it is no such table.

    Examples
    --------
    >>> [x.of for x in specimens_of("Id,x1,y1,z1,x2,y2,z2,x3,y3,z3".split(","))]
    ['1', '2', '3']
    >>> specimens_of(["name", "source.x", "source.y", "source.z", "dest.x", "dest.y", "dest.z"])
    ()
    """
    found, _ = axes_in(words_of(cells))
    of = [axes.of.strip().lower() for axes in found]
    words = [word.lower() for word in words_of(cells)]
    several = len(found) > len(Side) or _of_specimens(words)
    if not found or not several or set(of) <= _PLAIN or set(of) <= set(_SIDES):
        return ()
    return found


def _of_specimens(words: Sequence[str]) -> bool:
    return bool(words) and words[0] in SPECIMENS
