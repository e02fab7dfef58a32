"""Wavefront OBJ.

Not VTK's reader: it splits vertices wherever faces disagree about a normal or a texture
coordinate, so that a bone falls apart into triangles, and damaged files crash it. Not trimesh's:
it reads vertex number 0, coordinates that are none and the line ends of old programs wrongly, or
says only that an index is out of range.
"""

from __future__ import annotations

import re
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.mesh import Mesh
from pinwarp.core.words import counted
from pinwarp.io.mesh_formats.numbers import numbers_of
from pinwarp.io.mesh_formats.surface import BrokenMeshError, Report, Surface
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData
from pinwarp.io.text import Lines, narrow, stretches_of, with_lf

# Comments come behind the three words that are taken.
_VERTEX = re.compile(rb"^[ \t]*v[ \t]+([^\n]*)", re.M | re.I)
_FACE = re.compile(rb"^[ \t]*fo?[ \t]+([^\n#]*)", re.M | re.I)
_LOOSE = re.compile(rb"^[ \t]*[lp][ \t]", re.M | re.I)
_CONTINUED = re.compile(rb"\\[ \t]*\n")
# Only of what is read: the path of a folder may end in a backslash.
_LONG_LINE = re.compile(rb"^[ \t]*(?:v|fo?)[ \t](?:[^\n\\]|\\[ \t]*\n|\\)*", re.M | re.I)
_TEXTURE_AND_NORMAL = re.compile(rb"/[^\s]*")
_ROWS = 1 << 16
_NONE = np.empty(0, dtype=np.int64)


def read_obj(data: bytes, report: Report) -> Surface:
    r"""Read the vertices and faces of an OBJ file; materials, normals and groups are left out.

    Parameters
    ----------
    data
        The bytes of the file.
    report
        Told the share that is done.

    Returns
    -------
    Surface
        Every ``v`` line is one point, every ``f`` line one polygon.

    Raises
    ------
    BrokenMeshError
        When a line cannot be read, or the file is not OBJ.

    Examples
    --------
    >>> text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 -1//1\n"
    >>> read_obj(text, lambda share: None).corners.tolist()
    [0, 1, 2]
    """
    text = narrow(data)
    if b"\0" in text[:4096]:
        raise BrokenMeshError("This is not an OBJ file: it is not text. Export the mesh again.")
    if b"\\" in text:
        text = with_lf(text)
        if _CONTINUED.search(text):
            # The blank in place of a line end keeps the line numbers nearly right.
            text = _LONG_LINE.sub(lambda line: _CONTINUED.sub(b" ", line[0]), text)
    points, corners, sizes = [np.empty((0, 3))], [_NONE], [_NONE]
    count = loose = 0
    for lines in stretches_of(text):
        try:
            points.append(_vertices(lines.data))
            chunk_corners, chunk_sizes = _faces(lines.data, count)
        except (ValueError, OverflowError) as error:
            raise _complaint(lines) from error
        corners.append(chunk_corners)
        sizes.append(chunk_sizes)
        count += len(points[-1])
        loose += len(_LOOSE.findall(lines.data))
        report(lines.share)
    notes = (f"{counted(loose, 'line or point', 'lines or points')} dropped.",) if loose else ()
    return Surface(np.concatenate(points), np.concatenate(corners), np.concatenate(sizes), notes)


def _vertices(chunk: bytes) -> NDArray[np.float64]:
    rows = [row.split(None, 3)[:3] for row in _VERTEX.findall(chunk)]
    if any(len(row) < 3 for row in rows):
        raise ValueError
    words = list(chain.from_iterable(rows))
    return numbers_of(words).astype(np.float64, copy=False).reshape(len(rows), 3)


def _faces(chunk: bytes, vertices_before: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    found = _FACE.findall(chunk)
    if not found:
        return _NONE, _NONE
    rows = [row.split() for row in _TEXTURE_AND_NORMAL.sub(b"", b"\n".join(found)).split(b"\n")]
    sizes = np.array([len(row) for row in rows], dtype=np.int64)
    numbers = np.array(list(chain.from_iterable(rows)), dtype=np.int64)
    if not numbers.all():
        raise ValueError
    if (numbers > 0).all():
        return numbers - 1, sizes
    # Negative numbers count back from the vertices that came before the face.
    vertex_places = [match.start() for match in _VERTEX.finditer(chunk)]
    face_places = [match.start() for match in _FACE.finditer(chunk)]
    before = vertices_before + np.searchsorted(vertex_places, face_places)
    return np.where(numbers > 0, numbers - 1, numbers + np.repeat(before, sizes)), sizes


def _complaint(lines: Lines) -> BrokenMeshError:
    """Find the line that could not be read."""
    for number, line in enumerate(lines.data.split(b"\n"), lines.first):
        try:
            _vertices(line)
        except ValueError:
            return BrokenMeshError(
                "A vertex needs three numbers. Repair this line or export the mesh again.", number
            )
        try:
            _faces(line, 0)
        except (ValueError, OverflowError):
            return BrokenMeshError(
                "A face is a list of vertex numbers, counted from 1. "
                "Repair this line or export the mesh again.",
                number,
            )
    return BrokenMeshError("The vertices or faces cannot be read. Export the mesh again.")


def write_obj(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write an OBJ file whose numbers read back exactly.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh.
    extras
        Its normals and remarks; there is no room for scalars.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_obj(Path(folder, "a.obj"), Mesh(np.eye(3) / 3, [[0, 1, 2]]))
    ...     print(Path(folder, "a.obj").read_text().splitlines()[1])
    v 0.3333333333333333 0.0 0.0
    """
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.writelines(f"# {line}\n" for line in extras.plain_remarks or ("pinwarp",))
        # repr gives the fewest digits that read back exactly; 9 would lose half of a double.
        for start in range(0, len(mesh.vertices), _ROWS):
            vertices = mesh.vertices[start : start + _ROWS].tolist()
            file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in vertices)
        if extras.normals is not None:
            for start in range(0, len(mesh.vertices), _ROWS):
                normals = extras.normals[start : start + _ROWS].tolist()
                file.writelines(f"vn {x:.7g} {y:.7g} {z:.7g}\n" for x, y, z in normals)
        # Each vertex has the normal of its own number.
        corner = "{0}" if extras.normals is None else "{0}//{0}"
        row = f"f {corner} {corner.replace('0', '1')} {corner.replace('0', '2')}\n"
        for start in range(0, len(mesh.faces), _ROWS):
            faces = (mesh.faces[start : start + _ROWS] + np.int64(1)).tolist()
            file.writelines(row.format(*corners) for corners in faces)
