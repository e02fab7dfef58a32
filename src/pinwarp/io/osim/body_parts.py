"""What stands on a body, gathered from a model for the warp."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from pinwarp.core.model_parts import (
    BodyParts,
    JointPart,
    KeptPart,
    MeshPart,
    OffsetPart,
    PointPart,
    StationFramePart,
    TrajectoryPart,
    WrapPart,
    WrapShape,
)
from pinwarp.core.placement import Placement, frame_of_stations
from pinwarp.io.osim.document import Element
from pinwarp.io.osim.kept_parts import kept_parts
from pinwarp.io.osim.model import OFFSETS, STATION_FRAME, OsimModel
from pinwarp.io.osim.sockets import owner_of
from pinwarp.io.osim.trajectories import joint_way, moving_point

POINT_KINDS = {
    "PathPoint": "path point",
    "ConditionalPathPoint": "conditional path point",
    "Marker": "marker",
    "Station": "station",
}
_WRAPS = frozenset(shape.value for shape in WrapShape)
_OF_PATHS = ("PathPoint", "ConditionalPathPoint")
_STATIONS = ("socket_point_a", "socket_point_b", "socket_point_c", "socket_origin_point")


def body_parts(model: OsimModel, body: str, meshes: Sequence[MeshPart] = ()) -> BodyParts:
    """Gather what stands on a body.

    Parameters
    ----------
    model
        The model.
    body
        Path of the body.
    meshes
        Its meshes, read by :func:`~pinwarp.io.osim.geometry.read_meshes`.

    Returns
    -------
    BodyParts
        Everything that a socket, or its place in the file, puts on the body.

    Raises
    ------
    FileFormatError
        When a number or a socket in one of them cannot be used; the message names the element.

    Examples
    --------
    >>> from pinwarp.io.osim.reading import read_model
    >>> from pinwarp.io.samples import sample_model
    >>> parts = body_parts(read_model(sample_model()), "/bodyset/thigh")
    >>> [point.path for point in parts.points][:2], parts.points[1].kind
    (['/forceset/rf/path/rf-P2', '/forceset/ham/path/ham-P2'], 'conditional path point')
    """
    return _Gatherer(model, body).gathered(meshes)


class _Gatherer:
    """Goes through the elements of a model once for one body."""

    def __init__(self, model: OsimModel, body: str) -> None:
        self._model, self._body = model, body
        self._elements = model.objects
        self._wraps = {}
        for element in self._elements:
            if element.tag in _WRAPS and self._is_on(owner_of(model, element)):
                self._wraps[element.name] = model.path_of(element)

    def gathered(self, meshes: Sequence[MeshPart]) -> BodyParts:
        model = self._model
        element = model.components[self._body]
        moving: list[TrajectoryPart | KeptPart] = [*self._moving_points()]
        ways: list[TrajectoryPart | KeptPart | JointPart] = [*self._joints()]
        both = [*moving, *ways]
        return BodyParts(
            path=self._body,
            mass_centre=PointPart(
                element.number,
                self._body,
                "mass centre",
                element.line,
                self._body,
                model.numbers(element, "mass_center", (0, 0, 0)),
            ),
            frames={part.path: part for part in self._frames()},
            points=tuple(self._points()),
            trajectories=tuple(part for part in both if isinstance(part, TrajectoryPart)),
            wraps=tuple(self._wrap_parts()),
            meshes=tuple(meshes),
            joints=tuple(part for part in both if isinstance(part, JointPart)),
            kept=(
                *(part for part in both if isinstance(part, KeptPart)),
                *kept_parts(model, self._body),
            ),
        )

    def _is_on(self, frame: str) -> bool:
        return self._model.body_of(frame) == self._body

    def _about(self, element: Element, kind: str) -> tuple[int, str, str, int]:
        return element.number, self._model.path_of(element), kind, element.line

    def _frames(self) -> Iterator[OffsetPart | StationFramePart]:
        model = self._model
        for element in self._elements:
            if element.tag not in (*OFFSETS, STATION_FRAME):
                continue
            path = model.path_of(element)
            if not self._is_on(path):
                continue
            if model.components[path] is not element:
                raise model.error(element, "Another element has this path. Rename one of them.")
            if element.tag == STATION_FRAME:
                yield self._station_frame(element)
                continue
            angles = model.numbers(element, "orientation", (0, 0, 0))
            origin = model.numbers(element, "translation", (0, 0, 0))
            yield OffsetPart(
                *self._about(element, "offset frame"),
                frame=model.frame_of(element, "socket_parent"),
                placement=Placement.from_angles(angles, origin),
            )

    def _station_frame(self, element: Element) -> StationFramePart:
        model = self._model
        stations = [model.connected(element, socket) for socket in _STATIONS]
        for station, socket in zip(stations, _STATIONS, strict=True):
            if station.tag not in POINT_KINDS or not self._is_on(
                model.frame_of(station, "socket_parent_frame")
            ):
                raise model.error(element, f"Its {socket} is no station of its body. Correct it.")
        axes = (model.text(element, "ab_axis", "+x"), model.text(element, "ab_x_ac_axis", "+y"))
        a, b, c, origin = (station.number for station in stations)
        try:
            # Whether these are axes; where the stations are is known only in the end.
            frame_of_stations([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]], *axes)
        except ValueError as error:
            raise model.error(element, f"Of its axes {error}. Correct it.") from None
        return StationFramePart(
            *self._about(element, "station-defined frame"),
            stations=(a, b, c, origin),
            ab_axis=axes[0],
            ab_x_ac_axis=axes[1],
        )

    def _points(self) -> Iterator[PointPart]:
        model = self._model
        for element in self._elements:
            if element.tag not in POINT_KINDS:
                continue
            frame = model.frame_of(element, "socket_parent_frame")
            if self._is_on(frame):
                is_of_path = element.tag in _OF_PATHS
                yield PointPart(
                    *self._about(element, POINT_KINDS[element.tag]),
                    frame=frame,
                    location=model.numbers(element, "location", (0, 0, 0)),
                    is_of_path=is_of_path,
                    wraps=self._used_wraps(element) if is_of_path else (),
                )

    def _used_wraps(self, point: Element) -> tuple[str, ...]:
        """Return the wraps of this body that the muscle of a path point uses."""
        at = point.parent
        while at is not None and at.tag != "GeometryPath":
            at = at.parent
        if at is None:
            return ()
        names = [self._model.text(e, "wrap_object") for e in at.walk() if e.tag == "PathWrap"]
        return tuple(self._wraps[name] for name in names if name in self._wraps)

    def _wrap_parts(self) -> Iterator[WrapPart]:
        model = self._model
        for element in self._elements:
            if element.tag not in _WRAPS or not self._is_on(owner_of(model, element)):
                continue
            shape = WrapShape(element.tag)
            match shape:
                case WrapShape.CYLINDER:
                    radius = model.numbers(element, "radius", 0.0)
                    size = np.concatenate([radius, model.numbers(element, "length", 1.0)])
                case WrapShape.ELLIPSOID:
                    size = model.numbers(element, "dimensions", (0, 0, 0))
                case WrapShape.SPHERE:
                    size = model.numbers(element, "radius", 0.0)
            if not (size > 0).all():
                raise model.error(element, "Its size is not above 0. Correct it.")
            angles = model.numbers(element, "xyz_body_rotation", (0, 0, 0))
            origin = model.numbers(element, "translation", (0, 0, 0))
            yield WrapPart(
                *self._about(element, f"wrap {shape.value.removeprefix('Wrap').lower()}"),
                shape=shape,
                frame=owner_of(model, element),
                placement=Placement.from_angles(angles, origin),
                size=size,
            )

    def _moving_points(self) -> Iterator[TrajectoryPart | KeptPart]:
        for element in self._elements:
            if element.tag == "MovingPathPoint" and self._is_on(
                self._model.frame_of(element, "socket_parent_frame")
            ):
                yield moving_point(self._model, element)

    def _joints(self) -> Iterator[TrajectoryPart | KeptPart | JointPart]:
        model = self._model
        for element in self._elements:
            if not element.tag.endswith("Joint"):
                continue
            parent, child = (
                model.frame_of(element, socket)
                for socket in ("socket_parent_frame", "socket_child_frame")
            )
            if not (self._is_on(parent) or self._is_on(child)):
                continue
            about = self._about(element, "joint")
            if self._body in (parent, child):
                yield JointPart(*about)
            elif element.tag == "EllipsoidJoint" and self._is_on(parent):
                flag = "Its ellipsoid is that of the generic bone: change it by hand."
                yield KeptPart(*about, words="its radii are kept", flag=flag)
            else:
                yield KeptPart(*about, words="it stands on frames that are carried")
            if element.tag == "CustomJoint" and self._is_on(parent):
                yield joint_way(model, element, parent)
