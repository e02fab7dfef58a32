"""What became of every element of a model, as a table, as JSON and as text."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from pinwarp.core.model_rows import ElementRow, Outcome, counts
from pinwarp.core.words import counted
from pinwarp.io.atomic import write_atomically
from pinwarp.io.csv_cells import Numeral
from pinwarp.io.csv_text import csv_line

COLUMNS = (
    *("outcome", "body", "kind", "path", "line", "moved_mm", "plus_minus_mm", "turned_deg"),
    *("rule", "flag"),
)

_PLURALS = {
    "mesh": "meshes",
    "muscle lengths": "muscles' lengths",
    "mass and inertia": "masses and inertias",
}


def report_csv(rows: Iterable[ElementRow]) -> str:
    """Return the table: a row per element, lengths in millimetres.

    Examples
    --------
    >>> row = ElementRow("thigh", "/markerset/KNEE", "marker", 7, True, "carried", 0.0123456)
    >>> print(report_csv([row]).splitlines()[1])
    warped,thigh,marker,/markerset/KNEE,7,12.3456,,,carried,
    """
    lines = [csv_line(COLUMNS)]
    for row in rows:
        figures = (1e3 * row.moved, 1e3 * row.plus_minus, row.turned)
        cells = [row.outcome.value, row.body, row.kind, row.path, Numeral(str(row.line))]
        cells += [Numeral("" if math.isnan(x) else f"{x:.6g}") for x in figures]
        lines.append(csv_line([*cells, row.words, row.flag]))
    return "".join(lines)


def report_json(rows: Sequence[ElementRow], about: Mapping[str, Any]) -> dict[str, Any]:
    """Return all of it as plain values for JSON, lengths in millimetres.

    Parameters
    ----------
    rows
        The elements.
    about
        What they belong to.

    Examples
    --------
    >>> row = ElementRow("thigh", "/markerset/KNEE", "marker", 7, True, "carried", 0.0123456)
    >>> report_json([row], {})["elements"][0]["moved_mm"]
    12.3456
    """
    elements = []
    for row in rows:
        plain = row.as_json()
        for name in ("moved", "plus_minus"):
            value = plain.pop(name)
            plain[f"{name}_mm"] = None if value is None else 1e3 * value
        plain["turned_deg"] = plain.pop("turned")
        plain["rule"] = plain.pop("words")
        elements.append(plain)
    return {
        **about,
        "counts": {outcome.value: count for outcome, count in counts(rows).items()},
        "elements": elements,
    }


def report_text(rows: Sequence[ElementRow], notes: Sequence[str] = ()) -> str:
    """Return what a person reads first: a line per kind, then everything that is flagged.

    Examples
    --------
    >>> row = ElementRow("thigh", "/markerset/KNEE", "marker", 7, True, "carried", 0.0123456)
    >>> print(report_text([row]))
    thigh
      1 marker warped, moved by 12.3 mm
    1 warped, 0 kept, 0 flagged
    """
    lines: list[str] = []
    for body in dict.fromkeys(row.body for row in rows):
        lines.append(body)
        on_body = [row for row in rows if row.body == body]
        for kind in dict.fromkeys(row.kind for row in on_body):
            lines += _kind(kind, [row for row in on_body if row.kind == kind])
    flagged = [row for row in rows if row.outcome is Outcome.FLAGGED]
    for row in flagged:
        state = "warped" if row.is_warped else "kept"
        lines.append(f"! {row.path} ({row.kind}, {state}: {row.words})")
        lines.append(f"  {row.flag}")
    lines += [f"- {note}" for note in notes]
    found = counts(rows)
    lines.append(", ".join(f"{count} {outcome.value}" for outcome, count in found.items()))
    return "\n".join(lines)


def write_report_csv(path: str | Path, rows: Iterable[ElementRow]) -> None:
    """Write the table, all of it or nothing.

    Raises
    ------
    OSError
        When the file cannot be written; an older one is untouched.
    """
    write_atomically(path, report_csv(rows))


def _kind(kind: str, rows: Sequence[ElementRow]) -> list[str]:
    lines = []
    for state, chosen in (
        ("warped", [row for row in rows if row.is_warped]),
        ("kept", [row for row in rows if not row.is_warped]),
    ):
        if not chosen:
            continue
        moved = [1e3 * row.moved for row in chosen if not math.isnan(row.moved)]
        far = ""
        if moved:
            mean = sum(moved) / len(moved)
            on_average = "" if len(moved) == 1 else f" on average and {max(moved):.1f} mm at most"
            verb = "moved" if state == "warped" else "where the bone moves"
            far = f", {verb} by {mean:.1f} mm{on_average}"
        flags = sum(bool(row.flag) for row in chosen)
        told = f", {flags} flagged" if flags else ""
        lines.append(f"  {counted(len(chosen), kind, _PLURALS.get(kind, ''))} {state}{far}{told}")
    return lines
