"""A warped model's bytes: the model's own, with new values spliced in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath

from numpy.typing import ArrayLike

from pinwarp.core.mesh import Mesh
from pinwarp.core.model_warp import WarpedBody
from pinwarp.io.osim.functions import put_function
from pinwarp.io.osim.model import OsimModel
from pinwarp.io.osim.sockets import owner_of
from pinwarp.io.osim.splicing import Splicer

_NOT_IN_A_NAME = '\\/:*?"<>|%&'


def spliced(
    model: OsimModel,
    bodies: Sequence[WarpedBody],
    mesh_names: Mapping[int, str],
    lengths: Mapping[int, Mapping[str, ArrayLike]] | None = None,
) -> bytes:
    """Return the bytes of a model with the new values of its bodies.

    Parameters
    ----------
    model
        As it was read.
    bodies
        Its warped bodies.
    mesh_names
        The files of the new meshes as the model is to name them, by key.
    lengths
        New lengths of muscles by key and property.

    Returns
    -------
    bytes
        Those of the model but for what is new.

    Examples
    --------
    >>> from pinwarp.io.osim.reading import read_model
    >>> from pinwarp.io.samples import sample_model
    >>> model = read_model(sample_model())
    >>> spliced(model, [], {}) == model.data
    True
    """
    splicer = Splicer(model.document)
    for key, numbers_by_name in (lengths or {}).items():
        for name, numbers in numbers_by_name.items():
            splicer.set_numbers(model.elements[key], name, numbers)
    for body in bodies:
        for key, values in body.values.items():
            for name, numbers in values.items():
                splicer.set_numbers(model.elements[key], name, numbers)
        for key, change in body.functions.items():
            element = model.elements[key]
            put_function(splicer, element, change.function)
            if len(change.function.knots):
                _set_coordinate(splicer, model, key, change.coordinate)
        for key in body.meshes:
            element = model.elements[key]
            splicer.set_text(element, "mesh_file", mesh_names[key])
            if (model.numbers(element, "scale_factors", (1, 1, 1)) != 1).any():
                splicer.set_text(element, "scale_factors", "1 1 1")
    return splicer.spliced()


def mesh_names(model: OsimModel, meshes: Mapping[int, Mesh], folder: str) -> dict[int, str]:
    """Return how the files of new meshes are called: by body and old name, each once.

    Parameters
    ----------
    model
        The model that they are of.
    meshes
        By key.
    folder
        That they go into, as seen from the new model.

    Examples
    --------
    >>> from pinwarp.io.osim.reading import read_model
    >>> from pinwarp.io.samples import sample_model
    >>> model = read_model(sample_model())
    >>> mesh = model.components["/bodyset/thigh/thigh_geom"]
    >>> mesh_names(model, {mesh.number: None}, "new_Geometry")[mesh.number]
    'new_Geometry/thigh_thigh.vtp'
    """
    names: dict[int, str] = {}
    taken: set[str] = set()
    for key in sorted(meshes):
        element = model.elements[key]
        body = model.body_of(owner_of(model, element)).rsplit("/", 1)[-1]
        old = PurePosixPath(model.text(element, "mesh_file").replace("\\", "/")).stem
        stem = "".join("_" if x in _NOT_IN_A_NAME or ord(x) < 32 else x for x in f"{body}_{old}")
        name, number = stem, 2
        while name.casefold() in taken:
            name, number = f"{stem}_{number}", number + 1
        taken.add(name.casefold())
        names[key] = f"{folder}/{name}.vtp"
    return names


def _set_coordinate(splicer: Splicer, model: OsimModel, key: int, coordinate: str) -> None:
    """Say which coordinate a function depends on, where a constant depended on none."""
    function = model.elements[key]
    holder = function.parent
    assert holder is not None, "a function is a property of something"
    if holder.tag == "function":
        holder = holder.parent
        assert holder is not None, "a property is one of something"
    if holder.tag == "TransformAxis":
        if model.text(holder, "coordinates") != coordinate:
            splicer.set_text(holder, "coordinates", coordinate)
        return
    # A moving path point: x_location goes with socket_x_coordinate.
    point = holder.parent if holder.tag.endswith("_location") else holder
    assert point is not None, "a property is one of something"
    axis = (holder.tag if holder.tag.endswith("_location") else function.name)[0]
    socket = f"socket_{axis}_coordinate"
    if model.socket(point, socket) != coordinate:
        splicer.set_text(point, socket, coordinate)
