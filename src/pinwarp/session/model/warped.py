"""A study's model carried through the warps of its bodies: a value, with a row per element."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.model_rows import ElementRow, Outcome, counts
from pinwarp.core.model_warp import WarpedBody, warp_body
from pinwarp.io.osim.bone import Bone, bone_of, split_bone_path
from pinwarp.io.osim.writing import mesh_names, spliced
from pinwarp.session.keeping.files import with_meshes
from pinwarp.session.model.body_warp import BodyWarp, body_warp
from pinwarp.session.model.study import ModelStudy, StudyBody
from pinwarp.session.session import Session

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class WarpedModel:
    """A model that was carried; nothing is written yet.

    Attributes
    ----------
    study
        What it was made from.
    bodies
        The warped bodies, in the order of the study.
    warps
        What each was carried through, in the same order.
    rows
        What became of every element that stands on them, each once.
    notes
        What is to be known, as sentences.
    lengths
        New lengths of muscles by key and property, where they were scaled.

    Examples
    --------
    >>> import pinwarp
    >>> from pinwarp.io.samples import sample_model
    >>> model = pinwarp.read_model(sample_model())
    >>> shank = pinwarp.read_mesh(sample_model().parent / "Geometry" / "shank.obj").mesh
    >>> landmarks = tuple(
    ...     pinwarp.Landmark(f"p{i}", tuple(place), tuple(1.2 * place))
    ...     for i, place in enumerate(shank.vertices[::9])
    ... )
    >>> session = pinwarp.Session(landmarks=landmarks)
    >>> warped = pinwarp.warp_model(model, {"shank": session})
    >>> {outcome.value: count for outcome, count in warped.counts.items()}
    {'warped': 5, 'kept': 5, 'flagged': 0}
    """

    study: ModelStudy
    bodies: tuple[WarpedBody, ...]
    warps: tuple[BodyWarp, ...]
    rows: tuple[ElementRow, ...]
    notes: tuple[str, ...]
    lengths: Mapping[int, Mapping[str, Matrix]] = field(default_factory=dict)

    @property
    def flagged(self) -> tuple[ElementRow, ...]:
        """The rows that ask to be looked at."""
        return tuple(row for row in self.rows if row.outcome is Outcome.FLAGGED)

    @property
    def counts(self) -> dict[Outcome, int]:
        """How many elements were warped, kept and flagged."""
        return counts(self.rows)

    @cached_property
    def meshes(self) -> dict[int, Mesh]:
        """The new meshes by key, each in the frame that it is drawn in."""
        return {key: mesh for body in self.bodies for key, mesh in body.meshes.items()}

    def mesh_names(self, folder: str) -> dict[int, str]:
        """Return how their files are called within a folder beside the new model, by key."""
        return mesh_names(self.study.model, self.meshes, folder)

    def data(self, folder: str) -> bytes:
        """Return the bytes of the new model, its meshes in a folder beside it."""
        return spliced(self.study.model, self.bodies, self.mesh_names(folder), self.lengths)


def warped_model(
    study: ModelStudy, told: Callable[[str], None] = lambda _body: None
) -> WarpedModel:
    """Carry all enabled bodies of a study.

    Parameters
    ----------
    study
        What is to be done.
    told
        Called with the name of each body before it is carried; what it raises ends the work.

    Returns
    -------
    WarpedModel

    Raises
    ------
    PinwarpError
        When no body is enabled, a session does not fit its body, a mesh is missing, or a rule
        names nothing on these bodies; see :func:`~pinwarp.session.model.body_warp.body_warp`.
    """
    chosen = [each for each in study.bodies if each.enabled]
    if not chosen:
        raise PinwarpError("No body has a session: name one, as in --body femur_r=SESSION.")
    bones = [bone_of(study.model, each.body, study.folders) for each in chosen]
    _check_rules(study, bones)
    bodies, warps = [], []
    for each, bone in zip(chosen, bones, strict=True):
        told(bone.name)
        warp = body_warp(_readied(each, bone), bone)
        rules = study.rules_of(each)
        try:
            bodies.append(warp_body(bone.parts, warp.warp, rules, warp.deviation))
        except ValueError as error:
            raise PinwarpError(f"{bone.name}: of a frame {error} after the warp.") from None
        warps.append(warp)
    # A muscle or a joint may stand on two bodies.
    rows = {(row.path, row.kind, row.line): row for body in reversed(bodies) for row in body.rows}
    ordered = [
        row for body in bodies for row in body.rows if rows[row.path, row.kind, row.line] is row
    ]
    notes = (*study.notes, *(note for warp in warps for note in warp.notes))
    return WarpedModel(study, tuple(bodies), tuple(warps), tuple(ordered), notes)


def _readied(each: StudyBody, bone: Bone) -> Session:
    """Return the session with the meshes that its warp asks for."""
    session, source = each.session, each.session.source
    if source is not None and split_bone_path(source.path) is not None and bone.meshes:
        needs_bone = session.mesh(Side.SOURCE) is None and not source.mirrored
        if needs_bone and source.sha256 == bone.file.sha256:
            mesh = bone.file.mesh
            file = replace(
                bone.file,
                mesh=mesh.with_vertices(source.scaled * mesh.vertices),
                scaled=source.scaled,
            )
            session = session.with_mesh(Side.SOURCE, file)
    folder = None if each.path is None else each.path.parent
    if session.groups:
        return with_meshes(session, Side, folder)
    if source is not None and source.mirrored:
        return with_meshes(session, [Side.SOURCE], folder)
    return session


def _check_rules(study: ModelStudy, bones: list[Bone]) -> None:
    known = frozenset[str]().union(*(bone.parts.paths for bone in bones))
    frames = {path for bone in bones for path in bone.parts.frames}
    for path in sorted(study.keep - known):
        raise PinwarpError(
            f"{path} cannot be kept: it is no point, frame, wrap, mesh or moving joint of a body "
            "that is warped."
        )
    for path in sorted(study.turn - frames):
        raise PinwarpError(
            f"{path} cannot be turned: it is no frame of the bodies that are warped."
        )
