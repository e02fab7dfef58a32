"""In which unit lengths are shown: files and what leaves the program keep theirs."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pinwarp.core.landmarks import Side
from pinwarp.core.lengths import METRES, ROUNDING, Ruler
from pinwarp.session.mesh_units import LARGEST_IN_METRES, unit_on
from pinwarp.session.session import Session
from pinwarp.session.view import LengthUnit

_AS_STORED = Ruler()


@dataclass(frozen=True)
class Rulers:
    """How the lengths of a session are shown, and coordinates on either side.

    Those of a side have no unit where the session's cannot be right there.
    """

    session: Ruler = _AS_STORED
    source: Ruler = _AS_STORED
    destination: Ruler = _AS_STORED

    def on(self, side: Side) -> Ruler:
        """Return how lengths on one side are shown."""
        return self.source if side is Side.SOURCE else self.destination


def rulers_of(session: Session, wanted: LengthUnit = LengthUnit.FILE) -> Rulers:
    """Return how the lengths of a session are shown.

    Parameters
    ----------
    session
        Its unit is that of its files.
    wanted
        Automatic shows bones in metres in millimetres, all others as in the file.

    Examples
    --------
    >>> from pathlib import Path
    >>> from pinwarp.core.mesh import Mesh
    >>> from pinwarp.io.meshes import MeshFile
    >>> bone = Mesh([[0, 0, 0], [0.4, 0, 0], [0, 0.1, 0]], [[0, 1, 2]])
    >>> session = Session(source=MeshFile(Path("femur.vtp"), bone, "", ()), unit="m")
    >>> rulers_of(session, LengthUnit.AUTOMATIC).session.text(0.0076912, 3)
    '7.69 mm'
    """
    ruler = ruler_of(session.unit, _reach(session), wanted)
    plain = Ruler(least=ruler.least)
    source, destination = (ruler if unit_on(session, x) else plain for x in Side)
    return Rulers(ruler, source, destination)


def ruler_of(unit: str, reach: float, wanted: LengthUnit) -> Ruler:
    """Return how lengths in a unit are shown, of something that is so large.

    Examples
    --------
    >>> ruler_of("m", 0.4, LengthUnit.CM).text(0.0076912, 3)
    '0.769 cm'
    """
    # A round share of the size: a landmark that is placed changes no ruler.
    least = ROUNDING * 10.0 ** math.floor(math.log10(reach)) if reach > 0 else 0.0
    shown = unit
    if unit in METRES:
        if wanted is LengthUnit.AUTOMATIC:
            shown = "mm" if unit == "m" and reach < LARGEST_IN_METRES else unit
        elif wanted is not LengthUnit.FILE:
            shown = wanted.value
    factor = 1.0 if shown == unit else METRES[unit] / METRES[shown]
    if factor > 1:
        factor = float(round(factor))
    return Ruler(shown, factor, least)


def _reach(session: Session) -> float:
    """Return how large the bones are; without meshes how far their landmarks reach."""
    diagonals = [mesh.diagonal for side in Side if (mesh := session.mesh(side)) is not None]
    if diagonals:
        return max(diagonals)
    places = [x.position(side) for x in session.landmarks for side in Side]
    return max((abs(number) for place in places if place for number in place), default=0.0)
