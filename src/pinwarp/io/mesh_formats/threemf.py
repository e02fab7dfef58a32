"""3MF, the packed XML of printers and of CAD programs.

Not trimesh's reader: it takes lxml and networkx as well, unpacks whatever a small file asks for,
and keeps an object for every vertex in memory.
"""

from __future__ import annotations

import io
import zipfile
import zlib
from array import array
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.mesh import Mesh
from pinwarp.io.careful_xml import XmlError, parse_xml
from pinwarp.io.mesh_formats.allowance import Allowance
from pinwarp.io.mesh_formats.parts import Parts
from pinwarp.io.mesh_formats.surface import BrokenMeshError, Report, Surface
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData
from pinwarp.io.reading import LARGEST

_MODEL = "3D/3dmodel.model"
_DAMAGED = "The file is damaged or was cut off. Export or copy it again."
_DEEPEST = 50
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
_FURNITURE = {
    "[Content_Types].xml": (
        f'{_XML}<Types xmlns="{_PACKAGE}/content-types">'
        '<Default Extension="rels" '
        'ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        '<Default Extension="model" '
        'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>\n'
    ),
    "_rels/.rels": (
        f'{_XML}<Relationships xmlns="{_PACKAGE}/relationships"><Relationship '
        f'Target="/{_MODEL}" Id="rel0" '
        'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n'
    ),
}

_Key = tuple[str, str]
"""The file in the archive that an object is in, and its number there."""


@dataclass(eq=False)
class _Placed:
    """An object where it is used."""

    key: _Key
    matrix: NDArray[np.float64]


@dataclass(eq=False)
class _Object:
    places: array[float] = field(default_factory=lambda: array("d"))
    corners: array[int] = field(default_factory=lambda: array("q"))
    components: list[_Placed] = field(default_factory=list)


class _Models:
    """All objects of the models in an archive."""

    def __init__(self) -> None:
        self.objects: dict[_Key, _Object] = {}
        self.items: list[_Placed] = []
        self.unit = ""
        self._file = ""
        self._open = _Object()

    def parse(self, file: str, data: bytes) -> None:
        self._file = file.lower().strip("/")
        # Vertices and triangles take no more memory than their numbers.
        parse_xml(data, self._begin, most=LARGEST)

    def _begin(self, tag: str, attributes: Mapping[str, str], line: int) -> None:
        try:
            self._take(tag.rpartition(":")[2], attributes)
        except (KeyError, ValueError, OverflowError):
            raise XmlError(f"<{tag[:20]}> lacks a number, or has one that is none", line) from None

    def _take(self, tag: str, attributes: Mapping[str, str]) -> None:
        match tag:
            case "vertex":
                self._open.places.extend(float(attributes[axis]) for axis in "xyz")
            case "triangle":
                self._open.corners.extend(int(attributes[v]) for v in ("v1", "v2", "v3"))
            case "object":
                self._open = self.objects[self._file, attributes["id"]] = _Object()
            case "component":
                self._open.components.append(self._placed(attributes))
            case "item":
                self.items.append(self._placed(attributes))
            case "model":
                self.unit = self.unit or attributes.get("unit", "")

    def _placed(self, attributes: Mapping[str, str]) -> _Placed:
        file = next((v for k, v in attributes.items() if k.endswith("path")), self._file)
        matrix = np.eye(4)
        if "transform" in attributes:
            # Rows to be multiplied with from the left, the shift last.
            numbers = [float(word) for word in attributes["transform"].split()]
            matrix[:3] = np.array(numbers).reshape(4, 3).T
        return _Placed((file.lower().strip("/"), attributes["objectid"]), matrix)


def read_3mf(data: bytes, report: Report) -> Surface:
    """Read all objects of a 3MF file, each where it stands; colours are left out.

    Parameters
    ----------
    data
        The bytes of the file.
    report
        Told the share that is done.

    Returns
    -------
    Surface
        In the file's unit, which is told where it is not the millimetre.

    Raises
    ------
    BrokenMeshError
        When the file is damaged, unpacks to far more than its size, or is not 3MF.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_3mf(Path(folder, "a.3mf"), Mesh(np.eye(3), [[0, 1, 2]]))
    ...     read_3mf(Path(folder, "a.3mf").read_bytes(), lambda share: None).points.shape
    (3, 3)
    """
    allowance = Allowance(len(data))
    models = _Models()
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            files = [x for x in archive.infolist() if x.filename.lower().endswith(".model")]
            # The main one first: it says the unit.
            files.sort(key=lambda x: x.filename.lower().strip("/") != _MODEL.lower())
            for number, file in enumerate(files, 1):
                allowance.take(file.file_size)
                models.parse(file.filename, archive.read(file))
                report(0.8 * number / len(files))
    except XmlError as error:
        raise BrokenMeshError(
            f"The model in the file cannot be read: {error} (its line {error.line:,}). "
            "Export or copy it again."
        ) from None
    except (zipfile.BadZipFile, zlib.error, EOFError, ValueError, OSError) as error:
        raise BrokenMeshError(_DAMAGED) from error
    except (NotImplementedError, RuntimeError) as error:
        # What zipfile raises over a way of packing that it does not know, and over a password.
        raise BrokenMeshError(
            "The file is encrypted, or packed in a way that cannot be read. Export it again."
        ) from error
    parts = Parts(allowance)
    for item in models.items or [_Placed(key, np.eye(4)) for key in models.objects]:
        _add(parts, models, item, np.eye(4), 0)
    report(1.0)
    points, triangles = parts.together()
    unit = models.unit.lower()
    notes = (f"The file says that its unit is the {unit[:20]}.",) if unit else ()
    return Surface(
        points,
        triangles.ravel(),
        np.full(len(triangles), 3, dtype=np.int64),
        parts.note() + (notes if unit != "millimeter" else ()),
    )


def _add(
    parts: Parts, models: _Models, placed: _Placed, onto: NDArray[np.float64], depth: int
) -> None:
    found = models.objects.get(placed.key)
    if found is None or depth > _DEEPEST:
        raise BrokenMeshError(_DAMAGED)
    # Also what holds nothing: components of components can be a billion.
    parts.take_one()
    matrix = onto @ placed.matrix
    if found.places or not found.components:
        points = np.frombuffer(found.places, dtype=np.float64).reshape(-1, 3)
        parts.add(points, np.frombuffer(found.corners, dtype=np.int64).reshape(-1, 3), matrix)
    for component in found.components:
        _add(parts, models, component, matrix, depth + 1)


def write_3mf(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write a 3MF file whose numbers read back exactly.

    Parameters
    ----------
    path
        The file. It says no unit, which other programs take for the millimetre.
    mesh
        The mesh.
    extras
        Its remarks; there is no room for anything else.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_3mf(Path(folder, "a.3mf"), Mesh(np.eye(3), [[0, 1, 2]]))
    ...     zipfile.ZipFile(Path(folder, "a.3mf")).namelist()
    ['[Content_Types].xml', '_rels/.rels', '3D/3dmodel.model']
    """
    vertices = "".join(
        f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>\n' for x, y, z in mesh.vertices.tolist()
    )
    triangles = "".join(
        f'<triangle v1="{a}" v2="{b}" v3="{c}"/>\n' for a, b, c in mesh.faces.tolist()
    )
    remarks = escape("\n".join(extras.plain_remarks))
    made = f'<metadata name="Description">{remarks}</metadata>' if remarks else ""
    model = (
        f'{_XML}<model xmlns="{_CORE}">{made}<resources><object id="1" type="model"><mesh>\n'
        f"<vertices>\n{vertices}</vertices>\n<triangles>\n{triangles}</triangles>\n</mesh></object>"
        '</resources><build><item objectid="1"/></build></model>\n'
    )
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in {**_FURNITURE, _MODEL: model}.items():
            archive.writestr(name, text)
    path.write_bytes(whole.getvalue())
