"""Files that are something else than was asked for: named, with the way to what is needed."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import FileFormatError

_TO_SURFACE = (
    "Segment it, for example in 3D Slicer, and export the segment as STL or PLY to get a surface; "
    "landmarks placed on it are saved there as .mrk.json."
)
_AS_TABLE = "Save the landmarks as CSV (name,x,y,z) instead."
_A_MESH = "Open it as the source or the destination mesh; landmarks are files of their own."
_HEAD = 4096


@dataclass(frozen=True)
class _Kind:
    """A kind of file: what it is called, the way out, and how it is known.

    By bytes at a place, and others anywhere near the beginning; or by its suffix, where it is no
    text.
    """

    name: str
    way_out: str
    magic: bytes = b""
    at: int = 0
    suffixes: tuple[str, ...] = ()
    also: bytes = b""


_PACKED = b"\x1f\x8b"
_KINDS = (
    _Kind("a DICOM image", _TO_SURFACE, b"DICM", 128, (".dcm",)),
    _Kind("a NIfTI volume", _TO_SURFACE, b"n+1\0", 344, (".nii", ".nii.gz")),
    _Kind("a NIfTI volume", _TO_SURFACE, b"ni1\0", 344, (".hdr",)),
    _Kind("an NRRD volume", _TO_SURFACE, b"NRRD", 0, (".nrrd", ".nhdr")),
    _Kind("a MetaImage volume", _TO_SURFACE, b"ObjectType = Image", 0, (".mha", ".mhd")),
    _Kind("a MINC or HDF5 file", _TO_SURFACE, b"\x89HDF\r\n", 0, (".mnc", ".h5", ".hdf5")),
    _Kind("a NetCDF or MINC file", _TO_SURFACE, b"CDF\x01"),
    _Kind("a TIFF image", _TO_SURFACE, b"II*\0", 0, (".tif", ".tiff")),
    _Kind("a TIFF image", _TO_SURFACE, b"MM\0*"),
    _Kind("a PNG image", _AS_TABLE, b"\x89PNG", 0, (".png",)),
    _Kind("a JPEG image", _AS_TABLE, b"\xff\xd8\xff", 0, (".jpg", ".jpeg")),
    _Kind("a PDF", _AS_TABLE, b"%PDF", 0, (".pdf",)),
    _Kind("a spreadsheet or another packed file", f"Unpack it, or: {_AS_TABLE}", b"PK\x03\x04"),
    _Kind("an old Office file", _AS_TABLE, b"\xd0\xcf\x11\xe0", 0, (".xls",)),
    _Kind("a MATLAB file", f"{_AS_TABLE} In MATLAB: writetable.", b"MATLAB 5.0", 0, (".mat",)),
    _Kind("a file of R", f"{_AS_TABLE} In R: write.csv.", b"RDX3\n", 0, (".rds", ".rdata", ".rda")),
    _Kind("a NumPy file", f"{_AS_TABLE} In Python: numpy.savetxt.", b"\x93NUMPY", 0, (".npy",)),
    _Kind(
        "a Viewbox file",
        "Export the points in Viewbox as text: a name and three numbers on each line.",
        b"Viewbox",
        0,
        (".vbx", ".vbd", ".vb3", ".vb4"),
    ),
    _Kind(
        "a Stratovan Checkpoint file",
        "Export the landmarks in Checkpoint as .pts, NTS, TPS or Morphologika.",
        b"Stratovan",
        0,
        (".ckpt",),
    ),
    _Kind("a scene of 3D Slicer", "Save the points on their own as .mrk.json.", b"<MRML"),
    _Kind("a PLY mesh", _A_MESH, b"ply\n"),
    _Kind("a PLY mesh", _A_MESH, b"ply\r"),
    _Kind("an STL mesh", _A_MESH, b"solid", 0, (".stl",), b"facet"),
    _Kind("an OFF mesh", _A_MESH, b"OFF\n"),
    _Kind("an OFF mesh", _A_MESH, b"OFF\r"),
    _Kind("a VTK file", _A_MESH, b"# vtk DataFile"),
    _Kind("a VTK file", _A_MESH, b"<VTKFile"),
    _Kind("a glTF mesh", _A_MESH, b"glTF"),
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
    'This is a NIfTI volume. '
    >>> stranger(Path("femur.csv"), b"name,x,y,z")
    ''
    """
    head = data[:_HEAD].lstrip(b"\xef\xbb\xbf \t\r\n")
    name = path.name.lower()
    is_packed = head.startswith(_PACKED)
    # What is in a file tells more than what it is called, but for what is packed.
    for kind in _KINDS:
        is_marked = data.startswith(kind.magic, kind.at) and kind.also in head
        if is_marked or (is_packed and name.endswith(kind.suffixes)):
            return f"This is {kind.name}. {kind.way_out}"
    if is_packed:
        return "This is a packed file. Unpack it first."
    if _HTML.match(head):
        return f"This is a web page, not the file that it leads to. {_AS_TABLE}"
    if _OBJ_VERTEX.search(head) and _OBJ_FACE.search(data):
        return f"This is an OBJ mesh. {_A_MESH}"
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
