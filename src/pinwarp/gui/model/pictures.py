"""What stands on a body as drawables, those chosen in the list marked."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.landmarks import as_position
from pinwarp.core.model_rows import ElementRow
from pinwarp.gui.scene.model_drawables import ElementLine, ModelElements
from pinwarp.session.model.elements import Elements, OutlineKind, muscle_of

# Degrees: a smaller turn of a frame is not written beside it.
LEAST_TURN = 0.5
_AXES = (OutlineKind.AXIS_X, OutlineKind.AXIS_Y, OutlineKind.AXIS_Z)


def picture_of(
    elements: Elements, chosen: frozenset[str], rows: Iterable[ElementRow] = ()
) -> ModelElements:
    """Return what is drawn.

    Parameters
    ----------
    elements
        In the frame of the side.
    chosen
        The paths of what is chosen.
    rows
        Whose turns are written beside the frames.
    """
    lines = tuple(
        ElementLine(one.places, one.kind, one.path in chosen) for one in elements.outlines
    )
    is_chosen = [path in chosen or muscle_of(path) in chosen for path in elements.paths]
    places = {one.path: one.places[0] for one in elements.outlines if one.kind in _AXES}
    # Frames at one place turn as one.
    turns = {
        tuple(places[row.path].round(9)): f"{row.turned:.1f}°"
        for row in rows
        if row.path in places and row.turned >= LEAST_TURN
    }
    labels = [(words, as_position(place)) for place, words in turns.items()]
    if len(chosen) == 1:
        (path,) = chosen
        own = elements.of_path(path)
        if len(own) and path not in places:
            labels.append((path.rsplit("/", 1)[-1], as_position(own[0])))
    return ModelElements(
        elements.points,
        elements.groups >= 0,
        np.array(is_chosen, dtype=np.bool_),
        lines,
        tuple(labels),
    )


def places_of(elements: Elements, path: str) -> NDArray[np.float64]:
    """Return the (n, 3) places of an element; of a muscle, those of its points, too."""
    own = elements.of_path(path)
    of_muscle = [
        place
        for place, at in zip(elements.points, elements.paths, strict=True)
        if muscle_of(at) == path
    ]
    return np.concatenate([own, np.array(of_muscle).reshape(-1, 3)])
