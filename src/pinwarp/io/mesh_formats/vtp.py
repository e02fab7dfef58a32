"""VTP, the XML format of VTK and ParaView.

Not VTK's reader: a damaged file can make it ask for more memory than there is, which ends the
program instead of raising an exception.
"""

from __future__ import annotations

import binascii
import lzma
import re
import xml.etree.ElementTree as ET
import zlib
from bisect import bisect_right
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.words import counted
from pinwarp.io.careful_xml import XmlError, xml_tree
from pinwarp.io.mesh_formats.surface import (
    BrokenMeshError,
    Report,
    Surface,
    cut_strips,
)

_TYPES = {
    "Int8": "i1",
    "UInt8": "u1",
    "Int16": "i2",
    "UInt16": "u2",
    "Int32": "i4",
    "UInt32": "u4",
    "Int64": "i8",
    "UInt64": "u8",
    "Float32": "f4",
    "Float64": "f8",
}
_APPENDED = re.compile(rb"<AppendedData\b[^>]*>\s*_")
# A flat and regular mesh packs to a thirtieth; zeros, to a thousandth.
_MOST_UNPACKED = 50
_ALWAYS_ALLOWED = 64 << 20
# What the strongest compression needs to be undone; the file could ask for gigabytes.
_LZMA_MEMORY = 128 << 20
_DAMAGED = "The data of the file is damaged or was cut off. Export or copy it again."


class _Allowance:
    """How many bytes all arrays of a file together may unpack to, in proportion to the file."""

    def __init__(self, size: int) -> None:
        self._left = max(_ALWAYS_ALLOWED, _MOST_UNPACKED * size)

    def take(self, size: int) -> None:
        """Set so many bytes aside before they are unpacked, or refuse."""
        self._left -= size
        if self._left < 0:
            raise BrokenMeshError(
                "The file unpacks to far more than its size, which no mesh does. Export it again."
            )


@dataclass(frozen=True, eq=False)
class _Encoding:
    """How the arrays of one file are stored."""

    order: str
    header: np.dtype[np.unsignedinteger]
    compressor: str
    appended: bytes
    appended_is_text: bool
    places: tuple[int, ...]
    allowance: _Allowance


def read_vtp(data: bytes, report: Report) -> Surface:
    """Read the polygons and triangle strips of a VTP file; data arrays are left out.

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
        When the file is damaged, holds no surface, or is not VTP.

    Examples
    --------
    >>> array = '<DataArray type="Float64" format="ascii">0 0 0 1 0 0 0 1 0</DataArray>'
    >>> piece = f'<Piece NumberOfPoints="3"><Points>{array}</Points></Piece>'
    >>> text = f'<VTKFile type="PolyData"><PolyData>{piece}</PolyData></VTKFile>'
    >>> read_vtp(text.encode(), lambda share: None).points.shape
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
    lines = sum(_count(piece, "NumberOfLines") for piece in pieces)
    return Surface(
        np.concatenate([surface.points for surface in surfaces]),
        np.concatenate([s.corners + start for s, start in zip(surfaces, starts, strict=True)]),
        np.concatenate([surface.sizes for surface in surfaces]),
        (f"{counted(lines, 'line')} dropped.",) if lines else (),
    )


def _open(data: bytes) -> tuple[ET.Element, _Encoding]:
    """Take the XML and the data appended to it apart."""
    appended = _APPENDED.search(data)
    try:
        # What follows the underscore may be any bytes, which no XML parser takes.
        root = xml_tree(data[: appended.start()] + b"</VTKFile>" if appended else data)
    except XmlError as error:
        raise BrokenMeshError(
            f"This is not a VTP file: {error}. Export or copy it again.", error.line
        ) from None
    kind = root.get("type")
    if root.tag != "VTKFile" or kind != "PolyData":
        raise BrokenMeshError(
            f"The file holds {kind or root.tag!r} and not a surface. "
            "Extract the surface and save it as PolyData (.vtp)."
        )
    order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
    header = np.dtype(order + _TYPES.get(root.get("header_type", "UInt32"), "u4"))
    return root, _Encoding(
        order,
        header,
        root.get("compressor", ""),
        data[appended.end() :] if appended else b"",
        appended is not None and b"base64" in appended.group(),
        tuple(sorted({_count(array, "offset") for array in root.iter("DataArray")})),
        _Allowance(len(data)),
    )


def _count(element: ET.Element, attribute: str) -> int:
    text = element.get(attribute, "0").strip()
    return int(text) if re.fullmatch(r"[0-9]{1,12}", text) else 0


def _read_piece(piece: ET.Element, encoding: _Encoding) -> Surface:
    points = np.empty((0, 3))
    place = piece.find("Points/DataArray")
    count = _count(piece, "NumberOfPoints")
    if place is not None:
        points = _read_array(place, encoding, 3 * count).reshape(-1, 3).astype(np.float64)
    if len(points) != count:
        raise BrokenMeshError(_DAMAGED)
    corners, sizes = _read_cells(piece, "Polys", encoding)
    strips = cut_strips(*_read_cells(piece, "Strips", encoding))
    sizes = np.concatenate([sizes, np.full(len(strips), 3, dtype=np.int64)])
    return Surface(points, np.concatenate([corners, strips.ravel()]), sizes)


def _read_cells(
    piece: ET.Element, kind: str, encoding: _Encoding
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the corners of all cells of a kind, and how many each has."""
    arrays = {element.get("Name"): element for element in piece.iterfind(f"{kind}/DataArray")}
    ends = corners = np.empty(0, dtype=np.int64)
    if "offsets" in arrays:
        # Not every writer says how many cells there are; then their own ends do.
        count = _count(piece, f"NumberOf{kind}") or None
        ends = _whole_numbers(_read_array(arrays["offsets"], encoding, count))
    sizes = np.diff(ends, prepend=0)
    if (sizes < 0).any():
        raise BrokenMeshError(_DAMAGED)
    total = int(ends[-1]) if len(ends) else 0
    if "connectivity" in arrays:
        corners = _whole_numbers(_read_array(arrays["connectivity"], encoding, total))
    if len(corners) != total:
        raise BrokenMeshError(_DAMAGED)
    return corners, sizes


def _whole_numbers(numbers: NDArray[np.generic]) -> NDArray[np.int64]:
    if numbers.dtype.kind not in "iu":
        raise BrokenMeshError(_DAMAGED)
    return numbers.astype(np.int64)


def _read_array(element: ET.Element, encoding: _Encoding, count: int | None) -> NDArray[np.generic]:
    """Return so many numbers; where the count is open, as many as there are."""
    kind = _TYPES.get(element.get("type", ""))
    if kind is None:
        raise BrokenMeshError(_DAMAGED)
    text = element.text or ""
    wanted = None if count is None else count * np.dtype(kind).itemsize
    try:
        match element.get("format", "ascii"):
            case "ascii":
                words = text.split() if count is None else text.split(None, count)
                if count not in (None, len(words)):
                    raise BrokenMeshError(_DAMAGED)
                return np.array(words, dtype=kind)
            case "binary":
                content = _unpacked(_from_base64(text.encode()), encoding, wanted)
            case "appended":
                offset = _count(element, "offset")
                if offset > len(encoding.appended):
                    raise BrokenMeshError(_DAMAGED)
                # Up to where the next one begins: of thousands, each would take all the rest.
                following = bisect_right(encoding.places, offset)
                content = encoding.appended[offset : next(iter(encoding.places[following:]), None)]
                if encoding.appended_is_text:
                    content = _from_base64(content.partition(b"<")[0])
                content = _unpacked(content, encoding, wanted)
            case _:
                raise BrokenMeshError(_DAMAGED)
        return np.frombuffer(content, dtype=encoding.order + kind)
    except (ValueError, OverflowError, zlib.error, lzma.LZMAError) as error:
        raise BrokenMeshError(_DAMAGED) from error


def _from_base64(text: bytes) -> bytes:
    # The lengths in front are often encoded by themselves and end in padding of their own.
    parts = re.findall(rb"[A-Za-z0-9+/]+=*", b"".join(text.split()))
    return b"".join(binascii.a2b_base64(part) for part in parts)


def _unpacked(content: bytes, encoding: _Encoding, wanted: int | None) -> bytes:
    """Return the bytes of one array, which stands at the beginning of the content.

    Nothing is unpacked that is not as long as wanted, or for which too little is left over.
    """
    word = encoding.header.itemsize
    if not encoding.compressor:
        (size,) = (int(n) for n in np.frombuffer(content, encoding.header, 1))
        if size > len(content) - word or wanted not in (None, size):
            raise BrokenMeshError(_DAMAGED)
        encoding.allowance.take(size)
        return content[word : word + size]
    (blocks,) = (int(n) for n in np.frombuffer(content, encoding.header, 1))
    if (3 + blocks) * word > len(content):
        raise BrokenMeshError(_DAMAGED)
    full, last, *sizes = (
        int(n) for n in np.frombuffer(content, encoding.header, 2 + blocks, offset=word)
    )
    total = full * max(blocks - 1, 0) + (last or full) if blocks else 0
    if wanted not in (None, total):
        raise BrokenMeshError(_DAMAGED)
    encoding.allowance.take(total)
    place = (3 + blocks) * word
    unpacked = []
    for number, size in enumerate(sizes):
        length = last if last and number == blocks - 1 else full
        if size > len(content) - place:
            raise BrokenMeshError(_DAMAGED)
        block = _decompressed(content[place : place + size], length, encoding.compressor)
        if len(block) != length:
            raise BrokenMeshError(_DAMAGED)
        unpacked.append(block)
        place += size
    return b"".join(unpacked)


def _decompressed(block: bytes, length: int, compressor: str) -> bytes:
    # The length bounds the memory: a damaged block cannot unpack into gigabytes.
    most = min(length + 1, 1 << 31)
    match compressor:
        case "vtkZLibDataCompressor":
            return zlib.decompressobj().decompress(block, most)
        case "vtkLZMADataCompressor":
            return lzma.LZMADecompressor(memlimit=_LZMA_MEMORY).decompress(
                block, min(length + 1, 1 << 31)
            )
        case _:
            raise BrokenMeshError(
                f"The file is compressed by {compressor}. Save it with ZLib or no compression."
            )
