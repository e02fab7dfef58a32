"""geomorph and Morpho, two packages for R: points, and which of them slide along what."""

from __future__ import annotations

import json

from pinwarp.io.csv_cells import coordinates_text
from pinwarp.io.csv_text import csv_line
from pinwarp.io.semilandmark_formats.morphometrics import ONLY_ORDER, tps_text
from pinwarp.io.semilandmark_formats.points import CurveRows, OutputFile, PointSet, from_one

_MISSING = "{} are missing (NA): estimate them before the superimposition, which refuses them."


def geomorph_files(points: PointSet, title: str) -> tuple[list[OutputFile], list[str]]:
    r"""Return the points for geomorph, and its tables of sliders, rows counted from 1.

    Examples
    --------
    >>> row = [(x, (1.0, 2.0, 3.0)) for x in "abc"]
    >>> points = PointSet(tuple(row), 2, (CurveRows("crest", False, (0, 2, 1), (2,)),))
    >>> [file.text for file in geomorph_files(points, "femur")[0]][1]
    'before,slide,after\n1,3,2\n'
    """
    files = [OutputFile(".tps", tps_text(points, title))]
    if points.curves:
        rows = [tuple(x + 1 for x in row) for curve in points.curves for row in curve.sliders]
        lines = ["before,slide,after", *(f"{a},{b},{c}" for a, b, c in rows), ""]
        files.append(OutputFile(".sliders.csv", "\n".join(lines)))
    if points.patches:
        # As geomorph writes it itself: a column with a title.
        lines = ["x", *(str(x + 1) for x in points.on_surfaces), ""]
        files.append(OutputFile(".surfslide.csv", "\n".join(lines)))
    return files, [ONLY_ORDER, *_fixed_ends(points), *_missing(points)]


def morpho_files(points: PointSet, title: str) -> tuple[list[OutputFile], list[str]]:
    """Return lines of R for Morpho, and the table of points that they read."""
    lines = [
        "# Points of one specimen, and how Morpho may slide them: rows are counted from 1.",
        "# Give each specimen a file of points in this order, and slide3d the array of them.",
        f"points <- as.matrix(read.csv({_quoted(f'{title}.points.csv')}, row.names = 1))",
        f"SMvector <- c({from_one(points.sliding)})",
    ]
    if points.curves:
        outlines = [f"  c({from_one(_outline(curve))})" for curve in points.curves]
        names = ", ".join(one.name for one in points.curves)
        lines += [f"# {' '.join(names.split())}", "outlines <- list(", ",\n".join(outlines), ")"]
    else:
        lines.append("outlines <- NULL")
    surfaces = f"c({from_one(points.on_surfaces)})" if points.patches else "NULL"
    lines += [
        f"surp <- {surfaces}",
        "# slider3d(dat.array, SMvector = SMvector, outlines = outlines, surp = surp, ...)",
        "",
    ]
    table = [csv_line(("name", "x", "y", "z"))]
    for name, place in points.places:
        cells = ("NA",) * 3 if place is None else coordinates_text(place)
        table.append(csv_line((name, *cells)))
    files = [OutputFile(".R", "\n".join(lines)), OutputFile(".points.csv", "".join(table))]
    return files, [*_fixed_ends(points), *_missing(points)]


def _outline(curve: CurveRows) -> tuple[int, ...]:
    # Morpho's outlines have two ends, which stay: of a closed curve they are one.
    return (*curve.rows, curve.rows[0]) if curve.is_closed else curve.rows


def _fixed_ends(points: PointSet) -> list[str]:
    fixed = sum(len(curve.points) - len(curve.sliders) for curve in points.curves)
    if not fixed:
        return []
    verb = "stays" if fixed == 1 else "stay"
    return [f"{fixed} at the ends of curves {verb} fixed: anchor these at landmarks."]


def _missing(points: PointSet) -> list[str]:
    return [_MISSING.format(points.missing)] if points.missing else []


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
