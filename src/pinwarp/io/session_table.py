"""The table of a session file: one row per landmark; below, points of groups, fitted places."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Position, Role, Side
from pinwarp.io.csv_cells import (
    YES_NO,
    as_sentence,
    coordinates_text,
    formula_unquoted,
    number_of,
    position_of,
    shortened,
)
from pinwarp.io.csv_text import Row, csv_line, rows_of
from pinwarp.io.group_record import GroupRole, GroupRow
from pinwarp.io.session_header import CORRECT

_SOURCE = ("source_x", "source_y", "source_z")
_DESTINATION = ("destination_x", "destination_y", "destination_z")
_COLUMNS = ("name", "role", "enabled", *_SOURCE, *_DESTINATION, "note")
# What a table that somebody wrote by hand may leave out, and what is meant then.
_DEFAULTS = {"role": Role.PAIR.value, "enabled": "1", "note": ""}
# Only there where some landmark is locked.
_LOCKED = "locked"
# Only there where some landmark was digitised again.
_SPREADS = {side: f"{side.value}_spread" for side in Side}
_KNOWN = (*_COLUMNS, _LOCKED, *_SPREADS.values())
# The role of rows that are no landmarks: where a refinement found the surface.
_FITTED = "fitted"

_GROUPED = frozenset(role.value for role in GroupRole)

Pair = tuple[Position, Position]


def table_lines(
    landmarks: Iterable[Landmark],
    fitted: Iterable[Pair] = (),
    grouped: Iterable[GroupRow] = (),
) -> list[str]:
    r"""Return the line of column names, a line per landmark, point of a group and fitted place.

    Examples
    --------
    >>> table_lines([Landmark("fovea", source=(1, 2, 3))])[1]
    'fovea,pair,1,1.0,2.0,3.0,,,,\n'
    """
    rows = list(landmarks)
    # What an older or newer version wrote beside our columns goes back behind them.
    extra = [c for landmark in rows for c, _ in landmark.extra if c not in _KNOWN]
    extra = list(dict.fromkeys(extra))
    locks = [_LOCKED] if any(landmark.locked for landmark in rows) else []
    spread = [x for x in Side if any(landmark.spread(x) is not None for landmark in rows)]
    spreads = [_SPREADS[side] for side in spread]
    lines = [csv_line([*_COLUMNS, *locks, *spreads, *extra])]
    for landmark in rows:
        others = dict(landmark.extra)
        cells = [
            landmark.name,
            landmark.role.value,
            "1" if landmark.enabled else "0",
            *coordinates_text(landmark.source),
            *coordinates_text(landmark.destination),
            landmark.note,
            *["1" if landmark.locked else "0" for _ in locks],
            *["" if (x := landmark.spread(side)) is None else repr(float(x)) for side in spread],
            *[others.get(column, "") for column in extra],
        ]
        lines.append(csv_line(cells))
    empty = [""] * len([*locks, *spreads, *extra])
    for row in grouped:
        places = (*coordinates_text(row.source), *coordinates_text(row.destination))
        on = "1" if row.enabled else "0"
        lines.append(csv_line([row.name, row.role.value, on, *places, row.note, *empty]))
    for number, (source, destination) in enumerate(fitted, 1):
        places = (*coordinates_text(source), *coordinates_text(destination))
        lines.append(csv_line([f"{_FITTED}_{number}", _FITTED, "1", *places, "", *empty]))
    return lines


def read_table(
    path: str | Path, lines: Sequence[str], first_line: int, separator: str
) -> tuple[tuple[Landmark, ...], tuple[Pair, ...], tuple[GroupRow, ...]]:
    """Read the column names, and the landmarks, fitted places and points of groups below them.

    Parameters
    ----------
    path
        The file, for the messages.
    lines
        The lines of the table with their ends.
    first_line
        The number of the first of them.
    separator
        What separates the cells.

    Raises
    ------
    FileFormatError
        At the first row that cannot be read.

    Examples
    --------
    >>> lines = table_lines([Landmark("fovea", note="=1+1")])
    >>> read_table("femur.pinwarp.csv", lines, 1, ",")[0][0].note
    '=1+1'
    """
    rows = list(rows_of(lines, separator, first_line))
    if not rows:
        raise FileFormatError(
            path, f"The table of landmarks is missing: the file was cut off. {CORRECT}"
        )
    ends = lines[-1].endswith(("\n", "\r"))
    columns = _read_columns(path, rows[0], len(rows) == 1 and not ends)
    landmarks: dict[str, Landmark] = {}
    fitted: list[Pair] = []
    grouped: list[GroupRow] = []
    for row in rows[1:]:
        if row.is_blank:
            continue
        is_cut_off = row is rows[-1] and not ends
        try:
            values = _values(row, columns, is_cut_off)
            role = values["role"].strip().lower()
            if role == _FITTED:
                fitted.append(_fitted(values, separator))
                continue
            if role in _GROUPED:
                grouped.append(_grouped(values, separator))
                continue
            landmark = _landmark(values, columns, separator)
            if landmark.name in landmarks:
                raise ValueError(f"The name {shortened(landmark.name)} was used before.")
        except ValueError as error:
            raise FileFormatError(path, f"{as_sentence(str(error))} {CORRECT}", row.line) from None
        landmarks[landmark.name] = landmark
    return tuple(landmarks.values()), tuple(fitted), tuple(grouped)


def _read_columns(path: str | Path, row: Row, is_cut_off: bool) -> tuple[str, ...]:
    cells = [formula_unquoted(cell.strip()) for cell in row.cells]
    columns = tuple(cell.lower() if cell.lower() in _KNOWN else cell for cell in cells)
    problem = row.problem
    # Somebody who writes it by hand may leave out a side, but never one of its coordinates.
    sides = [side for side in (_SOURCE, _DESTINATION) if set(side) & set(columns)]
    needed = {"name", *(column for side in sides or [_SOURCE] for column in side)}
    if is_cut_off:
        needed = set(_COLUMNS)
    if missing := [x for x in _COLUMNS if x in needed and x not in columns]:
        problem = f"the column {missing[0]!r} is missing"
    named = [column for column in columns if column]
    if len(set(named)) < len(named):
        problem = "two columns have the same name"
    if problem:
        raise FileFormatError(path, f"{as_sentence(problem)} {CORRECT}", row.line)
    return columns


def _values(row: Row, columns: Sequence[str], is_cut_off: bool) -> dict[str, str]:
    """Return the cells of one row by column, or raise a ValueError with the reason."""
    if row.problem:
        raise ValueError(row.problem)
    cells = row.cells
    # Spreadsheets leave out empty cells at the end of a row, but they do end the row.
    if len(cells) < (len(columns) if is_cut_off else 3):
        raise ValueError(f"the row ends after {len(cells)} of {len(columns)} cells")
    cells = (*cells, *[""] * (len(columns) - len(cells)))
    if any(cell.strip() for cell in cells[len(columns) :]):
        raise ValueError(f"the row has {len(cells)} cells for {len(columns)} columns")
    values = {**_DEFAULTS, **dict.fromkeys((*_SOURCE, *_DESTINATION), "")}
    values |= dict(zip(columns, cells, strict=False))
    if values.get("", "").strip():
        raise ValueError("a cell is filled in a column without a name")
    return values


def _fitted(values: dict[str, str], separator: str) -> Pair:
    """Make a fitted place of one row, or raise a ValueError with the reason."""
    source = position_of([values[column] for column in _SOURCE], separator)
    destination = position_of([values[column] for column in _DESTINATION], separator)
    if source is None or destination is None:
        raise ValueError("a fitted place lacks one of its positions")
    return source, destination


def _grouped(values: dict[str, str], separator: str) -> GroupRow:
    """Make a point of a group of one row, or raise a ValueError with the reason."""
    return GroupRow(
        GroupRole(values["role"].strip().lower()),
        formula_unquoted(values["name"]),
        _yes_or_no("enabled", values["enabled"]),
        position_of([values[column] for column in _SOURCE], separator),
        position_of([values[column] for column in _DESTINATION], separator),
        formula_unquoted(values["note"]),
    )


def _landmark(values: dict[str, str], columns: Sequence[str], separator: str) -> Landmark:
    """Make a landmark of one row, or raise a ValueError with the reason."""
    role = values["role"].strip().lower() or Role.PAIR.value
    if role not in {known.value for known in Role}:
        raise ValueError(f"the role {shortened(role)} is neither 'pair' nor 'passenger'")
    # An empty cell means enabled, and not locked: a landmark as it begins.
    enabled = _yes_or_no("enabled", values["enabled"])
    locked = _yes_or_no(_LOCKED, values.get(_LOCKED, "").strip() or "0")
    return Landmark(
        formula_unquoted(values["name"]),
        source=position_of([values[column] for column in _SOURCE], separator),
        destination=position_of([values[column] for column in _DESTINATION], separator),
        role=Role(role),
        enabled=enabled,
        note=formula_unquoted(values["note"]),
        extra=tuple(
            (column, formula_unquoted(values[column]))
            for column in columns
            if column and column not in _KNOWN
        ),
        locked=locked,
        source_spread=_spread(values, Side.SOURCE, separator),
        destination_spread=_spread(values, Side.DESTINATION, separator),
    )


def _spread(values: dict[str, str], side: Side, separator: str) -> float | None:
    text = values.get(_SPREADS[side], "").strip()
    if not text:
        return None
    spread = number_of(text, separator)
    if spread < 0:
        raise ValueError(f"the {side.value} spread {shortened(text)} is below 0")
    return spread


def _yes_or_no(column: str, text: str) -> bool:
    value = YES_NO.get(text.strip().lower())
    if value is None:
        raise ValueError(f"{column!r} is {shortened(text)} and not 1 or 0")
    return value
