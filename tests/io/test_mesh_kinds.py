"""What is in a file decides what it is; what is not read is named, with the way to a surface."""

from __future__ import annotations

import gzip
import shutil
from pathlib import Path

import pytest

from pinwarp.core.errors import FileFormatError
from pinwarp.core.mesh import Mesh
from pinwarp.core.words import with_article
from pinwarp.io.meshes import MESH_SUFFIXES, read_mesh, write_mesh

TETRAHEDRON = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2]])
NIFTI = b"\x5c\x01\0\0".ljust(344, b"\0") + b"n+1\0" + bytes(9)
IGES = f"{'femur':72}S      1\n{'1H,,1H;':72}G      1\n"
DAE = '<?xml version="1.0"?>\n<COLLADA xmlns="x"></COLLADA>'
FOREIGN = {
    "slice.dcm": (bytes(128) + b"DICM\2\0\0\0", "a DICOM image: segment the bone"),
    "IM-0001-0001": (bytes(128) + b"DICM\2\0\0\0", "a DICOM image"),
    "scan.nii": (NIFTI, "a NIfTI volume: segment the bone"),
    "scan.nii.gz": (gzip.compress(NIFTI), "a NIfTI volume"),
    "scan.nrrd": (b"NRRD0005\ntype: short\n", "an NRRD volume"),
    "scan.mha": (b"ObjectType = Image\nNDims = 3\n", "a MetaImage volume"),
    "leg.mcs": (b"\1\2\3\4", "a Mimics project: export the bone's part"),
    "implant.step": (b"ISO-10303-21;\nHEADER;\n", "a STEP model: open it in FreeCAD"),
    "implant.stl": (b"ISO-10303-21;\nHEADER;\n", "a STEP model"),
    "implant.igs": (IGES.encode(), "an IGES model"),
    "leg.fbx": (b"Kaydara FBX Binary  \0\x1a\0", "an FBX scene: open it in Blender"),
    "leg.dae": (DAE.encode(), "a Collada scene"),
    "leg.ply": (DAE.encode("utf-16"), "a Collada scene"),
    "leg.blend": (b"BLENDER-v402", "a Blender file"),
    "cloud.xyz": (b"0 0 0\n1 0.5 -2e3\n0 1 0\n0 1 1\n", "a list of points without a surface"),
    "cloud.obj": (b"3\r\n0,0,0\r\n1,0,0\r\n0,1,0\r\n", "a list of points without a surface"),
    "cloud.pcd": (b"# .PCD v0.7\nVERSION 0.7\n", "a point cloud"),
    "volume.vti": (b'<VTKFile type="ImageData"></VTKFile>', "a file of VTK that is no surface"),
    "points.fcsv": (b"# Markups fiducial file version = 4.11\n", "landmarks of 3D Slicer"),
    "points.stl": (b'{"@schema": "x", "markups": []}', "landmarks of 3D Slicer"),
    "lh.white": (b"\xff\xff\xfecreated by x", "a FreeSurfer surface"),
    "femur.stl": (b"version https://git-lfs.github.com/spec/v1\noid", "a pointer of Git LFS"),
    "femur.obj": (b"<!DOCTYPE html><html></html>", "a web page: get the file itself"),
    "femur.zip": (b"PK\3\4\x14\0\0\0\0\0femur.stl", "an archive: unpack it"),
    "femur.stl.gz": (gzip.compress(b"solid"), "a packed file: unpack it"),
    "leg.max": (b"\xd0\xcf\x11\xe0", "a 3D Studio scene"),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_what_is_not_read_is_named_with_the_way_to_a_surface(tmp_path: Path, name: str) -> None:
    content, words = FOREIGN[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(FileFormatError) as caught:
        read_mesh(tmp_path / name)
    assert str(caught.value).startswith(f"{name}: This is {words}")
    assert str(caught.value).endswith(".")


@pytest.mark.parametrize("suffix", [s for s in MESH_SUFFIXES if s != ".obj"])
def test_a_mesh_is_read_whatever_its_name_says(tmp_path: Path, suffix: str) -> None:
    write_mesh(tmp_path / f"a{suffix}", TETRAHEDRON)
    for name in ("b.obj", "b", "b.mesh"):
        shutil.copy(tmp_path / f"a{suffix}", tmp_path / name)
        found = read_mesh(tmp_path / name)
        assert len(found.mesh.faces) == 3
        assert found.notes == (
            f"It is {with_article(suffix[1:].upper())} file, whatever its name says.",
        )


def test_no_mesh_is_taken_for_something_else(tmp_path: Path) -> None:
    for suffix in MESH_SUFFIXES:
        write_mesh(tmp_path / f"a{suffix}", TETRAHEDRON)
        assert read_mesh(tmp_path / f"a{suffix}").notes == ()
