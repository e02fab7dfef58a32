"""The header of a session file: its ``# key: value`` lines."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from pinwarp.core.errors import FileFormatError, NewerFileError, PinwarpError
from pinwarp.core.mirror import AXES
from pinwarp.core.settings import WarpSettings
from pinwarp.io.csv_cells import as_sentence, number_of, shortened
from pinwarp.io.csv_text import plain_line
from pinwarp.io.mesh_reference import MeshReference, mesh_reference
from pinwarp.io.refinement_record import RefinementRecord, refinement_of
from pinwarp.io.setting_keys import SETTING_KEYS

VERSION = 3
"""The newest version of the format that is known: with another basis than r."""
RICH = 2
"""The version of a session with groups or a refinement."""
PLAIN = 1
"""The version of any other, which the oldest can read."""
CORRECT = "Correct it in a text editor, or use an earlier copy of the file."

_FIELDS = {
    "source_mesh": "source_mesh",
    "destination_mesh": "destination_mesh",
    "source_mirrored": "source_mirrored",
    "destination_mirrored": "destination_mirrored",
    "source_scaled": "source_scaled",
    "destination_scaled": "destination_scaled",
    "unit": "unit",
    "refine": "refinement",
    "landmarks": "announced",
}
"""The field of a session record, or of one of its meshes, that each known key fills."""
GROUP_KEYS = frozenset({"curve", "patch", "patch_around", "slid"})
"""Keys that describe groups: several lines may have the same."""


# To a spreadsheet, what follows a separator is a cell of its own.
_HAS_FORMULA = re.compile(r"[,;\t][\s\"']*[=+\-@＝＋－＠]")


class HeaderLine(NamedTuple):
    """One header line: its number, key and text; a line without a colon has an empty key."""

    line: int
    key: str
    text: str


def is_header(line: str) -> bool:
    """Whether a line belongs to the header.

    Examples
    --------
    >>> is_header('"# unit: mm",,,'), is_header("name,role")
    (True, False)
    """
    text = line.strip().lstrip('"')
    # A spreadsheet fills blank lines with separators.
    return text.startswith("#") or not text.strip(',;\t "')


def header_line(entry: str) -> str:
    r"""Return a line of the header; one that holds what a spreadsheet would run is in quotes.

    Examples
    --------
    >>> header_line("# unit: mm"), header_line("# unit: mm,=1+1")
    ('# unit: mm\n', '"# unit: mm,=1+1"\n')
    """
    return plain_line([entry]) if _HAS_FORMULA.search(entry) else f"{entry}\n"


def read_header(path: str | Path, lines: Sequence[str], separator: str) -> list[HeaderLine]:
    r"""Read the header lines and check the version.

    Parameters
    ----------
    path
        The file, for the messages.
    lines
        The lines above the table.
    separator
        What separates the cells of the table, in case a spreadsheet has saved the file.

    Returns
    -------
    list of HeaderLine
        All but the line of the version.

    Raises
    ------
    FileFormatError
        When this is not a session.
    NewerFileError
        When a newer pinwarp wrote it.

    Examples
    --------
    >>> read_header("a.pinwarp.csv", ["# pinwarp-session: 1\n", "# unit: m\n"], ",")
    [HeaderLine(line=2, key='unit', text='m')]
    """
    first = lines[0].rstrip("\r\n") if lines else ""
    mangled = first.endswith(separator) or first.startswith('"')
    found = []
    for number, line in enumerate(lines, 1):
        line = line.rstrip("\r\n")
        text = _header_text(line, separator, mangled)
        if text.startswith("#"):
            entry = text.removeprefix("#").strip()
            key, colon, value = entry.partition(":")
            # Nothing before the colon, or no colon at all: a remark.
            if not colon or not key.strip():
                key, value = "", entry
            found.append(HeaderLine(number, key.strip(), value.strip()))
    if not found or found[0][:2] != (1, "pinwarp-session"):
        raise FileFormatError(
            path,
            "This is not a pinwarp session: it should begin with '# pinwarp-session: 1'. "
            "Landmarks of other programs can be imported instead.",
        )
    version = found[0].text
    if not re.fullmatch(r"[0-9]{1,9}", version) or int(version) < 1:
        raise FileFormatError(
            path, f"The version {shortened(version)} is not a number from 1. {CORRECT}", 1
        )
    if int(version) > VERSION:
        raise NewerFileError(
            path,
            f"This session was written by a newer pinwarp (version {int(version)}); "
            f"update pinwarp to open it. This one knows version {VERSION}.",
        )
    return found[1:]


def _header_text(line: str, separator: str, mangled: bool) -> str:
    """Undo what a spreadsheet does to a header line: quotes, and separators at its end."""
    if not mangled and not line.startswith('"#'):
        return line.strip()
    # It took commas in the text for separators, and wrote its own in their place.
    text = ",".join(next(csv.reader([line], delimiter=separator), []))
    # Where none did, a comma at the end belongs to the text.
    return (text.rstrip(",") if mangled else text).strip()


def read_values(
    path: str | Path, header: Sequence[HeaderLine]
) -> tuple[dict[str, Any], tuple[tuple[str, str], ...]]:
    """Read the header lines this version knows, and keep the others.

    Parameters
    ----------
    path
        The session file; mesh paths are seen from its folder.
    header
        Its header lines.

    Returns
    -------
    known
        Fields of a session record; ``groups`` are key and text of the lines that describe some.
    unknown
        Key and text of the other lines, in order.

    Raises
    ------
    FileFormatError
        At the first line that cannot be read.

    Examples
    --------
    >>> read_values("a.pinwarp.csv", [HeaderLine(2, "unit", "m"), HeaderLine(3, "by", "Ada")])
    ({'unit': 'm'}, (('by', 'Ada'),))
    """
    folder = Path(os.path.abspath(path)).parent
    known: dict[str, Any] = {}
    chosen: dict[str, Any] = {}
    given: set[str] = set()
    unknown, lines = [], {}
    for line, key, text in header:
        lines[key] = line
        if key in GROUP_KEYS:
            known.setdefault("groups", []).append((key, text))
            continue
        if key not in _FIELDS and key not in SETTING_KEYS:
            unknown.append((key, text))
            continue
        try:
            if key in given:
                raise ValueError(f"{key} is given twice")
            if key in SETTING_KEYS:
                chosen[SETTING_KEYS[key].field] = SETTING_KEYS[key].read(text)
            else:
                known[_FIELDS[key]] = _value(key, text, folder)
            given.add(key)
        except ValueError as error:
            raise FileFormatError(path, f"{as_sentence(str(error))} {CORRECT}", line) from None
    for side in ("source", "destination"):
        for how in ("mirrored", "scaled"):
            value = known.pop(f"{side}_{how}", None)
            if value is None:
                continue
            mesh = known.get(f"{side}_mesh")
            if mesh is None:
                raise FileFormatError(
                    path,
                    f"The {side} mesh is {how}, but there is none. {CORRECT}",
                    lines[f"{side}_{how}"],
                )
            known[f"{side}_mesh"] = replace(mesh, **{how: value})
    if chosen:
        try:
            known["settings"] = WarpSettings(**chosen)
        except PinwarpError as error:
            # Each is a setting, but not beside the others.
            raise FileFormatError(path, f"{error} {CORRECT}", lines.get("basis")) from None
    return known, tuple(unknown)


def _value(
    key: str, text: str, folder: Path
) -> MeshReference | RefinementRecord | float | int | str:
    """Read the text of one line, or raise a ValueError with the reason."""
    match key:
        case "source_mesh" | "destination_mesh":
            return mesh_reference(text, folder)
        case "source_mirrored" | "destination_mirrored":
            return _axes(key, text)
        case "source_scaled" | "destination_scaled":
            return _factor(key, text)
        case "refine":
            return refinement_of(text)
        case "landmarks":
            return _count(text)
        case _:
            return text


def _count(text: str) -> int:
    if not re.fullmatch("[0-9]{1,9}", text):
        raise ValueError(f"the number of landmarks is {shortened(text)}, which is none")
    return int(text)


def _axes(key: str, text: str) -> str:
    axes = "".join(axis for axis in AXES if axis in text)
    if not text or len(axes) != len(text):
        raise ValueError(f"{key} is {shortened(text)} and names no axes such as x or xy")
    return axes


def _factor(key: str, text: str) -> float:
    value = number_of(text, ",")
    if not value > 0:
        raise ValueError(f"{key} is {text}, and only what is above 0 scales a mesh")
    return value
