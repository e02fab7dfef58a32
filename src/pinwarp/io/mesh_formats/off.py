"""OFF, the text format of Geomview, CGAL and Meshlab.

Not trimesh's reader: a file that was cut off is a mesh with fewer faces there, and polygons that
are not convex are cut outside of themselves.
"""

from __future__ import annotations

import re
from pathlib import Path

from pinwarp.core.mesh import Mesh
from pinwarp.core.words import counted
from pinwarp.io.mesh_formats.surface import BrokenMeshError, Report, Surface
from pinwarp.io.mesh_formats.text_rows import TextRows
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData
from pinwarp.io.text import lines_of, narrow

# Texture, colour and normal come behind the three coordinates of a vertex.
# A small n stands for their dimension.
HEAD = re.compile(rb"(?:\s|#[^\r\n]*[\r\n])*(?:ST|st)?[Cc]?N?(4?n?)(?:OFF|off)\b([ \t]+BINARY)?")
_ROWS = 1 << 16


def read_off(data: bytes, report: Report) -> Surface:
    r"""Read the vertices and faces of an OFF file; colours and normals are left out.

    Parameters
    ----------
    data
        The bytes of the file.
    report
        Told the share that is done.

    Returns
    -------
    Surface
        In double precision.

    Raises
    ------
    BrokenMeshError
        When the file was cut off, is binary or of more than three dimensions, or is not OFF.

    Examples
    --------
    >>> text = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n"
    >>> read_off(text, lambda share: None).corners.tolist()
    [0, 1, 2]
    """
    data = narrow(data)
    head = HEAD.match(data)
    if head is not None and (head[1] or head[2]):
        raise BrokenMeshError(
            "Binary OFF files, and those of four and more dimensions, cannot be read. "
            "Save it as text, or as PLY."
        )
    # The word itself may be left out.
    begin = head.end() if head else 0
    first_line = max(1, len(lines_of(data[:begin].decode("latin-1"))))
    rows = TextRows(data, begin, first_line, report, has_comments=True)
    points_and_faces = rows.table(1, 2)[0]
    if not all(count.is_integer() and 0 <= count < 2**40 for count in points_and_faces.tolist()):
        raise BrokenMeshError(
            "This is not an OFF file: it does not begin with the numbers of its vertices and "
            "faces. Export the mesh again."
        )
    points = rows.table(int(points_and_faces[0]), 3)
    corners, sizes = rows.lists(int(points_and_faces[1]))
    left = rows.left_over()
    notes = (f"{counted(left, 'line')} below the last row ignored.",) if left else ()
    return Surface(points, corners, sizes, notes)


def write_off(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write an OFF file whose numbers read back exactly.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh.
    extras
        Its remarks; there is no room for anything else.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_off(Path(folder, "a.off"), Mesh([[0.1, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    ...     print(Path(folder, "a.off").read_text().splitlines()[2])
    0.1 0.0 0.0
    """
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write("OFF\n")
        file.writelines(f"# {line}\n" for line in extras.plain_remarks)
        file.write(f"{len(mesh.vertices)} {len(mesh.faces)} 0\n")
        for start in range(0, len(mesh.vertices), _ROWS):
            vertices = mesh.vertices[start : start + _ROWS].tolist()
            file.writelines(f"{x!r} {y!r} {z!r}\n" for x, y, z in vertices)
        for start in range(0, len(mesh.faces), _ROWS):
            faces = mesh.faces[start : start + _ROWS].tolist()
            file.writelines(f"3 {a} {b} {c}\n" for a, b, c in faces)
