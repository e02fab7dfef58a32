"""The tables of a binary PLY file, of either byte order."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from pinwarp.io.mesh_formats.ply_header import Element, Property

_CODES = {
    "i1": "b",
    "u1": "B",
    "i2": "h",
    "u2": "H",
    "i4": "i",
    "u4": "I",
    "i8": "q",
    "u8": "Q",
    "f4": "f",
    "f8": "d",
}

Columns = dict[str, Any]
"""The values of each property: an array, or a list of tuples where the rows differ in length."""


def read_element(body: bytes, place: int, element: Element, order: str) -> tuple[Columns, int]:
    r"""Return the columns of one table and where the next one begins.

    Parameters
    ----------
    body
        The file below its header.
    place
        Where the table begins.
    element
        What the header says of it.
    order
        ``"<"`` or ``">"``.

    Raises
    ------
    BrokenMeshError
        When the file is too short for it.

    Examples
    --------
    >>> element = Element("vertex", 2, (Property("x", "i2"),))
    >>> columns, place = read_element(b"\1\0\2\0", 0, element, "<")
    >>> columns["x"].tolist(), place
    ([1, 2], 4)
    """
    if not element.rows or not element.properties:
        return {}, place
    # Checked first, so that a nonsense count does not ask for nonsense memory.
    shortest = sum(np.dtype(p.length_kind or p.kind).itemsize for p in element.properties)
    if element.rows * shortest > len(body) - place:
        raise element.too_short()
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
                raise element.too_short()
            layout = f"{order}{int(length)}{_CODES[p.kind]}"
            row.append(struct.unpack_from(layout, body, place))
        except struct.error:
            raise element.too_short() from None
        place += struct.calcsize(layout)
    return row, place
