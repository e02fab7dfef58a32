"""A session's warp as a Python script, for those who go on from there."""

from __future__ import annotations

import math
import os
from dataclasses import fields, replace
from enum import Enum
from pathlib import Path

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Landmark, as_position
from pinwarp.core.settings import USUAL_SETTINGS, WarpSettings
from pinwarp.core.words import counted
from pinwarp.io.mesh_reference import MeshReference
from pinwarp.io.meshes import MeshFile
from pinwarp.session.session import Session
from pinwarp.session.warp.provenance import provenance
from pinwarp.session.warp.refined import fitted_names, refinement_in_use, warp_in_words
from pinwarp.session.warp.slid_words import point_names
from pinwarp.session.warp.solved import SolvedWarp, solved
from pinwarp.version import __version__

# Told even where they are as usual.
_ALWAYS = ("penalty", "convention")


def script_of(session: Session | SolvedWarp, folder: Path) -> str:
    """Return a script that writes the warped mesh as the session exports it.

    The landmarks are in the script, with all their digits; the mesh is read from where it is.

    Parameters
    ----------
    session
        With a source mesh and pairs; or its warp, solved.
    folder
        Where the script will be: meshes below it are named relative to it, and the warped mesh
        is written there.

    Raises
    ------
    PinwarpError
        When there is no source mesh or no pair, or only a part of a refined warp is applied.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> script = script_of(read_session(sample_session()), sample_session().parent)
    >>> [line for line in script.splitlines() if line.startswith("SOURCE_MESH")]
    ["SOURCE_MESH = HERE / 'femur_generic.ply'"]
    """
    warp = session
    if isinstance(session, SolvedWarp):
        session = session.session
    source = session.source
    if source is None:
        raise PinwarpError("There is no source mesh to warp: open one first.")
    if not session.pairs:
        raise PinwarpError("There is no pair yet: place a landmark on both meshes first.")
    path, words, made = source.path, warp_in_words(session), provenance(session)
    warped = f"{path.stem}_warped{path.suffix}"
    placed = len(session.pairs)
    session, is_slid = _of_plain_pairs(session, warp)
    count = counted(len(session.pairs), "pair")
    count += f", {len(session.pairs) - placed} of them semilandmarks" if is_slid else ""
    pairs = [
        f"    {pair.name!r}: ({pair.source!r}, {pair.destination!r})," for pair in session.pairs
    ]
    changes, imports = _as_seen(source)
    return "\n".join(
        [
            f'"""Warp a mesh as pinwarp {__version__} did: {words}, {count}."""',
            "",
            *(f"# {' '.join(line.split())}" for line in made),
            "",
            *(["from dataclasses import replace"] if changes else []),
            "from pathlib import Path",
            "",
            "import pinwarp",
            *imports,
            "",
            "HERE = Path(__file__).resolve().parent",
            f"SOURCE_MESH = {_place(path, folder)}",
            f"SOURCE_SHA256 = {source.sha256!r}",
            f"WARPED_MESH = HERE / {warped!r}",
            "",
            f"# name: (source, destination), in {' '.join(session.unit.split())}",
            "PAIRS = {",
            *pairs,
            "}",
            "",
            "mesh = pinwarp.read_mesh(SOURCE_MESH)",
            "if mesh.sha256 != SOURCE_SHA256:",
            '    print(f"{SOURCE_MESH} is not the file that the landmarks were placed on.")',
            *changes,
            "session = pinwarp.Session(",
            "    source=mesh,",
            "    landmarks=tuple(pinwarp.Landmark(name, *pair) for name, pair in PAIRS.items()),",
            "    settings=pinwarp.WarpSettings(",
            *(f"        {option}," for option in _options(session.settings)),
            "    ),",
            ")",
            "pinwarp.write_mesh(WARPED_MESH, pinwarp.warped_mesh(session))",
            'print(f"Wrote {WARPED_MESH}")',
            "",
        ]
    )


def _of_plain_pairs(session: Session, warp: Session | SolvedWarp) -> tuple[Session, bool]:
    """Return the session with what was fitted or slid as pairs like any other, and if any slid."""
    refined = refinement_in_use(session)
    if refined is None:
        return _with_semilandmarks(warp) if session.groups else (session, False)
    if not session.settings.is_whole:
        raise PinwarpError("A script can only apply a refined warp in full: choose the full warp.")
    names = [pair.name for pair in session.pairs]
    names += fitted_names(len(refined.source) - len(names), names)
    rows = zip(names, refined.source, refined.destination, strict=True)
    plain = replace(
        session,
        landmarks=tuple(Landmark(name, source, place) for name, source, place in rows),
        settings=USUAL_SETTINGS,
        refinement=None,
        groups=(),
    )
    return plain, False


def _with_semilandmarks(session: Session | SolvedWarp) -> tuple[Session, bool]:
    warp = solved(session)
    session = warp.session
    at_rest = warp.result.semilandmarks
    if at_rest is None:
        return replace(session, groups=()), False
    names = [pair.name for pair in session.pairs]
    factor, places = warp.fit
    rows = zip(
        point_names(at_rest, names), factor.source[len(names) :], places[len(names) :], strict=True
    )
    points = (Landmark(name, as_position(a), as_position(b)) for name, a, b in rows)
    return replace(session, landmarks=(*session.pairs, *points), groups=()), True


def _as_seen(file: MeshFile | MeshReference) -> tuple[list[str], list[str]]:
    """Return what scales and mirrors the mesh as the session sees it, and an import for that."""
    changes, imports = [], []
    if file.scaled != 1:
        scaled = f"mesh.mesh.with_vertices({file.scaled!r} * mesh.mesh.vertices)"
        changes.append(f"mesh = replace(mesh, mesh={scaled})")
    if file.mirrored:
        changes.append(f'mesh = replace(mesh, mesh=mirrored_mesh(mesh.mesh, "{file.mirrored}"))')
        imports.append("from pinwarp.core.mirror import mirrored_mesh")
    return changes, imports


def _options(settings: WarpSettings) -> list[str]:
    """Return how the warp is solved and applied; what is usual goes without saying."""
    return [
        f"{field.name}={_literal(value)}"
        for field in fields(settings)
        if (value := getattr(settings, field.name)) != getattr(USUAL_SETTINGS, field.name)
        or field.name in _ALWAYS
    ]


def _literal(value: object) -> str:
    """Return a value as Python reads it where only pinwarp is imported."""
    if isinstance(value, Enum):
        return f"pinwarp.{type(value).__name__}.{value.name}"
    return 'float("inf")' if value == math.inf else repr(value)


def _place(path: Path, folder: Path) -> str:
    """Return a path in Python as seen from a folder above it; others are absolute."""
    whole = Path(os.path.abspath(path))
    base = Path(os.path.abspath(folder))
    if whole.is_relative_to(base):
        return f"HERE / {whole.relative_to(base).as_posix()!r}"
    return f"Path({whole.as_posix()!r})"
