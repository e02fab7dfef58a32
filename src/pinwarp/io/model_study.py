"""The study of a model as a file: bodies with their sessions, and what is kept or turned."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import FileFormatError, NewerFileError
from pinwarp.io.atomic import write_atomically
from pinwarp.io.csv_cells import YES_NO, as_sentence, formula_unquoted, shortened
from pinwarp.io.csv_text import Row, csv_line, rows_of
from pinwarp.io.file_names import with_slashes
from pinwarp.io.text import lines_of, read_text, refuse_binary

VERSION = 1
COLUMNS = ("body", "session", "orientation_rule", "enabled", "note")
KEEP, TURN = "keep", "turn"
_HEADER = re.compile(r"#\s*(?P<key>pinwarp-model|model)\s*:\s*(?P<value>.*?)\s*", re.IGNORECASE)
_MODEL = re.compile(r"(?P<path>.+?)(?:\s+sha256=(?P<sha256>[0-9a-f]*))?", re.IGNORECASE)
_CORRECT = "Correct the line, or write the study again."


@dataclass(frozen=True)
class BodyRow:
    """One body of a study.

    Parameters
    ----------
    body
        Its name, or its path in the model.
    session
        The file of its session, absolute.
    turns
        Whether its frames turn with the bone.
    enabled
        Whether it is warped.
    note
        Free text.
    line
        The line of the file; 0 for a row that was not read.
    """

    body: str
    session: Path
    turns: bool = False
    enabled: bool = True
    note: str = ""
    line: int = 0


@dataclass(frozen=True)
class StudyRecord:
    """Everything that a study's file holds.

    Parameters
    ----------
    model
        The model's file, absolute.
    sha256
        Its hash as it was; empty where it is not said.
    bodies
        In the order of the rows.
    turn, keep
        Paths of frames that turn with their bone, and of elements that are left as they are.
    """

    model: Path
    sha256: str
    bodies: tuple[BodyRow, ...]
    turn: tuple[str, ...] = ()
    keep: tuple[str, ...] = ()


def read_model_study(path: str | Path) -> StudyRecord:
    r"""Read a study.

    Parameters
    ----------
    path
        The file; the paths in it are seen from its folder.

    Returns
    -------
    StudyRecord
        Whether the files are there is not looked at.

    Raises
    ------
    FileFormatError
        When it names no model, a row cannot be used, or a body is there twice; the message names
        the line.

    Examples
    --------
    >>> import tempfile
    >>> text = "# pinwarp-model: 1\n# model: leg.osim\nbody,session\nthigh,thigh.csv\n/p/P2,keep\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "leg.pinwarp-model.csv").write_text(text)
    ...     study = read_model_study(Path(folder, "leg.pinwarp-model.csv"))
    >>> study.model.name, study.bodies[0].session.name, study.keep
    ('leg.osim', 'thigh.csv', ('/p/P2',))
    """
    place = Path(os.path.abspath(path))
    text = read_text(place, "study")
    refuse_binary(place, text)
    lines = lines_of(text)
    model, sha256 = _header(place, lines)
    separator = _separator(lines)
    rows = [
        row
        for row in rows_of(lines, separator)
        if not row.is_blank and not row.text.lstrip().startswith("#")
    ]
    columns = _columns(place, rows)
    bodies: dict[str, BodyRow] = {}
    rules: dict[str, list[str]] = {KEEP: [], TURN: []}
    for row in rows[1:]:
        try:
            if row.problem:
                raise ValueError(row.problem)
            values = [formula_unquoted(cell.strip()) for cell in row.cells]
            cells = dict(zip(columns, values, strict=False))
            name, what = cells.get("body", ""), cells.get("session", "")
            if name.startswith("/") and what.lower() in rules:
                rules[what.lower()].append(name)
                continue
            body = _body(cells, place.parent, row.line)
            if earlier := bodies.get(body.body.rsplit("/", 1)[-1]):
                raise ValueError(
                    f"the body {shortened(body.body)} has a session in line {earlier.line} already"
                )
        except ValueError as error:
            raise FileFormatError(
                place, f"{as_sentence(str(error))} {_CORRECT}", row.line
            ) from None
        bodies[body.body.rsplit("/", 1)[-1]] = body
    return StudyRecord(
        model, sha256, tuple(bodies.values()), tuple(rules[TURN]), tuple(rules[KEEP])
    )


def write_model_study(path: str | Path, study: StudyRecord) -> None:
    """Write a study; reading it gives back the same.

    Parameters
    ----------
    path
        The file, named ``NAME.pinwarp-model.csv`` by custom; paths below its folder are written
        as seen from there.
    study
        What to write.

    Raises
    ------
    OSError
        When the file cannot be written; an older one is untouched.
    """
    folder = Path(os.path.abspath(path)).parent

    def seen(file: Path) -> str:
        try:
            return Path(os.path.relpath(file, folder)).as_posix()
        except ValueError:
            # Another drive on Windows cannot be reached by a relative path.
            return file.as_posix()

    sha256 = f" sha256={study.sha256}" if study.sha256 else ""
    lines = [f"# pinwarp-model: {VERSION}\n", f"# model: {seen(study.model)}{sha256}\n"]
    lines.append(csv_line(COLUMNS))
    for row in study.bodies:
        rule = TURN if row.turns else KEEP
        lines.append(csv_line((row.body, seen(row.session), rule, str(int(row.enabled)), row.note)))
    for rule, paths in ((TURN, study.turn), (KEEP, study.keep)):
        lines += [csv_line((each, rule)) for each in paths]
    write_atomically(path, "".join(lines))


def _header(path: Path, lines: list[str]) -> tuple[Path, str]:
    version, model, sha256 = None, None, ""
    for number, line in enumerate(lines, 1):
        found = _HEADER.fullmatch(line.strip())
        if found is None:
            continue
        value = found["value"]
        if found["key"].lower() == "model":
            named = _MODEL.fullmatch(value)
            if named is None or model is not None:
                raise FileFormatError(path, f"It names its model badly. {_CORRECT}", number)
            model = Path(os.path.abspath(path.parent / with_slashes(named["path"], path.parent)))
            sha256 = named["sha256"] or ""
        elif not value.isascii() or not value.isdigit():
            raise FileFormatError(path, f"It is of no version that is known. {_CORRECT}", number)
        else:
            version = int(value)
            if version > VERSION:
                words = f"It is of version {version}: open it with a newer pinwarp."
                raise NewerFileError(path, words, number)
    if version is None or model is None:
        raise FileFormatError(
            path,
            "This is no study of a model: it begins with '# pinwarp-model: 1' and "
            "'# model: NAME.osim'.",
        )
    return model, sha256


def _separator(lines: list[str]) -> str:
    filled = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    return max(",;\t", key=filled[0].count) if filled else ","


def _columns(path: Path, rows: list[Row]) -> tuple[str, ...]:
    cells = rows[0].cells if rows else ()
    columns = tuple(cell.strip().lower().replace(" ", "_") for cell in cells)
    if not {"body", "session"} <= set(columns):
        raise FileFormatError(
            path,
            f"Its first row names no columns body and session. Write {','.join(COLUMNS)}.",
            rows[0].line if rows else None,
        )
    return columns


def _body(cells: dict[str, str], folder: Path, line: int) -> BodyRow:
    """Make a body of a row, or raise a ValueError with the reason."""
    for column in ("body", "session"):
        if not cells.get(column):
            raise ValueError(f"there is no {column}")
    rule = cells.get("orientation_rule", "").lower() or KEEP
    if rule not in (KEEP, TURN):
        raise ValueError(f"the orientation_rule {shortened(rule)} is neither keep nor turn")
    enabled = YES_NO.get(cells.get("enabled", "").lower())
    if enabled is None:
        raise ValueError(f"enabled is {shortened(cells['enabled'])} and neither 1 nor 0")
    session = Path(os.path.abspath(folder / with_slashes(cells["session"], folder)))
    return BodyRow(cells["body"], session, rule == TURN, enabled, cells.get("note", ""), line)
