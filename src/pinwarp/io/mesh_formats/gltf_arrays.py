"""The arrays of a glTF file: where they stand in its buffers, checked before they are taken."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinwarp.io.mesh_formats.allowance import Allowance
from pinwarp.io.mesh_formats.surface import BrokenMeshError

DAMAGED = "The file is damaged or was cut off. Export or copy it again."
_KINDS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
# What stands for 1 in numbers that stand for 0 ... 1.
_LARGEST = {"i1": 127, "u1": 255, "i2": 32767, "u2": 65535}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def item(scene: dict[str, Any], kind: str, number: Any) -> dict[str, Any]:
    """Return one entry of a list of the file.

    Raises
    ------
    BrokenMeshError
        When there is none.

    Examples
    --------
    >>> item({"meshes": [{"name": "femur"}]}, "meshes", 0)
    {'name': 'femur'}
    """
    entries = scene.get(kind)
    if not isinstance(entries, list) or whole(number) >= len(entries):
        raise BrokenMeshError(DAMAGED)
    entry = entries[number]
    if not isinstance(entry, dict):
        raise BrokenMeshError(DAMAGED)
    return entry


def whole(number: Any) -> int:
    """Return a number that is whole and not below zero.

    Raises
    ------
    BrokenMeshError
        When it is none.

    Examples
    --------
    >>> whole(3)
    3
    """
    if not isinstance(number, int) or isinstance(number, bool) or number < 0:
        raise BrokenMeshError(DAMAGED)
    return number


class Arrays:
    """The arrays of one file.

    Parameters
    ----------
    scene
        What the file says.
    buffers
        The bytes it has.
    allowance
        How much all of them may come to.
    """

    def __init__(self, scene: dict[str, Any], buffers: list[bytes], allowance: Allowance) -> None:
        self._scene, self._buffers, self._allowance = scene, buffers, allowance

    def positions(self, primitive: dict[str, Any]) -> NDArray[np.float64]:
        """Return the (n, 3) positions of a part's vertices.

        Raises
        ------
        BrokenMeshError
            When they are compressed, damaged or not there.
        """
        accessor = self._accessor_of(primitive, primitive.get("attributes", {}).get("POSITION"))
        found = self._array(accessor)
        if found.shape[1] != 3:
            raise BrokenMeshError(DAMAGED)
        positions: NDArray[np.float64] = found.astype(np.float64)
        if accessor.get("normalized"):
            positions = np.maximum(positions / _LARGEST.get(found.dtype.str[1:], 1), -1.0)
        return positions

    def corners(self, primitive: dict[str, Any]) -> NDArray[np.int64]:
        """Return the vertex numbers of a part, in a row; where it has none, one after the other.

        Raises
        ------
        BrokenMeshError
            When they are compressed or damaged.
        """
        if "indices" in primitive:
            found = self._array(self._accessor_of(primitive, primitive["indices"]))
            if found.dtype.kind != "u":
                raise BrokenMeshError(DAMAGED)
            return found.ravel().astype(np.int64)
        position = primitive.get("attributes", {}).get("POSITION")
        count = whole(self._accessor_of(primitive, position)["count"])
        self._allowance.take(8 * count)
        return np.arange(count)

    def _accessor_of(self, primitive: dict[str, Any], number: Any) -> dict[str, Any]:
        accessor = item(self._scene, "accessors", number)
        view = accessor.get("bufferView")
        packed = [*primitive.get("extensions", {})] if view is None else []
        if view is not None:
            packed = [*item(self._scene, "bufferViews", view).get("extensions", {})]
        # Without them the numbers mean something else, or are zeros.
        for extension in packed:
            if "compression" in extension:
                raise BrokenMeshError(
                    f"The mesh is compressed ({extension[:40]}). Export it without compression."
                )
        return accessor

    def _array(self, accessor: dict[str, Any]) -> NDArray[np.generic]:
        count, width = whole(accessor["count"]), _WIDTHS[accessor["type"]]
        kind = np.dtype(_KINDS[accessor["componentType"]])
        self._allowance.take(count * width * kind.itemsize)
        if "bufferView" in accessor:
            found = self._table(accessor, count, width, kind)
        else:
            found = np.zeros((count, width), dtype=kind)
        sparse = accessor.get("sparse")
        if sparse:
            changed = whole(sparse["count"])
            rows_kind = np.dtype(_KINDS[sparse["indices"]["componentType"]])
            rows = self._table(sparse["indices"], changed, 1, rows_kind).ravel().astype(np.int64)
            values = self._table(sparse["values"], changed, width, kind)
            if changed and rows.max() >= count:
                raise BrokenMeshError(DAMAGED)
            found = found.copy()
            found[rows] = values
        return found

    def _table(
        self, where: dict[str, Any], count: int, width: int, kind: np.dtype[Any]
    ) -> NDArray[Any]:
        """Return so many rows from a view of a buffer."""
        view = item(self._scene, "bufferViews", where["bufferView"])
        number = whole(view["buffer"])
        if number >= len(self._buffers):
            raise BrokenMeshError(DAMAGED)
        buffer = self._buffers[number]
        begin = whole(view.get("byteOffset", 0))
        end = begin + whole(view["byteLength"])
        start = begin + whole(where.get("byteOffset", 0))
        row = width * kind.itemsize
        stride = whole(view.get("byteStride", row))
        if count == 0:
            return np.empty((0, width), dtype=kind)
        if stride < row or end > len(buffer) or start + (count - 1) * stride + row > end:
            raise BrokenMeshError(DAMAGED)
        return np.ndarray((count, width), kind, buffer, start, (stride, kind.itemsize))
