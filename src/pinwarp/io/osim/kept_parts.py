"""What on a body no rule carries: named all the same, so that nothing is silent."""

from __future__ import annotations

import re
from collections.abc import Iterator

from pinwarp.core.model_parts import KeptPart
from pinwarp.core.words import with_article
from pinwarp.io.osim.document import Element
from pinwarp.io.osim.model import OFFSETS, STATION_FRAME, OsimModel
from pinwarp.io.osim.sockets import attached_to, is_frame_socket, owner_of

LENGTHS = ("optimal_fiber_length", "tendon_slack_length", "resting_length", "rest_length")
"""Properties of forces along a path that a change of the path's length asks to change, too."""

# What the other modules carry or name.
_KNOWN = (
    *("PathPoint", "ConditionalPathPoint", "MovingPathPoint", "Marker", "Station"),
    *("WrapCylinder", "WrapEllipsoid", "WrapSphere", *OFFSETS, STATION_FRAME, "FrameGeometry"),
)
_BODY_NAME = re.compile(r"body(_?[12AB])?")
_BY_HAND = "There is no rule for it, its numbers are those of the generic bone: look at it."


def kept_parts(model: OsimModel, body: str) -> Iterator[KeptPart]:
    """Yield what stands on a body and is left as it is.

    Parameters
    ----------
    model
        The model.
    body
        Path of the body.

    Raises
    ------
    FileFormatError
        When a socket leads nowhere.
    """
    element = model.components[body]
    mass = f"{model.numbers(element, 'mass', 0.0)[0]:g}"
    about = (element.number, body, "mass and inertia", element.line)
    yield KeptPart(*about, words=f"mass {mass} kg and inertia are the generic body's")
    for each in model.objects:
        for kind, words, flag in _of(model, body, each):
            yield KeptPart(each.number, model.path_of(each), kind, each.line, words, flag)


def _of(model: OsimModel, body: str, element: Element) -> Iterator[tuple[str, str, str]]:
    """Yield kind, words and flag where an element is to be named."""
    tag = element.tag
    if tag in _KNOWN or tag.endswith("Joint"):
        return
    kind = _in_words(tag)
    if tag == "FunctionBasedPath":
        if body in _bodies_moved(model, element):
            flag = "Its length is a function of coordinates: fit it anew to the warped model."
            yield kind, "its functions are the generic model's", flag
    elif tag.startswith("Wrap") and not tag.endswith("Set"):
        if model.body_of(owner_of(model, element)) == body:
            yield kind, "there is no rule for this shape", _BY_HAND
    elif element.parent is not None and element.parent.tag == "attached_geometry":
        if tag != "Mesh" and model.body_of(attached_to(model, element)) == body:
            yield "drawn shape", f"{with_article(kind)} moves with its frame and keeps its size", ""
    elif element.child("GeometryPath") is not None:
        lengths = [
            f"{name} {model.numbers(element, name, 0.0)[0]:g}"
            for name in LENGTHS
            if element.child(name) is not None
        ]
        if lengths and body in _bodies_passed(model, element):
            are = "is" if len(lengths) == 1 else "are"
            yield "muscle lengths", f"{' and '.join(lengths)} {are} the generic muscle's", ""
    elif tag != "Mesh" and body in _bodies_named(model, element):
        yield kind, "there is no rule for it", _BY_HAND


def _bodies_named(model: OsimModel, element: Element) -> set[str]:
    """Return the bodies that an element's sockets lead to, or that it names."""
    found = set()
    for child in element.children:
        if is_frame_socket(child.tag) and child.text.strip():
            found.add(model.body_of(model.frame_of(element, child.tag)))
        elif _BODY_NAME.fullmatch(child.tag):
            name = child.text.strip()
            found.update(path for path in model.bodies if name in (path, path.rsplit("/", 1)[-1]))
    return found


def _bodies_passed(model: OsimModel, force: Element) -> set[str]:
    """Return the bodies that a force's path is on, and those that it spans."""
    chains = []
    for point in force.walk():
        if point.tag not in ("PathPoint", "ConditionalPathPoint", "MovingPathPoint"):
            continue
        chain = [model.body_of(model.frame_of(point, "socket_parent_frame"))]
        while (parent := model.parents.get(chain[-1])) is not None and parent not in chain:
            chain.append(parent)
        chains.append(chain)
    if not chains:
        return set()
    shared = set(chains[0]).intersection(*chains)
    passed = {body for chain in chains for body in chain} - shared
    # Where all chains meet is passed, what is behind that is not.
    return passed | set([body for body in chains[0] if body in shared][:1])


def _bodies_moved(model: OsimModel, path: Element) -> set[str]:
    """Return the bodies that the coordinates of a path of functions move."""
    found = set()
    for coordinate in model.text(path, "coordinate_paths").split():
        joint = model.components.get(coordinate.rsplit("/", 1)[0])
        if joint is not None and joint.tag.endswith("Joint"):
            found |= _bodies_named(model, joint)
    return found


def _in_words(tag: str) -> str:
    """Return a tag as words.

    Examples
    --------
    >>> _in_words("ContactHalfSpace")
    'contact half space'
    """
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", tag).lower()
