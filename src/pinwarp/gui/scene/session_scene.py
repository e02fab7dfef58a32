"""What a session puts into a scene, as a pure function of it, the view state and the results."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from pinwarp.core.landmarks import Landmark, LandmarkState, Position, Side, as_position
from pinwarp.gui.scene.drawables import (
    Arrow,
    Arrows,
    Bone,
    Caption,
    Cut,
    Drawable,
    Hint,
    Marker,
    Markers,
    ScaleBar,
)
from pinwarp.gui.scene.key_words import with_own_keys
from pinwarp.io.mesh_reference import MeshReference
from pinwarp.io.meshes import MeshFile
from pinwarp.session.judging.quality import Quality
from pinwarp.session.rulers import rulers_of
from pinwarp.session.session import Session
from pinwarp.session.view import Selection, ViewState
from pinwarp.session.warp.pair_names import pair_names
from pinwarp.session.warp.result import WarpResult
from pinwarp.session.warp.solver import is_rounding

# With more of them selected, their labels would hide the bone.
MOST_LABELS = 12

_EMPTY_HINTS = {
    Side.SOURCE: "Drop the source mesh here\nor open it with Ctrl+1\n\n"
    "To look around first: File > Open Sample Bones",
    Side.DESTINATION: "Drop the destination mesh here\nor open it with Ctrl+2",
}
# Where there is something else to be seen, which words over it would cover.
_NO_MESH = {
    Side.SOURCE: "no mesh yet (Ctrl+1)",
    Side.DESTINATION: "no mesh yet (Ctrl+2)",
}


def session_drawables(
    side: Side,
    session: Session,
    selection: Selection,
    view: ViewState,
    result: WarpResult | None,
    quality: Quality | None = None,
) -> Iterator[Drawable]:
    """Say what the session puts into a viewport, as the view state wants it.

    Passengers have no destination: on that side they stand where the warp carries them.
    Selected landmarks get a second arrow, as at penalty 0 the warp misses none of them.
    """
    mesh, file = session.mesh(side), session.mesh_file(side)
    carried = side is Side.DESTINATION and result is not None and result.vertices is not None
    markers = _markers(side, session, selection, view, result)
    is_empty = mesh is None and not carried and not markers
    no_mesh = "" if is_empty else with_own_keys(_NO_MESH[side])
    words = _file_words(file) if file is not None else no_mesh
    notes = file.notes if isinstance(file, MeshFile) else ()
    yield Caption(side.value.capitalize(), words, notes)
    if mesh is not None:
        yield Bone(mesh, view.wireframe)
    elif is_empty:
        yield Hint(with_own_keys(_EMPTY_HINTS[side]))
    if not is_empty:
        yield ScaleBar(rulers_of(session, view.lengths).on(side))
    if view.section is not None:
        yield Cut(view.section)
    yield Markers(markers, view.marker_radius)
    if side is Side.DESTINATION and view.arrows:
        arrows = _arrows(session, selection, view, result, quality)
        if arrows:
            yield Arrows(arrows)


def _file_words(file: MeshFile | MeshReference) -> str:
    """Return the name of a mesh's file, and how the mesh differs from what is in it."""
    ways = [f"mirrored: {file.mirrored}"] if file.mirrored else []
    if file.scaled != 1:
        ways.append(f"× {file.scaled:g}")
    return f"{file.path.name} ({', '.join(ways)})" if ways else file.path.name


def _markers(
    side: Side,
    session: Session,
    selection: Selection,
    view: ViewState,
    result: WarpResult | None,
) -> tuple[Marker, ...]:
    markers = [
        _marker(landmark, position, selection, view)
        for landmark in session.landmarks
        if (position := landmark.position(side)) is not None
        # One that was a pair keeps its destination, but is not drawn there; one that came with
        # its bone when the sides were swapped is.
        and (
            side is Side.SOURCE
            or landmark.state is not LandmarkState.PASSENGER
            or landmark.source is None
        )
    ]
    if side is Side.DESTINATION and result is not None and result.passengers is not None:
        passengers = [
            landmark
            for landmark in session.landmarks
            if landmark.state is LandmarkState.PASSENGER and landmark.source is not None
        ]
        if len(passengers) == len(result.passengers):
            markers += [
                _marker(landmark, as_position(warped), selection, view, movable=False)
                for landmark, warped in zip(passengers, result.passengers, strict=True)
            ]
    return tuple(markers)


def _arrows(
    session: Session,
    selection: Selection,
    view: ViewState,
    result: WarpResult | None,
    quality: Quality | None,
) -> tuple[Arrow, ...]:
    ends = {pair.name: pair.destination for pair in session.pairs if pair.destination}
    arrows = []
    if view.overlay and result is not None and result.landmarks is not None:
        starts = map(as_position, result.landmarks.tolist())
        for name, start in zip(pair_names(result.inputs, session), starts, strict=True):
            if name is not None and not is_rounding(math.dist(start, ends[name]), ends[name]):
                arrows.append(Arrow(name, start, ends[name]))
    if selection.names and quality is not None and quality.left_out is not None:
        expected = np.array(quality.inputs.destination) - quality.left_out.errors
        starts = map(as_position, expected.tolist())
        for name, start in zip(pair_names(quality.inputs, session), starts, strict=True):
            if name in selection.names and name is not None and math.isfinite(sum(start)):
                arrows.append(Arrow(name, start, ends[name], left_out=True))
    return tuple(arrows)


def _marker(
    landmark: Landmark,
    position: Position,
    selection: Selection,
    view: ViewState,
    *,
    movable: bool = True,
) -> Marker:
    selected = landmark.name in selection.names
    pointed_at = landmark.name in (view.hovered, view.guided)
    return Marker(
        name=landmark.name,
        position=position,
        state=landmark.state,
        selected=selected,
        labelled=pointed_at or (selected and len(selection.names) <= MOST_LABELS),
        movable=movable and not view.locked and not landmark.locked,
        pointed_at=pointed_at,
    )
