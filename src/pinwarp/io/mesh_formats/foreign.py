"""What is no mesh that can be read, told by what is in it or else by its name.

What people have is often not yet a surface. Then the name of the thing and the way from there to a
surface help more than what was expected in its third line.
"""

from __future__ import annotations

import re
import zlib
from contextlib import suppress
from dataclasses import dataclass

from pinwarp.io.text import narrow

_LOOKED_AT = 4096

_SEGMENT = "Segment the bone (3D Slicer: Segment Editor) and export its surface as STL or PLY"
_CAD = "Open it in FreeCAD or Gmsh and export a mesh as STL"
_BLENDER = "Open it in Blender and export the bone as PLY or OBJ"
_POINTS = "Make a surface of them (MeshLab: Screened Poisson) and save it as PLY"
_PARAVIEW = "Open it in ParaView, extract the surface and save it as PolyData (.vtp)"
_UNPACK = "Unpack it and choose the mesh inside"
_AGAIN = "Get the file itself and choose that"
_NUMBER = rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
# Three rows of three numbers; comments, and how many rows there are, may come first.
_POINT_ROWS = (
    rb"(?:\s*(?:#|//)[^\r\n]*[\r\n])*(?:[ \t]*\d+[ \t]*[\r\n]+)?"
    rb"(?:[ \t]*" + _NUMBER + rb"(?:[ \t,;]+" + _NUMBER + rb"){2,}[ \t]*[\r\n]+){3}"
)


@dataclass(frozen=True)
class _Foreign:
    """What is not read, and the pattern that the file begins with."""

    name: str
    way: str
    signature: bytes | None
    suffixes: tuple[str, ...] = ()


_FOREIGN = (
    _Foreign("a DICOM image", _SEGMENT, rb".{128}DICM", (".dcm", ".dicom", ".ima")),
    _Foreign(
        "a NIfTI volume",
        _SEGMENT,
        rb".{344}(?:n[+i][12]\0)|.{4}n[+i]2\0",
        (".nii", ".nii.gz", ".hdr", ".img"),
    ),
    _Foreign("an NRRD volume", _SEGMENT, rb"NRRD000\d", (".nrrd", ".nhdr", ".seg.nrrd")),
    _Foreign(
        "a MetaImage volume",
        _SEGMENT,
        rb"\s*(?:ObjectType\s*=|NDims\s*=|Comment\s*=)",
        (".mha", ".mhd"),
    ),
    _Foreign("a MINC volume", _SEGMENT, None, (".mnc",)),
    _Foreign("an MGH volume of FreeSurfer", _SEGMENT, None, (".mgh", ".mgz")),
    _Foreign(
        "a Mimics project",
        "Export the bone's part from Mimics or 3-matic as binary STL",
        None,
        (".mcs", ".mcsx", ".mpr", ".mxp", ".3matic"),
    ),
    _Foreign(
        "a 3D Slicer scene",
        "Open it in 3D Slicer and export the model or segment as PLY or VTP",
        rb"[^\0]*?<MRML\b",
        (".mrml", ".mrb"),
    ),
    _Foreign(
        "landmarks of 3D Slicer",
        "Import them as landmarks, and choose a mesh here",
        rb"# Markups fiducial file|\s*\{[^\0]*?\"markups\"",
        (".fcsv", ".mrk.json"),
    ),
    _Foreign("a session", "Open it instead", rb'"?# pinwarp-session'),
    _Foreign(
        "an Amira or Avizo file",
        "Open it in Amira or Avizo and save the surface as PLY or STL",
        rb"# (?:AmiraMesh|Avizo|HyperSurface|HyperMesh)",
        (".am", ".surf"),
    ),
    _Foreign("a FreeSurfer surface", "Convert it by mris_convert to VTK", rb"\xff\xff[\xfe\xff]"),
    _Foreign(
        "a GIfTI surface",
        "Convert it by mris_convert or wb_command to VTK",
        rb"[^\0]*?<GIFTI\b",
        (".gii",),
    ),
    _Foreign("a STEP model", _CAD, rb"\s*ISO-10303-21", (".step", ".stp")),
    _Foreign("an IGES model", _CAD, rb"[^\r\n]{72}S *1 *[\r\n]", (".iges", ".igs")),
    _Foreign("a BREP model", _CAD, rb"\s*(?:DBRep_DrawableShape|CASCADE Topology)", (".brep",)),
    _Foreign(
        "a Parasolid or CAD part",
        "Export a mesh as STL from the program it came from",
        None,
        (".x_t", ".x_b", ".sldprt", ".ipt", ".prt", ".catpart", ".f3d", ".3dm"),
    ),
    _Foreign("a drawing", _CAD, None, (".dwg", ".dxf")),
    _Foreign("an FBX scene", _BLENDER, rb"Kaydara FBX Binary|\s*; FBX \d", (".fbx",)),
    _Foreign("a Collada scene", _BLENDER, rb"[^\0]*?<COLLADA\b", (".dae",)),
    _Foreign("a Blender file", _BLENDER, rb"BLENDER[-_\d]", (".blend",)),
    _Foreign("a 3D Studio scene", _BLENDER, None, (".3ds", ".max")),
    _Foreign("a USD scene", _BLENDER, rb"#usda|PXR-USDC", (".usd", ".usda", ".usdc", ".usdz")),
    _Foreign("an Alembic scene", _BLENDER, rb"Ogawa", (".abc",)),
    _Foreign(
        "a VRML or X3D scene",
        "Open it in MeshLab or Blender and export the bone as PLY",
        rb"#(?:VRML|X3D)|[^\0]*?<X3D\b",
        (".wrl", ".vrml", ".x3d"),
    ),
    _Foreign(
        "an AMF file",
        "Open it in a slicer or MeshLab and save it as 3MF or STL",
        rb"[^\0]*?<amf\b",
        (".amf",),
    ),
    _Foreign(
        "a Gmsh mesh",
        "Export the surface from Gmsh as STL",
        rb"\s*\$MeshFormat",
        (".msh",),
    ),
    _Foreign(
        "a finite element model",
        "Export its outer surface as STL",
        rb"\s*\*(?:HEADING|NODE|KEYWORD)\b|\s*<febio_spec",
        (".inp", ".feb", ".k", ".cdb", ".bdf"),
    ),
    _Foreign(
        "a file of VTK that is no surface",
        _PARAVIEW,
        rb"[^\0]*?<VTKFile[^>]*\btype=",
        (".vti", ".vts", ".vtr", ".vtm", ".pvtp", ".pvtu", ".pvd"),
    ),
    _Foreign(
        "a point cloud",
        _POINTS,
        rb"\s*#? ?\.PCD|LASF|ASTM-E57",
        (".pcd", ".las", ".laz", ".e57", ".xyz", ".asc", ".pts", ".ptx"),
    ),
    _Foreign(
        "an image",
        "Choose a mesh",
        rb"\x89PNG|\xff\xd8\xff|GIF8|II\*\0|MM\0\*",
        (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp"),
    ),
    _Foreign(
        "a MATLAB or HDF5 file",
        "Write its vertices and faces as PLY or STL first",
        rb"MATLAB 5\.0 MAT-file|\x89HDF",
        (".mat", ".h5", ".hdf5"),
    ),
    _Foreign(
        "a pointer of Git LFS to a file that is elsewhere",
        "Fetch the file itself (git lfs pull) and choose that",
        rb"version https://git-lfs",
    ),
    _Foreign(
        "a web page",
        _AGAIN,
        rb"\s*(?:<!--.*?-->\s*)?<(?:!DOCTYPE html|html)\b",
        (".html", ".htm"),
    ),
    _Foreign("a PDF document", _AGAIN, rb"%PDF-", (".pdf",)),
    _Foreign("an archive", _UNPACK, rb"PK\x03\x04|Rar!|7z\xbc\xaf", (".zip", ".rar", ".7z")),
    _Foreign(
        "a packed file",
        _UNPACK,
        rb"\x1f\x8b|BZh|\xfd7zXZ",
        (".gz", ".bz2", ".xz", ".tgz", ".tar"),
    ),
    _Foreign(
        "a list of points without a surface",
        _POINTS,
        _POINT_ROWS,
    ),
)


def foreign_in(data: bytes) -> str | None:
    r"""Return in words what a file is that is not read, and the way to a surface.

    Parameters
    ----------
    data
        All bytes of the file.

    Examples
    --------
    >>> foreign_in(b"ISO-10303-21;\nHEADER;\n")
    'This is a STEP model: open it in FreeCAD or Gmsh and export a mesh as STL.'
    """
    heads = [narrow(data[:_LOOKED_AT])]
    if data.startswith(b"\x1f\x8b"):
        with suppress(zlib.error):
            heads.insert(0, zlib.decompressobj(31).decompress(data[:_LOOKED_AT], _LOOKED_AT))
    for head in heads:
        for known in _FOREIGN:
            # Compiled only here: most files are what they should be.
            if known.signature and re.match(known.signature, head, re.I | re.S):
                return _words(known)
    return None


def volume_in(data: bytes, name: str) -> str | None:
    """Return in words what a volume is and the way to a surface; None for all that is no volume.

    Parameters
    ----------
    data
        All bytes of the file, or its first few thousand.
    name
        What it is called, which tells where nothing in it does.

    Examples
    --------
    >>> volume_in(b"NRRD0004", "skull.any")[:24], volume_in(b"name,x,y,z", "skull.csv")
    ('This is an NRRD volume: ', None)
    """
    small = name.lower()
    for known in _FOREIGN:
        signed = known.signature and re.match(known.signature, data, re.I | re.S)
        named = bool(known.suffixes) and small.endswith(known.suffixes) and b"\0" in data
        if known.way == _SEGMENT and (signed or named):
            return _words(known)
    return None


def foreign_named(name: str) -> str | None:
    """Return in words what a file is by its name, and the way to a surface.

    Parameters
    ----------
    name
        The name of the file.

    Examples
    --------
    >>> foreign_named("Femur.blend")
    'This is a Blender file: open it in Blender and export the bone as PLY or OBJ.'
    """
    small = name.lower()
    known = next((x for x in _FOREIGN if x.suffixes and small.endswith(x.suffixes)), None)
    return _words(known) if known else None


def _words(known: _Foreign) -> str:
    # Names of programs keep their capital letters, and none begins the way.
    return f"This is {known.name}: {known.way[0].lower()}{known.way[1:]}."
