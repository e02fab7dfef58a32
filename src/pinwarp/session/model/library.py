"""A model warped in one call: what scripts use."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from pinwarp.io.osim.model import OsimModel
from pinwarp.session.model.study import study_of
from pinwarp.session.model.warped import WarpedModel, warped_model
from pinwarp.session.session import Session


def warp_model(
    model: OsimModel,
    sessions: Mapping[str, Session | str | Path],
    *,
    turn: Iterable[str] = (),
    keep: Iterable[str] = (),
    turns: bool = False,
    folders: Iterable[str | Path] = (),
) -> WarpedModel:
    """Carry bodies of a generic model, and all that stands on them, to a subject's bones.

    Points, markers and frames go where the warp of the body, without its pose, takes them; so do
    joints that move along splines, wraps, meshes and the mass centre. Always from the model as
    it is: nothing is warped twice because its frame moved. Muscle lengths, mass and inertia are
    kept; every element has a row that says what became of it.

    Parameters
    ----------
    model
        From :func:`pinwarp.read_model`, in metres.
    sessions
        For the name or path of each body: a session, or its file. Its source landmarks are on
        the body's mesh (in the body's frame, or that of a mesh file of the body), its
        destination landmarks on the subject, in any pose but in the same unit.
    turn, keep
        Paths of frames that turn with the bone (they keep their orientation otherwise), and of
        elements that are left as they are.
    turns
        Whether all frames turn with their bone.
    folders
        Where meshes are looked for, beside the model and its Geometry folder.

    Returns
    -------
    WarpedModel
        ``rows`` says what became of every element; :func:`pinwarp.write_model` writes it.

    Raises
    ------
    PinwarpError
        When there is no such body, a mesh is missing, a session's landmarks do not lie on the
        body's mesh, the subject is in another unit, or a path in ``turn`` or ``keep`` names
        nothing on these bodies.

    Examples
    --------
    A thigh that is a tenth longer, and lies elsewhere:

    >>> import pinwarp
    >>> from pinwarp.io.samples import sample_model
    >>> model = pinwarp.read_model(sample_model())
    >>> bone = pinwarp.read_mesh(sample_model().parent / "Geometry" / "thigh.vtp").mesh
    >>> landmarks = tuple(
    ...     pinwarp.Landmark(f"p{i}", tuple(place), tuple(place * [1, 1.1, 1] + [5, 0, 0]))
    ...     for i, place in enumerate(bone.vertices[::9])
    ... )
    >>> warped = pinwarp.warp_model(model, {"thigh": pinwarp.Session(landmarks=landmarks)})
    >>> row = next(row for row in warped.rows if row.path == "/markerset/KNEE")
    >>> row.outcome.value, round(1000 * row.moved)  # mm
    ('warped', 23)
    """
    study = study_of(model, sessions, turn=turn, keep=keep, turns=turns, folders=folders)
    return warped_model(study)
