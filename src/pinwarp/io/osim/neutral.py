"""Where the bodies of a model stand in one another while all coordinates are 0."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pinwarp.core.frame_warp import BodyRules, CarriedFrames
from pinwarp.core.model_parts import BodyParts, TrajectoryPart
from pinwarp.core.placement import HERE, Placement
from pinwarp.io.osim.model import GROUND, OsimModel
from pinwarp.io.osim.trajectories import joint_way


def neutral_pose(model: OsimModel, parts: Mapping[str, BodyParts]) -> dict[str, Placement]:
    """Return where bodies are in the ground, for pictures: joints moved along, but not turned.

    Parameters
    ----------
    model
        The model.
    parts
        What stands on each of its bodies.

    Returns
    -------
    dict
        By path; bodies that no joint connects with the ground are not in it.

    Examples
    --------
    >>> from pinwarp.io.osim.body_parts import body_parts
    >>> from pinwarp.io.osim.reading import read_model
    >>> from pinwarp.io.samples import sample_model
    >>> model = read_model(sample_model())
    >>> pose = neutral_pose(model, {body: body_parts(model, body) for body in model.bodies})
    >>> pose["/bodyset/shank"].origin.round(2).tolist()
    [0.0, 0.54, 0.05]
    """
    frames = {path: CarriedFrames(one, lambda x: x, BodyRules()) for path, one in parts.items()}

    def in_body(frame: str) -> Placement:
        body = model.body_of(frame)
        if body in frames:
            return frames[body].before(frame)
        # The ground has offset frames, too.
        placement = HERE
        while frame != GROUND:
            element = model.components[frame]
            angles = model.numbers(element, "orientation", (0, 0, 0))
            origin = model.numbers(element, "translation", (0, 0, 0))
            placement = Placement.from_angles(angles, origin).holding(placement)
            frame = model.frame_of(element, "socket_parent")
        return placement

    pose, joints = {GROUND: HERE}, []
    for element in model.objects:
        if not element.tag.endswith("Joint"):
            continue
        parent, child = (
            model.frame_of(element, socket)
            for socket in ("socket_parent_frame", "socket_child_frame")
        )
        moved = HERE
        if element.tag == "CustomJoint":
            way = joint_way(model, element, parent)
            if isinstance(way, TrajectoryPart):
                along = np.array([float(function(0.0)) for function in way.functions])
                moved = Placement(np.eye(3), way.axes @ along)
        at_parent = in_body(parent).holding(moved)
        joints.append((model.body_of(parent), at_parent, model.body_of(child), in_body(child)))
    # A joint may stand before the one that its parent hangs on.
    while waiting := [one for one in joints if one[0] in pose and one[2] not in pose]:
        for parent, at_parent, child, at_child in waiting:
            pose[child] = pose[parent].holding(at_parent).holding(HERE.seen_from(at_child))
    return pose
