"""Files that are something else than was asked for: named, with the way to what is needed."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.io.mesh_formats.foreign import volume_in
from pinwarp.io.mesh_formats.kinds import kind_in

_AS_TABLE = "Save the landmarks as CSV (name,x,y,z) instead."
_A_MESH = "Open it as the source or the destination mesh; landmarks are files of their own."
_HEAD = 4096


@dataclass(frozen=True)
class _Kind:
    """A kind of file: what it is called, the way out, and how it is known.

    By its first bytes, or by its suffix, where it is no text.
    """

    name: str
    way_out: str
    magic: bytes = b""
    suffixes: tuple[str, ...] = ()


_PACKED = b"\x1f\x8b"
_KINDS = (
    _Kind("a TIFF image", _AS_TABLE, b"II*\0", (".tif", ".tiff")),
    _Kind("a TIFF image", _AS_TABLE, b"MM\0*"),
    _Kind("a PNG image", _AS_TABLE, b"\x89PNG", (".png",)),
    _Kind("a JPEG image", _AS_TABLE, b"\xff\xd8\xff", (".jpg", ".jpeg")),
    _Kind("a PDF", _AS_TABLE, b"%PDF", (".pdf",)),
    _Kind("a spreadsheet or another packed file", f"Unpack it, or: {_AS_TABLE}", b"PK\x03\x04"),
    _Kind("an old Office file", _AS_TABLE, b"\xd0\xcf\x11\xe0", (".xls",)),
    _Kind("a MATLAB file", f"{_AS_TABLE} In MATLAB: writetable.", b"MATLAB 5.0", (".mat",)),
    _Kind("a file of R", f"{_AS_TABLE} In R: write.csv.", b"RDX3\n", (".rds", ".rdata", ".rda")),
    _Kind("a NumPy file", f"{_AS_TABLE} In Python: numpy.savetxt.", b"\x93NUMPY", (".npy",)),
    _Kind("an HDF5 file", _AS_TABLE, b"\x89HDF\r\n", (".h5", ".hdf5")),
    _Kind(
        "a Viewbox file",
        "Export the points in Viewbox as text: a name and three numbers on each line.",
        b"Viewbox",
        (".vbx", ".vbd", ".vb3", ".vb4"),
    ),
    _Kind(
        "a Stratovan Checkpoint file",
        "Export the landmarks in Checkpoint as .pts, NTS, TPS or Morphologika.",
        b"Stratovan",
        (".ckpt",),
    ),
    _Kind(
        "a recording of markers over time (TRC)",
        f"Take one moment of it. {_AS_TABLE}",
        b"PathFileType",
    ),
    _Kind("a scene of 3D Slicer", "Save the points on their own as .mrk.json.", b"<MRML"),
)
_OBJ_VERTEX = re.compile(rb"^v[ \t]+[-+.\d]", re.MULTILINE)
_OBJ_FACE = re.compile(rb"^f[ \t]+\d", re.MULTILINE)
_HTML = re.compile(rb"<(!doctype\s+html|html)", re.IGNORECASE)


def stranger(path: Path, data: bytes) -> str:
    r"""Return what a file is and the way out, as sentences, where it is known to be no landmarks.

    Parameters
    ----------
    path
        The file: its suffix tells where no mark in its content does.
    data
        Its content.

    Returns
    -------
    str
        Empty where nothing is known about it.

    Examples
    --------
    >>> stranger(Path("brain.any"), b"\0" * 344 + b"n+1\0")[:24]
    'This is a NIfTI volume: '
    >>> stranger(Path("femur.csv"), b"name,x,y,z")
    ''
    """
    if volume := volume_in(data[:_HEAD], path.name):
        return f"{volume} Landmarks placed on it in 3D Slicer are saved as .mrk.json."
    head = data[:_HEAD].lstrip(b"\xef\xbb\xbf \t\r\n")
    name = path.name.lower()
    is_packed = head.startswith(_PACKED)
    # What is in a file tells more than what it is called, but for what is packed.
    for kind in _KINDS:
        is_marked = data.startswith(kind.magic)
        if is_marked or (is_packed and name.endswith(kind.suffixes)):
            return f"This is {kind.name}. {kind.way_out}"
    if is_packed:
        return "This is a packed file. Unpack it first."
    if _HTML.match(head):
        return f"This is a web page, not the file that it leads to. {_AS_TABLE}"
    is_obj = _OBJ_VERTEX.search(head) and _OBJ_FACE.search(data)
    if mesh := ".obj" if is_obj else kind_in(data, path.suffix.lower()):
        return f"This is a mesh ({mesh}). {_A_MESH}"
    for kind in _KINDS:
        if name.endswith(kind.suffixes) and b"\0" in data:
            return f"This is {kind.name}. {kind.way_out}"
    return ""


def refuse_stranger(path: str | Path, data: bytes) -> None:
    """Raise where a file is known to be something else than landmarks.

    Raises
    ------
    FileFormatError
        With what it is, and the way out.

    Examples
    --------
    >>> refuse_stranger("femur.csv", b"name,x,y,z")
    """
    if words := stranger(Path(path), data):
        raise FileFormatError(path, words)
