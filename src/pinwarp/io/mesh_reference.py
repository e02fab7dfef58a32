"""How a session file names the meshes it works on."""

from __future__ import annotations

import json
import os
import re
from dataclasses import dataclass
from pathlib import Path

from pinwarp.io.file_names import as_spelt_everywhere, as_spelt_here, with_slashes

_SAID = re.compile(r"(?: sha256=(?P<sha256>\S*))?(?: vertices=(?P<vertices>\d{1,18}))?", re.ASCII)
_BEHIND = re.compile(r"(?: sha256=\S*)?(?: vertices=\d{1,18})?$", re.ASCII)
_AT_END = re.compile(r" (?:sha256|vertices)=\S*$")


@dataclass(frozen=True)
class MeshReference:
    """A mesh a session works on.

    Parameters
    ----------
    path
        Where it is, absolute.
    sha256
        The hash of the file as it was when the landmarks were placed; empty where nobody says:
        people and scripts that write a session have none.
    vertices
        Its number of vertices then; 0 where nobody says.
    mirrored
        The axes across which the session sees it mirrored, such as ``"x"``.
    scaled
        What the session multiplies its coordinates by, such as 1000 from metres to millimetres.
    """

    path: Path
    sha256: str = ""
    vertices: int = 0
    mirrored: str = ""
    scaled: float = 1.0

    def is_of(self, sha256: str, vertices: int) -> bool:
        """Whether a mesh is the one that is meant, as far as is said.

        Examples
        --------
        >>> MeshReference(Path("femur.stl"), vertices=456).is_of("ab", 456)
        True
        """
        if self.sha256:
            return sha256 == self.sha256
        return self.vertices in (0, vertices)


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
    >>> mesh_reference("left femur.stl", Path("/bones")).path.name
    'left femur.stl'
    """
    name, said = _split(text)
    found = _SAID.fullmatch(said)
    if not name or found is None:
        raise ValueError("a mesh is given as: PATH sha256=HASH vertices=NUMBER, or by PATH alone")
    name = as_spelt_here(name) if text.startswith('"') else with_slashes(name, folder)
    # '..' is counted from the real folder, as the system would, not from a link to it.
    base = os.path.realpath(folder) if ".." in Path(name).parts else folder
    where = Path(os.path.normpath(os.path.join(base, name)))
    return MeshReference(where, found["sha256"] or "", int(found["vertices"] or 0))


def _split(text: str) -> tuple[str, str]:
    """Return the path of a mesh line, and what stands behind it."""
    if text.startswith('"'):
        name, end = json.JSONDecoder().raw_decode(text)
        return str(name), text[end:]
    found = _BEHIND.search(text)
    assert found is not None, "what is empty is found anywhere"
    name, said = text[: found.start()], text[found.start() :]
    # What should have been said is no part of a name.
    return ("" if not said and _AT_END.search(name) else name), said


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
    text = as_spelt_everywhere(text)
    # Only what a line of text cannot hold as it is: line ends, blanks at either end, and what
    # would be taken for what stands behind a path, or for a path of Windows.
    plain = text.isprintable() and text == text.strip() and not text.startswith('"')
    plain = plain and "\\" not in text and not _AT_END.search(text)
    name = text if plain else json.dumps(text)
    sha256 = f" sha256={mesh.sha256}" if mesh.sha256 else ""
    return f"{name}{sha256}" + (f" vertices={mesh.vertices}" if mesh.vertices else "")
