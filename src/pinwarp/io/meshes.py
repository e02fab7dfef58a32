"""Reading and writing meshes, whatever the file format."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pinwarp.core.errors import FileFormatError, MeshError
from pinwarp.core.mesh import Mesh
from pinwarp.io.atomic import atomic_path
from pinwarp.io.mesh_formats.obj import read_obj, write_obj
from pinwarp.io.mesh_formats.ply import read_ply, write_ply
from pinwarp.io.mesh_formats.stl import read_stl, write_stl
from pinwarp.io.mesh_formats.surface import BrokenMeshError
from pinwarp.io.mesh_formats.triangles import mesh_of
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData
from pinwarp.io.mesh_formats.vtk_legacy import read_legacy_vtk
from pinwarp.io.mesh_formats.vtp import read_vtp
from pinwarp.io.reading import read_content

MESH_SUFFIXES = (".stl", ".ply", ".obj", ".vtp", ".vtk")
# What has room for more than places and triangles.
NORMALS_SUFFIXES = (".ply", ".obj", ".vtp", ".vtk")
SCALARS_SUFFIXES = (".ply", ".vtp", ".vtk")

_READERS = {
    ".stl": read_stl,
    ".ply": read_ply,
    ".obj": read_obj,
    ".vtp": read_vtp,
    ".vtk": read_legacy_vtk,
}


def _write_vtp(path: Path, mesh: Mesh, extras: VertexData) -> None:
    # VTK is loaded only for what needs it.
    from pinwarp.io.mesh_formats.polydata import write_vtp

    write_vtp(path, mesh, extras)


def _write_legacy_vtk(path: Path, mesh: Mesh, extras: VertexData) -> None:
    from pinwarp.io.mesh_formats.polydata import write_legacy_vtk

    write_legacy_vtk(path, mesh, extras)


_WRITERS: dict[str, Callable[[Path, Mesh, VertexData], None]] = {
    ".stl": write_stl,
    ".ply": write_ply,
    ".obj": write_obj,
    ".vtp": _write_vtp,
    ".vtk": _write_legacy_vtk,
}


@dataclass(frozen=True, eq=False)
class MeshFile:
    """A mesh and the file it came from.

    Parameters
    ----------
    path
        The file, absolute.
    mesh
        The mesh.
    sha256
        The hash of the file's bytes, those the mesh was made of.
    notes
        What was changed or left out, as sentences for the user.
    mirrored
        The axes across which the mesh was mirrored after reading, such as ``"x"``.
    scaled
        What its coordinates were multiplied by after reading.

    Examples
    --------
    >>> from pinwarp.io.samples import assets_folder
    >>> file = read_mesh(assets_folder() / "femur_generic.ply")
    >>> file.path.name, len(file.mesh.vertices), file.notes
    ('femur_generic.ply', 10000, ())
    """

    path: Path
    mesh: Mesh
    sha256: str
    notes: tuple[str, ...]
    mirrored: str = ""
    scaled: float = 1.0


def read_mesh(
    path: str | Path, *, progress: Callable[[float, str], None] | None = None
) -> MeshFile:
    r"""Read a mesh of any supported format.

    Parameters
    ----------
    path
        The file; its suffix tells the format.
    progress
        Told the share that is done (0 ... 1) and what is going on. To cancel, let it raise:
        the exception comes out of here.

    Returns
    -------
    MeshFile
        Vertices keep the order of the file. Polygons are cut into triangles; vertices that no
        triangle uses are dropped. STL has no shared vertices: corners at one place become one.

    Raises
    ------
    FileFormatError
        When the file is missing, cut off, damaged, of an unknown format, or not a surface.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "square.obj")
    ...     _ = path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    ...     found = read_mesh(path)
    >>> len(found.mesh.faces), found.notes
    (2, ('1 polygon of more than 3 corners cut into triangles.',))
    """

    def tell(share: float, words: str) -> None:
        if progress is not None:
            progress(share, words)

    read = _READERS.get(_suffix(path))
    if read is None and not os.path.isdir(path):
        raise _unknown_suffix(path)
    content = read_content(path, what="mesh", progress=lambda share: tell(0.3 * share, "Reading"))
    assert read is not None, "a folder is refused above"
    try:
        # Numbers that are none make numpy warn; the check of the vertices refuses them in words.
        with np.errstate(invalid="ignore", over="ignore"):
            surface = read(content.data, lambda share: tell(0.3 + 0.5 * share, "Finding triangles"))
            tell(0.8, "Checking triangles")
            mesh, notes = mesh_of(surface)
    except BrokenMeshError as error:
        raise FileFormatError(content.path, str(error), error.line) from error
    except MeshError as error:
        raise FileFormatError(content.path, f"{error} Export the mesh again.") from error
    tell(1.0, "Done")
    return MeshFile(content.path, mesh, content.sha256, notes)


def write_mesh(path: str | Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write a mesh in the format of the file's suffix, all of it or nothing.

    Parameters
    ----------
    path
        The file. All formats but STL keep double precision; STL knows only single.
    mesh
        The mesh.
    extras
        Normals (PLY, OBJ, VTP, VTK) and scalars (PLY, VTP, VTK) to go with its vertices; STL has
        room for neither.

    Raises
    ------
    FileFormatError
        When the format is not supported, or cannot hold these coordinates.
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "triangle.ply")
    ...     write_mesh(path, Mesh([[0.1, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    ...     float(read_mesh(path).mesh.vertices[0, 0])
    0.1
    """
    write = _WRITERS.get(_suffix(path))
    if write is None:
        raise _unknown_suffix(path)
    with atomic_path(path) as temporary:
        try:
            write(temporary, mesh, extras)
        except BrokenMeshError as error:
            raise FileFormatError(path, str(error)) from error


def _suffix(path: str | Path) -> str:
    return Path(path).suffix.lower()


def _unknown_suffix(path: str | Path) -> FileFormatError:
    return FileFormatError(
        path,
        f"Meshes of the type {_suffix(path) or 'without a suffix'!r} are not supported. "
        f"Convert it to one of {', '.join(MESH_SUFFIXES)}.",
    )
