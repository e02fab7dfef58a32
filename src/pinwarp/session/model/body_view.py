"""How a session sees a body of a model: on the bone itself, or on one of its mesh files."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side, as_position, positions
from pinwarp.core.mesh import Mesh
from pinwarp.core.mirror import mirrored_points
from pinwarp.core.placement import HERE, Placement
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.io.mesh_reference import MeshReference
from pinwarp.io.meshes import MeshFile
from pinwarp.io.osim.bone import Bone, split_bone_path
from pinwarp.session.session import Session

Matrix = NDArray[np.float64]

IN_BODY_FRAME = "the session's landmarks are taken to be in the body's frame."


@dataclass(frozen=True, eq=False)
class BodyView:
    """The way from a session's source to a body's frame and back.

    Attributes
    ----------
    at, scale
        Where the frame of the mesh is in the body, and the (3,) factors it is drawn with there.
    scaled
        What the session multiplies the file's coordinates by.
    axes, mesh
        Across which it mirrors them, and the mesh whose middle the mirror is in, as it sees it.
    """

    at: Placement = HERE
    scale: Matrix = field(default_factory=lambda: np.ones(3))
    scaled: float = 1.0
    axes: str = ""
    mesh: Mesh | None = None

    @property
    def is_similar(self) -> bool:
        """Whether shapes stay: the factors change nothing but the side and the unit."""
        sizes = np.abs(self.scale)
        power = math.log10(sizes[0])
        return bool((sizes == sizes[0]).all()) and abs(power - round(power)) < 1e-9

    @property
    def unit(self) -> float:
        """What a length of the session is multiplied by to be one of the body."""
        return float(np.abs(self.scale[0])) / self.scaled

    @property
    def is_mirrored(self) -> bool:
        """Whether the session sees the other side's bone."""
        return bool(np.prod(self.scale) < 0) != (len(self.axes) % 2 == 1)

    def out(self, places: Matrix) -> Matrix:
        """Return (m, 3) places of the session as places of the body."""
        return self.at.out(self._mirrored(places) / self.scaled * self.scale)

    def into(self, places: Matrix) -> Matrix:
        """Return (m, 3) places of the body as places of the session."""
        return self._mirrored(self.at.into(places) / self.scale * self.scaled)

    def _mirrored(self, places: Matrix) -> Matrix:
        for axis in self.axes:
            assert self.mesh is not None, "what is mirrored has a mesh"
            places = mirrored_points(places, self.mesh, axis)
        return places


def view_of(session: Session, bone: Bone) -> tuple[BodyView, tuple[str, ...]]:
    """Find out how a session sees a bone.

    Parameters
    ----------
    session
        Its source is the bone, one of its mesh files, or not known.
    bone
        The body.

    Returns
    -------
    view, notes
        What is to be known about it, as sentences.

    Raises
    ------
    PinwarpError
        When the session is of another body, or a mesh that it mirrors is not there.
    """
    source = session.source
    if source is None:
        return BodyView(), (f"Its session names no source mesh: {IN_BODY_FRAME}",)
    named = split_bone_path(source.path)
    if named is not None and named[1] != bone.body:
        raise PinwarpError(
            f"{bone.name}: its session was made on {named[1]}. Give each body a session of its own."
        )
    if named is not None:
        changed = bool(bone.meshes) and source.sha256 != bone.file.sha256
        notes = ("Its meshes have changed since the landmarks were placed on them.",)
        return _seen(BodyView(), source, bone.mesh, bone), notes if changed else ()
    views = [
        _seen(BodyView(at, mesh.part.scale), source, mesh.file.mesh, bone)
        for mesh, at in bone.meshes
        if _is_same(source, mesh.file)
    ]
    if views:
        # A file that is drawn twice, once in a mirror, was paired where the landmarks lie.
        places = positions(session.pairs, Side.SOURCE)
        return min(views, key=lambda view: _far(bone, view.out(places))), ()
    mesh = session.mesh(Side.SOURCE)
    original = None if mesh is None else mesh.with_vertices(mesh.vertices / source.scaled)
    notes = (f"{source.path.name} is none of its meshes: {IN_BODY_FRAME}",)
    return _seen(BodyView(), source, original, bone), notes


def _seen(
    view: BodyView, source: MeshFile | MeshReference, mesh: Mesh | None, bone: Bone
) -> BodyView:
    if not source.mirrored:
        return replace(view, scaled=source.scaled)
    if mesh is None:
        raise PinwarpError(
            f"{bone.name}: its session sees {source.path.name} in a mirror, and that mesh, which "
            "tells where the mirror is, is not there."
        )
    seen = mesh.with_vertices(source.scaled * mesh.vertices)
    return replace(view, scaled=source.scaled, axes=source.mirrored, mesh=seen)


def _is_same(source: MeshFile | MeshReference, file: MeshFile) -> bool:
    return source.sha256 == file.sha256 or os.path.realpath(source.path) == os.path.realpath(
        file.path
    )


def _far(bone: Bone, places: Matrix) -> float:
    assert bone.mesh is not None, "a bone with a mesh file has a mesh"
    return float(SurfaceIndex(bone.mesh).distances(places).mean())


def in_body_frame(session: Session, view: BodyView) -> Session:
    """Return a session of pairs as it would be on the body itself.

    Through factors that differ along the axes shapes change: what was paired with the subject is
    the bone as the model draws it. Whether the subject is of the body's side or of the mirrored
    file's is seen from the pairs.
    """
    source = view.out(positions(session.pairs, Side.SOURCE))
    destination = positions(session.pairs, Side.DESTINATION) / view.scaled
    # The pose is left out of the warp: any mirror will do.
    sides = [destination, destination * [-1, 1, 1]] if view.is_mirrored else [destination]
    destination = min(sides, key=lambda places: _misfit(source, places))
    landmarks = tuple(
        replace(pair, source=as_position(a), destination=as_position(b))
        for pair, a, b in zip(session.pairs, source, destination, strict=True)
    )
    penalty = session.settings.penalty / view.scaled**session.settings.basis.power
    settings = replace(session.settings, penalty=penalty)
    return Session(landmarks=landmarks, settings=settings)


def _misfit(source: Matrix, destination: Matrix) -> float:
    return float(np.abs(fit_similarity(source, destination).apply(source) - destination).sum())
