"""Legacy VTK files (.vtk), ASCII and binary, up to version 5.1.

Not VTK's reader: a file that was cut off in the wrong place crashes the whole program.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.words import counted
from pinwarp.io.mesh_formats.numbers import numbers_of
from pinwarp.io.mesh_formats.surface import (
    BrokenMeshError,
    Report,
    Surface,
    cut_strips,
)
from pinwarp.io.mesh_formats.vtk_cells import faces_of_cells
from pinwarp.io.text import narrow, with_lf

_TYPES = {
    "float": ">f4",
    "double": ">f8",
    "char": ">i1",
    "unsigned_char": ">u1",
    "short": ">i2",
    "unsigned_short": ">u2",
    "int": ">i4",
    "unsigned_int": ">u4",
    "long": ">i8",
    "unsigned_long": ">u8",
    "vtkidtype": ">i4",
    "vtktypeint32": ">i4",
    "vtktypeint64": ">i8",
}
_OPENING = re.compile(
    rb"\s*# vtk DataFile Version (\d+)\.\d+"
    + 2 * rb"[^\r\n]*(?:\r\n|\n|\r)"
    + rb"\s*(ASCII|BINARY)\s",
    re.I,
)
_KEYWORDS = rb"POINTS|VERTICES|LINES|POLYGONS|TRIANGLE_STRIPS|CELLS|CELL_TYPES|POINT_DATA|CELL_DATA"
_OTHER_KINDS = {
    "STRUCTURED_POINTS": "an image volume",
    "STRUCTURED_GRID": "a structured grid",
    "RECTILINEAR_GRID": "a rectilinear grid",
    "FIELD": "a table",
}
_NEXT = re.compile(
    rb"^[ \t]*(?:" + _KEYWORDS + rb"|METADATA|FIELD|OFFSETS|CONNECTIVITY)\b", re.MULTILINE | re.I
)
_CHUNK = 1 << 20
_NONE = np.empty(0, dtype=np.int64)


@dataclass
class _File:
    """The file and how far it was read."""

    data: bytes
    is_text: bool
    place: int
    report: Report = field(repr=False)

    def words(self) -> list[str]:
        """Return the words of the next line that is not blank; none at the end of the file."""
        while self.place < len(self.data):
            end = self.data.find(b"\n", self.place)
            end = len(self.data) if end < 0 else end
            words = self.data[self.place : min(end, self.place + 1000)].decode("latin-1").split()
            self.place = end + 1
            if words:
                return words
        return []

    def array(self, count: int, kind: str) -> NDArray[np.generic]:
        """Return the next numbers."""
        if kind.lower() not in _TYPES:
            raise BrokenMeshError(f"Numbers of the type {kind[:40]!r} cannot be read.")
        dtype = np.dtype(_TYPES[kind.lower()])
        if self.is_text:
            return self._text_array(count, dtype)
        if count * dtype.itemsize > len(self.data) - self.place:
            raise cut_off()
        found = np.frombuffer(self.data, dtype, count, self.place)
        self.place += found.nbytes
        return found

    def _text_array(self, count: int, dtype: np.dtype[np.generic]) -> NDArray[np.generic]:
        following = _NEXT.search(self.data, self.place)
        end = following.start() if following else len(self.data)
        parts = []
        while self.place < end:
            stop = self.data.find(b"\n", self.place + _CHUNK, end)
            stop = end if stop < 0 else stop
            text = self.data[self.place : stop]
            try:
                parts.append(numbers_of(text.split(), dtype))
            except (ValueError, OverflowError) as error:
                raise BrokenMeshError(f"Numbers were expected: {error}. Export it again.") from None
            self.place = stop
            self.report(stop / len(self.data))
        found = np.concatenate([np.empty(0, dtype), *parts])
        if len(found) != count:
            raise cut_off()
        return found


def cut_off() -> BrokenMeshError:
    """Return the complaint about announced numbers that are not there."""
    return BrokenMeshError(
        "The file does not hold as many numbers as it announces: it was cut off or is damaged. "
        "Export or copy it again."
    )


def read_legacy_vtk(data: bytes, report: Report) -> Surface:
    r"""Read a surface or an unstructured grid with faces; data arrays are left out.

    Parameters
    ----------
    data
        The bytes of the file.
    report
        Told the share that is done.

    Returns
    -------
    Surface
        In the precision of the file.

    Raises
    ------
    BrokenMeshError
        When the file was cut off, holds no surface, or is not a VTK file.

    Examples
    --------
    >>> text = "# vtk DataFile Version 3.0\nbone\nASCII\nDATASET POLYDATA\n"
    >>> text += "POINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n"
    >>> read_legacy_vtk(text.encode(), lambda share: None).corners.tolist()
    [0, 1, 2]
    """
    data = narrow(data)
    opening = _OPENING.match(data)
    if opening is None:
        raise BrokenMeshError("This is not a VTK file. Export the mesh again.")
    is_new = int(opening[1]) >= 5
    is_text = opening[2].upper() == b"ASCII"
    if is_text:
        data = with_lf(data)
        opening = _OPENING.match(data)
        assert opening is not None, "it has the same words"
    file = _File(data, is_text, opening.end(), report)
    points = np.empty((0, 3))
    cells = dict.fromkeys(("POLYGONS", "TRIANGLE_STRIPS", "LINES", "CELLS"), (_NONE, _NONE))
    kinds = _NONE
    while words := file.words():
        match [words[0].upper(), *words[1:]]:
            case ["DATASET", kind, *_]:
                if kind.upper() not in ("POLYDATA", "UNSTRUCTURED_GRID"):
                    what = _OTHER_KINDS.get(kind.upper(), f"data of the kind {kind[:40]!r}")
                    raise BrokenMeshError(
                        f"The file holds {what} and not a surface. "
                        "Extract the surface and save it as PolyData."
                    )
            case ["POINTS", count, kind]:
                points = file.array(3 * _number(count), kind).reshape(-1, 3).astype(np.float64)
            case [
                "VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS" | "CELLS" as name,
                first,
                second,
            ]:
                read = _new_cells if is_new else _old_cells
                cells[name] = read(file, _number(first), _number(second))
            case ["CELL_TYPES", count]:
                kinds = file.array(_number(count), "int").astype(np.int64)
            case ["METADATA"]:
                # Ends at a blank line.
                end = re.compile(rb"\n[ \t\r]*\n").search(data, max(file.place - 1, 0))
                file.place = end.end() if end else len(data)
            case ["FIELD", _, count]:
                _skip_fields(file, _number(count))
            case ["POINT_DATA" | "CELL_DATA", *_]:
                break
            case _:
                raise BrokenMeshError(
                    f"The line {' '.join(words)[:40]!r} was not expected: the file is damaged. "
                    "Export the mesh again."
                )
    report(1.0)
    corners, sizes = cells["POLYGONS"]
    strips = cut_strips(*cells["TRIANGLE_STRIPS"])
    faces, face_sizes, notes = faces_of_cells(kinds, *cells["CELLS"])
    lines = len(cells["LINES"][1])
    return Surface(
        points,
        np.concatenate([corners, strips.ravel(), faces]),
        np.concatenate([sizes, np.full(len(strips), 3, dtype=np.int64), face_sizes]),
        (*((f"{counted(lines, 'line')} dropped.",) if lines else ()), *notes),
    )


def _number(text: str) -> int:
    if not re.fullmatch(r"[0-9]{1,12}", text):
        raise BrokenMeshError(f"{text[:40]!r} is not a count: the file is damaged.")
    return int(text)


def _new_cells(
    file: _File, offsets: int, corners: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Read cells of version 5: where each ends, then all corners."""
    found = {}
    for name, count in (("OFFSETS", offsets), ("CONNECTIVITY", corners)):
        match file.words():
            case [word, kind] if word.upper() == name:
                found[name] = file.array(count, kind).astype(np.int64)
            case _:
                raise cut_off()
    sizes = np.diff(found["OFFSETS"])
    if (sizes < 0).any() or sizes.sum() != corners:
        raise cut_off()
    return found["CONNECTIVITY"], sizes


def _old_cells(file: _File, cells: int, size: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Read cells of versions before 5: each is its number of corners, then the corners."""
    numbers = file.array(size, "int").astype(np.int64)
    if cells and size == 4 * cells and (numbers[::4] == 3).all():
        return numbers.reshape(-1, 4)[:, 1:].ravel(), np.full(cells, 3, dtype=np.int64)
    places = []
    place = 0
    for _ in range(cells):
        if place >= size or numbers[place] < 0:
            raise cut_off()
        places.append(place)
        place += 1 + int(numbers[place])
    if place != size:
        raise cut_off()
    return np.delete(numbers, places), numbers[places]


def _skip_fields(file: _File, count: int) -> None:
    for _ in range(count):
        if file.is_text:
            following = _NEXT.search(file.data, file.place)
            file.place = following.start() if following else len(file.data)
            return
        match file.words():
            case [_, components, rows, kind]:
                file.array(_number(components) * _number(rows), kind)
            case _:
                raise cut_off()
