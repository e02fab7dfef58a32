"""Places that depend on a coordinate: moving path points, and the translations of joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pinwarp.core.coordinate_function import CoordinateFunction
from pinwarp.core.model_parts import KeptPart, TrajectoryPart
from pinwarp.io.osim.document import Element
from pinwarp.io.osim.functions import UnknownFunctionError, function_in, read_function
from pinwarp.io.osim.model import OsimModel

_BY_HAND = "Its numbers are those of the generic bone: change them by hand."


def moving_point(model: OsimModel, element: Element) -> TrajectoryPart | KeptPart:
    """Return a moving path point as a way, or kept where its functions are of another kind.

    Raises
    ------
    FileFormatError
        When a function cannot be used.
    """
    return _way(
        model,
        element,
        "moving path point",
        model.frame_of(element, "socket_parent_frame"),
        np.eye(3),
        [function_in(element, f"{axis}_location") for axis in "xyz"],
        [model.socket(element, f"socket_{axis}_coordinate") for axis in "xyz"],
    )


def joint_way(model: OsimModel, element: Element, parent: str) -> TrajectoryPart | KeptPart:
    """Return how a joint moves its child along its parent, or kept where that is not by knots.

    Parameters
    ----------
    model, element
        A custom joint.
    parent
        Path of its parent's frame.

    Raises
    ------
    FileFormatError
        When a function or an axis cannot be used.
    """
    transform = element.child("SpatialTransform")
    axes = [] if transform is None else [e for e in transform.children if e.tag == "TransformAxis"]
    along = [axis for axis in axes if axis.name.startswith("translation")]
    kind = "joint translation"
    if len(along) != 3:
        # All is left at its default: nothing moves along the parent.
        words = "it has no translations"
        flag = "" if not along else "Its translations are incomplete: look at them in OpenSim."
        return KeptPart(*_about(model, element, kind), words=words, flag=flag)
    return _way(
        model,
        element,
        kind,
        parent,
        np.array([model.numbers(axis, "axis", (1, 0, 0)) for axis in along]).T,
        [function_in(axis, "function") for axis in along],
        [model.text(axis, "coordinates") for axis in along],
    )


def _way(
    model: OsimModel,
    element: Element,
    kind: str,
    frame: str,
    axes: np.ndarray,
    elements: Sequence[Element | None],
    coordinates: Sequence[str],
) -> TrajectoryPart | KeptPart:
    about = _about(model, element, kind)
    functions: list[CoordinateFunction] = []
    for each in elements:
        try:
            if each is None:
                raise UnknownFunctionError("missing")
            functions.append(read_function(model, each))
        except UnknownFunctionError as error:
            words = f"a function of it is {error}, which has no knots to carry"
            return KeptPart(*about, words=words, flag=_BY_HAND)
    x, y, z = functions
    a, b, c = (-1 if each is None else each.number for each in elements)
    first, second, third = coordinates
    return TrajectoryPart(
        *about,
        frame=frame,
        axes=axes,
        functions=(x, y, z),
        coordinates=(first, second, third),
        function_keys=(a, b, c),
    )


def _about(model: OsimModel, element: Element, kind: str) -> tuple[int, str, str, int]:
    return element.number, model.path_of(element), kind, element.line
