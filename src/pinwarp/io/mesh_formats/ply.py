"""PLY, ASCII and binary of either byte order.

Not VTK's reader: it rounds double precision to single, reads past the end of files that were
cut off, and crashes on damaged ones. Not trimesh's: what was cut off is a mesh without faces there,
numbers that are not whole become others, and text takes three times the memory.
"""

from __future__ import annotations

from itertools import chain, takewhile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.mesh import Mesh
from pinwarp.core.words import counted
from pinwarp.io.mesh_formats.ply_binary import Columns, read_element
from pinwarp.io.mesh_formats.ply_header import Element, read_header
from pinwarp.io.mesh_formats.surface import BrokenMeshError, Report, Surface, cut_strips
from pinwarp.io.mesh_formats.text_rows import TextRows
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData
from pinwarp.io.text import narrow

_NONE = np.empty(0, dtype=np.int64)
_POINTS, _FACES, _STRIPS = "vertex", "face", "tristrips"

_Polygons = tuple[NDArray[np.int64], NDArray[np.int64]]
"""The corners of all polygons in a row, and how many each has."""


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
    data = narrow(data)
    order, elements, begin, line = read_header(data)
    points: NDArray[np.float64] | None = None
    polygons: dict[str, _Polygons] = {}
    notes = []
    tables: _Text | _Binary
    tables = _Text(data, begin, line, report) if order == "=" else _Binary(data[begin:], order)
    for element in elements:
        if element.name == _POINTS:
            points = tables.points(element)
        elif element.name in (_FACES, _STRIPS):
            polygons[element.name] = tables.polygons(element)
        else:
            tables.skip(element)
            if element.rows:
                notes.append(f"{counted(element.rows, 'row')} of {element.name!r} dropped.")
    report(1.0)
    if points is None or not polygons:
        raise BrokenMeshError(
            "The file holds no faces, only points. Export the bone as a triangle surface."
        )
    corners, sizes = polygons.get(_FACES, (_NONE, _NONE))
    strips = _cut(*polygons.get(_STRIPS, (_NONE, _NONE)))
    return Surface(
        points,
        np.concatenate([corners, strips.ravel()]),
        np.concatenate([sizes, np.full(len(strips), 3, dtype=np.int64)]),
        (*notes, *tables.notes()),
    )


def _corners_of(element: Element) -> str | None:
    """Return the name of the property that holds the corners of faces."""
    lists = [p.name for p in element.properties if p.length_kind and p.kind[0] in "iu"]
    known = [name for name in lists if name.startswith("vert")]
    return next(iter([*known, *lists]), None)


def _cut(corners: NDArray[np.int64], sizes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cut strips, each of which may be several with -1 between them."""
    begins = np.zeros(len(corners) + 1, dtype=bool)
    begins[np.cumsum(sizes) - sizes] = True
    is_corner = corners != -1
    strip = np.cumsum(begins[:-1] | ~is_corner)[is_corner]
    return cut_strips(corners[is_corner], np.bincount(strip))


class _Text:
    """The tables of a text, row by row."""

    def __init__(self, data: bytes, begin: int, line: int, report: Report) -> None:
        self._rows = TextRows(data, begin, line, report)
        self._notes: list[str] = []

    def points(self, element: Element) -> NDArray[np.float64]:
        names = [p.name for p in takewhile(lambda p: not p.length_kind, element.properties)]
        if not {"x", "y", "z"} <= {*names}:
            raise _no_places()
        axes = [names.index(axis) for axis in "xyz"]
        table = self._rows.table(element.rows, max(axes) + 1, row_width=len(names))
        if len(names) == len(element.properties):
            self._tell_longer(element)
        return table[:, axes]

    def polygons(self, element: Element) -> _Polygons:
        corners = _corners_of(element)
        if corners is None:
            self._rows.skip(element.rows)
            return _NONE, _NONE
        layout = [p.length_kind is not None for p in element.properties]
        wanted = [p.name for p in element.properties].index(corners)
        polygons = self._rows.lists(element.rows, layout, wanted)
        self._tell_longer(element)
        return polygons

    def skip(self, element: Element) -> None:
        if element.properties:
            self._rows.skip(element.rows)

    def notes(self) -> list[str]:
        left = self._rows.left_over()
        ignored = [f"{counted(left, 'line')} below the last row ignored."] if left else []
        return [*self._notes, *ignored]

    def _tell_longer(self, element: Element) -> None:
        if self._rows.longer:
            rows = counted(self._rows.longer, "row")
            self._notes.append(
                f"{rows} of {element.name!r} longer than the header says, the rest of each ignored."
            )


class _Binary:
    """The tables of a binary file."""

    def __init__(self, body: bytes, order: str) -> None:
        self._body, self._order, self._place = body, order, 0

    def points(self, element: Element) -> NDArray[np.float64]:
        columns = self._columns(element)
        if not columns:
            return np.empty((0, 3))
        axes = [np.asarray(columns[axis]) for axis in "xyz" if axis in columns]
        if len(axes) < 3 or any(axis.size != len(axis) for axis in axes):
            raise _no_places()
        return np.column_stack(axes).astype(np.float64)

    def polygons(self, element: Element) -> _Polygons:
        columns = self._columns(element)
        corners = _corners_of(element)
        if corners not in columns:
            return _NONE, _NONE
        rows = columns[corners]
        if isinstance(rows, list):
            sizes = np.array([len(row) for row in rows], dtype=np.int64)
            return np.array(list(chain.from_iterable(rows)), dtype=np.int64), sizes
        return rows.ravel().astype(np.int64), np.full(len(rows), rows.shape[1], dtype=np.int64)

    def skip(self, element: Element) -> None:
        self._columns(element)

    def notes(self) -> list[str]:
        left = len(self._body) - self._place
        return [f"{counted(left, 'byte')} behind the last row ignored."] if left else []

    def _columns(self, element: Element) -> Columns:
        columns, self._place = read_element(self._body, self._place, element, self._order)
        return columns


def _no_places() -> BrokenMeshError:
    return BrokenMeshError("The vertices have no x, y and z. Export the mesh again.")


def write_ply(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    r"""Write a binary PLY file in double precision.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh.
    extras
        Normals, scalars and remarks; scalars as properties of single precision.

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
    comments = "".join(f"comment {line}\n" for line in extras.plain_remarks or ("pinwarp",))
    header = (
        f"ply\nformat binary_little_endian 1.0\n{comments}"
        f"element vertex {len(mesh.vertices)}\n{properties}"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    with path.open("wb") as file:
        file.write(header.encode())
        file.write(vertices.tobytes())
        file.write(faces.tobytes())
