"""STL, binary and ASCII.

Not VTK's reader: it takes whatever bytes there are, so that a file which was cut off becomes
half a bone without a word. Not trimesh's: what was cut off, or ends as other programs end it,
is an empty mesh there, and text takes three times the memory.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.mesh import Mesh
from pinwarp.core.words import counted
from pinwarp.io.mesh_formats.numbers import numbers_of
from pinwarp.io.mesh_formats.surface import (
    BrokenMeshError,
    Report,
    Surface,
    are_few,
    merge_equal,
)
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData
from pinwarp.io.text import narrow, stretches_of

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
# For text in small letters: to disregard case takes three times as long.
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")
_FACET_END = re.compile(rb"end[ \t]*facet")
_SOLID_END = re.compile(rb"end[ \t]*solid")
# A name may be any words, "vertex" among them; it ends where the first facet begins.
_NAME = re.compile(
    rb"^[ \t]*(?:end[ \t]*)?solid\b[^\n]*?(?=\bfacet[ \t]+normal\b|$)|^[ \t]*(?:#|//|;)[^\n]*", re.M
)
_WITH_NAMES = (b"solid", b"#", b"//", b";")
_TEXT = re.compile(rb"^\s*(?:solid|facet)\b", re.I | re.M)
_LOOKED_AT = 4096
_TAIL = 1 << 20


def read_stl(data: bytes, report: Report) -> Surface:
    """Read a binary or ASCII STL file, merging corners at exactly the same place.

    Parameters
    ----------
    data
        The bytes of the file.
    report
        Told the share that is done.

    Returns
    -------
    Surface
        One triangle per facet.

    Raises
    ------
    BrokenMeshError
        When the file was cut off, or is not STL.

    Examples
    --------
    >>> loop = "outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop"
    >>> text = f"solid bone facet normal 0 0 1 {loop} endfacet endsolid"
    >>> read_stl(text.encode(), lambda share: None).points.shape
    (3, 3)
    """
    if _is_binary(data):
        places, notes = _read_binary(data)
    else:
        text = narrow(data)
        places, notes = (_read_text if _is_text(text) else _read_binary)(text, report)
    report(0.4)
    # A corner that is not a number cannot be merged; -0.0 and 0.0 are one place.
    whole: NDArray[np.bool_] = np.logical_and.reduce(np.isfinite(places).reshape(-1, 9), axis=1)
    if not whole.all():
        broken = np.flatnonzero(~whole)
        if not are_few(len(broken), len(whole)):
            raise BrokenMeshError(
                f"Facet {int(broken[0]) + 1:,} has a coordinate that is not a finite number. "
                "Repair the mesh in the program it came from."
            )
        places = places.reshape(-1, 9)[whole].reshape(-1, 3)
        notes += (f"{counted(len(broken), 'facet')} without a finite position dropped.",)
    points, corners = merge_equal(places + 0.0)
    report(1.0)
    return Surface(points, corners, np.full(len(corners) // 3, 3, dtype=np.int64), notes)


def _is_binary(data: bytes) -> bool:
    """Whether the file is as long as its count says; some such begin with "solid" as well."""
    return len(data) >= _HEADER and len(data) == _HEADER + 50 * _announced(data)


def _announced(data: bytes) -> int:
    return int(struct.unpack_from("<I", data, 80)[0])


def _is_text(data: bytes) -> bool:
    # The count of a binary file has a zero in it.
    # Text may have some behind its end.
    return b"\0" not in data[:512].rstrip(b"\0") and _TEXT.search(data[:_LOOKED_AT]) is not None


def _read_binary(
    data: bytes, _report: Report | None = None
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    if len(data) < _HEADER:
        raise BrokenMeshError(
            "The file is too short to be an STL file: it was cut off or is something else. "
            "Export it again."
        )
    announced = _announced(data)
    room, rest = divmod(len(data) - _HEADER, _RECORD.itemsize)
    notes: tuple[str, ...] = ()
    if announced == 0 and room and not rest:
        # Exporters that cannot seek back leave the count at zero.
        found = counted(room, "triangle")
        notes = (f"The header announces no triangles; {found} found and read.",)
        announced = room
    if announced > room:
        if b"\0" not in data[:512]:
            raise BrokenMeshError("This is not an STL file. Export the bone as a triangle surface.")
        raise BrokenMeshError(
            f"The header announces {counted(announced, 'triangle')}, but the file ends after "
            f"{room:,}: it was cut off, or is not an STL file. Export or copy it again."
        )
    left_over = len(data) - _HEADER - announced * _RECORD.itemsize
    if left_over:
        notes += (f"{counted(left_over, 'byte')} after the last triangle ignored.",)
    records = np.frombuffer(data, dtype=_RECORD, count=announced, offset=_HEADER)
    return records["corners"].reshape(-1, 3).astype(np.float64), notes


def _read_text(data: bytes, report: Report) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    parts = [np.empty((0, 3))]
    facets = 0
    for lines in stretches_of(data):
        text = _without_names(lines.data)
        found = _VERTEX.findall(text)
        try:
            parts.append(_numbers(found).reshape(-1, 3))
        except ValueError as error:
            line = lines.first + text.count(b"\n", 0, _first_bad_vertex(text))
            raise BrokenMeshError(
                "A vertex needs three numbers. Repair this line or export the mesh again.", line
            ) from error
        facets += len(_FACET_END.findall(text))
        report(0.3 * lines.share)
    places = np.concatenate(parts)
    # What stands behind the last facet tells whether the file is all there.
    tail = data[-_TAIL:].replace(b"\r", b"\n").lower()
    rest = tail[max((match.end() for match in _FACET_END.finditer(tail)), default=0) :]
    is_ended = _SOLID_END.search(rest) is not None
    if not is_ended and _without_names(rest).strip():
        raise BrokenMeshError(
            f"The file ends after {counted(facets, 'facet')} without 'endsolid': it was cut off. "
            "Export or copy it again."
        )
    if len(places) != 3 * facets:
        raise BrokenMeshError(
            f"{counted(facets, 'facet')} should have three vertices each, but there are "
            f"{len(places):,} vertices. Export the mesh again."
        )
    note = "The file ends without 'endsolid': look whether a part of the bone is missing."
    return places, () if is_ended else (note,)


def _without_names(text: bytes) -> bytes:
    """Return the text in small letters, without names and comments."""
    small = text.lower()
    return _NAME.sub(b"", small) if any(word in small for word in _WITH_NAMES) else small


def _numbers(found: Sequence[Sequence[bytes]]) -> NDArray[np.float64]:
    words = list(chain.from_iterable(found))
    return numbers_of(words).astype(np.float64, copy=False)


def _first_bad_vertex(text: bytes) -> int:
    for match in _VERTEX.finditer(text):
        try:
            _numbers([match.groups()])
        except ValueError:
            return match.start()
    return 0


def write_stl(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write a binary STL file; its numbers have single precision, the format knows no other.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh; its triangles get normals of their own.
    extras
        The first of its remarks; there is no room for anything else.

    Raises
    ------
    BrokenMeshError
        When a coordinate is too large for single precision.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_stl(Path(folder, "a.stl"), Mesh(np.eye(3), [[0, 1, 2]]))
    ...     Path(folder, "a.stl").stat().st_size
    134
    """
    if np.abs(mesh.vertices).max() > np.finfo(np.float32).max:
        raise BrokenMeshError(
            "The coordinates are too large for STL, which has single precision. "
            "Save as PLY, OBJ or VTP instead."
        )
    records = np.zeros(len(mesh.faces), dtype=_RECORD)
    records["corners"] = mesh.vertices[mesh.faces]
    a, b, c = np.moveaxis(records["corners"].astype(np.float64), 1, 0)
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    records["normal"] = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    with path.open("wb") as file:
        # A header that begins with "solid" would be taken for text.
        head = (*extras.plain_remarks, "pinwarp")[0].removeprefix("solid").encode()
        file.write(head[:80].ljust(80) + struct.pack("<I", len(records)))
        file.write(records.tobytes())
