"""A small forward kinematics of our models, which shares no line with what it is to check.

It knows what the three models hold: sockets by path, welds, pins, balls at rest and one custom
joint about z. Its transforms are 4 x 4.
"""

from __future__ import annotations

import math
import posixpath
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from scipy.interpolate import make_interp_spline

_FRAMES = ("Body", "PhysicalOffsetFrame", "StationDefinedFrame")
_PROPERTIES = ("objects", "components", "frames", "attached_geometry", "coordinates")


class Kinematics:
    """A model in a pose: where its frames and points are in the ground."""

    def __init__(self, path: Path, **coordinates: float):
        model = ET.parse(path).getroot().find("Model")
        self._q = coordinates
        self._parts, self._joints = {}, {}
        self._walk(model, "")
        self._ground = {"/ground": np.eye(4)}

    def _walk(self, element, path):
        for child in element:
            if child.tag == "defaults":
                continue
            here = path
            if child.tag.endswith("Set") and not child.tag.startswith("Path"):
                here = f"{path}/{child.tag.lower()}"
            elif child.tag == "GeometryPath":
                here = f"{path}/path"
            elif (child.get("name") and not child.tag.startswith("Path")) or "Point" in child.tag:
                here = f"{path}/{child.get('name')}" if child.get("name") else path
            if child.get("name"):
                self._parts[here] = child
            if child.tag.endswith("Joint"):
                parent = self._socket(here, child, "socket_parent_frame")
                self._joints[self._socket(here, child, "socket_child_frame")] = (parent, child)
            self._walk(child, here)

    @staticmethod
    def _socket(path, element, name):
        return posixpath.normpath(posixpath.join(path, element.findtext(name).strip()))

    def in_ground(self, path: str) -> np.ndarray:
        """Return the 4 x 4 placement of a frame in the ground."""
        if path not in self._ground:
            body = self._body_of(path)
            if body == "/ground":
                return self.in_body(path)
            (child,) = (frame for frame in self._joints if self._body_of(frame) == body)
            parent, joint = self._joints[child]
            at = self.in_ground(parent) @ self._moved(joint) @ np.linalg.inv(self.in_body(child))
            self._ground[path] = at @ self.in_body(path)
        return self._ground[path]

    def _body_of(self, path):
        element = self._parts.get(path)
        if path == "/ground" or element.tag == "Body":
            return path
        if element.tag == "StationDefinedFrame":
            station = self._socket(path, element, "socket_origin_point")
            return self._body_of(self._socket(station, self._parts[station], "socket_parent_frame"))
        return self._body_of(self._socket(path, element, "socket_parent"))

    def in_body(self, path: str) -> np.ndarray:
        """Return the 4 x 4 placement of a frame in its body."""
        if path == "/ground" or self._parts[path].tag == "Body":
            return np.eye(4)
        element = self._parts[path]
        if element.tag == "StationDefinedFrame":
            return self._of_stations(path, element)
        outer = self.in_body(self._socket(path, element, "socket_parent"))
        return outer @ _placed(_numbers(element, "orientation"), _numbers(element, "translation"))

    def _of_stations(self, path, element):
        a, b, c, origin = (
            self.point_in_body(self._socket(path, element, f"socket_{name}"))
            for name in ("point_a", "point_b", "point_c", "origin_point")
        )
        long, across = b - a, np.cross(b - a, c - a)
        axes = {}
        for text, vector in (("ab_axis", long), ("ab_x_ac_axis", across)):
            sign, letter = element.findtext(text).strip()
            axes[letter] = (-1 if sign == "-" else 1) * vector / np.linalg.norm(vector)
        (missing,) = set("xyz") - set(axes)
        after = {"x": "yz", "y": "zx", "z": "xy"}[missing]
        axes[missing] = np.cross(axes[after[0]], axes[after[1]])
        made = np.eye(4)
        made[:3, :3] = np.column_stack([axes[letter] for letter in "xyz"])
        made[:3, 3] = origin
        return made

    def point_in_body(self, path: str) -> np.ndarray:
        """Return where a point is in the body that it is on."""
        element = self._parts[path]
        frame = self.in_body(self._socket(path, element, "socket_parent_frame"))
        return (frame @ [*_numbers(element, "location"), 1])[:3]

    def point_in_ground(self, path: str) -> np.ndarray:
        """Return where a point is in the ground."""
        element = self._parts[path]
        frame = self.in_ground(self._socket(path, element, "socket_parent_frame"))
        return (frame @ [*_numbers(element, "location"), 1])[:3]

    def _moved(self, joint):
        q = [self._q.get(c.get("name"), 0.0) for c in joint.iter("Coordinate")]
        if joint.tag == "PinJoint":
            return _placed([0, 0, q[0]], [0, 0, 0])
        if joint.tag != "CustomJoint":
            return np.eye(4)
        moved = np.zeros(3)
        for axis in joint.iter("TransformAxis"):
            if axis.get("name").startswith("translation"):
                moved += _numbers(axis, "axis") * _value(axis, q[0])
        return _placed([0, 0, q[0]], moved)


def _numbers(element, tag):
    return np.array((element.findtext(tag) or "0 0 0").split(), dtype=float)


def _placed(angles, origin):
    made = np.eye(4)
    for axis, angle in enumerate(angles):
        turn = np.eye(3)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn[i, i] = turn[j, j] = math.cos(angle)
        turn[i, j], turn[j, i] = -math.sin(angle), math.sin(angle)
        made[:3, :3] = made[:3, :3] @ turn
    made[:3, 3] = origin
    return made


def _value(axis, q):
    if (constant := axis.find("Constant")) is not None:
        return float(constant.findtext("value"))
    spline = axis.find("SimmSpline")
    return simm_spline(_numbers(spline, "x"), _numbers(spline, "y"), q)


def simm_spline(x, y, where):
    """Evaluate OpenSim's spline by scipy's, its third derivatives at the ends prescribed."""
    ends = []
    for knots, values in ((x[:4], y[:4]), (x[-4:], y[-4:])):
        ends.append(6 * np.polyfit(knots, values, 3)[0])
    return make_interp_spline(x, y, bc_type=([(3, ends[0])], [(3, ends[1])]))(where)
