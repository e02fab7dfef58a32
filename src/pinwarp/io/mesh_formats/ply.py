"""PLY, ASCII and binary of either byte order.

Not VTK's reader: it rounds double precision to single, reads past the end of files that were
cut off, and crashes on damaged ones.
"""

from __future__ import annotations

import struct
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.mesh import Mesh
from pinwarp.core.words import counted
from pinwarp.io.mesh_formats.ply_header import Element, Property, in_doubles, read_header
from pinwarp.io.mesh_formats.surface import BrokenMeshError, Report, Surface
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData

_CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}
_CHUNK = 1 << 20

_Columns = dict[str, Any]
"""The values of each property: an array, or a list of tuples where the rows differ in length."""


def read_ply(data: bytes, report: Report) -> Surface:
    r"""Read the vertices and faces of a PLY file; colours and the like are left out.

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
        When the file was cut off, holds no faces, or is not PLY.

    Examples
    --------
    >>> header = "ply\nformat ascii 1.0\nelement vertex 3\n"
    >>> header += "property double x\nproperty double y\nproperty double z\n"
    >>> header += "element face 1\nproperty list uchar int vertex_indices\n"
    >>> body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    >>> read_ply(f"{header}end_header\n{body}".encode(), lambda share: None).sizes.tolist()
    [3]
    """
    order, elements, begin = read_header(data)
    body = data[begin:]
    if order == "=":
        # Text becomes a binary file of doubles: from here on there is one kind of PLY.
        body = _numbers(body, report).tobytes()
        elements = [in_doubles(element) for element in elements]
    report(0.5)
    points: NDArray[np.float64] | None = None
    polygons: tuple[NDArray[np.int64], NDArray[np.int64]] | None = None
    notes = []
    place = 0
    for element in elements:
        columns, place = _read_element(body, place, element, order)
        if element.name == "vertex":
            points = _points(columns)
        elif element.name == "face":
            polygons = _polygons(columns)
        elif element.rows:
            notes.append(f"{counted(element.rows, 'row')} of {element.name!r} dropped.")
    report(1.0)
    if points is None or polygons is None:
        raise BrokenMeshError(
            "The file holds no faces, only points. Export the bone as a triangle surface."
        )
    return Surface(points, *polygons, tuple(notes))


def _numbers(body: bytes, report: Report) -> NDArray[np.float64]:
    parts = []
    start = 0
    while start < len(body):
        end = body.find(b"\n", start + _CHUNK)
        chunk = body[start : end + 1 if end >= 0 else len(body)]
        try:
            parts.append(np.array(chunk.split(), dtype=np.float64))
        except ValueError as error:
            raise BrokenMeshError(
                f"The part after the header is not all numbers: {error}. Export the mesh again."
            ) from error
        start += len(chunk)
        report(0.4 * start / len(body))
    return np.concatenate(parts) if parts else np.empty(0)


def _read_element(body: bytes, place: int, element: Element, order: str) -> tuple[_Columns, int]:
    """Return the columns of one element and where the next one begins."""
    if not element.rows or not element.properties:
        return {}, place
    # Checked first, so that a nonsense count does not ask for nonsense memory.
    shortest = sum(np.dtype(p.length_kind or p.kind).itemsize for p in element.properties)
    if element.rows * shortest > len(body) - place:
        raise _cut_off(element)
    first, _ = _read_row(body, place, element, order)
    # All rows are alike in nearly every file: then they are one table.
    table = np.dtype(
        [
            field
            for p, values in zip(element.properties, first, strict=True)
            for field in _fields(p, len(values), order)
        ]
    )
    if element.rows * table.itemsize <= len(body) - place:
        rows = np.frombuffer(body, dtype=table, count=element.rows, offset=place)
        lists = [p for p in element.properties if p.length_kind]
        if all((rows[f"{p.name} length"] == rows[p.name].shape[1]).all() for p in lists):
            return {p.name: rows[p.name] for p in element.properties}, place + rows.nbytes
    found: list[list[tuple[float, ...]]] = []
    for _ in range(element.rows):
        row, place = _read_row(body, place, element, order)
        found.append(row)
    columns = zip(*found, strict=True)
    return {
        p.name: list(values) for p, values in zip(element.properties, columns, strict=True)
    }, place


def _fields(p: Property, length: int, order: str) -> list[tuple[Any, ...]]:
    if p.length_kind is None:
        return [(p.name, order + p.kind)]
    return [(f"{p.name} length", order + p.length_kind), (p.name, order + p.kind, (length,))]


def _read_row(
    body: bytes, place: int, element: Element, order: str
) -> tuple[list[tuple[float, ...]], int]:
    """Return the values of one row, a tuple per property, and where the next row begins."""
    row = []
    for p in element.properties:
        length = 1.0
        room = len(body) - place
        try:
            if p.length_kind is not None:
                (length,) = struct.unpack_from(order + _CODES[p.length_kind], body, place)
                place += np.dtype(p.length_kind).itemsize
            if not 0 <= length <= room:
                raise _cut_off(element)
            layout = f"{order}{int(length)}{_CODES[p.kind]}"
            row.append(struct.unpack_from(layout, body, place))
        except struct.error:
            raise _cut_off(element) from None
        place += struct.calcsize(layout)
    return row, place


def _cut_off(element: Element) -> BrokenMeshError:
    return BrokenMeshError(
        f"The header announces {element.rows:,} rows of {element.name!r}, but the file is too "
        "short for them: it was cut off or is damaged. Export or copy it again."
    )


def _points(columns: _Columns) -> NDArray[np.float64]:
    if not columns:
        return np.empty((0, 3))
    axes = [np.asarray(columns[axis]) for axis in "xyz" if axis in columns]
    if len(axes) < 3 or any(axis.size != len(axis) for axis in axes):
        raise BrokenMeshError("The vertices have no x, y and z. Export the mesh again.")
    return np.column_stack(axes).astype(np.float64)


def _polygons(columns: _Columns) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    rows = columns.get("vertex_indices", columns.get("vertex_index"))
    if rows is None:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    if isinstance(rows, list):
        sizes = np.array([len(row) for row in rows], dtype=np.int64)
        corners = np.array(list(chain.from_iterable(rows)), dtype=np.float64)
    else:
        # A face of one number instead of a list has one corner and is dropped later.
        table = np.atleast_2d(rows.T).T
        sizes = np.full(len(table), table.shape[1], dtype=np.int64)
        corners = table.ravel()
    # Text holds any number where a vertex number belongs; none of 2**53 or more is one.
    if corners.dtype.kind == "f" and not (np.abs(corners) < 2**53).all():
        raise BrokenMeshError("A face names a vertex that does not exist. Export the mesh again.")
    return corners.astype(np.int64), sizes


def write_ply(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    r"""Write a binary PLY file in double precision.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh.
    extras
        Normals and scalars; the latter as properties of single precision.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_ply(Path(folder, "a.ply"), Mesh(np.eye(3), [[0, 1, 2]]))
    ...     Path(folder, "a.ply").read_bytes()[:37]
    b'ply\nformat binary_little_endian 1.0\nc'
    """
    fields: list[tuple[str, str] | tuple[str, str, int]] = [("places", "<f8", 3)]
    properties = "property double x\nproperty double y\nproperty double z\n"
    if extras.normals is not None:
        fields.append(("normals", "<f4", 3))
        properties += "property float nx\nproperty float ny\nproperty float nz\n"
    for name in extras.scalars:
        fields.append((name, "<f4"))
        properties += f"property float {name}\n"
    vertices = np.empty(len(mesh.vertices), dtype=fields)
    vertices["places"] = mesh.vertices
    if extras.normals is not None:
        vertices["normals"] = extras.normals
    for name, values in extras.scalars.items():
        vertices[name] = values
    faces = np.empty(len(mesh.faces), dtype=[("length", "u1"), ("corners", "<i4", 3)])
    faces["length"] = 3
    faces["corners"] = mesh.faces
    header = (
        "ply\nformat binary_little_endian 1.0\ncomment pinwarp\n"
        f"element vertex {len(mesh.vertices)}\n{properties}"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    with path.open("wb") as file:
        file.write(header.encode())
        file.write(vertices.tobytes())
        file.write(faces.tobytes())
