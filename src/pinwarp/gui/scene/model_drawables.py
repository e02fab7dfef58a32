"""What a viewport draws of a model: frozen values, as of :mod:`pinwarp.gui.scene.drawables`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.landmarks import Position
from pinwarp.session.model.elements import OutlineKind


@dataclass(frozen=True, eq=False)
class ElementLine:
    """A line of something that stands on a body of a model.

    Parameters
    ----------
    places
        (k, 3) from end to end.
    kind
        What it is part of.
    is_chosen
        Whether that is chosen in the list.
    """

    places: NDArray[np.float64]
    kind: OutlineKind
    is_chosen: bool = False


@dataclass(frozen=True, eq=False)
class ModelElements:
    """What stands on a body of a model, as passengers that the mouse does not see.

    Parameters
    ----------
    points
        (n, 3) places of muscles' path points, markers and stations.
    is_of_muscle, is_chosen
        (n,) whether a muscle runs through it, and whether it is chosen in the list.
    lines
        Muscles, wraps and the axes of frames.
    labels
        Words and where they stand.
    """

    points: NDArray[np.float64]
    is_of_muscle: NDArray[np.bool_]
    is_chosen: NDArray[np.bool_]
    lines: tuple[ElementLine, ...]
    labels: tuple[tuple[str, Position], ...] = ()
