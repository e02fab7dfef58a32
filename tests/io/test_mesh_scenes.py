"""OFF, glTF and 3MF, as other programs write them, and what is in them that cannot be read."""

from __future__ import annotations

import base64
import io
import json
import struct
import tracemalloc
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinwarp.core.errors import FileFormatError
from pinwarp.core.mesh import Mesh
from pinwarp.io.mesh_formats import parts
from pinwarp.io.meshes import MeshFile, read_mesh, write_mesh

PLACES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype="<f4")
TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def read(folder: Path, name: str, content: bytes | str) -> MeshFile:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_mesh(path)


def refusal(folder: Path, name: str, content: bytes | str) -> str:
    """Return why a file is refused, for which little memory is taken."""
    tracemalloc.start()
    try:
        with pytest.raises(FileFormatError) as caught:
            read(folder, name, content)
        assert tracemalloc.get_traced_memory()[1] < 100 << 20
    finally:
        tracemalloc.stop()
    return str(caught.value)


def volume(found: MeshFile) -> float:
    a, b, c = np.moveaxis(found.mesh.vertices[found.mesh.faces], 1, 0)
    return float((a * np.cross(b, c)).sum() / 6)


# OFF

OFF = "4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"


@pytest.mark.parametrize(
    "text",
    [
        f"OFF\n{OFF}",
        f"OFF {OFF}",
        f"off\r\n\r\n# by hand\r\n{OFF}".replace("\n", "\r\n").replace("\r\r", "\r"),
        f"# by hand\n\nOFF # of a bone\n{OFF}",
        OFF,
        f"OFF\n{OFF}".replace("4 4 6", "4 4"),
        f"COFF\n{OFF}".replace("0 0 1\n", "0 0 1 255 0 0 255\n"),
        f"STCNOFF\n{OFF}".replace("0 1 0\n", "0 1 0 0 0 1 255 0 0 255 0.5 0.5\n"),
        f"OFF\n{OFF}".replace("3 0 2 1\n", "3 0 2 1 255 0 0\n").replace("3 0 1 3", "3 0 1 3 7"),
    ],
    ids=[
        "plain",
        "counts behind the word",
        "small letters and a comment",
        "comments first",
        "no word",
        "two counts",
        "colours",
        "normals and textures",
        "colours of faces",
    ],
)
def test_off_of_any_program_is_read(tmp_path, text):
    found = read(tmp_path, "a.off", text)
    assert found.mesh.vertices.tolist() == PLACES.tolist()
    assert found.mesh.faces.tolist() == TETRAHEDRON.tolist()
    assert found.notes == ()


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (f"OFF\n{OFF}"[:-20], "cut off"),
        (f"OFF\n{OFF}".replace("3 0 1 3", "3 0 1"), "line 8: The line ends before all"),
        (f"OFF\n{OFF}".replace("3 0 1 3", "3 0 1 4"), "names vertex 5"),
        (f"OFF\n{OFF}".replace("4 4 6", "4 999999999999 6"), "cut off"),
        ("OFF BINARY\n\0\0\0\4", "Binary OFF"),
        ("nOFF\n4\n1 1 0\n", "four and more dimensions"),
        ("OFF\n4.5 4 6\n", "does not begin with the numbers"),
        ("bone\n", "line 1"),
    ],
)
def test_off_that_cannot_be_read_is_refused_in_words(tmp_path, text, reason):
    assert reason in refusal(tmp_path, "a.off", text)


# glTF


def scene_of(tables: list[np.ndarray], **more: Any) -> dict[str, Any]:
    """A scene whose accessors are these tables, one view each: corners first, then places."""
    kinds = {"u1": 5121, "u2": 5123, "u4": 5125, "i2": 5122, "f4": 5126}
    ends = np.cumsum([table.nbytes for table in tables]).tolist()
    return {
        "asset": {"version": "2.0"},
        "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "accessors": [
            {
                "bufferView": number,
                "componentType": kinds[table.dtype.str[1:]],
                "count": len(table),
                "type": "SCALAR" if table.ndim == 1 else "VEC3",
            }
            for number, table in enumerate(tables)
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": end - table.nbytes, "byteLength": table.nbytes}
            for table, end in zip(tables, ends, strict=True)
        ],
        "buffers": [{"byteLength": ends[-1]}],
    } | more


def glb(scene: dict[str, Any], tables: list[np.ndarray]) -> bytes:
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(table.tobytes() for table in tables)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text
    body += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


TABLES = [TETRAHEDRON.ravel().astype("<u2"), PLACES]


def test_a_part_stands_where_its_nodes_put_it_and_a_mirror_turns_it_round(tmp_path):
    half = np.sqrt(0.5)
    nodes = [
        {"children": [1, 2], "translation": [10, 0, 0], "rotation": [0, 0, half, half]},
        {"mesh": 0, "scale": [2, 2, 2]},
        {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1]},
    ]
    found = read(tmp_path, "a.glb", glb(scene_of(TABLES, nodes=nodes), TABLES))
    assert found.notes == ("2 parts became one mesh.",)
    # A quarter turn about z takes x to y and y to -x.
    first = np.column_stack([10 - 2 * PLACES[:, 1], 2 * PLACES[:, 0], 2 * PLACES[:, 2]])
    second = np.column_stack([10 - (PLACES[:, 1] + 5), -PLACES[:, 0], PLACES[:, 2]])
    np.testing.assert_allclose(found.mesh.vertices, [*first, *second], atol=1e-6)
    assert volume(found) == pytest.approx((8 + 1) / 6)


def test_vertices_that_were_split_for_their_normals_become_one(tmp_path):
    tables = [np.arange(12, dtype="<u4"), PLACES[TETRAHEDRON.ravel()]]
    found = read(tmp_path, "a.glb", glb(scene_of(tables), tables))
    assert len(found.mesh.vertices) == 4
    assert volume(found) == pytest.approx(1 / 6)


@pytest.mark.parametrize("kind", ["strip", "fan", "no numbers"])
def test_strips_fans_and_parts_without_numbers_are_read(tmp_path, kind):
    corners = np.arange(4, dtype="<u1")
    tables = [corners, PLACES]
    primitive: dict[str, Any] = {"attributes": {"POSITION": 1}, "indices": 0}
    expected = [[0, 1, 2], [3, 2, 1]] if kind == "strip" else [[0, 1, 2], [0, 2, 3]]
    if kind == "no numbers":
        del primitive["indices"]
        tables = [corners, PLACES[[0, 1, 2, 0, 2, 3]]]
    else:
        primitive["mode"] = 5 if kind == "strip" else 6
    scene = scene_of(tables, meshes=[{"primitives": [primitive, primitive | {"mode": 1}]}])
    found = read(tmp_path, "a.glb", glb(scene, tables))
    assert found.mesh.faces.tolist() == expected
    assert found.notes == ("1 part of lines or points dropped.",)


def test_numbers_between_others_sparse_ones_and_small_whole_ones_are_read(tmp_path):
    wide = np.zeros((4, 8), dtype="<f4")
    wide[:, 1:4] = PLACES
    scene = scene_of([TABLES[0], wide])
    scene["accessors"][1] |= {"byteOffset": 4}
    scene["bufferViews"][1]["byteStride"] = 32
    found = read(tmp_path, "a.glb", glb(scene, [TABLES[0], wide]))
    assert found.mesh.vertices.tolist() == PLACES.tolist()

    tables = [*TABLES, np.array([3], dtype="<u2"), np.array([[0, 0, 7]], dtype="<f4")]
    scene = scene_of(tables)
    scene["accessors"][1]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": 2, "componentType": 5123},
        "values": {"bufferView": 3},
    }
    found = read(tmp_path, "b.glb", glb(scene, tables))
    assert found.mesh.vertices[3].tolist() == [0, 0, 7]

    tables = [TABLES[0], (PLACES * 32767).astype("<i2")]
    scene = scene_of(tables, nodes=[{"mesh": 0, "scale": [3, 3, 3]}])
    scene["accessors"][1]["normalized"] = True
    found = read(tmp_path, "c.glb", glb(scene, tables))
    np.testing.assert_allclose(found.mesh.vertices, 3 * PLACES)


def test_a_gltf_with_its_numbers_inside_or_beside_it_is_read(tmp_path):
    binary = b"".join(table.tobytes() for table in TABLES)
    scene = scene_of(TABLES)
    scene["buffers"][0]["uri"] = "data:;base64," + base64.b64encode(binary).decode()
    assert volume(read(tmp_path, "a.gltf", json.dumps(scene))) == pytest.approx(1 / 6)
    (tmp_path / "left femur.bin").write_bytes(binary)
    scene["buffers"][0]["uri"] = "left%20femur.bin"
    marked = b"\xef\xbb\xbf" + json.dumps(scene).encode()
    assert volume(read(tmp_path, "b.gltf", marked)) == pytest.approx(1 / 6)
    scene["buffers"][0]["uri"] = "gone.bin"
    assert "gone.bin: There is no such file" in refusal(tmp_path, "c.gltf", json.dumps(scene))
    for place in ("../secret.bin", "/etc/passwd", "https://example.org/a.bin", "C:\\a.bin"):
        scene["buffers"][0]["uri"] = place
        assert "Save it as GLB" in refusal(tmp_path, "d.gltf", json.dumps(scene))


def changed(**more: Any) -> bytes:
    return glb(scene_of(TABLES, **more), TABLES)


def compressed() -> bytes:
    scene = scene_of(TABLES)
    for accessor in scene["accessors"]:
        del accessor["bufferView"]
    scene["meshes"][0]["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": {}}
    return glb(scene, TABLES)


def with_accessor(number: int, **more: Any) -> bytes:
    scene = scene_of(TABLES)
    scene["accessors"][number] |= more
    return glb(scene, TABLES)


def of_nothing(count: int) -> bytes:
    """A scene whose places are zeros that stand nowhere."""
    scene = scene_of(TABLES)
    scene["accessors"][1] |= {"count": count}
    del scene["accessors"][1]["bufferView"]
    return glb(scene, TABLES)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (glb(scene_of(TABLES), TABLES)[:-5], "cut off"),
        (compressed(), "compressed (KHR_draco_mesh_compression)"),
        (with_accessor(0, count=10**6), "damaged"),
        (with_accessor(1, count=10**15), "unpacks to far more"),
        (with_accessor(1, count=3), "does not exist"),
        (with_accessor(1, count=-1), "damaged"),
        (with_accessor(1, type="VEC9"), "damaged"),
        (with_accessor(1, componentType=True), "damaged"),
        (of_nothing(10**9), "unpacks to far more"),
        (changed(nodes=[{"mesh": 0, "children": [0]}]), "damaged"),
        (changed(nodes=[{"mesh": 7}]), "damaged"),
        (changed(nodes=7), "damaged"),
        (changed(nodes=[{"mesh": 0, "matrix": [1]}]), "damaged"),
        (changed(bufferViews=[{"buffer": 3, "byteLength": 4}] * 2), "damaged"),
        (changed(meshes=[{"primitives": [{"attributes": {}}]}]), "damaged"),
    ],
)
def test_a_scene_that_cannot_be_read_is_refused_in_words(tmp_path, content, reason):
    assert reason in refusal(tmp_path, "a.glb", content)


# 3MF


def threemf(models: dict[str, str], **options: Any) -> bytes:
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED, **options) as archive:
        for name, text in models.items():
            archive.writestr(name, text)
    return whole.getvalue()


def model(resources: str, build: str, more: str = "") -> str:
    return (
        f'<?xml version="1.0"?>\n<m:model xmlns:m="core" {more}><m:resources>{resources}'
        f"</m:resources><m:build>{build}</m:build></m:model>"
    )


def tetrahedron(number: int) -> str:
    vertices = "".join(f'<m:vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in PLACES.tolist())
    triangles = "".join(f'<m:triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in TETRAHEDRON)
    return (
        f'<m:object id="{number}"><m:mesh><m:vertices>{vertices}</m:vertices>'
        f"<m:triangles>{triangles}</m:triangles></m:mesh></m:object>"
    )


MAIN = "3D/3dmodel.model"


def test_objects_of_3mf_stand_where_items_and_components_put_them(tmp_path):
    whole = (
        '<m:object id="2"><m:components>'
        '<m:component objectid="1" transform="2 0 0 0 2 0 0 0 2 0 0 5"/>'
        '<m:component objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>'
        "</m:components></m:object>"
    )
    item = '<m:item objectid="2" transform="0 1 0 -1 0 0 0 0 1 10 0 0"/>'
    text = model(tetrahedron(1) + whole, item, 'unit="inch"')
    found = read(tmp_path, "a.3mf", threemf({MAIN: text}))
    assert found.notes == ("2 parts became one mesh.", "The file says that its unit is the inch.")
    first = 2 * PLACES + [0, 0, 5]
    second = PLACES * [-1, 1, 1]
    both = np.concatenate([first, second])
    expected = np.column_stack([10 - both[:, 1], both[:, 0], both[:, 2]])
    np.testing.assert_allclose(found.mesh.vertices, expected, atol=1e-6)
    assert volume(found) == pytest.approx((8 + 1) / 6)


def test_objects_in_files_of_their_own_are_found(tmp_path):
    # As slicers write them.
    part = '<m:component p:path="/3D/Objects/bone_1.model" objectid="1"/>'
    whole = f'<m:object id="8"><m:components>{part}</m:components></m:object>'
    main = model(whole, '<m:item objectid="8"/>', 'xmlns:p="production"')
    other = model(tetrahedron(1), "")
    files = {"3D/Objects/bone_1.model": other, MAIN: main, "Metadata/plate.png": "x"}
    found = read(tmp_path, "a.3mf", threemf(files))
    assert volume(found) == pytest.approx(1 / 6)
    assert found.notes == ()


def laughs() -> str:
    """Components of components, a billion in all."""
    objects = [tetrahedron(0)]
    for number in range(1, 10):
        parts = 10 * f'<m:component objectid="{number - 1}"/>'
        objects.append(f'<m:object id="{number}"><m:components>{parts}</m:components></m:object>')
    return model("".join(objects), '<m:item objectid="9"/>')


CIRCLE = '<m:object id="1"><m:components><m:component objectid="1"/></m:components></m:object>'


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (threemf({MAIN: model(tetrahedron(1), '<m:item objectid="1"/>')})[:-60], "damaged"),
        (threemf({MAIN: model(CIRCLE, '<m:item objectid="1"/>')}), "damaged"),
        (threemf({MAIN: model("", '<m:item objectid="7"/>')}), "damaged"),
        (threemf({MAIN: model(tetrahedron(1).replace('v1="0"', 'v1="9"'), "")}), "not exist"),
        (threemf({MAIN: model(tetrahedron(1).replace('v1="0"', ""), "")}), "lacks a number"),
        (threemf({MAIN: model(tetrahedron(1).replace('x="0.0"', 'x="z"'), "")}), "lacks a number"),
        (threemf({MAIN: model("", "")}), "no triangles"),
        (threemf({MAIN: "<m"}), "cannot be read: this is not XML"),
        (threemf({MAIN: '<!DOCTYPE a [<!ENTITY b "c">]><a/>'}), "declares entities"),
        (threemf({MAIN: " " * (200 << 20)}, compresslevel=1), "unpacks to far more"),
        (threemf({"[Content_Types].xml": "", "word/document.xml": ""}), "no triangles"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_3mf_that_cannot_be_read_is_refused_in_words(tmp_path, content, reason):
    assert reason in refusal(tmp_path, "a.3mf", content)


def test_scenes_of_too_many_parts_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(parts, "MOST", 100)
    words = "more than 100 parts, which are no bone"
    primitive = {"attributes": {"POSITION": 1}, "indices": 0}
    content = changed(meshes=[{"primitives": [primitive] * 101}])
    assert words in refusal(tmp_path, "a.glb", content)
    assert words in refusal(tmp_path, "a.3mf", threemf({MAIN: laughs()}))
    empty = laughs().replace(tetrahedron(0), '<m:object id="0"/>')
    assert words in refusal(tmp_path, "b.3mf", threemf({MAIN: empty}))


# Write, then read


@pytest.mark.parametrize("suffix", [".off", ".glb", ".gltf", ".3mf", ".vtu"])
@settings(max_examples=25)
@given(data=st.data())
def test_any_triangles_come_back_with_their_corners(tmp_path_factory, suffix, data):
    count = data.draw(st.integers(3, 9))
    faces = data.draw(
        st.lists(
            st.lists(st.integers(0, count - 1), min_size=3, max_size=3, unique=True),
            min_size=1,
            max_size=9,
        )
    )
    seed = data.draw(st.integers(0, 1000))
    places = np.random.default_rng(seed).normal(scale=100, size=(count, 3)).astype(np.float32)
    mesh = Mesh(places, faces)
    path = tmp_path_factory.mktemp("mesh") / f"a{suffix}"
    write_mesh(path, mesh)
    found = read_mesh(path).mesh
    np.testing.assert_array_equal(found.vertices[found.faces], mesh.vertices[mesh.faces])
    assert len(found.vertices) == len(np.unique(mesh.faces))
