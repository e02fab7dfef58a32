"""The manifest of a batch: a table with one row for each subject."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.components import Components
from pinwarp.core.errors import FileFormatError
from pinwarp.io.csv_cells import as_sentence, formula_unquoted, shortened
from pinwarp.io.csv_text import Row, lines_of, read_text, refuse_binary, rows_of
from pinwarp.io.setting_keys import penalty_of

REQUIRED = ("name", "destination_landmarks")
OPTIONAL = ("destination_mesh", "penalty", "components")
_COLUMNS = (*REQUIRED, *OPTIONAL)

# Windows and macOS refuse some of these, and a folder in a name would leave the output folder.
_NOT_IN_A_NAME = re.compile(r'[\x00-\x1f\x7f/\\:*?"<>|]')
_TAKEN_BY_WINDOWS = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
_LONGEST_NAME = 120


@dataclass(frozen=True)
class Subject:
    """One row of a manifest.

    Parameters
    ----------
    name
        What the subject's files are called.
    line
        The line of the manifest, counted from 1.
    destination_landmarks, destination_mesh
        Absolute paths; there need not be a mesh.
    penalty, components
        For this subject alone; None where the row leaves them open.
    """

    name: str
    line: int
    destination_landmarks: Path
    destination_mesh: Path | None = None
    penalty: float | None = None
    components: Components | None = None


@dataclass(frozen=True)
class Manifest:
    """All rows of a manifest.

    Parameters
    ----------
    path
        The file, absolute.
    subjects
        In the order of the rows; names differ, also where upper and lower case are one.
    unused
        Columns that mean nothing here.
    """

    path: Path
    subjects: tuple[Subject, ...]
    unused: tuple[str, ...] = ()


def read_manifest(path: str | Path) -> Manifest:
    r"""Read a manifest: columns ``name, destination_landmarks`` and some more, in any order.

    Parameters
    ----------
    path
        The file; the paths in it are seen from its folder. ``destination_mesh``, ``penalty`` and
        ``components`` may be missing or empty.

    Returns
    -------
    Manifest

    Raises
    ------
    FileFormatError
        When a column is missing or a row cannot be used; the message names the line. Whether the
        files are there is not looked at.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "study.csv")
    ...     _ = path.write_text("name,destination_landmarks,penalty\nanna,anna.csv,2.5\n")
    ...     (anna,) = read_manifest(path).subjects
    >>> anna.name, anna.destination_landmarks.name, anna.penalty
    ('anna', 'anna.csv', 2.5)
    """
    place = Path(os.path.abspath(path))
    text = read_text(place, "manifest")
    refuse_binary(place, text)
    lines = lines_of(text)
    filled = [line for line in lines if line.strip() and not line.startswith("#")]
    # No column's name has any of these in it.
    separator = max(",;\t", key=filled[0].count) if filled else ","
    rows = [
        row
        for row in rows_of(lines, separator)
        if not row.is_blank and not row.text.startswith("#")
    ]
    columns = _columns(place, rows)
    subjects: dict[str, Subject] = {}
    for row in rows[1:]:
        try:
            subject = _subject(row, columns, separator, place.parent)
            if earlier := subjects.get(subject.name.casefold()):
                raise ValueError(
                    f"the name {shortened(subject.name)} was used in line {earlier.line}: "
                    "the files of one would replace the other's"
                )
        except ValueError as error:
            raise FileFormatError(place, as_sentence(str(error)), row.line) from None
        subjects[subject.name.casefold()] = subject
    if not subjects:
        raise FileFormatError(place, "There is no subject in it: write one row for each.")
    unused = tuple(column for column in columns if column and column not in _COLUMNS)
    return Manifest(place, tuple(subjects.values()), unused)


def _columns(path: Path, rows: Sequence[Row]) -> tuple[str, ...]:
    cells = rows[0].cells if rows else ()
    columns = tuple(cell.strip().lower().replace(" ", "_") for cell in cells)
    line = rows[0].line if rows else 1
    if missing := [column for column in REQUIRED if column not in columns]:
        raise FileFormatError(
            path,
            f"The column {missing[0]!r} is missing. The first row names the columns: "
            f"{', '.join(REQUIRED)} and, where wanted, {', '.join(OPTIONAL)}.",
            line,
        )
    for column in _COLUMNS:
        if columns.count(column) > 1:
            raise FileFormatError(path, f"The column {column!r} is there twice.", line)
    return columns


def _subject(row: Row, columns: Sequence[str], separator: str, folder: Path) -> Subject:
    """Make a subject of one row, or raise a ValueError with the reason."""
    if row.problem:
        raise ValueError(row.problem)
    if any(cell.strip() for cell in row.cells[len(columns) :]):
        raise ValueError(f"the row has {len(row.cells)} cells for {len(columns)} columns")
    cells = dict(zip(columns, (cell.strip() for cell in row.cells), strict=False))
    name = checked_name(formula_unquoted(cells.get("name", "")))
    landmarks, mesh = (cells.get(f"destination_{what}", "") for what in ("landmarks", "mesh"))
    if not landmarks:
        raise ValueError(f"{shortened(name)} has no destination_landmarks")
    penalty, components = cells.get("penalty", ""), cells.get("components", "")
    return Subject(
        name=name,
        line=row.line,
        destination_landmarks=_path(landmarks, folder),
        destination_mesh=_path(mesh, folder) if mesh else None,
        penalty=penalty_of(penalty, separator) if penalty else None,
        components=_components(components) if components else None,
    )


def checked_name(name: str) -> str:
    """Return a subject's name if files can be called by it on every system.

    Raises
    ------
    ValueError
        With the reason as its message.

    Examples
    --------
    >>> checked_name("S 012-left")
    'S 012-left'
    >>> checked_name("../anna")
    Traceback (most recent call last):
    ...
    ValueError: the name '../anna' holds '/', which a file's name cannot
    """
    if not name:
        raise ValueError("the name is missing")
    if found := _NOT_IN_A_NAME.search(name):
        raise ValueError(
            f"the name {shortened(name)} holds {found[0]!r}, which a file's name cannot"
        )
    if name.startswith(".") or name.endswith(".") or _TAKEN_BY_WINDOWS.fullmatch(name):
        raise ValueError(f"no file can be called {shortened(name)} on every system")
    if len(name.encode()) > _LONGEST_NAME:
        raise ValueError(f"the name {shortened(name)} is too long for a file's name")
    return name


def _path(text: str, folder: Path) -> Path:
    return Path(os.path.abspath(folder / Path(text).expanduser()))


def _components(text: str) -> Components:
    try:
        return Components(text.lower().replace("_", " ").replace("-", " "))
    except ValueError:
        known = ", ".join(part.value for part in Components)
        raise ValueError(f"the components {shortened(text)} are none of {known}") from None
