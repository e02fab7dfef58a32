"""Meshes as other programs write them are read right, with a word for what is left out."""

from __future__ import annotations

import codecs
import struct
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from hypothesis import given
from hypothesis import strategies as st
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridWriter

from pinwarp.core.errors import FileFormatError
from pinwarp.io.mesh_formats.polydata import cut_polygons
from pinwarp.io.mesh_formats.surface import BrokenMeshError
from pinwarp.io.mesh_formats.vtk_cells import faces_of_cells
from pinwarp.io.meshes import MeshFile, read_mesh

TETRAHEDRON = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]
PLACES = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


def read(folder: Path, name: str, content: bytes | str) -> MeshFile:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_mesh(path)


def refusal(folder: Path, name: str, content: bytes | str) -> str:
    with pytest.raises(FileFormatError) as caught:
        read(folder, name, content)
    return str(caught.value)


def rows(table: list[list[int]], before: str = "") -> str:
    return "".join(f"{before}{' '.join(map(str, row))}\n" for row in table)


def is_tetrahedron(found: MeshFile) -> bool:
    corners = found.mesh.vertices[found.mesh.faces]
    return np.array_equal(corners, np.array(PLACES)[TETRAHEDRON])


def facet(corners: list[int]) -> str:
    loop = rows([PLACES[corner] for corner in corners], "vertex ")
    return f"facet normal 0 0 1\nouter loop\n{loop}endloop\nendfacet\n"


FACETS = "".join(map(facet, TETRAHEDRON))
PLY_HEADER = (
    "ply\nformat ascii 1.0\ncomment a bone\nelement vertex 4\nproperty float x\n"
    "property float y\nproperty float z\nelement face 4\n"
    "property list uchar int vertex_indices\nend_header\n"
)
WHOLE = {
    ".stl": f"solid bone\n{FACETS}endsolid bone\n",
    ".ply": PLY_HEADER + rows(PLACES) + rows(TETRAHEDRON, "3 "),
    ".obj": rows(PLACES, "v ") + rows([[c + 1 for c in face] for face in TETRAHEDRON], "f "),
    ".vtk": "# vtk DataFile Version 3.0\nbone\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
    f"{rows(PLACES)}POLYGONS 4 16\n{rows(TETRAHEDRON, '3 ')}",
    ".vtp": '\n<?xml version="1.0"?>\n<VTKFile type="PolyData">\n<PolyData>\n'
    '<Piece NumberOfPoints="4" NumberOfPolys="4">\n<Points>\n<DataArray type="Float32" '
    f'NumberOfComponents="3" format="ascii">\n{rows(PLACES)}</DataArray>\n</Points>\n<Polys>\n'
    f'<DataArray type="Int32" Name="connectivity" format="ascii">\n{rows(TETRAHEDRON)}'
    '</DataArray>\n<DataArray type="Int32" Name="offsets" format="ascii">3 6 9 12</DataArray>\n'
    "</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n",
}


# Text of any kind


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"], ids=["LF", "CRLF", "CR"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-be"])
@pytest.mark.parametrize("suffix", WHOLE)
def test_marks_wide_characters_and_line_ends_do_no_harm(tmp_path, suffix, encoding, line_end):
    content = WHOLE[suffix].replace("\n", line_end).encode(encoding)
    if encoding == "utf-16-be":
        content = codecs.BOM_UTF16_BE + content
    found = read(tmp_path, f"a{suffix}", content)
    assert is_tetrahedron(found)
    assert found.notes == ()


@pytest.mark.parametrize("suffix", WHOLE)
def test_blank_lines_in_front_do_no_harm(tmp_path, suffix):
    assert is_tetrahedron(read(tmp_path, f"a{suffix}", f"\n  \r\n{WHOLE[suffix]}"))


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".obj", ".vtk"])
def test_keywords_may_be_in_capitals(tmp_path, suffix):
    assert is_tetrahedron(read(tmp_path, f"a{suffix}", WHOLE[suffix].upper()))


def test_the_line_that_is_told_is_that_of_the_file_whatever_its_line_ends(tmp_path):
    words = refusal(tmp_path, "a.obj", b"\xef\xbb\xbfv 0 0 0\rv 1 x 0\r")
    assert words.startswith("a.obj, line 2: ")


# ASCII STL


@pytest.mark.parametrize(
    "text",
    [
        WHOLE[".stl"].replace("endfacet", "end facet").replace("endloop", "end loop"),
        WHOLE[".stl"].replace("endsolid", "end solid"),
        f"# a comment with a vertex 1 2 3\n// and another\n{WHOLE['.stl']}",
        f"solid vertex of a bone\n{FACETS}endsolid vertex of a bone\n",
        f"solid facet vertex 7 {FACETS}endsolid vertex 7",
        WHOLE[".stl"].replace("\n", " "),
        WHOLE[".stl"].replace("vertex 0 0 0", "vertex 0.0D+00 0.0d-1 0"),
        f"solid a\n{''.join(map(facet, TETRAHEDRON[:2]))}endsolid a\n"
        f"solid b\n{''.join(map(facet, TETRAHEDRON[2:]))}endsolid b\n",
        f"{WHOLE['.stl']}\n# written by hand\n",
        WHOLE[".stl"] + 20 * "\0",
    ],
    ids=[
        "end facet",
        "end solid",
        "comments",
        "a name with vertex",
        "a name with vertex in one line",
        "one line",
        "exponents of Fortran",
        "two solids",
        "a comment last",
        "zeros last",
    ],
)
def test_ascii_stl_of_any_program_is_read(tmp_path, text):
    found = read(tmp_path, "a.stl", text)
    assert is_tetrahedron(found)
    assert found.notes == ()


def test_an_ascii_stl_without_an_end_is_read_with_a_note_where_its_facets_are_whole(tmp_path):
    found = read(tmp_path, "a.stl", f"solid bone\n{FACETS}\n")
    assert is_tetrahedron(found)
    assert found.notes == (
        "The file ends without 'endsolid': look whether a part of the bone is missing.",
    )
    assert "cut off" in refusal(tmp_path, "b.stl", f"solid bone\n{FACETS}facet normal 0")


# PLY


def test_a_row_of_a_ply_file_is_a_line(tmp_path):
    # Rows that hold one list more than is announced, as VCGLIB wrote them.
    header = PLY_HEADER.replace("end_header", "property list uchar float texcoord\nend_header")
    wedges = "6 0.1 0.2 0.3 0.4 0.5 0.6 9 255 0 0 255 0 0 255 0 0"
    body = "".join(f"3 {a} {b} {c} {wedges}\n" for a, b, c in TETRAHEDRON)
    found = read(tmp_path, "a.ply", header + rows(PLACES) + body)
    assert is_tetrahedron(found)
    assert found.notes == (
        "4 rows of 'face' longer than the header says, the rest of each ignored.",
    )


def test_what_is_left_below_the_rows_of_a_ply_file_is_told(tmp_path):
    found = read(tmp_path, "a.ply", f"{WHOLE['.ply']}\n3 0 1 2\n")
    assert found.notes == ("1 line below the last row ignored.",)
    binary = PLY_HEADER.replace("ascii", "binary_little_endian").encode()
    binary += struct.pack("<12f", *np.ravel(PLACES))
    binary += b"".join(struct.pack("<B3i", 3, *face) for face in TETRAHEDRON)
    assert is_tetrahedron(read(tmp_path, "b.ply", binary))
    assert read(tmp_path, "c.ply", binary + b"\0\0").notes == (
        "2 bytes behind the last row ignored.",
    )


@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ("0.629 0 1 2", "'0.629' is not a whole number"),
        ("3 0 1.5 2", "'1.5' is not a whole number"),
        ("-3 0 1 2", "cannot have -3 numbers"),
        ("3 0 1", "ends before all"),
        ("3 0 1 two", "'two' is not a whole number"),
        ("3 0 1 99999999999999999999", "not a whole number"),
    ],
)
def test_a_ply_row_that_cannot_be_is_refused_with_its_line(tmp_path, row, reason):
    text = PLY_HEADER + rows(PLACES) + f"{row}\n" + rows(TETRAHEDRON[1:], "3 ")
    words = refusal(tmp_path, "a.ply", text)
    assert reason in words
    assert "line 15" in words


def test_whole_numbers_may_be_written_with_a_point(tmp_path):
    assert is_tetrahedron(
        read(
            tmp_path,
            "a.ply",
            PLY_HEADER + rows(PLACES) + "3.0 0.0 1 2.0\n" + rows(TETRAHEDRON[1:], "3 "),
        )
    )


def test_colours_flags_and_lists_around_the_corners_are_passed_over(tmp_path):
    header = (
        "ply\nformat ascii 1.0\nMade by Blender 2.47\nelement vertex 4\nproperty float x\n"
        "property uchar red\nproperty float y\nproperty float z\nproperty float quality\n"
        "element camera 1\nproperty float view\nelement face 4\nproperty uchar flags\n"
        "property list uchar float texcoord\nproperty list uchar int vertex_index\n"
        "property int group\nend_header\n"
    )
    body = "".join(f"{x} 255 {y} {z} 0.5\n" for x, y, z in PLACES) + "7\n\n"
    body += "".join(f"1 2 0.5 0.25 3 {a} {b} {c} 8\n" for a, b, c in TETRAHEDRON)
    found = read(tmp_path, "a.ply", header + body)
    assert is_tetrahedron(found)
    assert found.notes == ("1 row of 'camera' dropped.",)


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_triangle_strips_of_ply_are_cut_and_minus_one_ends_one(tmp_path, kind):
    header = (
        f"ply\nformat {kind} 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    )
    strip = [0, 1, 2, 3, -1, 1, 3, 2, -1]
    if kind == "ascii":
        body = (rows(PLACES) + rows([strip], "9 ")).encode()
    else:
        order = "<" if "little" in kind else ">"
        body = struct.pack(f"{order}12f10i", *np.ravel(PLACES), 9, *strip)
    found = read(tmp_path, "a.ply", header.encode() + body)
    assert found.mesh.faces.tolist() == [[0, 1, 2], [3, 2, 1], [1, 3, 2]]


def test_a_binary_ply_with_old_line_ends_begins_right_behind_its_header(tmp_path):
    # 10 is a line end elsewhere, and here the first byte of the first number.
    header = PLY_HEADER.replace("ascii", "binary_little_endian").replace("\n", "\r")
    places = np.array(PLACES, dtype="<f4")
    places[0, 0] = np.frombuffer(b"\n\0\0\0", "<f4")[0]
    body = places.tobytes() + b"".join(struct.pack("<B3i", 3, *face) for face in TETRAHEDRON)
    found = read(tmp_path, "a.ply", header.encode() + body)
    np.testing.assert_array_equal(found.mesh.vertices, places)


# OBJ


def test_an_obj_face_of_two_corners_is_dropped_and_told(tmp_path):
    found = read(tmp_path, "a.obj", WHOLE[".obj"] + "f 1 2\nf 3\n")
    assert is_tetrahedron(found)
    assert found.notes == ("2 faces of fewer than 3 corners dropped.",)


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"], ids=["LF", "CRLF", "CR"])
@pytest.mark.parametrize("blanks", ["", " ", " \t"], ids=["none", "one", "two"])
def test_a_backslash_goes_on_in_the_next_line_also_with_blanks_behind_it(
    tmp_path, blanks, line_end
):
    text = WHOLE[".obj"].replace("f 1 2 3\n", f"f 1 \\{blanks}\n 2 \\{blanks}\n3\n")
    assert is_tetrahedron(read(tmp_path, "a.obj", text.replace("\n", line_end)))


def test_a_path_that_ends_in_a_backslash_takes_no_vertex_away(tmp_path):
    assert is_tetrahedron(read(tmp_path, "a.obj", "mtllib C:\\a\\\n" + WHOLE[".obj"]))


# Polygons


@given(
    count=st.integers(4, 12),
    noise=st.sampled_from([0.0, 0.05, 0.2, 0.5, 2.0]),
    seed=st.integers(0, 10_000),
)
def test_a_polygon_becomes_two_triangles_less_than_it_has_corners(count, noise, seed):
    random = np.random.default_rng(seed)
    sizes = np.array([3, count, 4, count])
    points = np.empty((sizes.sum(), 3))
    for start, size in zip(np.cumsum(sizes) - sizes, sizes, strict=True):
        angles = np.sort(random.uniform(0, 2 * np.pi, size))
        radius = random.uniform(0.5, 1, size)
        heights = noise * random.normal(size=size)
        points[start : start + size] = np.column_stack(
            [radius * np.cos(angles), radius * np.sin(angles), heights]
        )
    triangles = cut_polygons(points, np.arange(len(points)), sizes)
    polygon = np.repeat(np.arange(4), sizes)[triangles]
    # Each belongs to one polygon, in their order, and each corner is used.
    assert (polygon == polygon[:, :1]).all()
    assert polygon[:, 0].tolist() == np.repeat(np.arange(4), sizes - 2).tolist()
    assert set(triangles.ravel()) == set(range(len(points)))


def test_a_bent_pentagon_leaves_no_hole(tmp_path):
    text = "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nv 0 1 -1\nf 1 2 3 4 5\n"
    found = read(tmp_path, "a.obj", text)
    assert len(found.mesh.faces) == 3
    assert found.notes == ("1 polygon of more than 3 corners cut into triangles.",)


# Unstructured grids


def grid_of(*cells: tuple[int, list[int]]) -> pv.UnstructuredGrid:
    corners = [number for _, cell in cells for number in (len(cell), *cell)]
    places = [[x, y, 0.5 * z] for z in range(2) for y in range(2) for x in range(3)]
    return pv.UnstructuredGrid(corners, [kind for kind, _ in cells], np.array(places, float))


SURFACE_CELLS = (
    (5, [0, 1, 3]),
    (9, [1, 2, 5, 4]),
    (8, [6, 7, 9, 10]),
    (7, [7, 8, 11, 10]),
    (6, [0, 3, 6, 9]),
)
SURFACE_TRIANGLES = 1 + 2 + 2 + 2 + 2


@pytest.mark.parametrize("binary", [True, False], ids=["binary", "ascii"])
@pytest.mark.parametrize("suffix", ["42.vtk", "51.vtk", ".vtu"])
def test_faces_of_an_unstructured_grid_are_its_surface(tmp_path, suffix, binary):
    path = tmp_path / f"a{suffix}"
    grid = grid_of(*SURFACE_CELLS, (3, [0, 5]))
    if suffix == ".vtu":
        grid.save(path, binary=binary)
    else:
        writer = vtkUnstructuredGridWriter()
        writer.SetInputData(grid)
        writer.SetFileVersion(int(suffix[:2]))
        (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
        writer.SetFileName(str(path))
        writer.Write()
    found = read_mesh(path)
    assert found.notes == (
        "1 line dropped.",
        "3 polygons of more than 3 corners cut into triangles.",
    )
    assert len(found.mesh.faces) == SURFACE_TRIANGLES
    theirs = grid.extract_cells(range(len(SURFACE_CELLS))).extract_surface(algorithm=None)
    areas = triangle_areas(found)
    assert areas.sum() == pytest.approx(theirs.triangulate().area)


def triangle_areas(found: MeshFile) -> np.ndarray:
    a, b, c = np.moveaxis(found.mesh.vertices[found.mesh.faces], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def test_a_grid_of_volumes_is_refused_with_the_way_out_and_beside_faces_they_are_dropped(tmp_path):
    path = tmp_path / "a.vtu"
    grid_of((10, [0, 1, 3, 6]), (10, [1, 2, 4, 7])).save(path)
    with pytest.raises(FileFormatError, match=r"unstructured grid of 2 volume cells.*Extract"):
        read_mesh(path)
    grid_of((10, [0, 1, 3, 6]), (5, [0, 1, 3])).save(path)
    found = read_mesh(path)
    assert len(found.mesh.faces) == 1
    assert found.notes == ("1 volume cell dropped.", "9 loose points dropped.")


def test_curved_triangles_and_quads_are_read_by_their_corners():
    corners, sizes, notes = faces_of_cells(
        np.array([22, 23]), np.arange(14), np.array([6, 8], dtype=np.int64)
    )
    assert corners.tolist() == [0, 1, 2, 6, 7, 8, 9]
    assert sizes.tolist() == [3, 4]
    assert notes == ("2 curved faces read by their corners.",)


def test_cells_without_as_many_kinds_are_refused():
    with pytest.raises(BrokenMeshError, match="not as many"):
        faces_of_cells(np.array([5]), np.arange(6), np.array([3, 3]))


# Vertices that are not finite


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".vtk", ".vtp", ".stl"])
@pytest.mark.parametrize("number", [np.nan, np.inf])
def test_a_few_vertices_that_are_not_finite_are_dropped_with_their_faces(tmp_path, suffix, number):
    ball = pv.Sphere(theta_resolution=20, phi_resolution=20)
    around = int((ball.regular_faces == 50).any(axis=1).sum())
    ball.points[50, 1] = number
    ball.save(tmp_path / f"a{suffix}")
    found = read_mesh(tmp_path / f"a{suffix}")
    assert len(found.mesh.vertices) == ball.n_points - 1
    assert len(found.mesh.faces) == ball.n_cells - around
    assert found.notes == (
        (f"{around} facets without a finite position dropped.",)
        if suffix == ".stl"
        else (f"1 vertex without a finite position dropped, with {around} faces on them.",)
    )


def test_no_number_as_microsoft_writes_it_and_exponents_of_fortran_are_read(tmp_path):
    # A fan of many triangles, one corner of which is broken.
    places = "".join(f"1.0D+00 {n}.5d0 {n * n}\n" for n in range(200)) + "-1.#IND nan(ind) 1.#INF\n"
    faces = "".join(f"3 0 {n} {n + 1}\n" for n in range(1, 200))
    header = PLY_HEADER.replace("vertex 4", "vertex 201").replace("face 4", "face 199")
    table = " ".join(f"{row}" for row in places.splitlines())
    texts = {
        "a.ply": header + places + faces,
        "a.off": f"OFF\n201 199\n{places}{faces}",
        "a.obj": "".join(f"v {row}\n" for row in places.splitlines())
        + "".join(f"f 1 {n + 1} {n + 2}\n" for n in range(1, 200)),
        "a.vtk": "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\n"
        f"POINTS 201 double\n{table}\nPOLYGONS 199 796\n{faces}",
    }
    numbers = " ".join(str(n) for face in faces.splitlines() for n in face.split()[1:])
    ends = " ".join(str(3 * n) for n in range(1, 200))
    texts["a.vtp"] = (
        '<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="201" NumberOfPolys="199">'
        f'<Points><DataArray type="Float64">{places}</DataArray></Points><Polys>'
        f'<DataArray type="Int32" Name="connectivity">{numbers}</DataArray>'
        f'<DataArray type="Int32" Name="offsets">{ends}</DataArray></Polys></Piece></PolyData>'
        "</VTKFile>"
    )
    for name, text in texts.items():
        found = read(tmp_path, name, text)
        assert found.mesh.vertices[3].tolist() == [1, 3.5, 9], name
        assert found.notes == ("1 vertex without a finite position dropped, with 1 face on them.",)


def test_lists_of_a_ply_vertex_behind_its_places_are_passed_over(tmp_path):
    header = PLY_HEADER.replace(
        "property float z\n", "property float z\nproperty list uchar int near\n"
    )
    body = "".join(f"{x} {y} {z} 2 7 8\n" for x, y, z in PLACES)
    found = read(tmp_path, "a.ply", header + body + rows(TETRAHEDRON, "3 "))
    assert is_tetrahedron(found)
    assert found.notes == ()


def test_more_than_a_few_vertices_that_are_not_finite_are_refused(tmp_path):
    ball = pv.Sphere(theta_resolution=20, phi_resolution=20)
    ball.points[::40, 1] = np.nan
    ball.save(tmp_path / "a.ply")
    with pytest.raises(FileFormatError, match=r"Vertex 1 has .* finite number, as have 9 more"):
        read_mesh(tmp_path / "a.ply")
