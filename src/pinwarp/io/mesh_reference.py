"""How a session file names the meshes it works on."""

from __future__ import annotations

import json
import os
import re
from dataclasses import dataclass
from pathlib import Path

_MESH = re.compile(r"(?P<path>.+) sha256=(?P<sha256>\S*) vertices=(?P<vertices>\d{1,18})", re.ASCII)


@dataclass(frozen=True)
class MeshReference:
    """A mesh a session works on.

    Parameters
    ----------
    path
        Where it is, absolute.
    sha256
        The hash of the file as it was when the landmarks were placed.
    vertices
        Its number of vertices then.
    mirrored
        The axes across which the session sees it mirrored, such as ``"x"``.
    scaled
        What the session multiplies its coordinates by, such as 1000 from metres to millimetres.
    """

    path: Path
    sha256: str
    vertices: int
    mirrored: str = ""
    scaled: float = 1.0


def mesh_reference(text: str, folder: Path) -> MeshReference:
    """Read the text of a mesh line; paths are seen from the folder of the session.

    Raises
    ------
    ValueError
        With the reason as its message.

    Examples
    --------
    >>> mesh_reference("left femur.stl sha256=ab vertices=456", Path("/bones")).vertices
    456
    """
    match = _MESH.fullmatch(text)
    if match is None:
        raise ValueError("a mesh is given as: PATH sha256=HASH vertices=NUMBER")
    name = match["path"]
    if name.startswith('"'):
        name = str(json.loads(name))
    # '..' is counted from the real folder, as the system would, not from a link to it.
    base = os.path.realpath(folder) if ".." in Path(name).parts else folder
    where = Path(os.path.normpath(os.path.join(base, name)))
    return MeshReference(where, match["sha256"], int(match["vertices"]))


def mesh_text(mesh: MeshReference, folder: Path | None) -> str:
    """Return the text of a mesh line, its path as seen from a folder or, without one, absolute.

    Examples
    --------
    >>> mesh_text(MeshReference(Path("/bones/femur.stl"), "ab", 456), Path("/bones"))
    'femur.stl sha256=ab vertices=456'
    """
    where = Path(os.path.abspath(mesh.path))
    if folder is None:
        text = where.as_posix()
    elif where.is_relative_to(folder):
        text = where.relative_to(folder).as_posix()
    else:
        try:
            text = Path(
                os.path.relpath(os.path.realpath(where.parent), os.path.realpath(folder)),
                where.name,
            ).as_posix()
        except ValueError:
            # Another drive on Windows cannot be reached by a relative path.
            text = where.as_posix()
    # Only what a line of text cannot hold as it is: line ends, and blanks at either end.
    plain = text.isprintable() and text == text.strip() and not text.startswith('"')
    name = text if plain else json.dumps(text)
    return f"{name} sha256={mesh.sha256} vertices={mesh.vertices}"
