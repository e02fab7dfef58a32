"""A session's warp as a Python script, for those who go on from there."""

from __future__ import annotations

import math
import os
from pathlib import Path

import pinwarp
from pinwarp.core.components import Components
from pinwarp.core.errors import PinwarpError
from pinwarp.session.exports import applied_in_words
from pinwarp.session.session import Session


def script_of(session: Session, folder: Path) -> str:
    """Return a script that writes the warped mesh as the session exports it.

    The landmarks are in the script, with all their digits; the mesh is read from where it is.

    Parameters
    ----------
    session
        With a source mesh and pairs.
    folder
        Where the script will be: meshes below it are named relative to it, and the warped mesh
        is written there.

    Raises
    ------
    PinwarpError
        When there is no source mesh or no pair.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.files import read_session
    >>> script = script_of(read_session(sample_session()), sample_session().parent)
    >>> [line for line in script.splitlines() if line.startswith("SOURCE_MESH")]
    ["SOURCE_MESH = HERE / 'femur_generic.ply'"]
    """
    if session.source is None:
        raise PinwarpError("There is no source mesh to warp: open one first.")
    if not session.pairs:
        raise PinwarpError("There is no pair yet: place a landmark on both meshes first.")
    whole = session.components is Components.FULL and session.blend == 1 and not session.planar
    imports, warp = _whole(session) if whole else _in_part(session)
    path, mirrored = session.source.path, session.source.mirrored
    if mirrored:
        imports.append("from pinwarp.core.mirror import mirrored_mesh")
        mesh = f'mesh = mirrored_mesh(file.mesh, "{mirrored}")  # as the session sees it'
    else:
        mesh = "mesh = file.mesh"
    imports.append("from pinwarp.io.meshes import read_mesh, write_mesh")
    unit = " ".join(session.unit.split())
    penalty, warped = session.warping_penalty, f"{path.stem}_warped{path.suffix}"
    number = 'float("inf")' if math.isinf(penalty) else repr(penalty)
    lines = [
        f'"""Warp a mesh as pinwarp {pinwarp.__version__} did: {applied_in_words(session)}, '
        f'{len(session.pairs)} pairs."""',
        "",
        "from pathlib import Path",
        "",
        "import numpy as np",
        "",
        *sorted(imports),
        "",
        "HERE = Path(__file__).resolve().parent",
        f"SOURCE_MESH = HERE / {_relative(path, folder)!r}",
        f"SOURCE_SHA256 = {session.source.sha256!r}",
        f"WARPED_MESH = HERE / {warped!r}",
        "",
        f"PENALTY = {number}  # {unit}",
        "# name: (source, destination)",
        "PAIRS = {",
        *(f"    {pair.name!r}: ({pair.source!r}, {pair.destination!r})," for pair in session.pairs),
        "}",
        "",
        "source, destination = np.array(list(PAIRS.values())).swapaxes(0, 1)",
        *warp,
        "",
        "file = read_mesh(SOURCE_MESH)",
        "if file.sha256 != SOURCE_SHA256:",
        '    print(f"{SOURCE_MESH} is not the file that the landmarks were placed on.")',
        mesh,
        "write_mesh(WARPED_MESH, mesh.with_vertices(warp(mesh.vertices)))",
        'print(f"Wrote {WARPED_MESH}")',
    ]
    return "\n".join(lines) + "\n"


def _whole(session: Session) -> tuple[list[str], list[str]]:
    """Return imports and statements for the warp as it is solved."""
    return (
        ["from pinwarp.tps3d import PenaltyConvention, solve_coefficients"],
        [
            "warp = solve_coefficients(",
            "    source,",
            "    destination,",
            "    warping_penalty=PENALTY,",
            f"    convention=PenaltyConvention.{session.convention.name},",
            ").warp_points",
        ],
    )


def _in_part(session: Session) -> tuple[list[str], list[str]]:
    """Return imports and statements for what is applied of the warp."""
    planar = ", planar=True" if session.planar else ""
    return (
        [
            "from pinwarp.core.components import Components, applied",
            "from pinwarp.core.factor import factorise",
            "from pinwarp.core.spline import PenaltyConvention, solve",
        ],
        [
            f"factor = factorise(source{planar})",
            "whole = solve(",
            f"    factor, destination, PENALTY, PenaltyConvention.{session.convention.name}",
            ")",
            "warp = applied(",
            "    whole,",
            "    factor,",
            "    destination,",
            f"    Components.{session.components.name},",
            f"    blend={session.blend!r},",
            ").evaluate",
        ],
    )


def _relative(path: Path, folder: Path) -> str:
    """Return a path as seen from a folder above it; others stay absolute."""
    whole = Path(os.path.abspath(path))
    base = Path(os.path.abspath(folder))
    return (whole.relative_to(base) if whole.is_relative_to(base) else whole).as_posix()
