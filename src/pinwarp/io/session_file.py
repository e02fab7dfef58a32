"""The session file: one CSV that a person can read, compare and open in a spreadsheet."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError, LandmarkError
from pinwarp.core.groups import Group
from pinwarp.core.landmarks import Landmark, duplicate_names
from pinwarp.core.settings import USUAL_SETTINGS, WarpSettings
from pinwarp.core.words import counted
from pinwarp.io.atomic import write_atomically
from pinwarp.io.csv_cells import as_sentence, shortened
from pinwarp.io.csv_text import LONGEST_CELL
from pinwarp.io.group_record import SlidRecord, group_lines, group_rows, groups_of
from pinwarp.io.mesh_reference import MeshReference, mesh_text
from pinwarp.io.refinement_record import RefinementRecord, refinement_text
from pinwarp.io.session_header import (
    CORRECT,
    PLAIN,
    RICH,
    VERSION,
    header_line,
    is_header,
    read_header,
    read_values,
)
from pinwarp.io.session_table import Pair, read_table, table_lines
from pinwarp.io.setting_keys import setting_lines
from pinwarp.io.text import lines_of, read_text

__all__ = ["MeshReference", "SessionRecord", "read_session", "write_session"]


@dataclass(frozen=True)
class SessionRecord:
    """Everything a session file holds.

    Parameters
    ----------
    landmarks
        In the order of the table.
    source_mesh, destination_mesh
        The meshes, or None where none was chosen yet.
    settings
        How the warp is solved and applied.
    refinement
        A refined warp, or None; it makes the file one of version 2, too.
    groups
        Curves and patches of semilandmarks; they make the file one of version 2.
    slid
        Where the semilandmarks came to rest, or None.
    unit
        The unit of length, for display.
    unknown
        Header lines this version does not know, as (key, text); a line without a key has
        an empty one.
    """

    landmarks: tuple[Landmark, ...] = ()
    source_mesh: MeshReference | None = None
    destination_mesh: MeshReference | None = None
    settings: WarpSettings = USUAL_SETTINGS
    refinement: RefinementRecord | None = None
    groups: tuple[Group, ...] = ()
    slid: SlidRecord | None = None
    unit: str = "mm"
    unknown: tuple[tuple[str, str], ...] = ()


def write_session(path: str | Path, record: SessionRecord, *, relative_meshes: bool = True) -> None:
    """Write a session file; reading it gives back the same record exactly.

    Parameters
    ----------
    path
        The file, named ``NAME.pinwarp.csv`` by custom.
    record
        What to write.
    relative_meshes
        Whether mesh paths are written as seen from the file's folder, where possible, so that
        they can move together.

    Raises
    ------
    LandmarkError
        When two landmarks have one name, or a name or note is longer than 100,000 characters:
        it could not be read back.
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "femur.pinwarp.csv")
    ...     write_session(path, SessionRecord((Landmark("fovea", source=(1, 2, 3)),)))
    ...     print(path.read_text().splitlines()[-1])
    fovea,pair,1,1.0,2.0,3.0,,,,
    """
    if repeated := duplicate_names(record.landmarks):
        raise LandmarkError(f"Two landmarks are called {repeated[0]!r}. Rename one of them.")
    for landmark in record.landmarks:
        if len(landmark.note) > LONGEST_CELL or len(landmark.name) > LONGEST_CELL:
            raise LandmarkError(
                f"The name or note of {shortened(landmark.name)} is too long to be read back. "
                f"Shorten it to {LONGEST_CELL:,} characters."
            )
    folder = Path(os.path.abspath(path)).parent if relative_meshes else None
    write_atomically(path, session_text(record, folder))


def session_text(record: SessionRecord, folder: Path | None = None) -> str:
    r"""Return all that a session file says.

    Parameters
    ----------
    record
        What it holds.
    folder
        Where it will be: meshes are named as seen from there; without one they are absolute.

    Examples
    --------
    >>> session_text(SessionRecord()).splitlines()[0]
    '# pinwarp-session: 1'
    """
    refined = record.refinement
    version = PLAIN if refined is None and not record.groups else RICH
    if record.settings.basis is not USUAL_SETTINGS.basis:
        # Who does not know the basis must not warp with another.
        version = VERSION
    header = [("pinwarp-session", str(version))]
    for key, mesh in (
        ("source_mesh", record.source_mesh),
        ("destination_mesh", record.destination_mesh),
    ):
        if mesh is not None:
            header.append((key, mesh_text(mesh, folder)))
            if mesh.mirrored:
                header.append((key.replace("mesh", "mirrored"), mesh.mirrored))
            if mesh.scaled != 1:
                header.append((key.replace("mesh", "scaled"), repr(float(mesh.scaled))))
    header += setting_lines(record.settings, always=True)
    header.append(("unit", record.unit))
    header += setting_lines(record.settings, always=False)
    header += group_lines(record.groups, record.slid)
    fitted: list[Pair] = []
    if refined is not None:
        header.append(("refine", refinement_text(refined)))
        fitted = list(zip(refined.source, refined.destination, strict=True))
    # Every header entry stays on its line, whatever it says.
    entries = [" ".join(f"# {key}: {text}".splitlines()).rstrip() for key, text in header]
    entries += [f"# {key}: {text}" if key else f"# {text}" for key, text in record.unknown]
    # Just above the table: a file that is cut off between two rows of it looks whole.
    entries.append(f"# landmarks: {len(record.landmarks)}")
    lines = [header_line(entry) for entry in entries]
    lines += table_lines(record.landmarks, fitted, group_rows(record.groups, record.slid))
    return "".join(lines)


def read_session(path: str | Path) -> SessionRecord:
    """Read a session file, also one that a spreadsheet has saved again.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    SessionRecord
        The whole of it; a session is never read in part.

    Raises
    ------
    NewerFileError
        When a newer pinwarp wrote it.
    FileFormatError
        When anything in it cannot be read; the message names the line.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "femur.pinwarp.csv")
    ...     write_session(path, SessionRecord(settings=WarpSettings(0.0042)))
    ...     read_session(path).settings.penalty
    0.0042
    """
    lines = lines_of(read_text(path, "session"))
    top = next((n for n, line in enumerate(lines) if not is_header(line)), len(lines))
    separator = max(",;\t", key=lines[top].count) if top < len(lines) else ","
    known, unknown = read_values(path, read_header(path, lines[:top], separator))
    landmarks, fitted, rows = read_table(path, lines[top:], top + 1, separator)
    announced = known.pop("announced", 0)
    # Rows that somebody added are welcome.
    if len(landmarks) < announced:
        raise FileFormatError(
            path,
            f"It announces {counted(announced, 'landmark')} and holds {len(landmarks)}: was it cut "
            f"off? {CORRECT} If rows were taken out on purpose, correct '# landmarks: "
            f"{announced}'.",
            len(lines),
        )
    try:
        groups, slid = groups_of(known.pop("groups", ()), rows)
    except ValueError as error:
        raise FileFormatError(path, f"{as_sentence(str(error))} {CORRECT}") from None
    refinement = known.pop("refinement", None)
    if (refinement is None) != (not fitted):
        lost = "the line '# refine: ...' is" if refinement is None else "what it fitted is"
        raise FileFormatError(path, f"The session was refined, but {lost} missing. {CORRECT}")
    if refinement is not None:
        source, destination = zip(*fitted, strict=True)
        refinement = replace(refinement, source=source, destination=destination)
    return SessionRecord(
        landmarks=landmarks,
        groups=groups,
        refinement=refinement,
        slid=slid,
        unknown=unknown,
        **known,
    )
