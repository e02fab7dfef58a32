"""The little of VTK that files need: cutting polygons into triangles, and its own writers."""

from __future__ import annotations

import errno
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (
    VTK_TRIANGLE,
    vtkCellArray,
    vtkPointSet,
    vtkPolyData,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

from pinwarp.core.mesh import Mesh
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData


def cut_polygons(
    points: NDArray[np.float64], corners: NDArray[np.int64], sizes: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Cut polygons into triangles, also those that are not convex or not flat.

    Parameters
    ----------
    points
        (n, 3) positions.
    corners
        The vertex numbers of all polygons in a row; they must exist.
    sizes
        The number of corners of each polygon, at least three.

    Returns
    -------
    ndarray
        (t, 3) vertex numbers: of each polygon two less than it has corners.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> cut_polygons(square, np.arange(4), np.array([4])).shape
    (2, 3)
    """
    polygons = _polydata(points, corners, np.concatenate([[0], np.cumsum(sizes)]))
    numbers = numpy_to_vtkIdTypeArray(np.arange(len(sizes)), deep=True)
    numbers.SetName("polygon")
    polygons.GetCellData().AddArray(numbers)
    cutter = vtkTriangleFilter()
    cutter.SetInputData(polygons)
    cutter.Update()
    output = cutter.GetOutput()
    cells = output.GetPolys().GetConnectivityArray()
    triangles: NDArray[np.int64] = vtk_to_numpy(cells).astype(np.int64).reshape(-1, 3)
    polygon = vtk_to_numpy(output.GetCellData().GetArray("polygon"))
    failed = np.bincount(polygon, minlength=len(sizes)) != sizes - 2
    if not failed.any():
        return triangles
    # Cutting off ears gives up where a polygon is bent and leaves a hole; a fan never does.
    counts = sizes[failed] - 2
    steps = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    first = np.repeat((np.cumsum(sizes) - sizes)[failed], counts)
    fans = corners[np.column_stack([first, first + steps + 1, first + steps + 2])]
    kept = ~failed[polygon]
    order = np.concatenate([polygon[kept], np.repeat(np.flatnonzero(failed), counts)])
    return np.concatenate([triangles[kept], fans])[np.argsort(order, kind="stable")]


def write_vtp(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write a VTP file in double precision.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh.
    extras
        Normals and scalars, in single precision, and remarks.

    Raises
    ------
    OSError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_vtp(Path(folder, "a.vtp"), Mesh(np.eye(3), [[0, 1, 2]]))
    ...     b'type="PolyData"' in Path(folder, "a.vtp").read_bytes()
    True
    """
    writer = vtkXMLPolyDataWriter()
    _write(writer, writer.GetOutputString, path, _surface(mesh), extras)


def write_vtu(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write a VTU file, an unstructured grid of triangles, in double precision.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh.
    extras
        Normals and scalars, in single precision, and remarks.

    Raises
    ------
    OSError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_vtu(Path(folder, "a.vtu"), Mesh(np.eye(3), [[0, 1, 2]]))
    ...     b'type="UnstructuredGrid"' in Path(folder, "a.vtu").read_bytes()
    True
    """
    surface = _surface(mesh)
    grid = vtkUnstructuredGrid()
    grid.SetPoints(surface.GetPoints())
    grid.SetCells(VTK_TRIANGLE, surface.GetPolys())
    writer = vtkXMLUnstructuredGridWriter()
    _write(writer, writer.GetOutputString, path, grid, extras)


def write_legacy_vtk(path: Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write a binary legacy VTK file in double precision.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh.
    extras
        Normals and scalars, in single precision, and remarks.

    Raises
    ------
    OSError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_legacy_vtk(Path(folder, "a.vtk"), Mesh(np.eye(3), [[0, 1, 2]]))
    ...     Path(folder, "a.vtk").read_bytes()[:14]
    b'# vtk DataFile'
    """
    writer = vtkPolyDataWriter()
    writer.SetFileTypeToBinary()
    # The title ends after 256 characters.
    writer.SetHeader(("; ".join(extras.plain_remarks) or "pinwarp")[:255])
    _write(writer, writer.GetOutputStdString, path, _surface(mesh), extras)


def _write(
    writer: Any,
    output: Callable[[], str | bytes],
    path: Path,
    mesh: vtkPointSet,
    extras: VertexData,
) -> None:
    complaints: list[str] = []

    def complain(_writer: object, _event: str, text: str) -> None:
        complaints.append(text)

    # With an observer VTK says it to us and not to the terminal.
    complain.CallDataType = "string"  # type: ignore[attr-defined]  # how VTK is asked for the text
    writer.AddObserver("ErrorEvent", complain)
    data = mesh.GetPointData()
    if extras.normals is not None:
        normals = numpy_to_vtk(np.ascontiguousarray(extras.normals, dtype=np.float32), deep=True)
        normals.SetName("Normals")
        data.SetNormals(normals)
    for name, values in extras.scalars.items():
        array = numpy_to_vtk(np.ascontiguousarray(values, dtype=np.float32), deep=True)
        array.SetName(name)
        data.AddArray(array)
    writer.SetInputData(mesh)
    # Not to the disk: where that is full, the legacy writer takes the whole program down.
    writer.WriteToOutputStringOn()
    if not writer.Write() or writer.GetErrorCode() or complaints:
        reason = f": {complaints[0].strip().splitlines()[-1]}" if complaints else ""
        raise OSError(errno.EIO, f"The mesh could not be written{reason}", str(path))
    content = output()
    # VTK hands out text where the bytes happen to be some.
    path.write_bytes(_remarked(content.encode() if isinstance(content, str) else content, extras))


def _remarked(content: bytes, extras: VertexData) -> bytes:
    """Put the remarks into a comment below the first line of XML; others have a title for them."""
    if not extras.remarks or not content.startswith(b"<?xml"):
        return content
    # Two dashes would end the comment.
    remarks = "\n".join(extras.plain_remarks).replace("--", "- -")
    head, end, rest = content.partition(b"\n")
    return head + end + f"<!-- {remarks} -->\n".encode() + rest


def _surface(mesh: Mesh) -> vtkPolyData:
    return _polydata(mesh.vertices, mesh.faces.ravel(), np.arange(0, mesh.faces.size + 1, 3))


def _polydata(
    points: NDArray[np.float64], corners: NDArray[Any], offsets: NDArray[np.int64]
) -> vtkPolyData:
    places = vtkPoints()
    # Copies: VTK would otherwise keep pointers into arrays it does not own.
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtkIdTypeArray(np.ascontiguousarray(offsets, dtype=np.int64), deep=True),
        numpy_to_vtkIdTypeArray(np.ascontiguousarray(corners, dtype=np.int64), deep=True),
    )
    surface = vtkPolyData()
    surface.SetPoints(places)
    surface.SetPolys(cells)
    return surface
