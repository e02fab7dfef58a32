"""The meshes that are drawn on a body of a model."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pinwarp.core.mesh import Mesh
from pinwarp.core.model_parts import MeshPart
from pinwarp.core.placement import Placement
from pinwarp.io.file_names import with_slashes
from pinwarp.io.meshes import MeshFile, read_mesh
from pinwarp.io.osim.document import Element
from pinwarp.io.osim.model import OsimModel
from pinwarp.io.osim.sockets import attached_to

FOLDER = "Geometry"


@dataclass(frozen=True, eq=False)
class BodyMesh:
    """A mesh of a body and the file it is from.

    Parameters
    ----------
    part
        The mesh in the model.
    file
        The file, as it was read.
    """

    part: MeshPart
    file: MeshFile


def mesh_elements(model: OsimModel, body: str) -> tuple[Element, ...]:
    """Return the elements of a body's meshes, those of its frames included.

    Parameters
    ----------
    model
        The model.
    body
        Path of the body.
    """
    return tuple(
        element
        for element in model.objects
        if element.tag == "Mesh"
        and model.text(element, "mesh_file")
        and model.body_of(attached_to(model, element)) == body
    )


def find_mesh_file(model: OsimModel, element: Element, folders: Sequence[Path] = ()) -> Path | None:
    """Return the file of a mesh: beside the model, in its Geometry folder, or in further folders.

    Parameters
    ----------
    model, element
        The mesh's element.
    folders
        Where it is looked for, too.
    """
    beside = model.path.parent
    name = with_slashes(model.text(element, "mesh_file"), beside)
    for folder in (beside, beside / FOLDER, *folders):
        place = folder / name
        if place.is_file():
            return place
    return None


def read_meshes(model: OsimModel, body: str, folders: Sequence[Path] = ()) -> tuple[BodyMesh, ...]:
    """Read all meshes of a body.

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
        When a mesh is missing or cannot be read; the message names the element.

    Examples
    --------
    >>> from pinwarp.io.osim.reading import read_model
    >>> from pinwarp.io.samples import sample_model
    >>> (thigh,) = read_meshes(read_model(sample_model()), "/bodyset/thigh")
    >>> thigh.file.path.name, thigh.part.path
    ('thigh.vtp', '/bodyset/thigh/thigh_geom')
    """
    found = []
    for element in mesh_elements(model, body):
        place = find_mesh_file(model, element, folders)
        if place is None:
            raise model.error(
                element,
                f"Its mesh {model.text(element, 'mesh_file')} is neither beside the model nor in "
                f"{model.path.parent / FOLDER}. Put it there, or name the folder it is in.",
            )
        file = read_mesh(place)
        part = MeshPart(
            element.number,
            model.path_of(element),
            "mesh",
            element.line,
            attached_to(model, element),
            file.mesh,
            model.numbers(element, "scale_factors", (1, 1, 1)),
        )
        if not part.scale.all():
            raise model.error(element, "A scale factor is 0. Correct it.")
        found.append(BodyMesh(part, file))
    return tuple(found)


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Return several meshes as one.

    Examples
    --------
    >>> triangle = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> joined([triangle, triangle]).faces.tolist()
    [[0, 1, 2], [3, 4, 5]]
    """
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]),
    )


def fingerprint(meshes: Sequence[tuple[BodyMesh, Placement]]) -> str:
    """Return a hash of a body's meshes and where they are on it, as of a file's bytes."""
    told = [
        (mesh.file.sha256, mesh.part.scale.tolist(), _rounded(at.rotation), _rounded(at.origin))
        for mesh, at in meshes
    ]
    return hashlib.sha256(repr(told).encode()).hexdigest()


def _rounded(values: np.ndarray) -> list[float]:
    # Sines and cosines differ in the last digit from one machine to the other.
    return [round(float(x), 9) + 0.0 for x in values.ravel()]
