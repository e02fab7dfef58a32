"""Sessions and the files they are kept in, meshes included."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from pinwarp.core.landmarks import Side
from pinwarp.io import session_file
from pinwarp.io.mesh_search import find_mesh
from pinwarp.io.meshes import MeshFile
from pinwarp.io.osim.bone import is_mesh_there, read_any_mesh
from pinwarp.io.session_file import MeshReference
from pinwarp.session.session import Session, as_seen, from_record, to_record
from pinwarp.session.warp.rested import with_rest
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver

CHANGED = "It has changed since the landmarks were placed on it."


def read_session(path: str | Path, *, meshes: Iterable[Side] = tuple(Side)) -> Session:
    """Read a session and the meshes it works on.

    Parameters
    ----------
    path
        The file; the paths of meshes in it are seen from its folder.
    meshes
        The sides whose mesh is read; the other stays a reference.

    Returns
    -------
    Session
        A mesh whose file is not there any more stays a reference, too: landmarks can be warped
        without it.

    Raises
    ------
    FileFormatError
        When the session, or a mesh that is there, cannot be read; the message names the line.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> session = read_session(sample_session())
    >>> len(session.pairs), len(session.mesh(Side.SOURCE).vertices)
    (16, 10000)
    """
    folder = Path(path).absolute().parent
    return with_meshes(from_record(session_file.read_session(path), None, None), meshes, folder)


def write_session(path: str | Path, session: Session) -> None:
    """Write a session; its meshes are named in it, not written.

    Parameters
    ----------
    path
        The file, named ``NAME.pinwarp.csv`` by custom.
    session
        What to write; where its semilandmarks rest is written, too.

    Raises
    ------
    LandmarkError
        When it could not be read back: two landmarks have one name.
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile
    >>> from pinwarp.core.settings import WarpSettings
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "femur.pinwarp.csv")
    ...     write_session(path, Session(settings=WarpSettings(2.5)))
    ...     read_session(path).settings.penalty
    2.5
    """
    if session.groups:
        session = with_rest(
            session, WarpSolver().solve_landmarks(WarpInputs.of(session)).semilandmarks
        )
    session_file.write_session(path, to_record(session))


def with_meshes(
    session: Session, sides: Iterable[Side] = tuple(Side), folder: Path | None = None
) -> Session:
    """Return the session with the meshes read that it refers to, as far as they are there.

    Parameters
    ----------
    session
        May hold references to meshes.
    sides
        Whose mesh is read.
    folder
        Where a mesh that moved is looked for; it is taken only if its hash is the right one.

    Returns
    -------
    Session
        A file that is not the one the landmarks were placed on has a note that says so.

    Raises
    ------
    FileFormatError
        When a mesh that is there cannot be read.

    Examples
    --------
    >>> with_meshes(Session()) == Session()
    True
    """
    for side in sides:
        reference = session.mesh_file(side)
        if not isinstance(reference, MeshReference):
            continue
        if not is_mesh_there(reference.path) and folder is not None:
            found = find_mesh(reference, [folder])
            if found is not None and found.is_same:
                reference = replace(reference, path=found.path)
        if is_mesh_there(reference.path):
            session = session.with_mesh(side, _read(reference))
    return session


def _read(reference: MeshReference) -> MeshFile:
    file = read_any_mesh(reference.path)
    if not reference.is_of(file.sha256, len(file.mesh.vertices)):
        file = replace(file, notes=(*file.notes, CHANGED))
    return as_seen(file, reference)
