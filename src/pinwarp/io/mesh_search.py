"""Finding a mesh again that is not where the session says."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from pinwarp.io.mesh_reference import MeshReference
from pinwarp.io.reading import hash_of

# Somebody keeps their sessions in the home folder: looking around must come to an end.
DEEPEST = 4
MOST_FOLDERS = 1000
# So many meshes of another name are read to compare their hashes.
MOST_READ = 30


@dataclass(frozen=True)
class FoundMesh:
    """A file of the right name.

    Parameters
    ----------
    path
        Where it is.
    is_same
        Whether its content is the one that the landmarks were placed on.
    """

    path: Path
    is_same: bool


def find_mesh(
    reference: MeshReference,
    folders: Iterable[Path],
    *,
    progress: Callable[[float], None] | None = None,
) -> FoundMesh | None:
    """Look for a mesh by its name, and among those of its name by its hash.

    Parameters
    ----------
    reference
        What the session says of the mesh.
    folders
        Where to look, nearest first; also in the folders inside them, to a limit.
    progress
        Told a share now and then; what it raises ends the search.

    Returns
    -------
    FoundMesh or None
        The first file of that name with the right hash; else a mesh of any name with the right
        hash that lies in one of the folders themselves; else the first of the right name.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     place = Path(folder, "meshes")
    ...     place.mkdir()
    ...     _ = place.joinpath("femur.stl").write_bytes(b"abc")
    ...     lost = MeshReference(Path("/gone/femur.stl"), "00", 456)
    ...     found = find_mesh(lost, [Path(folder)])
    ...     found.path.relative_to(folder).as_posix(), found.is_same
    ('meshes/femur.stl', False)
    """
    # A mesh that moved between systems may have changed the case of its name.
    name = reference.path.name.casefold()
    folders, first = list(folders), None
    for path in _files(folders, DEEPEST, progress or (lambda _share: None)):
        if path.name.casefold() != name:
            continue
        if reference.sha256 and hash_of(path, progress=progress) == reference.sha256:
            return FoundMesh(path, True)
        first = first or FoundMesh(path, False)
    renamed = _of_hash(reference, folders, progress) if reference.sha256 else None
    return renamed or first


def _of_hash(
    reference: MeshReference, folders: Iterable[Path], progress: Callable[[float], None] | None
) -> FoundMesh | None:
    """Look for a mesh under another name; reading every file is for a few of them."""
    suffix = reference.path.suffix.lower()
    files = _files(folders, 0, lambda _share: None)
    alike = (path for path in files if path.suffix.lower() == suffix)
    for path in islice(alike, MOST_READ):
        if hash_of(path, progress=progress) == reference.sha256:
            return FoundMesh(path, True)
    return None


def _files(
    folders: Iterable[Path], deepest: int, progress: Callable[[float], None]
) -> Iterator[Path]:
    """Yield the files in the folders, the nearest first; links to folders are not followed."""
    level = list(dict.fromkeys(folders))
    seen = 0
    for _ in range(deepest + 1):
        inner: list[Path] = []
        for folder in level:
            if seen == MOST_FOLDERS:
                return
            seen += 1
            progress(seen / MOST_FOLDERS)
            try:
                with os.scandir(folder) as entries:
                    here = sorted(entries, key=lambda entry: entry.name)
            except OSError:
                continue
            for entry in here:
                # Asking the entry itself raises where a link leads round in a circle.
                if os.path.isdir(entry.path) and not entry.is_symlink():
                    if not entry.name.startswith("."):
                        inner.append(Path(entry.path))
                elif os.path.isfile(entry.path):
                    yield Path(entry.path)
        level = inner
