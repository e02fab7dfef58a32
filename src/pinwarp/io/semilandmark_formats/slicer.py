"""3D Slicer's markups: a file for the landmarks, one for each curve, one for each patch."""

from __future__ import annotations

from pinwarp.io.file_names import as_file_name
from pinwarp.io.landmark_formats.slicer_json import markup_text
from pinwarp.io.semilandmark_formats.points import OutputFile, PointSet


def slicer_files(points: PointSet, title: str) -> tuple[list[OutputFile], list[str]]:
    """Return the markups, positions in millimetres.

    Points of a curve are its control points, in order, landmarks that it is anchored to among
    them: they have the labels of these, so that the curve finds them again.

    Raises
    ------
    LandmarkError
        When the unit is none that can be converted.
    """
    del title
    points = points.in_millimetres()
    lists: list[tuple[str, str, tuple[int, ...]]] = [
        ("", "Fiducial", tuple(range(points.landmarks)))
    ]
    lists += [
        (curve.name, "ClosedCurve" if curve.is_closed else "Curve", curve.rows)
        for curve in points.curves
    ]
    lists += [(patch.name, "Fiducial", patch.points) for patch in points.patches]
    files: list[OutputFile] = []
    taken: set[str] = set()
    for name, kind, rows in lists:
        stem = suffix = f".{as_file_name(name)}" if name else ""
        number = 2
        while suffix.casefold() in taken:
            suffix, number = f"{stem}_{number}", number + 1
        taken.add(suffix.casefold())
        text = markup_text([points.places[row] for row in rows], kind, name)
        files.append(OutputFile(f"{suffix}.mrk.json", text))
    return files, []
