"""The manifest of a cohort: a row for each subject, a column for each body of a model."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.io.csv_cells import formula_unquoted, shortened
from pinwarp.io.csv_text import Row
from pinwarp.io.file_names import with_slashes
from pinwarp.io.manifest import checked_name, manifest_rows, subjects_of

MESH = "_mesh"
"""What the column of a body's scan ends in, after the name of the body."""


@dataclass(frozen=True)
class BodyFiles:
    """What a subject has of one body.

    Parameters
    ----------
    body
        Its name.
    landmarks, mesh
        Absolute paths; the mesh is needed only where semilandmarks slide on it.
    """

    body: str
    landmarks: Path
    mesh: Path | None = None

    @property
    def paths(self) -> tuple[Path, Path | None]:
        """Its files."""
        return self.landmarks, self.mesh


@dataclass(frozen=True)
class ModelSubject:
    """One row.

    Parameters
    ----------
    name
        What the subject's model is called.
    line
        The line of the manifest, counted from 1.
    bodies
        Those that it has landmarks of.
    problem
        Why the row cannot be used, as a sentence; empty where it can.
    """

    name: str
    line: int
    bodies: tuple[BodyFiles, ...] = ()
    problem: str = ""


@dataclass(frozen=True)
class ModelManifest:
    """All rows.

    Parameters
    ----------
    path
        The file, absolute.
    subjects
        In the order of the rows.
    bodies
        The names of the bodies that have a column.
    """

    path: Path
    subjects: tuple[ModelSubject, ...]
    bodies: tuple[str, ...]


def read_model_manifest(path: str | Path, bodies: Sequence[str]) -> ModelManifest:
    r"""Read a cohort's manifest: ``name``, and for a body ``femur_r`` and ``femur_r_mesh``.

    Parameters
    ----------
    path
        The file; the paths in it are seen from its folder. In the column of a body stands the
        file of the subject's landmarks; where that is empty the body stays generic.
    bodies
        The names of the bodies that there may be columns for.

    Returns
    -------
    ModelManifest
        A row that cannot be used is a subject with a problem. Whether the files are there is not
        looked at.

    Raises
    ------
    FileFormatError
        When a column is missing, twice or unknown, or a row has no name that is its own; the
        message names the line.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "cohort.csv")
    ...     _ = path.write_text("name,thigh,shank\nanna,anna_thigh.csv,\n")
    ...     (anna,) = read_model_manifest(path, ["hip", "thigh", "shank"]).subjects
    >>> [(files.body, files.landmarks.name) for files in anna.bodies]
    [('thigh', 'anna_thigh.csv')]
    """
    place = Path(os.path.abspath(path))
    rows, _ = manifest_rows(place)
    columns = _columns(place, rows, bodies)
    subjects = subjects_of(
        place,
        rows[1:],
        lambda row: _subject(row, columns, place.parent),
        "the model of one would replace the other's",
    )
    found = tuple(body for body in bodies if body in columns)
    return ModelManifest(place, subjects, found)


def _columns(path: Path, rows: Sequence[Row], bodies: Sequence[str]) -> tuple[str, ...]:
    columns = tuple(cell.strip() for cell in rows[0].cells) if rows else ()
    line = rows[0].line if rows else 1
    known = ("name", *bodies, *(f"{body}{MESH}" for body in bodies))
    words = ""
    if "name" not in columns or not set(columns) & set(bodies):
        words = "The first row names the columns: name, and one for each body."
    elif unknown := [column for column in columns if column and column not in known]:
        words = f"The column {shortened(unknown[0])} is none of a body of the study."
    elif twice := [column for column in columns if column and columns.count(column) > 1]:
        words = f"The column {shortened(twice[0])} is there twice."
    if words:
        raise FileFormatError(path, f"{words} There may be {', '.join(known)}.", line)
    return columns


def _subject(row: Row, columns: Sequence[str], folder: Path) -> ModelSubject:
    """Make a subject of a row, or raise a ValueError where it has no name."""
    if row.problem:
        raise ValueError(row.problem)
    cells = dict(zip(columns, (cell.strip() for cell in row.cells), strict=False))
    name = checked_name(formula_unquoted(cells.get("name", "")))
    if any(cell.strip() for cell in row.cells[len(columns) :]):
        words = f"The row has {len(row.cells)} cells for {len(columns)} columns."
        return ModelSubject(name, row.line, problem=words)
    bodies = []
    for column in columns:
        if column and column != "name" and not column.endswith(MESH) and cells.get(column):
            mesh = cells.get(f"{column}{MESH}")
            bodies.append(
                BodyFiles(
                    column,
                    Path(os.path.abspath(folder / with_slashes(cells[column], folder))),
                    Path(os.path.abspath(folder / with_slashes(mesh, folder))) if mesh else None,
                )
            )
    if not bodies:
        return ModelSubject(name, row.line, problem="There are no landmarks of any body.")
    return ModelSubject(name, row.line, tuple(bodies))
