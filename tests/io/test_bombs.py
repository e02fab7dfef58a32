"""Small files that unpack to gigabytes are refused before they are unpacked."""

from __future__ import annotations

import lzma
import tracemalloc
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Side
from pinwarp.io import careful_xml
from pinwarp.io.landmark_files import read_landmarks
from pinwarp.io.meshes import read_mesh

MB = 1 << 20
ZLIB = ' compressor="vtkZLibDataCompressor"'


def complaint(read: Callable[[Path], object], path: Path, most: int) -> str:
    """Return why a file is refused, for which no more memory than this is taken."""
    tracemalloc.start()
    try:
        with pytest.raises(FileFormatError) as found:
            read(path)
        assert tracemalloc.get_traced_memory()[1] < most
    finally:
        tracemalloc.stop()
    return str(found.value)


def packed(block: bytes, blocks: int = 1, pack: Callable[[bytes], bytes] = zlib.compress) -> bytes:
    """Return an array of equal blocks, as VTK stores it."""
    content = pack(block)
    head = np.array([blocks, len(block), 0, *[len(content)] * blocks], dtype="<u8")
    return head.tobytes() + blocks * content


def vtp_file(path: Path, pieces: str, appended: bytes, more: str = ZLIB) -> Path:
    path.write_bytes(
        f'<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt64"{more}>'
        f'<PolyData>{pieces}</PolyData><AppendedData encoding="raw">_'.encode()
        + appended
        + b"</AppendedData></VTKFile>"
    )
    return path


def piece(points: int, offset: int = 0) -> str:
    return (
        f'<Piece NumberOfPoints="{points}"><Points><DataArray type="Float32" format="appended" '
        f'NumberOfComponents="3" offset="{offset}"/></Points></Piece>'
    )


@pytest.mark.parametrize("announced", [3, 48 * 64 * MB // 12])
def test_many_blocks_of_zeros(tmp_path, announced):
    appended = packed(bytes(48 * MB), 64)
    path = vtp_file(tmp_path / "a.vtp", piece(announced), appended)
    words = complaint(read_mesh, path, 5 * len(appended) + MB)
    assert words.startswith("a.vtp: ")
    assert "unpacks to far more" in words or "damaged" in words


def test_one_block_of_a_gigabyte(tmp_path):
    # Only announced: to make one takes longer than all these tests.
    content = zlib.compress(bytes(MB))
    size = 3 << 28
    head = np.array([1, size, 0, len(content)], dtype="<u8").tobytes()
    path = vtp_file(tmp_path / "a.vtp", piece(size // 12), head + content)
    assert "unpacks to far more" in complaint(read_mesh, path, 10 * MB)


def test_thousands_of_pieces_that_share_one_array(tmp_path):
    raw = np.array([12 * MB // 8], dtype="<u8").tobytes() + bytes(12 * MB // 8)
    for appended, more in ((packed(bytes(12 * MB)), ZLIB), (raw, "")):
        points = MB if more else MB // 8
        path = vtp_file(tmp_path / "a.vtp", 2000 * piece(points), appended, more)
        assert "unpacks to far more" in complaint(read_mesh, path, 400 * MB)


def test_a_number_of_cells_that_is_not_announced_is_bounded_as_well(tmp_path):
    array = '<DataArray type="Int64" Name="offsets" format="appended" offset="0"/>'
    cells = f'<Piece NumberOfPoints="0"><Polys>{array}</Polys></Piece>'
    path = vtp_file(tmp_path / "a.vtp", cells, packed(bytes(64 * MB), 4))
    assert "unpacks to far more" in complaint(read_mesh, path, 10 * MB)


def test_the_memory_that_a_dictionary_asks_for_is_bounded(tmp_path):
    def pack(block: bytes) -> bytes:
        # The size of the dictionary stands in the head; a small one packs the block as well.
        small = lzma.compress(block, filters=[{"id": lzma.FILTER_LZMA2, "dict_size": 1 << 16}])
        body = bytearray(small)
        place = 12 + 4
        assert body[12 + 2 : 12 + 4] == bytes([lzma.FILTER_LZMA2, 1])
        body[place] = 36  # 1 GB
        size = (body[12] + 1) * 4
        body[12 + size - 4 : 12 + size] = zlib.crc32(body[12 : 12 + size - 4]).to_bytes(4, "little")
        return bytes(body)

    more = ' compressor="vtkLZMADataCompressor"'
    path = vtp_file(tmp_path / "a.vtp", piece(12), packed(bytes(144), 1, pack), more)
    assert "damaged" in complaint(read_mesh, path, 10 * MB)


def test_what_a_mesh_packs_to_is_read(tmp_path):
    # Nothing packs better than a flat grid.
    grid = pv.Plane(i_resolution=400, j_resolution=400).triangulate()
    grid.save(tmp_path / "grid.vtp")
    assert len(read_mesh(tmp_path / "grid.vtp").mesh.vertices) == 401 * 401


def pp(declared: str, points: int) -> str:
    point = '<point x="1" y="2" z="3" active="1"/>'
    return f"<!DOCTYPE PickedPoints [{declared}]>\n<PickedPoints>{points * point}</PickedPoints>"


DECLARED = {
    "a default": f'<!ATTLIST point name CDATA "{"a" * 500_000}">',
    "an entity": f'<!ENTITY a "{"a" * 500_000}">',
    "an entity of parameters": "<!ENTITY % a \"<!ENTITY b 'c'>\"> %a;",
    "an entity from outside": '<!ENTITY a SYSTEM "file:///etc/passwd">',
    "an element": "<!ELEMENT point ANY>",
    "a notation": '<!NOTATION a SYSTEM "b">',
}


@pytest.mark.parametrize("declared", DECLARED.values(), ids=DECLARED)
def test_what_a_document_declares_of_its_own_is_refused(tmp_path, declared):
    path = tmp_path / "a.pp"
    path.write_text(pp(declared, 3000))
    words = complaint(lambda place: read_landmarks(place, Side.SOURCE), path, 20 * MB)
    assert "It declares entities or defaults of its own" in words
    mesh = tmp_path / "a.vtp"
    mesh.write_text(f"<!DOCTYPE VTKFile [{declared}]><VTKFile type='PolyData'/>")
    assert "declares entities or defaults" in complaint(read_mesh, mesh, 20 * MB)
    mesh.write_text(mesh.read_text(), encoding="utf-16")
    assert "declares entities or defaults" in complaint(read_mesh, mesh, 20 * MB)


def test_a_doctype_that_declares_nothing_is_usual(tmp_path):
    (tmp_path / "a.pp").write_text(pp("", 1).replace("[]", ""))
    assert read_landmarks(tmp_path / "a.pp", Side.SOURCE).count == 1


def test_too_many_and_too_deep_elements_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(careful_xml, "MOST", 1000)
    mesh = tmp_path / "a.vtp"
    mesh.write_text(f"<VTKFile>{1001 * '<a/>'}</VTKFile>")
    assert "more than 1,000 elements" in complaint(read_mesh, mesh, 10 * MB)
    mesh.write_text(101 * "<a>" + 101 * "</a>")
    assert "nested too deeply" in complaint(read_mesh, mesh, 10 * MB)
