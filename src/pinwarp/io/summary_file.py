"""The table of a batch's results: one row for each subject, to be opened in a spreadsheet."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.io.atomic import write_atomically
from pinwarp.io.csv_cells import formula_unquoted, numeral
from pinwarp.io.csv_text import csv_line, rows_of
from pinwarp.io.text import lines_of, read_text

SummaryRow = Mapping[str, str]

NUMBERS = (
    "pairs",
    "penalty",
    "rms_residual",
    "rms_leave_one_out",
    "suggested_penalty",
    "flexibility",
    "folded_vertices",
    "distance_mean",
    "distance_95",
    "distance_max",
    "fitted",
    "freed",
    "suggested",
    "misfit",
    "other_hand",
    "other_pose",
)
COLUMNS = (
    "name",
    "status",
    "verdict",
    *NUMBERS,
    "frame_or_unit",
    "findings",
    "notes",
    "error",
    "seconds",
    "made_from",
)


def write_summary(path: str | Path, rows: Iterable[SummaryRow]) -> None:
    r"""Write the table, all of it or nothing.

    Parameters
    ----------
    path
        The file.
    rows
        Cells by column; a column that is not there is empty. Text that a spreadsheet would run
        as a formula is quoted.

    Raises
    ------
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "summary.csv")
    ...     write_summary(path, [{"name": "=1+1", "status": "done"}])
    ...     path.read_text().splitlines()[1][:11], read_summary(path)["=1+1"]["status"]
    ("'=1+1,done,", 'done')
    """
    lines = [csv_line(COLUMNS)]
    for row in rows:
        cells = ((column, " ".join(row.get(column, "").split())) for column in COLUMNS)
        lines.append(csv_line(numeral(x) if column in NUMBERS else x for column, x in cells))
    write_atomically(path, "".join(lines))


def read_summary(path: str | Path) -> dict[str, SummaryRow]:
    """Read the rows by name, also where a spreadsheet has saved the table again.

    Returns
    -------
    dict
        Empty where there is no such file, or it is no summary.

    Examples
    --------
    >>> read_summary("there is none.csv")
    {}
    """
    try:
        lines = lines_of(read_text(path, "summary"))
    except FileFormatError:
        return {}
    separator = max(",;\t", key=lines[0].count)
    first, *rows = rows_of(lines, separator)
    found: dict[str, SummaryRow] = {}
    for row in rows:
        cells = dict(zip(first.cells, map(formula_unquoted, row.cells), strict=False))
        if cells.get("name"):
            found[cells["name"]] = cells
    return found
