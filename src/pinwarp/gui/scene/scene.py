"""What a viewport shows, as a pure function of the session, the view state and the results."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pinwarp.core.landmarks import Landmark, LandmarkState, Position, Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.session.judging.quality import Quality
from pinwarp.session.mesh_units import unit_on
from pinwarp.session.session import Session
from pinwarp.session.view import Selection, ViewState
from pinwarp.session.warp.ghost import Ghost
from pinwarp.session.warp.pair_names import pair_names
from pinwarp.session.warp.solver import WarpResult, is_rounding


@dataclass(frozen=True)
class Marker:
    """One landmark in one viewport."""

    name: str
    position: Position
    state: LandmarkState
    selected: bool = False
    labelled: bool = False
    movable: bool = True


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
class Scene:
    """All that one viewport shows besides its overlay's vertices."""

    side: Side
    mesh: Mesh | None
    markers: tuple[Marker, ...]
    overlay_visible: bool = False
    overlay_opacity: float = 0.5
    map_opacity: float = 1.0
    hint: str = ""
    ghost: Ghost | None = None
    arrows: tuple[Arrow, ...] = ()
    unit: str = ""
    marker_radius: float = 6.0
    wireframe: bool = False
    section: float | None = None

    @property
    def overlay(self) -> tuple[bool, float, float]:
        """How the overlay is drawn, with and without a map."""
        return self.overlay_visible, self.overlay_opacity, self.map_opacity


# With more of them selected, their labels would hide the bone.
MOST_LABELS = 12

_EMPTY_HINTS = {
    Side.SOURCE: "Drop the source mesh here\nor open it with Ctrl+1\n\n"
    "To look around first: File > Open Sample Bones",
    Side.DESTINATION: "Drop the destination mesh here\nor open it with Ctrl+2",
}


def scene_of(
    side: Side,
    session: Session,
    selection: Selection,
    view: ViewState,
    result: WarpResult | None,
    ghost: Ghost | None = None,
    quality: Quality | None = None,
) -> Scene:
    """Say what a viewport shows.

    Passengers have no destination: on that side they stand where the warp carries them.
    Selected landmarks get a second arrow, as at penalty 0 the warp misses none of them.
    """
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
    return Scene(
        side=side,
        mesh=session.mesh(side),
        markers=tuple(markers),
        overlay_visible=side is Side.DESTINATION and view.overlay,
        overlay_opacity=view.opacity,
        map_opacity=view.map_opacity,
        ghost=ghost,
        arrows=_arrows(session, selection, view, result, quality)
        if side is Side.DESTINATION and view.arrows
        else (),
        hint="" if session.mesh(side) is not None else _EMPTY_HINTS[side],
        unit=unit_on(session, side),
        marker_radius=view.marker_radius,
        wireframe=view.wireframe,
        section=view.section,
    )


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
    return Marker(
        name=landmark.name,
        position=position,
        state=landmark.state,
        selected=selected,
        labelled=landmark.name in (view.hovered, view.guided)
        or (selected and len(selection.names) <= MOST_LABELS),
        movable=movable and not view.locked and not landmark.locked,
    )
