"""The kinds of things that a viewport draws: frozen values, without a toolkit.

Two scenes are compared kind by kind, at every turn of the event loop while something moves. So
whatever holds large arrays is the same only where it is the very same object.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.folds import Folds
from pinwarp.core.landmarks import LandmarkState, Position
from pinwarp.core.lengths import Ruler
from pinwarp.core.maps import MapKind, Range, Suggestion
from pinwarp.core.mesh import Mesh
from pinwarp.gui.scene.model_drawables import ModelElements
from pinwarp.session.warp.ghost import Ghost

# What is rendered


@dataclass(frozen=True)
class Bone:
    """The side's own mesh, and whether its edges are drawn instead of its triangles."""

    mesh: Mesh
    wireframe: bool = False


@dataclass(frozen=True)
class Cut:
    """Which share of the bones' depth is cut away, seen from where the cut was switched on."""

    share: float


@dataclass(frozen=True)
class Motion:
    """Something here is moved by the hand: a stand-in may be drawn for what is slow."""


@dataclass(frozen=True, eq=False)
class OverlayWarp:
    """The warped source as drawn: triangles, vertices, normals, and whether its inside is out."""

    mesh: Mesh
    vertices: NDArray[np.float32]
    normals: NDArray[np.float32]
    inside_out: bool


@dataclass(frozen=True)
class Overlay:
    """The warped source over the destination.

    Parameters
    ----------
    full, stand_in
        In full detail, and coarsely for while something moves.
    visible
        Whether it is seen.
    opacity, map_opacity
        Without and with a map on it.
    """

    full: OverlayWarp | None
    stand_in: OverlayWarp | None = None
    visible: bool = True
    opacity: float = 0.5
    map_opacity: float = 1.0


@dataclass(frozen=True, eq=False)
class MapLevels:
    """Where the vertices of the overlay, and of its stand-in, stand on the scale of a map."""

    full: NDArray[np.float32] | None
    stand_in: NDArray[np.float32] | None = None


@dataclass(frozen=True)
class Colouring:
    """The colours of a map on the overlay."""

    levels: MapLevels
    kind: MapKind
    range: Range


@dataclass(frozen=True, eq=False)
class FoldedSurface:
    """The triangles of the warped source that touch a fold, and the edges around them.

    A closed part that folds as a whole has no edges around it: its rim is empty.

    Parameters
    ----------
    vertices
        (n, 3) positions.
    faces
        (m, 3) rows of them.
    rim
        (k, 2) rows of them.
    """

    vertices: NDArray[np.float32]
    faces: NDArray
    rim: NDArray

    @classmethod
    def of(cls, folds: Folds, faces: NDArray, vertices: NDArray) -> FoldedSurface | None:
        """Return what is folded of a warped mesh; None where nothing is."""
        folded = faces[folds.is_folded[faces].any(axis=1)]
        if not len(folded):
            return None
        rows, corners = np.unique(folded, return_inverse=True)
        corners = corners.reshape(-1, 3)
        edges = np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        edges, triangles = np.unique(edges, axis=0, return_counts=True)
        return cls(np.asarray(vertices[rows], np.float32), corners, edges[triangles == 1])


@dataclass(frozen=True, eq=False)
class GridLines:
    """(lines, samples, 3) positions of the grid."""

    lines: NDArray


# What is painted over it


@dataclass(frozen=True)
class Marker:
    """One landmark in one viewport; one that is pointed at has its name however little room is."""

    name: str
    position: Position
    state: LandmarkState
    selected: bool = False
    labelled: bool = False
    movable: bool = True
    pointed_at: bool = False


@dataclass(frozen=True)
class Markers:
    """The landmarks, and the radius of their signs in logical pixels."""

    markers: tuple[Marker, ...] = ()
    radius: float = 6.0


@dataclass(frozen=True)
class Arrow:
    """From where a landmark is carried to its destination.

    Parameters
    ----------
    name
        The landmark.
    start, end
        In the destination's frame.
    left_out
        Whether it is carried there by the other pairs alone.
    """

    name: str
    start: Position
    end: Position
    left_out: bool = False


@dataclass(frozen=True)
class Arrows:
    """The arrows to the landmarks of a viewport."""

    arrows: tuple[Arrow, ...]


@dataclass(frozen=True)
class OtherGhosts:
    """Where further landmarks are expected, besides the next one, and which one has its name."""

    ghosts: tuple[Ghost, ...]
    labelled: str | None = None


@dataclass(frozen=True)
class Counterpart:
    """Where the landmark is on this side that the other side's ghost stands for."""

    name: str
    position: Position


class DotKind(IntEnum):
    """What became of a semilandmark."""

    AT_REST = 0
    FREED = 1
    EXCLUDED = 2
    CHOSEN = 3


@dataclass(frozen=True, eq=False)
class Dots:
    """The semilandmarks of a side, which the mouse does not see.

    Parameters
    ----------
    positions
        (n, 3), in the side's frame.
    colours
        (n,) of which group each is, as a row of the groups' colours.
    kinds
        (n,) values of :class:`DotKind`.
    """

    positions: NDArray[np.float64]
    colours: NDArray[np.int64]
    kinds: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class PathLine:
    """One curve over the surface of a side.

    Parameters
    ----------
    places
        (p, 3); a closed one ends where it begins.
    colour
        A row of the groups' colours.
    is_ghost
        Whether it is only expected there.
    is_chosen
        Whether it is the one that is worked on.
    """

    places: NDArray[np.float64]
    colour: int
    is_ghost: bool = False
    is_chosen: bool = False


@dataclass(frozen=True, eq=False)
class Paths:
    """The curves of a side."""

    lines: tuple[PathLine, ...]


@dataclass(frozen=True)
class CurveHandle:
    """A place that a curve goes through on a side, which the hand can move.

    Parameters
    ----------
    curve, number
        Which one of which curve.
    position
        Where it is, or is expected.
    colour
        A row of the groups' colours.
    is_ghost
        Whether it is only expected there.
    movable
        Whether the hand may move it.
    """

    curve: str
    number: int
    position: Position
    colour: int
    is_ghost: bool = False
    movable: bool = True


@dataclass(frozen=True)
class Handles:
    """The handles of the curves of a side."""

    handles: tuple[CurveHandle, ...]


@dataclass(frozen=True, eq=False)
class Slides:
    """How far semilandmarks slid: (n, 3) from where to where, and their groups' colours."""

    starts: NDArray[np.float64]
    ends: NDArray[np.float64]
    colours: NDArray[np.int64]


@dataclass(frozen=True)
class ToolWords:
    """What the tool that is chosen asks for now."""

    words: str


@dataclass(frozen=True)
class NextClick:
    """What the next click here does, in few words."""

    words: str


@dataclass(frozen=True)
class Star:
    """Where the next landmark helps most, and how far from there the truth may be, in words."""

    suggestion: Suggestion
    deviation: str


@dataclass(frozen=True)
class Legend:
    """What a legend says of a map.

    Parameters
    ----------
    title
        In words.
    note
        Below it: the unit, or what the ratios are relative to.
    kind, range
        What gives the colours.
    clipped
        Whether values lie below and above what is shown.
    fixed
        Whether the user fixed the range.
    factor
        What its lengths are multiplied by to be in the unit that is shown.
    """

    title: str
    note: str
    kind: MapKind
    range: Range
    clipped: tuple[bool, bool] = (False, False)
    fixed: bool = False
    factor: float = 1.0


@dataclass(frozen=True)
class Caption:
    """Which side this is, which file is shown, and what was left out of that."""

    title: str
    file: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class ScaleBar:
    """A round length, as a ruler tells it."""

    ruler: Ruler


@dataclass(frozen=True)
class Hint:
    """What can be done in an empty viewport."""

    words: str


@dataclass(frozen=True)
class Badge:
    """Words on a plate that say that something unusual is shown."""

    words: str


@dataclass(frozen=True)
class WorkWords:
    """Words in the place of a badge, where there is none, that say what is being made."""

    words: str


Rendered = Bone | Cut | Motion | Overlay | Colouring | FoldedSurface | GridLines
Semilandmarks = Dots | Paths | Handles | Slides
Signs = Markers | Arrows | Ghost | OtherGhosts | Counterpart | Star | Semilandmarks | ModelElements
Painted = Signs | Legend | Caption | ScaleBar | Hint | NextClick | Badge | WorkWords | ToolWords
Drawable = Rendered | Painted
