"""IDAV Landmark, Morphologika and the tps programs: one file of numbered points."""

from __future__ import annotations

from pinwarp.io.landmark_formats import morphologika, tps
from pinwarp.io.landmark_formats.writing import numbers_text
from pinwarp.io.semilandmark_formats.points import OutputFile, PointSet

ONLY_ORDER = "The format has no names for landmarks: only their order was kept."


def idav_files(points: PointSet, title: str) -> tuple[list[OutputFile], list[str]]:
    """Return the file of IDAV Landmark; three times 9999 is a point that is missing.

    Examples
    --------
    >>> print(idav_files(PointSet((("a", (1, 2, 3)), ("b", None)), 2), "")[0][0].text, end="")
    Version 1.0
    2
    S000 1.0 2.0 3.0
    S001 9999 9999 9999
    <BLANKLINE>
    """
    del title
    names = {row: f"S{row:03d}" for row in range(points.landmarks)}
    of_groups = {"C": [x.points for x in points.curves], "P": [x.points for x in points.patches]}
    for letter, groups in of_groups.items():
        for number, rows in enumerate(groups):
            names |= {x: f"{letter}{number:03d}-{k:03d}" for k, x in enumerate(rows)}
    lines = ["Version 1.0", str(len(points.places))]
    for row, (_, place) in enumerate(points.places):
        lines.append(f"{names[row]} {numbers_text(place, '9999')}")
    notes = ["Landmarks are called S000, S001 and so on: the format has no other names."]
    if any(set(curve.rows) - set(curve.points) for curve in points.curves):
        notes.append("Landmarks at which curves are anchored are among the single ones only.")
    return [OutputFile(".pts", "\n".join([*lines, "", ""]))], notes


def morphologika_files(points: PointSet, title: str) -> tuple[list[OutputFile], list[str]]:
    """Return the file of Morphologika, curves as its wireframe."""
    rows = [numbers_text(place, "NA") for _, place in points.places]
    wires = [f"{a + 1} {b + 1}" for curve in points.curves for a, b in curve.steps]
    text = morphologika.specimen_text(rows, title, wires)
    return [OutputFile(".morphologika.txt", text)], [ONLY_ORDER]


def tps_text(points: PointSet, title: str) -> str:
    """Return a specimen of the tps programs, every point a landmark."""
    rows = [numbers_text(place, "NA") for _, place in points.places]
    return tps.specimen_text(rows, [], title)


def tps_curves_files(points: PointSet, title: str) -> tuple[list[OutputFile], list[str]]:
    """Return the file of the tps programs that keeps curves as curves.

    Each holds the landmarks it is anchored to; a closed one ends where it begins.
    """
    rows = [numbers_text(place, "NA") for _, place in points.places]
    curves = [
        [rows[row] for row in (*curve.rows, *curve.rows[: int(curve.is_closed)])]
        for curve in points.curves
    ]
    text = tps.specimen_text(rows[: points.landmarks], curves, title)
    notes = [ONLY_ORDER]
    if left := len(points.on_surfaces):
        notes.append(f"The format has no patches: {left:,} points were left out. They are in .tps.")
    return [OutputFile(".curves.tps", text)], notes
