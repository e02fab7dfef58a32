"""glTF and GLB, the scenes of the web and of Blender.

Not trimesh's reader: compressed and sparse positions are zeros or others there without a word, fans
are left out, and a small file can ask for all memory.
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.mesh import Mesh
from pinwarp.core.words import counted
from pinwarp.io.json_text import read_json
from pinwarp.io.mesh_formats.allowance import Allowance
from pinwarp.io.mesh_formats.gltf_arrays import DAMAGED, Arrays, item, whole
from pinwarp.io.mesh_formats.parts import Parts
from pinwarp.io.mesh_formats.surface import (
    BrokenMeshError,
    Report,
    Surface,
    cut_strips,
    merge_equal,
)
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData
from pinwarp.io.text import decoded

_MAGIC = b"glTF"
_JSON, _BINARY = 0x4E4F534A, 0x004E4942
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_EMBEDDED = "data:application/octet-stream;base64,"

Beside = Callable[[str], bytes]
"""Returns the bytes of a file that lies beside the one that is read."""


def read_gltf(data: bytes, report: Report, beside: Beside) -> Surface:
    """Read all triangles of a scene, each part where it stands; colours and the like are left out.

    Parameters
    ----------
    data
        The bytes of the file, of either kind.
    report
        Told the share that is done.
    beside
        Asked for files that a text names.

    Returns
    -------
    Surface
        In single precision. Programs split vertices where normals or textures disagree: those at
        one place become one again.

    Raises
    ------
    BrokenMeshError
        When the file was cut off, is compressed, or is not glTF.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_glb(Path(folder, "a.glb"), Mesh(np.eye(3), [[0, 1, 2]]))
    ...     content = Path(folder, "a.glb").read_bytes()
    >>> read_gltf(content, lambda share: None, lambda name: b"").points.shape
    (3, 3)
    """
    text, binary = _chunks(data) if data.startswith(_MAGIC) else (data, None)
    try:
        scene, _ = read_json(decoded(text))
    except (ValueError, RecursionError):
        raise BrokenMeshError(f"This is not a glTF file. {DAMAGED}") from None
    if not isinstance(scene, dict) or "asset" not in scene:
        raise BrokenMeshError("This is not a glTF file: it says nothing about its version.")
    buffers = _buffers(scene, binary, beside)
    allowance = Allowance(sum(map(len, buffers)))
    arrays = Arrays(scene, buffers, allowance)
    parts = Parts(allowance)
    lines = 0
    try:
        placed = _placed(scene)
        for number, (mesh, matrix) in enumerate(placed, 1):
            for primitive in item(scene, "meshes", mesh).get("primitives", []):
                triangles = _triangles(primitive, arrays)
                if triangles is None:
                    lines += 1
                    continue
                parts.take_one()
                parts.add(arrays.positions(primitive), triangles, matrix)
            report(0.8 * number / len(placed))
    except (AttributeError, KeyError, TypeError, ValueError, OverflowError, IndexError) as error:
        # What is there is not of the kind that the format says.
        raise BrokenMeshError(DAMAGED) from error
    points, found = parts.together()
    merged, numbers = merge_equal(points + 0.0)
    report(1.0)
    what = counted(lines, "part of lines or points", "parts of lines or points")
    return Surface(
        merged,
        numbers[found.ravel()],
        np.full(len(found), 3, dtype=np.int64),
        parts.note() + ((f"{what} dropped.",) if lines else ()),
    )


def _chunks(data: bytes) -> tuple[bytes, bytes | None]:
    """Return the text and the numbers of a binary file."""
    if len(data) < 20:
        raise BrokenMeshError(DAMAGED)
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise BrokenMeshError(f"It is of version {version} of glTF. Export it again, as version 2.")
    if length > len(data):
        raise BrokenMeshError(
            f"The file should have {length:,} bytes and has {len(data):,}: it was cut off. "
            "Export or copy it again."
        )
    found: dict[int, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = struct.unpack_from("<II", data, place)
        if place + 8 + size > length:
            raise BrokenMeshError(DAMAGED)
        found.setdefault(kind, data[place + 8 : place + 8 + size])
        place += 8 + size
    if _JSON not in found:
        raise BrokenMeshError(DAMAGED)
    return found[_JSON], found.get(_BINARY)


def _buffers(scene: dict[str, Any], binary: bytes | None, beside: Beside) -> list[bytes]:
    buffers = scene.get("buffers", [])
    if not isinstance(buffers, list):
        raise BrokenMeshError(DAMAGED)
    found = []
    for number, buffer in enumerate(buffers):
        uri = buffer.get("uri") if isinstance(buffer, dict) else None
        if uri is None and number == 0 and binary is not None:
            found.append(binary)
        elif not isinstance(uri, str):
            raise BrokenMeshError(DAMAGED)
        elif uri.startswith("data:"):
            try:
                found.append(base64.b64decode(uri.partition(",")[2], validate=True))
            except (binascii.Error, ValueError):
                raise BrokenMeshError(DAMAGED) from None
        else:
            found.append(beside(unquote(uri)))
    return found


def _placed(scene: dict[str, Any]) -> list[tuple[int, NDArray[np.float64]]]:
    """Return the meshes of a scene, each with the matrix that puts it into its place."""
    nodes = scene.get("nodes", [])
    if not nodes:
        return [(number, np.eye(4)) for number in range(len(scene.get("meshes", [])))]
    if scene.get("scenes"):
        roots = item(scene, "scenes", scene.get("scene", 0)).get("nodes", [])
    else:
        below = {child for node in nodes for child in node.get("children", [])}
        roots = [number for number in range(len(nodes)) if number not in below]
    found = []
    ahead = [(whole(root), np.eye(4)) for root in reversed(roots)]
    seen = set()
    while ahead:
        number, onto = ahead.pop()
        if number in seen:
            # Each has one place; going round would have no end.
            raise BrokenMeshError(DAMAGED)
        seen.add(number)
        node = item(scene, "nodes", number)
        matrix = onto @ _matrix(node)
        if "mesh" in node:
            found.append((whole(node["mesh"]), matrix))
        ahead += [(whole(child), matrix) for child in reversed(node.get("children", []))]
    return found


def _matrix(node: dict[str, Any]) -> NDArray[np.float64]:
    if "matrix" in node:
        # Column by column.
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    x, y, z, w = np.array(node.get("rotation", (0, 0, 0, 1)), dtype=np.float64)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    ) * np.array(node.get("scale", (1, 1, 1)), dtype=np.float64)
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


def _triangles(primitive: dict[str, Any], arrays: Arrays) -> NDArray[np.int64] | None:
    """Return the triangles of a part, None where it has lines or points."""
    kind = primitive.get("mode", _TRIANGLES)
    if kind not in (_TRIANGLES, _STRIP, _FAN):
        return None
    corners = arrays.corners(primitive)
    if kind == _STRIP:
        return cut_strips(corners, np.array([len(corners)]))
    if kind == _FAN:
        around = corners[1:]
        first = np.repeat(corners[:1], max(len(around) - 1, 0))
        return np.column_stack([first, around[:-1], around[1:]])
    return corners.reshape(-1, 3)


def write_glb(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write a binary glTF file; its numbers have single precision, the format knows no other.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh.
    extras
        Its normals and remarks; there is no room for scalars.

    Raises
    ------
    BrokenMeshError
        When a coordinate is too large for single precision.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_glb(Path(folder, "a.glb"), Mesh(np.eye(3), [[0, 1, 2]]))
    ...     Path(folder, "a.glb").read_bytes()[:4]
    b'glTF'
    """
    scene, binary = _scene(mesh, extras)
    text = json.dumps(scene).encode()
    # Each part ends at a multiple of four.
    text += b" " * (-len(text) % 4)
    length = 12 + 8 + len(text) + 8 + len(binary)
    head = _MAGIC + struct.pack("<II", 2, length)
    with path.open("wb") as file:
        file.write(head + struct.pack("<II", len(text), _JSON) + text)
        file.write(struct.pack("<II", len(binary), _BINARY) + binary)


def write_gltf(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write a glTF file with everything in it; otherwise as :func:`write_glb`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_gltf(Path(folder, "a.gltf"), Mesh(np.eye(3), [[0, 1, 2]]))
    ...     Path(folder, "a.gltf").read_text()[:10]
    '{"asset": '
    """
    scene, binary = _scene(mesh, extras)
    scene["buffers"][0]["uri"] = _EMBEDDED + base64.b64encode(binary).decode()
    path.write_text(json.dumps(scene), encoding="utf-8")


def _scene(mesh: Mesh, extras: VertexData) -> tuple[dict[str, Any], bytes]:
    if np.abs(mesh.vertices).max() > np.finfo(np.float32).max:
        raise BrokenMeshError(
            "The coordinates are too large for glTF, which has single precision. "
            "Save as PLY, OBJ or VTP instead."
        )
    places = mesh.vertices.astype("<f4")
    tables = [mesh.faces.astype("<u4"), places]
    attributes = {"POSITION": 1}
    if extras.normals is not None:
        attributes["NORMAL"] = len(tables)
        tables.append(extras.normals.astype("<f4"))
    accessors: list[dict[str, Any]] = [
        {"bufferView": n, "componentType": 5126, "count": len(table), "type": "VEC3"}
        for n, table in enumerate(tables)
    ]
    accessors[0] |= {"componentType": 5125, "count": tables[0].size, "type": "SCALAR"}
    accessors[1] |= {"min": places.min(axis=0).tolist(), "max": places.max(axis=0).tolist()}
    ends = np.cumsum([table.nbytes for table in tables]).tolist()
    views = [
        {"buffer": 0, "byteOffset": end - table.nbytes, "byteLength": table.nbytes}
        for table, end in zip(tables, ends, strict=True)
    ]
    made = {"extras": {"remarks": list(extras.plain_remarks)}} if extras.remarks else {}
    scene = {
        "asset": {"version": "2.0", "generator": "pinwarp", **made},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 0}]}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": ends[-1]}],
    }
    return scene, b"".join(table.tobytes() for table in tables)
