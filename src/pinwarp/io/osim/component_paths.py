"""The paths of components, as OpenSim makes them of tags and names."""

from __future__ import annotations

from collections.abc import Iterable

from pinwarp.io.osim.document import Element

PATHS = ("GeometryPath", "FunctionBasedPath", "PointBasedPath", "Scholz2015GeometryPath")
# Sets that are no component of their own.
_TRANSPARENT = ("PathPointSet", "PathWrapSet")


def paths_below(root: Element, elements: Iterable[Element]) -> dict[int, str]:
    """Return the path of every element by its number; a property has that of its component.

    Parameters
    ----------
    root
        The model, whose path is empty.
    elements
        All below it, in the order of the document.

    Examples
    --------
    >>> from pathlib import Path
    >>> from pinwarp.io.osim.document import read_document
    >>> text = b"<Model><BodySet><objects><Body name='hip'/></objects></BodySet></Model>"
    >>> root = read_document(Path("a.osim"), text).root
    >>> paths_below(root, root.walk())[3]
    '/bodyset/hip'
    """
    paths = {root.number: ""}
    for element in elements:
        if element.parent is not None and element is not root:
            segment = segment_of(element)
            above = paths[element.parent.number]
            paths[element.number] = f"{above}/{segment}" if segment else above
    return paths


def segment_of(element: Element) -> str:
    """Return what an element adds to the path of what is in it; empty for a mere property."""
    tag = element.tag
    # OpenSim goes by the property and not by the name attribute for what there is one of.
    if tag in PATHS:
        return "path"
    if tag in _TRANSPARENT or tag == "Model" or not tag[:1].isupper():
        return ""
    if tag.endswith("Set") or tag == "Ground":
        return tag.lower()
    return element.name


def canonical(path: str) -> str:
    """Return a path under the names that OpenSim goes by today.

    Examples
    --------
    >>> canonical("/forceset/rf/geometrypath/P1")
    '/forceset/rf/path/P1'
    """
    # Until version 4.5 the property that is "path" now was called "geometrypath".
    return path.replace("/geometrypath/", "/path/")
