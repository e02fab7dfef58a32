"""A model of OpenSim: its components by path, its sockets, and what its properties say."""

from __future__ import annotations

import posixpath
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.errors import FileFormatError
from pinwarp.core.words import some_of, with_article
from pinwarp.io.csv_cells import number_of, shortened
from pinwarp.io.osim.component_paths import canonical, paths_below, segment_of
from pinwarp.io.osim.document import Document, Element

BASES = ("Body", "Ground")
OFFSETS = ("PhysicalOffsetFrame", "OffsetFrame")
STATION_FRAME = "StationDefinedFrame"
GROUND = "/ground"
# How many frames may stand in one another; models have three or four.
_DEEPEST = 64


@dataclass(frozen=True, eq=False)
class OsimModel:
    """A model as it was read; nothing of it changes.

    Parameters
    ----------
    path
        The file, absolute.
    data
        Its bytes.
    sha256
        Their hash.
    version
        Of the format, such as 40500.
    document, element
        Its elements with their bytes, and the ``Model`` among them.
    elements
        All elements of the model but its defaults, by their number.

    Examples
    --------
    >>> from pinwarp.io.osim.reading import read_model
    >>> from pinwarp.io.samples import sample_model
    >>> model = read_model(sample_model())
    >>> model.bodies
    ('/bodyset/hip', '/bodyset/thigh', '/bodyset/shank')
    """

    path: Path
    data: bytes = field(repr=False)
    sha256: str
    version: int
    document: Document = field(repr=False)
    element: Element = field(repr=False)
    elements: dict[int, Element] = field(repr=False)

    @property
    def name(self) -> str:
        """The model's name."""
        return self.element.name or self.path.stem

    @cached_property
    def bodies(self) -> tuple[str, ...]:
        """The paths of its bodies, in the order of the file."""
        return tuple(path for path, e in self.components.items() if e.tag == "Body")

    @cached_property
    def objects(self) -> tuple[Element, ...]:
        """Its elements that are objects and not properties, in the order of the file."""
        return tuple(e for e in self.elements.values() if e.tag[:1].isupper())

    @cached_property
    def _bodies_of(self) -> dict[str, str]:
        """The bodies of the frames that were asked for."""
        return {}

    @cached_property
    def parents(self) -> dict[str, str]:
        """The body, or the ground, that each body is joined to as its child."""
        found: dict[str, str] = {}
        for joint in self.objects:
            if joint.tag.endswith("Joint"):
                parent, child = (
                    self.body_of(self.frame_of(joint, socket))
                    for socket in ("socket_parent_frame", "socket_child_frame")
                )
                found.setdefault(child, parent)
        return found

    @cached_property
    def components(self) -> dict[str, Element]:
        """Its named elements by path as OpenSim writes it; of two with one path, the first."""
        found: dict[str, Element] = {}
        for element in self.elements.values():
            if segment_of(element):
                found.setdefault(self._paths[element.number], element)
        return found

    @cached_property
    def _paths(self) -> dict[int, str]:
        """The path of every element: that of its parent, and a segment where it is a component."""
        return paths_below(self.element, self.elements.values())

    def path_of(self, element: Element) -> str:
        """Return an element's path; a property has that of its component."""
        return self._paths[element.number] or "/"

    def error(self, element: Element, words: str) -> FileFormatError:
        """Return an error about an element: it names file, line and path."""
        return FileFormatError(self.path, f"{self.path_of(element)}: {words}", element.line)

    def text(self, element: Element, tag: str, default: str = "") -> str:
        """Return what a property says, without blanks around it."""
        child = element.child(tag)
        return (child.text.strip() if child is not None else "") or default

    def numbers(self, element: Element, tag: str, default: ArrayLike) -> NDArray[np.float64]:
        """Return the numbers of a property, as many as its default has.

        Raises
        ------
        FileFormatError
            When they are not as many, or not finite numbers.
        """
        standard = np.atleast_1d(np.array(default, dtype=np.float64))
        words = self.text(element, tag)
        if not words:
            return standard
        found = self.any_numbers(element, tag)
        if len(found) != len(standard):
            raise self.error(
                element, f"{tag} has {len(found)} numbers instead of {len(standard)}. Correct it."
            )
        return found

    def any_numbers(self, element: Element, tag: str) -> NDArray[np.float64]:
        """Return the numbers of a property, however many.

        Raises
        ------
        FileFormatError
            When one is not a finite number.
        """
        words = self.text(element, tag).replace("(", " ").replace(")", " ").split()
        try:
            return np.array([number_of(word, ",") for word in words], dtype=np.float64)
        except ValueError:
            said = shortened(self.text(element, tag))
            problem = f"{tag} is {said} and not finite numbers. Correct it."
            raise self.error(element, problem) from None

    def socket(self, element: Element, name: str) -> str:
        """Return the path that a socket of a component leads to; empty where it says nothing.

        Whether something is there is not looked at.
        """
        words = self.text(element, name)
        if not words:
            return ""
        here = self.path_of(element)
        return canonical(posixpath.normpath(posixpath.join(here, words)))

    def connected(self, element: Element, name: str) -> Element:
        """Return the component that a socket is connected to.

        Raises
        ------
        FileFormatError
            When there is none.
        """
        path = self.socket(element, name)
        found = self.components.get(path)
        if found is None:
            said = shortened(self.text(element, name))
            raise self.error(
                element,
                f"Its {name} is {said}, and there is nothing of that path in the model. Open the "
                "model in OpenSim, connect it and save it.",
            )
        return found

    def frame_of(self, element: Element, name: str) -> str:
        """Return the path of the frame that a socket is connected to.

        Raises
        ------
        FileFormatError
            When there is none of that path, or it is no frame.
        """
        if self.socket(element, name) == GROUND:
            return GROUND
        found = self.connected(element, name)
        if found.tag not in (*BASES, *OFFSETS, STATION_FRAME):
            raise self.error(
                element, f"Its {name} is {with_article(found.tag)}, which is no frame known here."
            )
        return self.path_of(found)

    def body_of(self, frame: str) -> str:
        """Return the body, or the ground, that a frame stands on in the end.

        Raises
        ------
        FileFormatError
            When frames stand on each other in a circle, or too deep in one another.
        """
        if frame in self._bodies_of:
            return self._bodies_of[frame]
        at = frame
        for _ in range(_DEEPEST):
            if at == GROUND or self.components[at].tag in BASES:
                self._bodies_of[frame] = at
                return at
            element = self.components[at]
            if element.tag == STATION_FRAME:
                station = self.connected(element, "socket_origin_point")
                at = self.frame_of(station, "socket_parent_frame")
            else:
                at = self.frame_of(element, "socket_parent")
        raise self.error(
            self.components[frame], "It stands on itself, or too deep in other frames. Correct it."
        )

    def body(self, name: str) -> str:
        """Return the path of a body that is given by its name or its path.

        Raises
        ------
        FileFormatError
            When there is none; the message names those that are there.
        """
        for path in self.bodies:
            if name in (path, path.rsplit("/", 1)[-1]):
                return path
        known = some_of([path.rsplit("/", 1)[-1] for path in self.bodies])
        raise FileFormatError(
            self.path, f"There is no body {shortened(name)} in it. It has {known}."
        )
