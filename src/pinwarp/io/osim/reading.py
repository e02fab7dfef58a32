"""Reading a model, and refusing what is none."""

from __future__ import annotations

import hashlib
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.io.osim.document import Element, read_document
from pinwarp.io.osim.model import OsimModel
from pinwarp.io.osim.sockets import is_frame_socket
from pinwarp.io.reading import read_content

LARGEST = 256 << 20
OLDEST_VERSION = 40000


def read_model(path: str | Path) -> OsimModel:
    """Read a model of OpenSim, of version 4 or newer.

    Parameters
    ----------
    path
        The ``.osim`` file. Its meshes are not read.

    Returns
    -------
    OsimModel

    Raises
    ------
    FileFormatError
        When it is no model, one of an older version, damaged, or a frame that something stands
        on is not there; the message names the line and the element.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_model
    >>> read_model(sample_model()).version
    40500
    """
    content = read_content(path, what="model", largest=LARGEST)
    return model_of(content.path, content.data)


def model_of(path: Path, data: bytes) -> OsimModel:
    """Return the model that the bytes of a file hold, as :func:`read_model`.

    Raises
    ------
    FileFormatError
        As there.
    """
    document = read_document(path, data)
    root = document.root
    found = root.child("Model")
    if root.tag != "OpenSimDocument" or found is None:
        raise FileFormatError(
            path, "This is no model of OpenSim. Choose a model's .osim file.", root.line
        )
    version = _version(path, root)
    skipped = {
        e.number for child in found.children if child.tag == "defaults" for e in child.walk()
    }
    elements = {e.number: e for e in found.walk() if e.number not in skipped}
    model = OsimModel(
        path, data, hashlib.sha256(data).hexdigest(), version, document, found, elements
    )
    for element in elements.values():
        for child in element.children:
            if is_frame_socket(child.tag) and child.text.strip():
                model.frame_of(element, child.tag)
    return model


def _version(path: Path, root: Element) -> int:
    words = root.attributes.get("Version", "").strip()
    if not (words.isascii() and words.isdigit()):
        raise FileFormatError(
            path, "It does not say which version it is of. Save it once in OpenSim 4.", root.line
        )
    version = int(words)
    if version < OLDEST_VERSION:
        raise FileFormatError(
            path,
            f"It is of version {version}, in which joints are kept inside bodies. Open it once "
            "in OpenSim 4 and save it.",
            root.line,
        )
    return version
