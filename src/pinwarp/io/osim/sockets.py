"""Which frame something is attached to."""

from __future__ import annotations

from pinwarp.io.osim.document import Element
from pinwarp.io.osim.model import BASES, OFFSETS, STATION_FRAME, OsimModel


def is_frame_socket(tag: str) -> bool:
    """Whether a property connects to a frame.

    Examples
    --------
    >>> is_frame_socket("socket_parent_frame"), is_frame_socket("socket_coordinate")
    (True, False)
    """
    return tag.startswith("socket_") and (tag == "socket_parent" or "frame" in tag or "body" in tag)


def attached_to(model: OsimModel, element: Element) -> str:
    """Return the frame that a mesh or another shape is attached to: by its socket, or as owned.

    Raises
    ------
    FileFormatError
        When the socket leads nowhere, or nothing owns it.
    """
    if model.text(element, "socket_frame"):
        return model.frame_of(element, "socket_frame")
    return owner_of(model, element)


def owner_of(model: OsimModel, element: Element) -> str:
    """Return the path of the frame that an element is written in, as wraps are.

    Raises
    ------
    FileFormatError
        When it is in none.
    """
    at = element.parent
    while at is not None:
        if at.tag in (*BASES, *OFFSETS, STATION_FRAME):
            return model.path_of(at)
        at = at.parent
    raise model.error(element, "It is attached to no frame. Correct it.")
