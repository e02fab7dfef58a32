"""Which format a mesh file is in, told by what is in it: people rename files."""

from __future__ import annotations

import re
import struct

from pinwarp.io.mesh_formats.off import HEAD
from pinwarp.io.text import narrow

_LOOKED_AT = 4096
_STL_HEADER = 84

# Only what is certain; all others are told by the suffix.
_OURS = (
    (".ply", re.compile(rb"\s*ply[ \t]*[\r\n]\s*(?:comment[^\r\n]*\s+)*format\b", re.I)),
    (".vtk", re.compile(rb"\s*# vtk DataFile", re.I)),
    (".vtu", re.compile(rb"[^\0]*?<VTKFile[^>]*\btype=.UnstructuredGrid")),
    (".vtp", re.compile(rb"[^\0]*?<VTKFile[^>]*\btype=.PolyData")),
    (".off", HEAD),
    (
        ".stl",
        re.compile(rb"(?:\s|(?:#|//|;)[^\r\n]*[\r\n])*solid\b[^\0]*?\bfacet\s+normal\b", re.I),
    ),
    (".glb", re.compile(rb"glTF")),
    (".gltf", re.compile(rb'\s*\{[^\0]*?"asset"\s*:')),
)


def kind_in(data: bytes, suffix: str) -> str | None:
    r"""Return the suffix of the format that a mesh file is in, None where that is not certain.

    Parameters
    ----------
    data
        All bytes of the file.
    suffix
        What its name ends in, for archives that were cut off.

    Examples
    --------
    >>> kind_in(b"ply\nformat ascii 1.0\n", ".stl"), kind_in(b"v 0 0 0\n", ".obj")
    ('.ply', None)
    """
    head = narrow(data[:_LOOKED_AT])
    if (
        len(data) >= _STL_HEADER
        and len(data) == _STL_HEADER + 50 * struct.unpack_from("<I", data, 80)[0]
    ):
        return ".stl"
    if data.startswith(b"PK"):
        names = (head + data[-_LOOKED_AT:]).lower()
        return ".3mf" if suffix == ".3mf" or b"3d/3dmodel.model" in names else None
    return next((suffix for suffix, pattern in _OURS if pattern.match(head)), None)
