"""The header of a PLY file: what tables follow, and of what columns."""

from __future__ import annotations

import re
from dataclasses import dataclass

from pinwarp.io.mesh_formats.surface import BrokenMeshError

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
    "float": "f4",
    "double": "f8",
    "float32": "f4",
    "float64": "f8",
}
_ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
_END = re.compile(rb"^end_header[ \t]*(\r\n|\n|\r)", re.MULTILINE)


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


def read_header(data: bytes) -> tuple[str, list[Element], int]:
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

    Raises
    ------
    BrokenMeshError
        When this is not PLY, or the header cannot be understood.

    Examples
    --------
    >>> read_header(b"ply\nformat ascii 1.0\nelement vertex 3\nend_header\n")
    ('=', [Element(name='vertex', rows=3, properties=())], 49)
    """
    end = _END.search(data)
    if not data.startswith(b"ply") or end is None:
        raise BrokenMeshError(
            "This is not a PLY file, or its header was cut off. Export the mesh again."
        )
    order = None
    elements: list[Element] = []
    for number, line in enumerate(data[: end.start()].decode("latin-1").splitlines(), 1):
        match line.split():
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
            case [] | ["ply" | "comment" | "obj_info", *_]:
                pass
            case _:
                raise BrokenMeshError(
                    f"The header cannot be understood: {line[:60]!r}. Export the mesh again.",
                    number,
                )
    if order is None:
        raise BrokenMeshError("The header names no format. Export the mesh again.")
    return order, elements, end.end()


def _add(elements: list[Element], found: Property) -> None:
    last = elements[-1]
    if found.name in [p.name for p in last.properties]:
        raise BrokenMeshError(f"The header names {found.name!r} twice. Export the mesh again.")
    elements[-1] = Element(last.name, last.rows, (*last.properties, found))


def in_doubles(element: Element) -> Element:
    """Return the same table with every number in double precision.

    Examples
    --------
    >>> in_doubles(Element("vertex", 3, (Property("x", "f4"),))).properties[0].kind
    'f8'
    """
    return Element(
        element.name,
        element.rows,
        tuple(Property(p.name, "f8", p.length_kind and "f8") for p in element.properties),
    )
