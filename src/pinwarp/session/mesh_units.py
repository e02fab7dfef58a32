"""Meshes in different units: noticing them, and bringing one to the unit of the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pinwarp.core.errors import LandmarkError
from pinwarp.core.groups import moved_group
from pinwarp.core.landmarks import Side, scaled
from pinwarp.core.mesh import Mesh
from pinwarp.io.meshes import MeshFile
from pinwarp.session.session import Session

# A bone with a shorter diagonal is taken to be in metres.
LARGEST_IN_METRES = 3.0
# Two bones of one kind never differ so much in size.
UNLIKELY_RATIO = 50.0
# From centimetres and from millimetres to metres; that of millimetres to centimetres is no news
# to anybody who compares a mouse with a man.
_FACTORS = (100.0, 1000.0)
_LIKELY = 3.0
# By what a length in metres is multiplied.
_SMALLER = {100.0: "centimetres", 1000.0: "millimetres"}


def likely_unit(mesh: Mesh) -> str:
    """Return the unit that a bone is in by its size: bones measure centimetres to metres.

    Examples
    --------
    >>> likely_unit(Mesh([[0, 0, 0], [400, 0, 0], [0, 9, 0]], [[0, 1, 2]]))
    'mm'
    """
    return "m" if mesh.diagonal < LARGEST_IN_METRES else "mm"


def size_ratio(session: Session) -> float | None:
    """Return how many times as large as the source the destination is.

    None where a mesh is missing, or where they differ no more than bones do.
    """
    source, destination = (session.mesh(side) for side in Side)
    if source is None or destination is None or not source.diagonal * destination.diagonal:
        return None
    ratio = destination.diagonal / source.diagonal
    return None if 1 / UNLIKELY_RATIO < ratio < UNLIKELY_RATIO else ratio


def unit_factor(session: Session) -> float | None:
    """Return what the source is to be multiplied by to be in the unit of the destination.

    Returns
    -------
    float or None
        1000, 100 or one over these; None where the meshes are in one unit, or differ in size as
        no change between usual units explains.

    Examples
    --------
    >>> from pathlib import Path
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    >>> small = Mesh(corners, [[0, 1, 2]])
    >>> large = small.with_vertices(1100 * small.vertices)
    >>> files = (MeshFile(Path("a.ply"), mesh, "", ()) for mesh in (small, large))
    >>> unit_factor(Session(*files))
    1000.0
    """
    ratio = size_ratio(session)
    if ratio is None:
        return None
    for factor in _FACTORS:
        for each in (factor, 1 / factor):
            if 1 / _LIKELY < ratio / each < _LIKELY:
                return each
    return None


def scalings(session: Session) -> dict[Side, float]:
    """Return what either side is multiplied by to be in the unit of the other; see there.

    Examples
    --------
    >>> scalings(Session())
    {}
    """
    factor = unit_factor(session)
    return {} if factor is None else {Side.SOURCE: factor, Side.DESTINATION: 1 / factor}


def scaling_words(what: str, factor: float) -> str:
    """Say what a scaling does.

    Examples
    --------
    >>> scaling_words("the Source", 1000), scaling_words("source", 0.001)
    ('Scale the Source by 1,000', 'Scale source by 1/1,000')
    """
    by = f"{factor:,.0f}" if factor > 1 else f"1/{1 / factor:,.0f}"
    return f"Scale {what} by {by}"


def size_words(session: Session) -> tuple[str, ...]:
    """Say that the meshes must be in different units, where they are, and what that leads to.

    Returns
    -------
    tuple of str
        That one is larger, which units they seem to be in where one can tell, and what becomes of
        them as they are; nothing where they may be in one unit.
    """
    ratio, factor = size_ratio(session), unit_factor(session)
    if ratio is None:
        return ()
    sizes = [mesh.diagonal for side in Side if (mesh := session.mesh(side)) is not None]
    larger = Side.DESTINATION if ratio > 1 else Side.SOURCE
    words = [
        f"The {larger.value} is {max(sizes) / min(sizes):,.0f} times as large as the "
        f"{larger.other.value}: {max(sizes):.4g} and {min(sizes):.4g} across, in "
        "their own numbers."
    ]
    if factor is not None:
        smaller = _SMALLER[max(factor, 1 / factor)]
        words.append(f"One seems to be in metres and the other in {smaller}.")
    left = "the warp takes care of it, and what is exported is in the destination's unit."
    return (*words, f"Left as they are, {left}")


def unit_on(session: Session, side: Side) -> str:
    """Return the unit of lengths on one side; empty where the session's cannot be right there.

    Examples
    --------
    >>> unit_on(Session(unit="cm"), Side.SOURCE)
    'cm'
    """
    mesh = session.mesh(side)
    if mesh is None or size_ratio(session) is None or _suits(mesh, session.unit):
        return session.unit
    return ""


def scale_side(session: Session, side: Side, factor: float) -> Session:
    """Bring one side to another unit: the mesh, and the landmarks on it.

    The file of the mesh is untouched: the session remembers the factor. The warping penalty is
    of the source and goes along with it, so that the warp stays the same.

    Parameters
    ----------
    factor
        1000 from metres to millimetres.

    Raises
    ------
    LandmarkError
        Without a mesh on that side, or when a coordinate becomes too large for a number.

    Examples
    --------
    >>> from pathlib import Path
    >>> mesh = Mesh([[0, 0, 0], [0.4, 0, 0], [0, 0.1, 0]], [[0, 1, 2]])
    >>> session = Session(MeshFile(Path("femur.stl"), mesh, "", ()), unit="m")
    >>> after = scale_side(session, Side.SOURCE, 1000)
    >>> after.source.scaled, after.mesh(Side.SOURCE).vertices[1].tolist(), after.unit
    (1000.0, [400.0, 0.0, 0.0], 'mm')
    """
    file = session.mesh_file(side)
    if not isinstance(file, MeshFile):
        raise LandmarkError(f"There is no {side.value} mesh to scale: open one first.")
    whole = float(file.scaled * factor)
    mesh = file.mesh.with_vertices(factor * file.mesh.vertices)
    penalty = session.settings.penalty
    if side is Side.SOURCE:
        penalty *= factor**session.settings.basis.power
    session = replace(
        session.with_mesh(side, replace(file, mesh=mesh, scaled=whole)),
        landmarks=scaled(session.landmarks, factor, side),
        groups=tuple(
            moved_group(group, side, lambda places: factor * np.array(places))
            for group in session.groups
        ),
        settings=replace(session.settings, penalty=penalty),
    )
    if _suits(mesh, session.unit):
        return session
    other = session.mesh(side.other)
    return replace(session, unit=likely_unit(mesh if other is None else other))


def _suits(mesh: Mesh, unit: str) -> bool:
    """Whether a bone can be of this size in a unit."""
    return (unit == "m") == (likely_unit(mesh) == "m")
