from __future__ import annotations

import base64
import hashlib
import itertools
import struct
import subprocess
import sys
import tracemalloc
from pathlib import Path
from random import Random

import numpy as np
import pytest
import pyvista as pv
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from pinwarp.core.errors import FileFormatError, PinwarpError
from pinwarp.core.mesh import Mesh
from pinwarp.core.normals import vertex_normals
from pinwarp.core.positions import LARGEST_COORDINATE
from pinwarp.io.mesh_formats.vertex_data import VertexData
from pinwarp.io.meshes import MESH_SUFFIXES, read_mesh, write_mesh

TETRAHEDRON = Mesh(
    [[0.1, 0, 0], [1 / 3, 0, 0], [0, 1e-7, 0], [0, 0, -12345.678901234]],
    [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
)
# What VTK writes as well, and what has room for double precision.
VTK_SUFFIXES = (".stl", ".ply", ".obj", ".vtp", ".vtk")
EXACT_SUFFIXES = (".ply", ".obj", ".vtp", ".vtk", ".vtu", ".off", ".3mf")
SQUARE_OBJ = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def write(folder: Path, name: str, content: bytes | str) -> Path:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def sphere() -> Mesh:
    ball = pv.Sphere(theta_resolution=6, phi_resolution=6)
    return Mesh(ball.points, ball.regular_faces)


def valid_files(folder: Path) -> list[Path]:
    """One file of every format and encoding, as pinwarp and as VTK write them."""
    ball = pv.Sphere(theta_resolution=6, phi_resolution=6)
    paths = []
    for suffix in MESH_SUFFIXES:
        paths.append(folder / f"ours{suffix}")
        write_mesh(paths[-1], sphere())
        for binary in (True, False) if suffix in VTK_SUFFIXES else ():
            paths.append(folder / f"vtk-{'binary' if binary else 'ascii'}{suffix}")
            # VTK's OBJ writer has one kind only.
            ball.save(paths[-1], **({} if suffix == ".obj" else {"binary": binary}))
    return paths


# Round trips


@pytest.mark.parametrize("suffix", EXACT_SUFFIXES)
def test_a_mesh_comes_back_exactly(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    write_mesh(path, TETRAHEDRON)
    found = read_mesh(path)
    np.testing.assert_array_equal(found.mesh.vertices, TETRAHEDRON.vertices)
    np.testing.assert_array_equal(found.mesh.faces, TETRAHEDRON.faces)
    assert found.notes == ()


@pytest.mark.parametrize("suffix", [".stl", ".glb", ".gltf"])
def test_stl_and_gltf_come_back_in_single_precision_with_shared_vertices(
    tmp_path: Path, suffix: str
) -> None:
    write_mesh(tmp_path / f"a{suffix}", TETRAHEDRON)
    mesh = read_mesh(tmp_path / f"a{suffix}").mesh
    assert len(mesh.vertices) == 4
    np.testing.assert_array_equal(
        mesh.vertices[mesh.faces],
        TETRAHEDRON.vertices.astype(np.float32)[TETRAHEDRON.faces],
    )


@given(
    vertices=hnp.arrays(
        np.float64,
        (4, 3),
        # Beyond that a mesh is refused: squares leave the range of numbers.
        elements=st.floats(
            -LARGEST_COORDINATE, LARGEST_COORDINATE, exclude_min=True, exclude_max=True
        ),
    )
)
@pytest.mark.parametrize("suffix", EXACT_SUFFIXES)
def test_any_finite_coordinate_comes_back_exactly(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, vertices: np.ndarray
) -> None:
    path = tmp_path_factory.mktemp("mesh") / f"a{suffix}"
    write_mesh(path, Mesh(vertices, TETRAHEDRON.faces))
    found = read_mesh(path).mesh.vertices
    assert found.tobytes() == vertices.tobytes()


@pytest.mark.parametrize("suffix", [*VTK_SUFFIXES, ".vtu", ".glb", ".gltf"])
def test_what_we_write_vtk_reads(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    write_mesh(path, sphere())
    theirs = pv.read(path)
    if suffix == ".vtu":
        theirs = theirs.extract_surface(algorithm=None)
    elif isinstance(theirs, pv.MultiBlock):
        theirs = theirs.combine().extract_surface(algorithm=None)
    ours = sphere()
    assert theirs.n_points == len(ours.vertices)
    np.testing.assert_allclose(
        theirs.points[theirs.regular_faces], ours.vertices[ours.faces], atol=1e-7
    )


def test_what_vtk_writes_we_read_as_vtk_does(tmp_path: Path) -> None:
    for path in valid_files(tmp_path):
        if path.suffix not in VTK_SUFFIXES:
            continue
        theirs = pv.read(path)
        ours = read_mesh(path).mesh
        np.testing.assert_allclose(ours.vertices, theirs.points, atol=1e-6, err_msg=path.name)
        np.testing.assert_array_equal(ours.faces, theirs.regular_faces, err_msg=path.name)


@pytest.mark.parametrize("compressor", ["zlib", "lzma", "none"])
@pytest.mark.parametrize("mode", ["ascii", "binary", "appended", "appended base64"])
@pytest.mark.parametrize("big", [False, True], ids=["little", "big"])
def test_every_encoding_of_vtp_is_read(
    tmp_path: Path, compressor: str, mode: str, big: bool
) -> None:
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    writer = vtkXMLPolyDataWriter()
    ball = pv.Sphere()
    writer.SetInputData(ball)
    writer.SetFileName(str(tmp_path / "a.vtp"))
    # Small blocks, so that every array has several.
    writer.SetBlockSize(1024)
    getattr(
        writer,
        {"ascii": "SetDataModeToAscii", "binary": "SetDataModeToBinary"}.get(
            mode, "SetDataModeToAppended"
        ),
    )()
    writer.SetEncodeAppendedData(mode == "appended base64")
    getattr(
        writer,
        f"SetCompressorTypeTo{ {'zlib': 'ZLib', 'lzma': 'LZMA', 'none': 'None'}[compressor] }",
    )()
    if big:
        writer.SetByteOrderToBigEndian()
    writer.Write()
    mesh = read_mesh(tmp_path / "a.vtp").mesh
    np.testing.assert_allclose(mesh.vertices, ball.points, atol=1e-6)
    np.testing.assert_array_equal(mesh.faces, ball.regular_faces)


@pytest.mark.parametrize("version", [42, 51])
@pytest.mark.parametrize("binary", [True, False])
def test_both_layouts_of_legacy_vtk_are_read(tmp_path: Path, version: int, binary: bool) -> None:
    from vtkmodules.vtkIOLegacy import vtkPolyDataWriter

    ball = pv.Sphere(theta_resolution=6, phi_resolution=6)
    ball["height"] = ball.points[:, 2]
    ball.field_data["time"] = np.array([1.5])
    writer = vtkPolyDataWriter()
    writer.SetInputData(ball)
    writer.SetFileVersion(version)
    writer.SetFileName(str(tmp_path / "a.vtk"))
    (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
    writer.Write()
    mesh = read_mesh(tmp_path / "a.vtk").mesh
    np.testing.assert_allclose(mesh.vertices, ball.points, atol=1e-6)
    np.testing.assert_array_equal(mesh.faces, ball.regular_faces)


# Details of the formats


TOO_LARGE = """
import resource, sys
from pathlib import Path
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.io.samples import assets_folder

mesh = read_mesh(assets_folder() / "femur_generic.ply").mesh
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
try:
    write_mesh(Path(sys.argv[1]), mesh)
except OSError as error:
    print(error.strerror)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows limits no file by a process")
@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
def test_where_there_is_no_room_for_a_mesh_only_the_writing_fails(tmp_path: Path, suffix: str):
    # In a process of its own: VTK's legacy writer, left to write by itself, ends it.
    path = tmp_path / f"bone{suffix}"
    path.write_text("what was there")
    done = subprocess.run(
        [sys.executable, "-c", TOO_LARGE, str(path)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "File too large\n", "")
    assert path.read_text() == "what was there"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("suffix", [".vtp", ".vtk"])
def test_triangle_strips_are_cut_and_keep_their_side(tmp_path: Path, suffix: str) -> None:
    strip = pv.Plane(i_resolution=4, j_resolution=3).triangulate().strip()
    assert strip.n_strips
    strip.save(tmp_path / f"a{suffix}")
    mesh = read_mesh(tmp_path / f"a{suffix}").mesh
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    normals = np.cross(b - a, c - a)
    assert len(normals) == 24
    assert (normals[:, 2] > 0).all()


def test_polygons_are_cut_also_where_they_are_not_convex(tmp_path: Path) -> None:
    arrow = "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nf 1 2 3 4\n"
    found = read_mesh(write(tmp_path, "a.obj", arrow))
    a, b, c = np.moveaxis(found.mesh.vertices[found.mesh.faces], 1, 0)
    areas = np.cross(b - a, c - a)[:, 2] / 2
    assert sorted(areas) == [0.5, 0.5]
    assert found.notes == ("1 polygon of more than 3 corners cut into triangles.",)


@pytest.mark.parametrize("order", ["little", "big", "ascii"])
def test_a_ply_file_of_triangles_and_quads_is_read(tmp_path: Path, order: str) -> None:
    kind = "ascii" if order == "ascii" else f"binary_{order}_endian"
    header = (
        f"ply\nformat {kind} 1.0\ncomment a\nelement vertex 5\nproperty float x\n"
        "property float y\nproperty uchar red\nproperty float z\nelement face 2\n"
        "property list uchar int vertex_index\nproperty uchar flag\nelement edge 1\n"
        "property int vertex1\nproperty int vertex2\nend_header\n"
    )
    points = [(0, 0, 9, 0), (1, 0, 9, 0), (1, 1, 9, 0), (0, 1, 9, 0), (2, 0.5, 9, 0)]
    if order == "ascii":
        body = "\n".join(" ".join(map(str, point)) for point in points).encode()
        body += b"\n4 0 1 2 3 7\n3 1 4 2 7\n0 1\n"
    else:
        end = "<" if order == "little" else ">"
        body = b"".join(struct.pack(f"{end}ffBf", *point) for point in points)
        body += struct.pack(f"{end}B4iBB3iBii", 4, 0, 1, 2, 3, 7, 3, 1, 4, 2, 7, 0, 1)
    found = read_mesh(write(tmp_path, "a.ply", header.encode() + body))
    assert len(found.mesh.vertices) == 5
    assert len(found.mesh.faces) == 3
    assert found.notes[0] == "1 row of 'edge' dropped."


def test_obj_vertices_are_not_split_by_normals_and_negative_numbers_count_back(
    tmp_path: Path,
) -> None:
    text = (
        "# a comment\r\nmtllib a.mtl\r\no bone\r\nv 0 0 0 1.0\r\nv 1 0 0 0.5 0.5 0.5\r\n"
        "v 0 1 0\r\nvn 0 0 1\r\nvn 1 0 0\r\nvt 0 0\r\ng part\r\ns off\r\nusemtl bone\r\n"
        "f 1/1/1 2/1/1 3/1/1\r\nv 0 0 1\r\nf -4//2 \\\r\n -3//2 -1//2\r\nl 1 2\r\n"
    )
    found = read_mesh(write(tmp_path, "a.obj", text))
    assert found.mesh.faces.tolist() == [[0, 1, 2], [0, 1, 3]]
    assert len(found.mesh.vertices) == 4
    assert found.notes == ("1 line or point dropped.",)


def test_an_ascii_stl_in_capitals_is_read(tmp_path: Path) -> None:
    loop = "OUTER LOOP\nVERTEX 0 0 {z}\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\n"
    facet = f"FACET NORMAL 0 0 1\n{loop}ENDFACET\n"
    text = "SOLID\n" + facet.format(z=0) + facet.format(z=1) + "ENDSOLID\n"
    mesh = read_mesh(write(tmp_path, "a.STL", text)).mesh
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


def test_a_binary_stl_whose_header_says_solid_is_read(tmp_path: Path) -> None:
    write_mesh(tmp_path / "a.stl", TETRAHEDRON)
    data = (tmp_path / "a.stl").read_bytes()
    path = write(tmp_path, "b.stl", b"solid bone".ljust(80) + data[80:])
    assert len(read_mesh(path).mesh.faces) == 4


def test_a_binary_stl_without_a_count_is_read_with_a_note(tmp_path: Path) -> None:
    write_mesh(tmp_path / "a.stl", TETRAHEDRON)
    data = (tmp_path / "a.stl").read_bytes()
    found = read_mesh(write(tmp_path, "b.stl", data[:80] + bytes(4) + data[84:]))
    assert len(found.mesh.faces) == 4
    assert "announces no triangles" in found.notes[0]


def test_bytes_after_the_last_triangle_are_ignored_with_a_note(tmp_path: Path) -> None:
    write_mesh(tmp_path / "a.stl", TETRAHEDRON)
    found = read_mesh(write(tmp_path, "b.stl", (tmp_path / "a.stl").read_bytes() + b"\0" * 7))
    assert len(found.mesh.faces) == 4
    assert found.notes == ("7 bytes after the last triangle ignored.",)


def test_what_is_dropped_is_said(tmp_path: Path) -> None:
    text = SQUARE_OBJ + "v 9 9 9\nf 1 2 3\nf 1 3 4\nf 1 1 2\nl 1 2\np 5\n"
    found = read_mesh(write(tmp_path, "a.obj", text))
    assert found.notes == (
        "2 lines or points dropped.",
        "1 triangle with two corners at one vertex dropped.",
        "1 loose point dropped.",
    )
    assert len(found.mesh.vertices) == 4


def test_a_loose_point_that_is_not_finite_does_no_harm(tmp_path: Path) -> None:
    found = read_mesh(write(tmp_path, "a.obj", "v nan 0 0\n" + SQUARE_OBJ + "f 2 3 4\n"))
    assert found.mesh.faces.tolist() == [[0, 1, 2]]


def test_path_and_hash_are_those_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_mesh(tmp_path / "a b=c.obj", TETRAHEDRON)
    monkeypatch.chdir(tmp_path)
    found = read_mesh("a b=c.obj")
    assert found.path == tmp_path / "a b=c.obj"
    assert found.sha256 == hashlib.sha256((tmp_path / "a b=c.obj").read_bytes()).hexdigest()


# Progress


def test_progress_grows_from_nought_to_one(tmp_path: Path) -> None:
    for path in valid_files(tmp_path):
        told: list[tuple[float, str]] = []
        read_mesh(path, progress=lambda share, words, told=told: told.append((share, words)))
        shares = [share for share, _ in told]
        assert shares == sorted(shares), path.name
        assert 0 <= shares[0] <= shares[-1] == 1.0
        assert all(words for _, words in told)


class CancelledError(OSError):
    """An OSError on purpose: it must not be taken for a file that cannot be read."""


@pytest.mark.parametrize("after", [0.0, 0.3, 0.8, 1.0])
def test_what_progress_raises_comes_out(tmp_path: Path, after: float) -> None:
    def cancel(share: float, _words: str) -> None:
        if share >= after:
            raise CancelledError

    for path in valid_files(tmp_path):
        with pytest.raises(CancelledError):
            read_mesh(path, progress=cancel)


# Damage


def third(path: Path) -> bytes:
    data = path.read_bytes()
    return data[: len(data) // 3]


def test_a_file_that_was_cut_off_is_refused_with_its_name(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    for path in valid_files(tmp_path):
        if path.suffix != ".obj":
            broken = write(tmp_path, f"part-{path.name}", third(path))
            with pytest.raises(FileFormatError, match=r"cut off|damaged") as caught:
                read_mesh(broken)
            assert f"part-{path.name}" in str(caught.value)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("empty.stl", b"", "empty"),
        ("noise.stl", bytes(range(256)) * 9, "cut off"),
        ("noise.ply", bytes(range(256)) * 9, "not a PLY file"),
        ("noise.obj", bytes(range(256)) * 9, "not an OBJ file"),
        ("noise.vtp", bytes(range(256)) * 9, "not a VTP or VTU file"),
        ("noise.vtk", bytes(range(256)) * 9, "not a VTK file"),
        ("short.stl", b"\1" * 83, "too short"),
        ("huge.stl", b" " * 80 + b"\xff\xff\xff\xff" + bytes(50), "4,294,967,295 triangles"),
        (
            "signalling-nan.stl",
            bytes(80) + b"\1\0\0\0" + bytes(12) + b"\1\0\x80\x7f" + bytes(34),
            "Facet 1 .*not a finite number",
        ),
        ("none.stl", b"solid bone\nendsolid bone\n", "no triangles"),
        ("bad.stl", b"solid\nfacet\nvertex 0 0 z\nendfacet\nendsolid\n", "line 3: .*three numbers"),
        (
            "huge.ply",
            b"ply\nformat binary_little_endian 1.0\nelement vertex 999999999999\n"
            b"property float x\nproperty float y\nproperty float z\nend_header\n\0\0\0\0",
            "999,999,999,999 rows",
        ),
        (
            "cloud.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
            b"property float z\nend_header\n0 0 0\n",
            "only points",
        ),
        (
            "list.ply",
            b"ply\nformat binary_little_endian 1.0\nelement face 1\n"
            b"property list uint int vertex_indices\nend_header\n\xff\xff\xff\xff\0\0\0\0",
            "too short",
        ),
        ("kind.ply", b"ply\nformat ascii 1.0\nelement vertex many\nend_header\n", "line 3"),
        ("nothing.obj", b"# nothing here\n", "no triangles"),
        ("cloud.obj", SQUARE_OBJ.encode(), "no triangles"),
        ("far.obj", SQUARE_OBJ.encode() + b"f 1 2 9\n", "vertex 9, but there are only 4"),
        ("zero.obj", SQUARE_OBJ.encode() + b"f 0 1 2\n", "line 5: .*counted from 1"),
        ("back.obj", SQUARE_OBJ.encode() + b"f -1 -2 -5\n", "only 4"),
        ("two.obj", SQUARE_OBJ.encode() + b"f 1 2\n", "no triangles"),
        ("word.obj", SQUARE_OBJ.encode() + b"v 1 2 x\n", "line 5: A vertex needs three"),
        ("huge.obj", SQUARE_OBJ.encode() + b"f 1 2 99999999999999999999\n", "line 5"),
        ("nan.obj", b"v nan 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\n", "Vertex 1 .*not a finite number"),
        (
            "volume.vtk",
            b"# vtk DataFile Version 3.0\na\nASCII\nDATASET STRUCTURED_POINTS\nPOINTS 0 float\n",
            "an image volume and not a surface",
        ),
        (
            "short.vtk",
            b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n"
            b"0 0 0 1 1 1 0 1\nPOLYGONS 1 4\n3 0 1 2\n",
            "cut off",
        ),
        (
            "cloud.vtk",
            b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\n",
            "no triangles",
        ),
        (
            "huge.vtk",
            b"# vtk DataFile Version 3.0\nx\nBINARY\nDATASET POLYDATA\nPOINTS 99999999999 float\n",
            "cut off",
        ),
        (
            "volume.vtp",
            b'<VTKFile type="ImageData"><ImageData/></VTKFile>',
            "a file of VTK that is no surface: open it in ParaView",
        ),
        ("nothing.vtp", b'<VTKFile type="PolyData"><PolyData/></VTKFile>', "no surface"),
        (
            "huge.vtp",
            b'<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="99999999999">'
            b'<Points><DataArray type="Float32" format="ascii">0 0 0</DataArray></Points>'
            b"</Piece></PolyData></VTKFile>",
            "damaged",
        ),
        ("web.vtp", b"<html><body>404</body></html>", "a web page: get the file itself"),
        ("bone.qqq", b"anything", r"'\.qqq' are not supported.*\.stl, \.ply, \.obj"),
        ("short.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n", "line 4, but 1 more rows"),
        ("high.off", b"4OFF\n3 1 0\n", "four and more dimensions"),
        ("short.glb", b"glTF\2\0\0\0", "damaged"),
        ("old.glb", b"glTF\1\0\0\0" + bytes(30), "version 1 of glTF"),
        ("noise.gltf", b"{]", "not a glTF file"),
        ("nothing.gltf", b'{"asset": {"version": "2.0"}}', "no triangles"),
        ("noise.3mf", bytes(range(256)) * 9, "damaged"),
        ("bone", b"anything", "without a suffix"),
    ],
)
def test_a_damaged_file_is_refused_with_the_reason(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], name: str, content: bytes, reason: str
) -> None:
    path = write(tmp_path, name, content)
    with pytest.raises(FileFormatError, match=reason) as caught:
        read_mesh(path)
    assert str(caught.value).startswith(name)
    assert str(caught.value).endswith(".")
    assert capfd.readouterr() == ("", "")


BILLION = 1_000_000_000
ZLIB = ' compressor="vtkZLibDataCompressor"'


def ply(kind: str, vertices: int, faces: int, count: str = "uchar") -> str:
    return (
        f"ply\nformat {kind} 1.0\nelement vertex {vertices}\nproperty double x\n"
        f"property double y\nproperty double z\nelement face {faces}\n"
        f"property list {count} int vertex_indices\nend_header\n"
    )


def vtk(kind: str, rest: str, version: str = "3.0") -> str:
    return f"# vtk DataFile Version {version}\na\n{kind}\nDATASET POLYDATA\n{rest}\n"


def vtp(data: str, kind: str = "binary", more: str = "") -> str:
    return (
        f'<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt64"{more}>'
        f'<PolyData><Piece NumberOfPoints="{BILLION}" NumberOfPolys="{BILLION}"><Points>'
        f'<DataArray type="Float64" format="{kind}">{data}</DataArray></Points></Piece></PolyData>'
        "</VTKFile>"
    )


def blocks(*numbers: int) -> str:
    """A header of compressed blocks, and two bytes of data."""
    return base64.b64encode(struct.pack(f"<{len(numbers)}Q", *numbers) + b"xx").decode()


LITTLE, BIG = "binary_little_endian", "binary_big_endian"
POINTS = f"POINTS {BILLION} double\n0 0 0"
POLYGONS = f"POINTS 0 double\n\nPOLYGONS {BILLION} {4 * BILLION}\n"
OFFSETS = POLYGONS + "OFFSETS vtktypeint64\n0 3"
FIELD = f"FIELD FieldData 1\na {BILLION} {BILLION} double\n0 0"
LAUGHS = "".join(
    f'<!ENTITY {after} "{f"&{before};" * 10}">'
    for before, after in itertools.pairwise("abcdefghij")
)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("count.stl", b" " * 80 + struct.pack("<I", BILLION) + bytes(900)),
        *((f"{kind}-vertices.ply", ply(kind, BILLION, 1)) for kind in ("ascii", LITTLE, BIG)),
        *((f"{kind}-faces.ply", ply(kind, 0, BILLION)) for kind in ("ascii", LITTLE, BIG)),
        (
            "corners.ply",
            ply(LITTLE, 0, 1, "uint").encode() + struct.pack("<I", BILLION) + bytes(500),
        ),
        ("ascii-corners.ply", ply("ascii", 0, 1, "uint") + f"{BILLION} 0 1 2\n"),
        ("index.obj", SQUARE_OBJ + f"f 1 2 {BILLION}\n"),
        ("negative.obj", SQUARE_OBJ + f"f 1 2 -{BILLION}\n"),
        *((f"{kind}-points.vtk", vtk(kind, POINTS)) for kind in ("ASCII", "BINARY")),
        *((f"{kind}-polygons.vtk", vtk(kind, POLYGONS + "3 0")) for kind in ("ASCII", "BINARY")),
        *((f"{kind}-offsets.vtk", vtk(kind, OFFSETS, "5.1")) for kind in ("ASCII", "BINARY")),
        *((f"{kind}-field.vtk", vtk(kind, FIELD)) for kind in ("ASCII", "BINARY")),
        ("ascii.vtp", vtp("0 0 0", "ascii")),
        ("length.vtp", vtp(blocks(8 * BILLION))),
        ("blocks.vtp", vtp(blocks(BILLION, 8, 8, 8), more=ZLIB)),
        ("block.vtp", vtp(blocks(1, 24 * BILLION, 0, 2), more=ZLIB)),
        ("laughs.vtp", f'<!DOCTYPE a [<!ENTITY a "0 ">{LAUGHS}]>' + vtp("&j;", "ascii")),
    ],
    ids=lambda value: value if isinstance(value, str) and len(value) < 40 else "",
)
def test_a_small_file_that_announces_billions_is_refused_at_once(
    tmp_path: Path, name: str, content: bytes | str
) -> None:
    path = write(tmp_path, name, content)
    assert path.stat().st_size < 1500
    tracemalloc.start()
    try:
        with pytest.raises(FileFormatError) as caught:
            read_mesh(path)
        assert tracemalloc.get_traced_memory()[1] < 10 << 20
    finally:
        tracemalloc.stop()
    assert str(caught.value).startswith(name)


@pytest.mark.parametrize("number", [np.nan, np.inf])
@pytest.mark.parametrize("suffix", VTK_SUFFIXES)
def test_coordinates_that_are_not_finite_are_refused(
    tmp_path: Path, suffix: str, number: float
) -> None:
    ball = pv.Sphere(theta_resolution=6, phi_resolution=6)
    ball.points[3, 1] = number
    ball.save(tmp_path / f"a{suffix}")
    with pytest.raises(FileFormatError, match="not a finite number"):
        read_mesh(tmp_path / f"a{suffix}")


def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="no such file"):
        read_mesh(tmp_path / "bone.stl")
    (tmp_path / "folder.stl").mkdir()
    for folder in (tmp_path, tmp_path / "folder.stl"):
        with pytest.raises(FileFormatError, match="is a folder"):
            read_mesh(folder)


def test_a_mesh_too_large_for_stl_is_refused_and_the_old_file_stays(tmp_path: Path) -> None:
    path = write(tmp_path, "a.stl", "old")
    with pytest.raises(FileFormatError, match="single precision"):
        write_mesh(path, Mesh(TETRAHEDRON.vertices * 1e100, TETRAHEDRON.faces))
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_writing_an_unknown_type_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="not supported"):
        write_mesh(tmp_path / "a.fbx", TETRAHEDRON)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
def test_writing_into_a_missing_folder_is_an_os_error(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], suffix: str
) -> None:
    with pytest.raises(OSError, match="No such file"):
        write_mesh(tmp_path / "no" / f"a{suffix}", TETRAHEDRON)
    assert capfd.readouterr() == ("", "")


@pytest.fixture(scope="module")
def originals(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return valid_files(tmp_path_factory.mktemp("valid"))


JUNK = (
    b"",
    b"-1",
    b"999999999",
    b"nan",
    b"1e999",
    b" ",
    b"\n",
    b"\0",
    b"\xff\xff\xff\xff",
    b'"',
    b"<",
)


@settings(max_examples=400)
@given(number=st.integers(0, 19), random=st.randoms(use_true_random=False))
def test_any_change_to_a_file_gives_a_mesh_or_a_pinwarp_error(
    originals: list[Path], number: int, random: Random
) -> None:
    original = originals[number]
    assert len(originals) == 20
    content = bytearray(original.read_bytes())
    for _ in range(random.randint(1, 3)):
        # Headers are where it hurts most.
        place = random.randrange(random.choice([300, max(1, len(content))]))
        removed = random.choice([0, 1, 7, 0, 1, 7, len(content)])
        content[place : place + removed] = random.choice(JUNK)
    path = write(original.parent, f"changed{original.suffix}", bytes(content))
    try:
        mesh = read_mesh(path).mesh
    except PinwarpError:
        return
    assert np.isfinite(mesh.vertices).all()


def test_polygons_without_sense_are_cut_without_a_word_in_the_terminal(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    random = np.random.default_rng(1)
    points = random.integers(0, 3, (30, 3))
    faces = [random.integers(1, 31, random.integers(3, 12)) for _ in range(300)]
    lines = [f"v {x} {y} {z}" for x, y, z in points]
    lines += ["f " + " ".join(map(str, face)) for face in faces]
    assert len(read_mesh(write(tmp_path, "a.obj", "\n".join(lines))).mesh.faces) > 300
    assert capfd.readouterr() == ("", "")


# Real bones


def test_the_femurs_have_the_vertices_their_sessions_name(shared_data: Path) -> None:
    folder = shared_data / "opensim-creator-femur"
    generic = read_mesh(folder / "femur_r.obj")
    subject = read_mesh(folder / "subject_femur_r.obj")
    assert len(generic.mesh.vertices) == 456
    assert len(subject.mesh.vertices) == 89_666
    assert generic.notes == subject.notes == ()


def test_the_pelves_read_as_vtk_reads_them(shared_data: Path) -> None:
    for name in ("template_pelvis_r.stl", "target_pelvis_r.stl"):
        path = shared_data / "msk-morph-pelvis" / name
        theirs = pv.read(path)
        ours = read_mesh(path).mesh
        np.testing.assert_array_equal(ours.vertices, theirs.points)
        np.testing.assert_array_equal(ours.faces, theirs.regular_faces)


# What goes with the vertices


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".vtp", ".vtk", ".vtu"])
def test_normals_are_written_for_other_programs_and_the_mesh_reads_back_the_same(tmp_path, suffix):
    mesh, path = sphere(), tmp_path / f"a{suffix}"
    normals = vertex_normals(mesh)
    write_mesh(path, mesh, VertexData(normals))
    assert np.array_equal(read_mesh(path).mesh.vertices, mesh.vertices)
    assert np.array_equal(read_mesh(path).mesh.faces, mesh.faces)
    seen = pv.read(path)
    assert np.allclose(seen.point_data.active_normals, normals, atol=1e-6)


@pytest.mark.parametrize("suffix", [".ply", ".vtp", ".vtk", ".vtu"])
def test_scalars_are_written_under_their_names(tmp_path, suffix):
    mesh, path = sphere(), tmp_path / f"a{suffix}"
    heights = mesh.vertices[:, 2]
    write_mesh(path, mesh, VertexData(vertex_normals(mesh), {"height_mm": heights}))
    assert np.array_equal(read_mesh(path).mesh.vertices, mesh.vertices)
    if suffix == ".ply":
        # VTK's PLY reader knows no scalars of one's own.
        data = path.read_bytes()
        start = data.index(b"end_header\n") + len(b"end_header\n")
        fields = [("places", "<f8", 3), ("normals", "<f4", 3), ("height_mm", "<f4")]
        found = np.frombuffer(data, fields, len(heights), start)["height_mm"]
    else:
        found = pv.read(path).point_data["height_mm"]
    assert np.allclose(found, heights, atol=1e-6)


def test_stl_leaves_out_what_it_has_no_room_for(tmp_path):
    mesh, path = sphere(), tmp_path / "a.stl"
    write_mesh(path, mesh, VertexData(vertex_normals(mesh), {"height": mesh.vertices[:, 2]}))
    assert path.stat().st_size == 84 + 50 * len(mesh.faces)


@pytest.mark.parametrize("name", ["", "a b", "1st", "x\nend_header"])
def test_scalars_need_a_name_that_every_format_takes(name):
    with pytest.raises(ValueError, match="cannot be the name"):
        VertexData(scalars={name: np.zeros(3)})
