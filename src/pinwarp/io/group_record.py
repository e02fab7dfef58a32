"""What a session file says about curves and patches: header lines, and rows of the table."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

from pinwarp.core.errors import LandmarkError
from pinwarp.core.groups import MOST_POINTS, USUAL_COUNT, Curve, Group, Handle, Patch
from pinwarp.core.landmarks import Position
from pinwarp.io.csv_cells import number_of, shortened

# A newer method may bring the same points to rest elsewhere.
METHOD = 1


class GroupRole(StrEnum):
    """What a row of the table is, that is no landmark, to a group."""

    HANDLE = "handle"
    CURVE = "curve"
    SURFACE = "surface"


@dataclass(frozen=True)
class SlidRecord:
    """Where semilandmarks had come to rest.

    Parameters
    ----------
    source
        All points that took part, group by group.
    destination
        Where each came to rest; None for one without a counterpart.
    inputs
        A hash of what that followed from: where it has changed, this means nothing.
    method
        Which version of the method it was.
    """

    source: tuple[Position, ...]
    destination: tuple[Position | None, ...]
    inputs: str
    method: int = METHOD


@dataclass(frozen=True)
class GroupRow:
    """One row of the table that belongs to a group."""

    role: GroupRole
    name: str
    enabled: bool
    source: Position | None
    destination: Position | None
    note: str = ""


def group_lines(groups: Sequence[Group], slid: SlidRecord | None) -> Iterator[tuple[str, str]]:
    """Return key and text of the header lines.

    Examples
    --------
    >>> list(group_lines([Patch("shaft", ((1.0, 2.0, 3.0),))], None))
    [('patch', 'points=1 name=shaft')]
    """
    slid = slid if _belongs(slid, groups) else None
    for group in groups:
        if isinstance(group, Curve):
            words = [f"closed={int(group.is_closed)}", f"points={group.count}"]
            if group.drawn:
                words.append("destination=drawn")
            if group.excluded:
                words.append(f"excluded={'/'.join(map(str, sorted(group.excluded)))}")
        else:
            words = [f"points={group.count}"]
            if group.inside is not None:
                words.append(f"inside={'/'.join(repr(float(x)) for x in group.inside)}")
        # The name goes last: it may be any words.
        key = "curve" if isinstance(group, Curve) else "patch"
        yield key, " ".join([*words, f"name={group.name}"])
        if isinstance(group, Patch) and group.around:
            yield "patch_around", group.around
    if slid is not None:
        yield "slid", f"method={slid.method} inputs={slid.inputs}"


def group_rows(groups: Sequence[Group], slid: SlidRecord | None) -> Iterator[GroupRow]:
    """Return the rows below the landmarks: of each group its handles, then its points."""
    rest = None
    if slid is not None and _belongs(slid, groups):
        rest = iter(zip(slid.source, slid.destination, strict=True))
    for group in groups:
        if isinstance(group, Curve):
            for number, handle in enumerate(group.handles, 1):
                yield GroupRow(
                    GroupRole.HANDLE,
                    f"{group.name} {number}",
                    True,
                    handle.source,
                    handle.destination,
                    handle.landmark,
                )
            if rest is None:
                continue
            for number in range(group.count):
                if number not in group.excluded:
                    source, destination = next(rest)
                    name = f"{group.name} {number + 1}"
                    yield GroupRow(GroupRole.CURVE, name, True, source, destination)
            continue
        for number, place in enumerate(group.points):
            enabled = number not in group.excluded
            destination = next(rest)[1] if rest is not None and enabled else None
            name = f"{group.name} {number + 1}"
            yield GroupRow(GroupRole.SURFACE, name, enabled, place, destination)


def _belongs(slid: SlidRecord | None, groups: Sequence[Group]) -> bool:
    """Whether so many points as had come to rest are there: a count may have changed since."""
    return slid is not None and len(slid.source) == _used(groups)


def _used(groups: Sequence[Group]) -> int:
    return sum(group.count - len(group.excluded) for group in groups)


def groups_of(
    lines: Iterable[tuple[str, str]], rows: Iterable[GroupRow]
) -> tuple[tuple[Group, ...], SlidRecord | None]:
    """Put groups together again.

    Parameters
    ----------
    lines
        Key and text of the header lines.
    rows
        Of the table, in any order.

    Returns
    -------
    groups, slid

    Raises
    ------
    ValueError
        With the reason as its message.

    Examples
    --------
    >>> patch = Patch("shaft", ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0)), excluded=frozenset({1}))
    >>> groups_of(group_lines([patch], None), group_rows([patch], None)) == ((patch,), None)
    True
    """
    of_group: dict[tuple[GroupRole, str], dict[int, GroupRow]] = {}
    for row in rows:
        name, _, number = row.name.rpartition(" ")
        if not re.fullmatch("[1-9][0-9]{0,6}", number):
            raise ValueError(f"{shortened(row.name)} is no name of a group and a number")
        numbered = of_group.setdefault((row.role, name), {})
        if int(number) in numbered:
            raise ValueError(f"{shortened(row.name)} is there twice")
        numbered[int(number)] = row
    groups: list[Group] = []
    slid_text, names = None, set()
    source: list[Position] = []
    destination: list[Position | None] = []
    for key, text in _joined(lines):
        if key == "slid":
            if slid_text is not None:
                raise ValueError("slid is given twice")
            slid_text = text
            continue
        if key == "patch_around":
            raise ValueError(f"there is no patch inside the curve {shortened(text)}")
        values = _values(key, text)
        name = values["name"]
        count = _count(values, key) if "points" in values else None
        if name in names:
            raise ValueError(f"two groups are called {shortened(name)}")
        names.add(name)
        if key == "curve":
            handles = _numbered(of_group.pop((GroupRole.HANDLE, name), {}), None, name)
            points = of_group.pop((GroupRole.CURVE, name), {})
            usual = USUAL_COUNT if count is None else count
            groups.append(_curve(name, usual, values, handles))
            own = _used_rows(groups[-1], points) if points else []
        else:
            own = _numbered(of_group.pop((GroupRole.SURFACE, name), {}), count, name)
            groups.append(_patch(name, values, own))
            own = [row for row in own if row.enabled]
        source += [_placed(row) for row in own]
        destination += [row.destination for row in own]
    if of_group:
        (_, name), *_ = of_group
        raise ValueError(f"there are points of {shortened(name)}, but no line that says what it is")
    slid = None
    if slid_text is not None:
        values = _values("slid", f"{slid_text} name=slid")
        slid = SlidRecord(
            tuple(source), tuple(destination), values.get("inputs", ""), _number(values, "method")
        )
        if len(source) != _used(groups):
            raise ValueError("some of the points that slid are missing")
    return tuple(groups), slid


def _joined(lines: Iterable[tuple[str, str]]) -> Iterator[tuple[str, str]]:
    """Return the lines with what a patch lies inside put into its own line."""
    last: tuple[str, str] | None = None
    for key, text in lines:
        if key == "patch_around" and last is not None and last[0] == "patch":
            # On one line, as it is written: some line ends are none to those who read lines.
            yield "patch", f"around={' '.join(text.splitlines())}\n{last[1]}"
            last = None
            continue
        if last is not None:
            yield last
        last = (key, text)
    if last is not None:
        yield last


def _values(key: str, text: str) -> dict[str, str]:
    values = {}
    if text.startswith("around="):
        around, _, text = text.partition("\n")
        values["around"] = around.removeprefix("around=")
    words, equals, name = text.partition("name=")
    if not equals or not name.strip():
        raise ValueError(f"the {key} {shortened(text)} has no name")
    values |= dict(re.findall(r"(\w+)=(\S+)", words))
    values["name"] = name.strip()
    return values


def _number(values: Mapping[str, str], word: str) -> int:
    if not re.fullmatch(r"[0-9]{1,9}", values.get(word, "")):
        found = shortened(values.get(word, ""))
        raise ValueError(f"{word} of {shortened(values['name'])} is {found}, no number")
    return int(values[word])


def _count(values: Mapping[str, str], key: str) -> int:
    count = _number(values, "points")
    if count > MOST_POINTS:
        raise ValueError(
            f"the {key} {shortened(values['name'])} has more than {MOST_POINTS} points"
        )
    return count


def _numbered(rows: Mapping[int, GroupRow], count: int | None, name: str) -> list[GroupRow]:
    """Return rows in the order of their numbers, which must be 1, 2, 3 and so on."""
    wanted = len(rows) if count is None else count
    if sorted(rows) != list(range(1, wanted + 1)):
        raise ValueError(f"{shortened(name)} lacks some of its rows, or has too many")
    return [rows[number] for number in range(1, wanted + 1)]


def _used_rows(group: Group, rows: Mapping[int, GroupRow]) -> list[GroupRow]:
    """Return the rows of the points of a curve, which must be those that take part."""
    for number in rows:
        if number > group.count:
            raise ValueError(f"{shortened(group.name)} has no point {number}")
        if number - 1 in group.excluded:
            raise ValueError(f"point {number} of {shortened(group.name)} is excluded")
    return [rows[number] for number in sorted(rows)]


def _placed(row: GroupRow) -> Position:
    if row.source is None:
        raise ValueError(f"{shortened(row.name)} has no position on the source")
    return row.source


def _curve(name: str, count: int, values: Mapping[str, str], rows: Sequence[GroupRow]) -> Curve:
    closed = values.get("closed", "0")
    if closed not in ("0", "1"):
        raise ValueError(f"closed of {shortened(name)} is neither 0 nor 1")
    if values.get("destination", "drawn") != "drawn":
        found = shortened(values["destination"])
        raise ValueError(f"destination of {shortened(name)} is {found} and not 'drawn'")
    handles = tuple(Handle(_placed(row), row.destination, row.note) for row in rows)
    excluded = frozenset(map(int, re.findall("[0-9]{1,7}", values.get("excluded", ""))))
    try:
        drawn = "destination" in values
        return Curve(name, handles, closed == "1", count, excluded, drawn)
    except LandmarkError as error:
        raise ValueError(f"the curve {error}") from None


def _patch(name: str, values: Mapping[str, str], rows: Sequence[GroupRow]) -> Patch:
    inside = None
    if "inside" in values:
        numbers = [number_of(text, ",") for text in values["inside"].split("/")]
        if len(numbers) != 3:
            raise ValueError(f"inside of {shortened(name)} is no position")
        inside = (numbers[0], numbers[1], numbers[2])
    excluded = frozenset(number for number, row in enumerate(rows) if not row.enabled)
    try:
        return Patch(name, tuple(map(_placed, rows)), values.get("around", ""), inside, excluded)
    except LandmarkError as error:
        raise ValueError(f"the patch {error}") from None
