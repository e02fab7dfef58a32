"""The manifest of a batch: a table with one row for each subject."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar

from pinwarp.core.components import Components
from pinwarp.core.errors import FileFormatError
from pinwarp.core.names import visible
from pinwarp.io.csv_cells import as_sentence, formula_unquoted, shortened
from pinwarp.io.csv_text import Row, rows_of
from pinwarp.io.file_names import with_slashes
from pinwarp.io.setting_keys import penalty_of
from pinwarp.io.text import lines_of, read_text, refuse_binary


class Named(Protocol):
    """A subject, whatever else is known of it."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def line(self) -> int:
        """The line of the manifest, counted from 1."""


S = TypeVar("S", bound=Named)

REQUIRED = ("name", "destination_landmarks")
OPTIONAL = ("destination_mesh", "penalty", "components")
_COLUMNS = (*REQUIRED, *OPTIONAL)

# Windows and macOS refuse some of these, and a folder in a name would leave the output folder.
_NOT_IN_A_NAME = re.compile(r'[\x00-\x1f\x7f/\\:*?"<>|]')
_TAKEN_BY_WINDOWS = re.compile(
    r"(con(in\$|out\$)?|prn|aux|nul|(com|lpt)[\d¹²³])\s*(\..*)?", re.IGNORECASE
)
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
        Absolute paths; there need not be a mesh, nor landmarks where they are to be suggested.
    penalty, components
        For this subject alone; None where the row leaves them open.
    problem
        Why the row cannot be used, as a sentence; empty where it can.
    """

    name: str
    line: int
    destination_landmarks: Path | None
    destination_mesh: Path | None = None
    penalty: float | None = None
    components: Components | None = None
    problem: str = ""


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


def read_manifest(path: str | Path, *, suggested: bool = False) -> Manifest:
    r"""Read a manifest: columns ``name, destination_landmarks`` and some more, in any order.

    Parameters
    ----------
    path
        The file; the paths in it are seen from its folder. ``destination_mesh``, ``penalty`` and
        ``components`` may be missing or empty.
    suggested
        Whether ``destination_landmarks`` may be so, too: where it is they are to be suggested on
        the ``destination_mesh``.

    Returns
    -------
    Manifest

    Raises
    ------
    FileFormatError
        When a column is missing, or a row has no name that is its own; the message names the
        line. Another row that cannot be used is a subject with a problem, and the others go on.
        Whether the files are there is not looked at.

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
    rows, separator = manifest_rows(place)
    required = REQUIRED[:1] if suggested else REQUIRED
    columns = _columns(place, rows, required)
    subjects = subjects_of(
        place,
        rows[1:],
        lambda row: _subject(row, columns, separator, place, required),
        "the files of one would replace the other's",
    )
    unused = tuple(column for column in columns if column and column not in _COLUMNS)
    return Manifest(place, subjects, unused)


def manifest_rows(path: Path) -> tuple[list[Row], str]:
    """Read the rows of a manifest, that of its columns first; remarks and blanks are no rows.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    rows : list of Row
    separator : str
        What is between the cells.
    """
    text = read_text(path, "manifest")
    refuse_binary(path, text)
    lines = lines_of(text)
    filled = [line for line in lines if line.strip() and not line.startswith("#")]
    # No column's name has any of these in it.
    separator = max(",;\t", key=filled[0].count) if filled else ","
    rows = [
        row
        for row in rows_of(lines, separator)
        if not row.is_blank and not row.text.startswith("#")
    ]
    return rows, separator


def subjects_of(
    path: Path, rows: Sequence[Row], subject_of: Callable[[Row], S], harm: str
) -> tuple[S, ...]:
    """Make a subject of each row, every one with a name of its own.

    Parameters
    ----------
    path
        The manifest, for messages.
    rows
        Without that of the columns.
    subject_of
        Makes one, or raises a ValueError where the row has no name.
    harm
        What two subjects of one name would do to one another.

    Raises
    ------
    FileFormatError
        When a row has no name that is its own, or there is none; the message names the line.
    """
    subjects: dict[str, S] = {}
    for row in rows:
        try:
            subject = subject_of(row)
            # Some systems take two names for one whose letters are composed in other ways.
            look = visible(subject.name).casefold()
            if earlier := subjects.get(look):
                raise ValueError(
                    f"the name {shortened(subject.name)} was used in line {earlier.line}"
                    f"{_unlike(subject.name, earlier.name)}: {harm}"
                )
        except ValueError as error:
            raise FileFormatError(path, as_sentence(str(error)), row.line) from None
        subjects[look] = subject
    if not subjects:
        raise FileFormatError(path, "There is no subject in it: write one row for each.")
    return tuple(subjects.values())


def _unlike(name: str, other: str) -> str:
    """Say that two names only look alike, where it is so."""
    return "" if name.casefold() == other.casefold() else " in letters that look the same"


def _columns(path: Path, rows: Sequence[Row], required: Sequence[str]) -> tuple[str, ...]:
    cells = rows[0].cells if rows else ()
    columns = tuple(cell.strip().lower().replace(" ", "_") for cell in cells)
    line = rows[0].line if rows else 1
    if missing := [column for column in required if column not in columns]:
        raise FileFormatError(
            path,
            f"The column {missing[0]!r} is missing. The first row names the columns: "
            f"{', '.join(required)} and, where wanted, "
            f"{', '.join(column for column in _COLUMNS if column not in required)}.",
            line,
        )
    for column in _COLUMNS:
        if columns.count(column) > 1:
            raise FileFormatError(path, f"The column {column!r} is there twice.", line)
    return columns


def _subject(
    row: Row, columns: Sequence[str], separator: str, manifest: Path, required: Sequence[str]
) -> Subject:
    """Make a subject of one row, or raise a ValueError where it has no name."""
    if row.problem:
        raise ValueError(row.problem)
    cells = dict(zip(columns, (cell.strip() for cell in row.cells), strict=False))
    name = checked_name(formula_unquoted(cells.get("name", "")))
    try:
        if any(cell.strip() for cell in row.cells[len(columns) :]):
            raise ValueError(f"the row has {len(row.cells)} cells for {len(columns)} columns")
        for column in required[1:]:
            if not cells.get(column):
                raise ValueError(f"there is no {column}: write it, or add --suggest")
        values = {
            column: _value(column, cells.get(column, ""), separator, manifest.parent)
            for column in _COLUMNS[1:]
        }
        if values["destination_landmarks"] is None and values["destination_mesh"] is None:
            raise ValueError("there is no destination_mesh to suggest landmarks on")
    except ValueError as error:
        return Subject(name, row.line, manifest, problem=as_sentence(str(error)))
    return Subject(name, row.line, **values)


def _value(column: str, text: str, separator: str, folder: Path) -> Any:
    """Read a cell, or raise a ValueError with the reason, which names the column."""
    if not text:
        return None
    try:
        match column:
            case "penalty":
                return penalty_of(text, separator)
            case "components":
                return _components(text)
            case _:
                return _path(text, folder)
    except ValueError as error:
        raise ValueError(f"in the column {column!r}: {error}") from None


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
    try:
        return Path(os.path.abspath(folder / Path(with_slashes(text, folder)).expanduser()))
    except RuntimeError:
        raise ValueError(f"there is no user {shortened(Path(text).parts[0])}") from None


def _components(text: str) -> Components:
    try:
        return Components(text.lower().replace("_", " ").replace("-", " "))
    except ValueError:
        known = ", ".join(part.value for part in Components)
        raise ValueError(f"{shortened(text)} is none of {known}") from None
