"""The header of a PLY file: what tables follow, and of what columns."""

from __future__ import annotations

import re
from dataclasses import dataclass

from pinwarp.io.mesh_formats.surface import BrokenMeshError
from pinwarp.io.text import lines_of

_TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "int64": "i8",
    "uint64": "u8",
    "float": "f4",
    "double": "f8",
    "float32": "f4",
    "float64": "f8",
}
_ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
_START = re.compile(rb"\s*ply[ \t]*(\r\n|\n|\r)", re.I)
_END = rb"[\r\n]end_header[ \t]*"
_KEYWORDS = ("format", "element", "property")


@dataclass(frozen=True)
class Property:
    """One column; a list column has a type for its lengths as well."""

    name: str
    kind: str
    length_kind: str | None = None


@dataclass(frozen=True)
class Element:
    """One table of the file."""

    name: str
    rows: int
    properties: tuple[Property, ...]

    def too_short(self) -> BrokenMeshError:
        """Return the complaint that the file ends before all rows of the table."""
        return BrokenMeshError(
            f"The header announces {self.rows:,} rows of {self.name!r}, but the file is too "
            "short for them: it was cut off or is damaged. Export or copy it again."
        )


def read_header(data: bytes) -> tuple[str, list[Element], int, int]:
    r"""Read the header of a PLY file.

    Parameters
    ----------
    data
        The bytes of the file.

    Returns
    -------
    order
        ``"<"`` or ``">"`` for binary, ``"="`` for text.
    elements
        The tables in the order of the file.
    begin
        Where they begin.
    line
        The line they begin at, counted from 1.

    Raises
    ------
    BrokenMeshError
        When this is not PLY, or the header cannot be understood.

    Examples
    --------
    >>> read_header(b"ply\nformat ascii 1.0\nelement vertex 3\nend_header\n")
    ('=', [Element(name='vertex', rows=3, properties=())], 49, 5)
    """
    start = _START.match(data)
    # Numbers of a binary file may begin with a byte that is a line end elsewhere.
    line_end = rb"\r" if start and start[1] == b"\r" else rb"\r?\n"
    end = re.compile(_END + line_end, re.I).search(data)
    if start is None or end is None:
        raise BrokenMeshError(
            "This is not a PLY file, or its header was cut off. Export the mesh again."
        )
    order = None
    elements: list[Element] = []
    lines = lines_of(data[: end.end()].decode("latin-1"))
    for number, line in enumerate(lines, 1):
        match line.lower().split():
            case ["format", kind, *_] if kind in _ORDERS:
                order = _ORDERS[kind]
            case ["element", name, rows] if rows.isdecimal() and rows.isascii():
                elements.append(Element(name, int(rows), ()))
            case ["property", "list", length, kind, name] if (
                elements and length in _TYPES and kind in _TYPES
            ):
                _add(elements, Property(name, _TYPES[kind], _TYPES[length]))
            case ["property", kind, name] if elements and kind in _TYPES:
                _add(elements, Property(name, _TYPES[kind]))
            case [keyword, *_] if keyword in _KEYWORDS:
                raise BrokenMeshError(
                    f"The header cannot be understood: {line.strip()[:60]!r}. "
                    "Export the mesh again.",
                    number,
                )
            case _:
                # Comments, also those of programs that forget to say so.
                pass
    if order is None:
        raise BrokenMeshError("The header names no format. Export the mesh again.")
    return order, elements, end.end(), len(lines) + 1


def _add(elements: list[Element], found: Property) -> None:
    last = elements[-1]
    if found.name in [p.name for p in last.properties]:
        raise BrokenMeshError(f"The header names {found.name!r} twice. Export the mesh again.")
    elements[-1] = Element(last.name, last.rows, (*last.properties, found))
