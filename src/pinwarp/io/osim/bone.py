"""A body's bone: all of its meshes in the body's frame, read like a mesh's file."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.frame_warp import BodyRules, CarriedFrames
from pinwarp.core.mesh import Mesh
from pinwarp.core.model_parts import BodyParts
from pinwarp.core.placement import Placement
from pinwarp.io.meshes import MeshFile, read_mesh
from pinwarp.io.osim.body_parts import body_parts
from pinwarp.io.osim.geometry import BodyMesh, fingerprint, joined, read_meshes
from pinwarp.io.osim.model import OsimModel
from pinwarp.io.osim.reading import read_model

_BONE = re.compile(r"(?P<model>.+\.osim)#(?P<body>/.+)", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class Bone:
    """A body of a model with its meshes.

    Parameters
    ----------
    model, body
        Where it is from.
    parts
        All that stands on it.
    meshes
        Its meshes, with where the frame of each is in the body.
    """

    model: OsimModel
    body: str
    parts: BodyParts
    meshes: tuple[tuple[BodyMesh, Placement], ...]

    @property
    def name(self) -> str:
        """The body's name."""
        return self.parts.name

    @cached_property
    def mesh(self) -> Mesh | None:
        """All meshes as one in the body's frame; None where it has none."""
        return joined([mesh.part.on(at) for mesh, at in self.meshes]) if self.meshes else None

    @cached_property
    def file(self) -> MeshFile:
        """The bone as a session has it for its source.

        Raises
        ------
        FileFormatError
            When the body has no mesh.
        """
        if self.mesh is None:
            element = self.model.components[self.body]
            raise self.model.error(element, "It has no mesh to place landmarks on.")
        notes = [note for mesh, _ in self.meshes for note in mesh.file.notes]
        path = bone_path(self.model.path, self.body)
        return MeshFile(path, self.mesh, fingerprint(self.meshes), tuple(notes))


def bone_of(model: OsimModel, body: str, folders: Sequence[Path] = ()) -> Bone:
    """Gather a body and read its meshes.

    Parameters
    ----------
    model
        The model.
    body
        Path of the body.
    folders
        Where meshes are looked for beside the model's own places.

    Raises
    ------
    FileFormatError
        When a mesh is missing, or anything on the body cannot be used.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_model
    >>> thigh = bone_of(read_model(sample_model()), "/bodyset/thigh")
    >>> thigh.name, len(thigh.mesh.vertices), len(thigh.parts.points)
    ('thigh', 92, 5)
    """
    meshes = read_meshes(model, body, folders)
    parts = body_parts(model, body, [mesh.part for mesh in meshes])
    try:
        frames = CarriedFrames(parts, lambda places: places, BodyRules())
        for path in parts.frames:
            frames.before(path)
        placed = tuple((mesh, frames.before(mesh.part.frame)) for mesh in meshes)
    except ValueError as error:
        raise FileFormatError(model.path, f"{path}: Of its frame {error}. Correct it.") from None
    return Bone(model, body, parts, placed)


def bone_path(model: Path, body: str) -> Path:
    """Return how a session names a bone of a model.

    Examples
    --------
    >>> bone_path(Path("leg.osim"), "/bodyset/thigh").as_posix()
    'leg.osim#/bodyset/thigh'
    """
    return Path(f"{model}#{body}")


def split_bone_path(path: str | Path) -> tuple[Path, str] | None:
    """Return the model and the body that a path names; None where it is that of a mesh's file.

    Examples
    --------
    >>> split_bone_path("leg.osim#/bodyset/thigh")[1], split_bone_path("leg.stl")
    ('/bodyset/thigh', None)
    """
    found = _BONE.fullmatch(Path(path).as_posix())
    return None if found is None else (Path(found["model"]), found["body"])


def is_mesh_there(path: str | Path) -> bool:
    """Whether there is a file at a path, or the model where it names a body of one.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_model
    >>> is_mesh_there(f"{sample_model()}#/bodyset/shank"), is_mesh_there("no.osim#/bodyset/shank")
    (True, False)
    """
    named = split_bone_path(path)
    # Unlike Path.is_file, this never fails where a folder may not be looked into.
    return os.path.isfile(path if named is None else named[0])


def read_any_mesh(
    path: str | Path, *, progress: Callable[[float, str], None] | None = None
) -> MeshFile:
    """Read a mesh's file, or the bone of a body where a path names one.

    Parameters
    ----------
    path
        Of the file, or as of :func:`bone_path`.
    progress
        Told as by :func:`~pinwarp.io.meshes.read_mesh`; a bone is read in one go.

    Raises
    ------
    FileFormatError
        As :func:`~pinwarp.io.meshes.read_mesh` and :func:`read_bone`.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_model
    >>> len(read_any_mesh(f"{sample_model()}#/bodyset/shank").mesh.vertices)
    92
    """
    if split_bone_path(path) is None:
        return read_mesh(path, progress=progress)
    return read_bone(path)


def mesh_suffix(path: Path) -> str:
    """Return the suffix of a mesh that is made of the one at a path, in lower case.

    Examples
    --------
    >>> mesh_suffix(Path("femur.STL")), mesh_suffix(Path("leg.osim#/bodyset/thigh"))
    ('.stl', '.vtp')
    """
    return path.suffix.lower() if split_bone_path(path) is None else ".vtp"


def read_bone(path: str | Path) -> MeshFile:
    """Read the meshes of a body as one mesh in the body's frame.

    Parameters
    ----------
    path
        Of the model and the body, as of :func:`bone_path`.

    Returns
    -------
    MeshFile
        Its hash goes by the meshes' files and where they stand in the body, so that it stays
        where anything else of the model changes.

    Raises
    ------
    FileFormatError
        When model or meshes cannot be read, or there is no such body.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_model
    >>> read_bone(f"{sample_model()}#/bodyset/thigh").mesh.diagonal < 0.5
    True
    """
    named = split_bone_path(path)
    if named is None:
        raise FileFormatError(path, "This names no body of a model, as in leg.osim#/bodyset/hip.")
    model = read_model(named[0])
    return bone_of(model, model.body(named[1])).file
