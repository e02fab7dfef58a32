"""STL, binary and ASCII.

Not VTK's reader: it takes whatever bytes there are, so that a file which was cut off becomes
half a bone without a word.
"""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.mesh import Mesh
from pinwarp.core.words import counted
from pinwarp.io.mesh_formats.surface import (
    BrokenMeshError,
    Report,
    Surface,
    merge_equal,
)
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)
_FACET_END = re.compile(rb"endfacet", re.IGNORECASE)
_CHUNK = 1 << 20


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
    notes: tuple[str, ...] = ()
    if _is_text(data):
        places = _read_text(data, report)
    else:
        places, notes = _read_binary(data)
    report(0.4)
    # A corner that is not a number cannot be merged; -0.0 and 0.0 are one place.
    if not np.isfinite(places).all():
        facet = int(np.flatnonzero(~np.isfinite(places).all(axis=1))[0]) // 3
        raise BrokenMeshError(
            f"Facet {facet + 1} has a coordinate that is not a finite number. "
            "Repair the mesh in the program it came from."
        )
    points, corners = merge_equal(places + 0.0)
    report(1.0)
    return Surface(points, corners, np.full(len(corners) // 3, 3, dtype=np.int64), notes)


def _is_text(data: bytes) -> bool:
    if data.lstrip()[:5].lower() != b"solid":
        return False
    # Some exporters start the header of a binary file with "solid" as well.
    if len(data) >= _HEADER and len(data) == _HEADER + 50 * struct.unpack_from("<I", data, 80)[0]:
        return False
    return b"\0" not in data[:512]


def _read_binary(data: bytes) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    if len(data) < _HEADER:
        raise BrokenMeshError(
            "The file is too short to be an STL file: it was cut off or is something else. "
            "Export it again."
        )
    announced = int(struct.unpack_from("<I", data, 80)[0])
    room, rest = divmod(len(data) - _HEADER, _RECORD.itemsize)
    notes: tuple[str, ...] = ()
    if announced == 0 and room and not rest:
        # Exporters that cannot seek back leave the count at zero.
        notes = (f"The header announces no triangles; all {room:,} found were read.",)
        announced = room
    if announced > room:
        raise BrokenMeshError(
            f"The header announces {counted(announced, 'triangle')}, but the file ends after "
            f"{room:,}: it was cut off, or is not an STL file. Export or copy it again."
        )
    left_over = len(data) - _HEADER - announced * _RECORD.itemsize
    if left_over:
        notes += (f"{counted(left_over, 'byte')} after the last triangle were ignored.",)
    records = np.frombuffer(data, dtype=_RECORD, count=announced, offset=_HEADER)
    return records["corners"].reshape(-1, 3).astype(np.float64), notes


def _read_text(data: bytes, report: Report) -> NDArray[np.float64]:
    parts = []
    facets = start = 0
    while start < len(data):
        end = data.find(b"\n", start + _CHUNK)
        chunk = data[start : end + 1 if end >= 0 else len(data)]
        try:
            found = np.array(_VERTEX.findall(chunk), dtype=np.float64)
        except ValueError as error:
            line = data.count(b"\n", 0, start + _first_bad_vertex(chunk)) + 1
            raise BrokenMeshError(
                "A vertex needs three numbers. Repair this line or export the mesh again.", line
            ) from error
        parts.append(found.reshape(-1, 3))
        facets += len(_FACET_END.findall(chunk))
        start += len(chunk)
        report(0.3 * start / len(data))
    places = np.concatenate(parts)
    if b"endsolid" not in data[-_CHUNK:].lower():
        raise BrokenMeshError(
            f"The file ends after {counted(facets, 'facet')} without 'endsolid': it was cut off. "
            "Export or copy it again."
        )
    if len(places) != 3 * facets:
        raise BrokenMeshError(
            f"{counted(facets, 'facet')} should have three vertices each, but there are "
            f"{len(places):,} vertices. Export the mesh again."
        )
    return places


def _first_bad_vertex(chunk: bytes) -> int:
    for match in _VERTEX.finditer(chunk):
        try:
            [float(number) for number in match.groups()]
        except ValueError:
            return match.start()
    return 0


def write_stl(path: Path, mesh: Mesh, _extras: VertexData = NO_DATA) -> None:
    """Write a binary STL file; its numbers have single precision, the format knows no other.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh; its triangles get normals of their own, there is no room for anything else.

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
        file.write(b"pinwarp".ljust(80) + struct.pack("<I", len(records)))
        file.write(records.tobytes())
