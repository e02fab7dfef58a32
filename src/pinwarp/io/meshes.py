"""Reading and writing meshes, whatever the file format."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy as np

from pinwarp.core.errors import FileFormatError, MeshError
from pinwarp.core.mesh import Mesh
from pinwarp.core.words import with_article
from pinwarp.io.atomic import atomic_path
from pinwarp.io.mesh_formats.foreign import foreign_in, foreign_named
from pinwarp.io.mesh_formats.kinds import kind_in
from pinwarp.io.mesh_formats.obj import read_obj, write_obj
from pinwarp.io.mesh_formats.off import read_off, write_off
from pinwarp.io.mesh_formats.ply import read_ply, write_ply
from pinwarp.io.mesh_formats.stl import read_stl, write_stl
from pinwarp.io.mesh_formats.surface import BrokenMeshError, Report, Surface
from pinwarp.io.mesh_formats.triangles import mesh_of
from pinwarp.io.mesh_formats.vertex_data import NO_DATA, VertexData
from pinwarp.io.mesh_formats.vtk_legacy import read_legacy_vtk
from pinwarp.io.mesh_formats.vtk_xml import read_vtk_xml
from pinwarp.io.reading import Content, read_content

MESH_SUFFIXES = (
    ".stl",
    ".ply",
    ".obj",
    ".vtp",
    ".vtk",
    ".vtu",
    ".off",
    ".glb",
    ".gltf",
    ".3mf",
)
# What has room for more than places and triangles.
NORMALS_SUFFIXES = (".ply", ".obj", ".vtp", ".vtk", ".vtu", ".glb", ".gltf")
SCALARS_SUFFIXES = (".ply", ".vtp", ".vtk", ".vtu")

_Read = Callable[[bytes, Report], Surface]


def _read_3mf(data: bytes, report: Report) -> Surface:
    # Loaded only for files that need it, as all that is rare: the program starts sooner.
    from pinwarp.io.mesh_formats.threemf import read_3mf

    return read_3mf(data, report)


_READERS: dict[str, _Read] = {
    ".stl": read_stl,
    ".ply": read_ply,
    ".obj": read_obj,
    ".vtp": read_vtk_xml,
    ".vtk": read_legacy_vtk,
    ".vtu": read_vtk_xml,
    ".off": read_off,
    ".3mf": _read_3mf,
}


def _write_by(module: str, name: str) -> Callable[[Path, Mesh, VertexData], None]:
    def write(path: Path, mesh: Mesh, extras: VertexData) -> None:
        getattr(import_module(f"pinwarp.io.mesh_formats.{module}"), name)(path, mesh, extras)

    return write


_WRITERS: dict[str, Callable[[Path, Mesh, VertexData], None]] = {
    ".stl": write_stl,
    ".ply": write_ply,
    ".obj": write_obj,
    ".vtp": _write_by("polydata", "write_vtp"),
    ".vtk": _write_by("polydata", "write_legacy_vtk"),
    ".vtu": _write_by("polydata", "write_vtu"),
    ".off": write_off,
    ".glb": _write_by("gltf", "write_glb"),
    ".gltf": _write_by("gltf", "write_gltf"),
    ".3mf": _write_by("threemf", "write_3mf"),
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
        The file. What is in it tells the format, its suffix only where that leaves it open.
    progress
        Told the share that is done (0 ... 1) and what is going on. To cancel, let it raise:
        the exception comes out of here.

    Returns
    -------
    MeshFile
        Vertices keep the order of the file. Polygons are cut into triangles; vertices that no
        triangle uses are dropped. STL has no shared vertices, and glTF splits them: corners at
        one place become one.

    Raises
    ------
    FileFormatError
        When the file is missing, cut off, damaged, or not a surface; what it is instead is said
        where that is known, and the way from there to a surface.

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

    content = read_content(path, what="mesh", progress=lambda share: tell(0.3 * share, "Reading"))
    kind = kind_in(content.data, _suffix(content.path))
    read, notes_on_kind = _reader(content, kind)
    try:
        # Numbers that are none make numpy warn; the check of the vertices refuses them in words.
        with np.errstate(invalid="ignore", over="ignore"):
            surface = read(content.data, lambda share: tell(0.3 + 0.5 * share, "Finding triangles"))
            tell(0.8, "Checking triangles")
            mesh, notes = mesh_of(surface)
    except BrokenMeshError as error:
        # What it is instead helps more than what was expected in its third line.
        if kind is None and (instead := foreign_in(content.data)):
            raise FileFormatError(content.path, instead) from error
        raise FileFormatError(content.path, str(error), error.line) from error
    except MeshError as error:
        raise FileFormatError(content.path, f"{error} Export the mesh again.") from error
    tell(1.0, "Done")
    return MeshFile(content.path, mesh, content.sha256, (*notes_on_kind, *notes))


def write_mesh(path: str | Path, mesh: Mesh, extras: VertexData = NO_DATA) -> None:
    """Write a mesh in the format of the file's suffix, all of it or nothing.

    Parameters
    ----------
    path
        The file. All formats keep double precision but STL and glTF, which know only single.
    mesh
        The mesh.
    extras
        Normals (PLY, OBJ, glTF and those of VTK) and scalars (PLY and those of VTK) to go with its
        vertices; the others have room for neither.

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


def _reader(content: Content, found: str | None) -> tuple[_Read, tuple[str, ...]]:
    """Return what reads a file, and what is to be said of its name."""
    suffix = _suffix(content.path)
    if (found or suffix) in (".glb", ".gltf"):
        from pinwarp.io.mesh_formats.gltf import read_gltf

        read_scene = partial(read_gltf, beside=partial(_beside, content.path))
        return read_scene, _misnamed(suffix, found, (".glb", ".gltf"))
    if (found or suffix) not in _READERS:
        instead = foreign_in(content.data) or foreign_named(content.path.name)
        raise FileFormatError(content.path, instead) if instead else _unknown_suffix(content.path)
    read = _READERS[found or suffix]
    return read, _misnamed(suffix, found, [x for x, other in _READERS.items() if other is read])


def _misnamed(suffix: str, found: str | None, suffixes: Sequence[str]) -> tuple[str, ...]:
    if found is None or suffix in suffixes:
        return ()
    return (f"It is {with_article(found[1:].upper())} file, whatever its name says.",)


def _beside(path: Path, name: str) -> bytes:
    """Return the bytes of a file that another one names; nothing is looked for further away."""
    if Path(name).name != name or "\\" in name or ":" in name:
        raise BrokenMeshError(
            f"Its numbers are in another place ({name[:60]!r}). Save it as GLB, all in one file."
        )
    return read_content(path.with_name(name), what="mesh").data


def _suffix(path: str | Path) -> str:
    return Path(path).suffix.lower()


def _unknown_suffix(path: str | Path) -> FileFormatError:
    return FileFormatError(
        path,
        f"Meshes of the type {_suffix(path) or 'without a suffix'!r} are not supported. "
        f"Convert it to one of {', '.join(MESH_SUFFIXES)}.",
    )
