"""The arrays of VTK's XML files: as text, in base64 or appended, packed or not.

How much they unpack to is bounded by the size of the file.
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

from pinwarp.io.mesh_formats.allowance import Allowance
from pinwarp.io.mesh_formats.numbers import numbers_of
from pinwarp.io.mesh_formats.surface import BrokenMeshError

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
# What the strongest compression needs to be undone; the file could ask for gigabytes.
_LZMA_MEMORY = 128 << 20
DAMAGED = "The data of the file is damaged or was cut off. Export or copy it again."


@dataclass(frozen=True, eq=False)
class Encoding:
    """How the arrays of one file are stored."""

    order: str
    header: np.dtype[np.unsignedinteger]
    compressor: str
    appended: bytes
    appended_is_text: bool
    places: tuple[int, ...]
    allowance: Allowance


def encoding_of(root: ET.Element, size: int, appended: bytes, *, is_text: bool) -> Encoding:
    """Return how the arrays of a file are stored.

    Parameters
    ----------
    root
        The outermost element.
    size
        How many bytes the file has.
    appended
        The data behind all elements.
    is_text
        Whether these are in base64.

    Examples
    --------
    >>> encoding_of(ET.fromstring("<VTKFile/>"), 10, b"", is_text=False).order
    '<'
    """
    order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
    return Encoding(
        order,
        np.dtype(order + _TYPES.get(root.get("header_type", "UInt32"), "u4")),
        root.get("compressor", ""),
        appended,
        is_text,
        tuple(sorted({count_of(array, "offset") for array in root.iter("DataArray")})),
        Allowance(size),
    )


def count_of(element: ET.Element, attribute: str) -> int:
    """Return a whole number that an element says, 0 where it says none.

    Examples
    --------
    >>> count_of(ET.fromstring('<Piece NumberOfPoints="3"/>'), "NumberOfPoints")
    3
    """
    text = element.get(attribute, "0").strip()
    return int(text) if re.fullmatch(r"[0-9]{1,12}", text) else 0


def read_array(element: ET.Element, encoding: Encoding, count: int | None) -> NDArray[np.generic]:
    """Return so many numbers; where the count is open, as many as there are.

    Raises
    ------
    BrokenMeshError
        When there are not as many, or they are damaged.

    Examples
    --------
    >>> element = ET.fromstring('<DataArray type="Int32">0 1 2</DataArray>')
    >>> read_array(element, encoding_of(element, 40, b"", is_text=False), 3).tolist()
    [0, 1, 2]
    """
    kind = _TYPES.get(element.get("type", ""))
    if kind is None:
        raise BrokenMeshError(DAMAGED)
    text = (element.text or "").encode()
    wanted = None if count is None else count * np.dtype(kind).itemsize
    try:
        match element.get("format", "ascii"):
            case "ascii":
                words = text.split() if count is None else text.split(None, count)
                if count not in (None, len(words)):
                    raise BrokenMeshError(DAMAGED)
                return numbers_of(words, np.dtype(kind))
            case "binary":
                content = _unpacked(_from_base64(text), encoding, wanted)
            case "appended":
                offset = count_of(element, "offset")
                if offset > len(encoding.appended):
                    raise BrokenMeshError(DAMAGED)
                # Up to where the next one begins: of thousands, each would take all the rest.
                following = bisect_right(encoding.places, offset)
                content = encoding.appended[offset : next(iter(encoding.places[following:]), None)]
                if encoding.appended_is_text:
                    content = _from_base64(content.partition(b"<")[0])
                content = _unpacked(content, encoding, wanted)
            case _:
                raise BrokenMeshError(DAMAGED)
        return np.frombuffer(content, dtype=encoding.order + kind)
    except (ValueError, OverflowError, zlib.error, lzma.LZMAError) as error:
        raise BrokenMeshError(DAMAGED) from error


def _from_base64(text: bytes) -> bytes:
    # The lengths in front are often encoded by themselves and end in padding of their own.
    parts = re.findall(rb"[A-Za-z0-9+/]+=*", b"".join(text.split()))
    return b"".join(binascii.a2b_base64(part) for part in parts)


def _unpacked(content: bytes, encoding: Encoding, wanted: int | None) -> bytes:
    """Return the bytes of one array, which stands at the beginning of the content.

    Nothing is unpacked that is not as long as wanted, or for which too little is left over.
    """
    word = encoding.header.itemsize
    if not encoding.compressor:
        (size,) = (int(n) for n in np.frombuffer(content, encoding.header, 1))
        if size > len(content) - word or wanted not in (None, size):
            raise BrokenMeshError(DAMAGED)
        encoding.allowance.take(size)
        return content[word : word + size]
    (blocks,) = (int(n) for n in np.frombuffer(content, encoding.header, 1))
    if (3 + blocks) * word > len(content):
        raise BrokenMeshError(DAMAGED)
    full, last, *sizes = (
        int(n) for n in np.frombuffer(content, encoding.header, 2 + blocks, offset=word)
    )
    total = full * max(blocks - 1, 0) + (last or full) if blocks else 0
    if wanted not in (None, total):
        raise BrokenMeshError(DAMAGED)
    encoding.allowance.take(total)
    place = (3 + blocks) * word
    unpacked = []
    for number, size in enumerate(sizes):
        length = last if last and number == blocks - 1 else full
        if size > len(content) - place:
            raise BrokenMeshError(DAMAGED)
        block = _decompressed(content[place : place + size], length, encoding.compressor)
        if len(block) != length:
            raise BrokenMeshError(DAMAGED)
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
