"""VTP and VTU, the XML formats of VTK and ParaView.

Not VTK's reader: a damaged file can make it ask for more memory than there is, which ends the
program instead of raising an exception.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.words import counted
from pinwarp.io.careful_xml import XmlError, xml_tree
from pinwarp.io.mesh_formats.surface import BrokenMeshError, Report, Surface, cut_strips
from pinwarp.io.mesh_formats.vtk_cells import faces_of_cells
from pinwarp.io.mesh_formats.vtk_xml_arrays import (
    DAMAGED,
    Encoding,
    count_of,
    encoding_of,
    read_array,
)

_APPENDED = re.compile(rb"<AppendedData\b[^>]*>\s*_")
_NONE = np.empty(0, dtype=np.int64)


def read_vtk_xml(data: bytes, report: Report) -> Surface:
    """Read a surface, or an unstructured grid with faces; data arrays are left out.

    Parameters
    ----------
    data
        The bytes of the file.
    report
        Told the share that is done.

    Returns
    -------
    Surface
        All pieces of the file as one surface.

    Raises
    ------
    BrokenMeshError
        When the file is damaged, holds no surface, or is neither VTP nor VTU.

    Examples
    --------
    >>> array = '<DataArray type="Float64" format="ascii">0 0 0 1 0 0 0 1 0</DataArray>'
    >>> piece = f'<Piece NumberOfPoints="3"><Points>{array}</Points></Piece>'
    >>> text = f'<VTKFile type="PolyData"><PolyData>{piece}</PolyData></VTKFile>'
    >>> read_vtk_xml(text.encode(), lambda share: None).points.shape
    (3, 3)
    """
    root, encoding = _open(data)
    pieces = list(root.iter("Piece"))
    surfaces = []
    for number, piece in enumerate(pieces, 1):
        surfaces.append(_read_piece(piece, encoding))
        report(number / len(pieces))
    if not surfaces:
        raise BrokenMeshError("The file holds no surface. Export the bone as a triangle surface.")
    starts = np.cumsum([0] + [len(surface.points) for surface in surfaces[:-1]])
    return Surface(
        np.concatenate([surface.points for surface in surfaces]),
        np.concatenate([s.corners + start for s, start in zip(surfaces, starts, strict=True)]),
        np.concatenate([surface.sizes for surface in surfaces]),
        tuple(note for surface in surfaces for note in surface.notes),
    )


def _open(data: bytes) -> tuple[ET.Element, Encoding]:
    """Take the XML and the data appended to it apart."""
    appended = _APPENDED.search(data)
    try:
        # What follows the underscore may be any bytes, which no XML parser takes.
        root = xml_tree(data[: appended.start()] + b"</VTKFile>" if appended else data)
    except XmlError as error:
        raise BrokenMeshError(
            f"This is not a VTP or VTU file: {error}. Export or copy it again.", error.line
        ) from None
    kind = root.get("type")
    if root.tag != "VTKFile" or kind not in ("PolyData", "UnstructuredGrid"):
        raise BrokenMeshError(
            f"The file holds {kind or root.tag!r} and not a surface. "
            "Extract the surface and save it as PolyData (.vtp)."
        )
    rest = data[appended.end() :] if appended else b""
    is_text = appended is not None and b"base64" in appended.group()
    return root, encoding_of(root, len(data), rest, is_text=is_text)


def _read_piece(piece: ET.Element, encoding: Encoding) -> Surface:
    points = np.empty((0, 3))
    place = piece.find("Points/DataArray")
    count = count_of(piece, "NumberOfPoints")
    if place is not None:
        points = read_array(place, encoding, 3 * count).reshape(-1, 3).astype(np.float64)
    if len(points) != count:
        raise BrokenMeshError(DAMAGED)
    corners, sizes = _read_cells(piece, "Polys", encoding)
    strips = cut_strips(*_read_cells(piece, "Strips", encoding))
    kinds = piece.find("Cells/DataArray[@Name='types']")
    faces, face_sizes, notes = faces_of_cells(
        _NONE
        if kinds is None
        else _whole_numbers(read_array(kinds, encoding, count_of(piece, "NumberOfCells"))),
        *_read_cells(piece, "Cells", encoding),
    )
    lines = count_of(piece, "NumberOfLines")
    return Surface(
        points,
        np.concatenate([corners, strips.ravel(), faces]),
        np.concatenate([sizes, np.full(len(strips), 3, dtype=np.int64), face_sizes]),
        (*((f"{counted(lines, 'line')} dropped.",) if lines else ()), *notes),
    )


def _read_cells(
    piece: ET.Element, kind: str, encoding: Encoding
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the corners of all cells of a kind, and how many each has."""
    arrays = {element.get("Name"): element for element in piece.iterfind(f"{kind}/DataArray")}
    ends = corners = np.empty(0, dtype=np.int64)
    if "offsets" in arrays:
        # Not every writer says how many cells there are; then their own ends do.
        count = count_of(piece, f"NumberOf{kind}") or None
        ends = _whole_numbers(read_array(arrays["offsets"], encoding, count))
    sizes = np.diff(ends, prepend=0)
    if (sizes < 0).any():
        raise BrokenMeshError(DAMAGED)
    total = int(ends[-1]) if len(ends) else 0
    if "connectivity" in arrays:
        corners = _whole_numbers(read_array(arrays["connectivity"], encoding, total))
    if len(corners) != total:
        raise BrokenMeshError(DAMAGED)
    return corners, sizes


def _whole_numbers(numbers: NDArray[np.generic]) -> NDArray[np.int64]:
    if numbers.dtype.kind not in "iu":
        raise BrokenMeshError(DAMAGED)
    return numbers.astype(np.int64)
