"""Meshes that are not where the session says are found again."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import pytest

from pinwarp.io import mesh_search
from pinwarp.io.mesh_search import find_mesh
from pinwarp.io.session_file import MeshReference

CONTENT = b"solid femur"
LOST = MeshReference(Path("/gone/femur.stl"), hashlib.sha256(CONTENT).hexdigest(), 3)


def put(path: Path, content: bytes = CONTENT) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    return path


def test_a_mesh_is_found_in_a_folder_inside(tmp_path: Path) -> None:
    path = put(tmp_path / "left" / "meshes" / "femur.stl")
    put(tmp_path / "left" / "tibia.stl")
    found = find_mesh(LOST, [tmp_path])
    assert (found.path, found.is_same) == (path, True)


def test_of_several_the_one_with_the_right_hash_is_taken(tmp_path: Path) -> None:
    put(tmp_path / "femur.stl", b"another bone")
    put(tmp_path / "a" / "femur.stl", b"a third")
    path = put(tmp_path / "b" / "femur.stl")
    assert find_mesh(LOST, [tmp_path]).path == path


def test_with_no_right_hash_the_nearest_of_that_name_is_told_apart(tmp_path: Path) -> None:
    near = put(tmp_path / "femur.stl", b"another bone")
    put(tmp_path / "a" / "femur.stl", b"a third")
    found = find_mesh(LOST, [tmp_path])
    assert (found.path, found.is_same) == (near, False)


def test_earlier_folders_come_first(tmp_path: Path) -> None:
    put(tmp_path / "one" / "femur.stl")
    path = put(tmp_path / "two" / "femur.stl")
    assert find_mesh(LOST, [tmp_path / "two", tmp_path / "one"]).path == path


def test_the_case_of_the_name_does_not_matter(tmp_path: Path) -> None:
    assert find_mesh(LOST, [put(tmp_path / "Femur.STL").parent]).is_same


def test_a_mesh_that_was_renamed_is_found_by_its_hash(tmp_path: Path) -> None:
    put(tmp_path / "tibia.stl", b"another bone")
    path = put(tmp_path / "left femur.stl")
    found = find_mesh(LOST, [tmp_path])
    assert (found.path, found.is_same) == (path, True)


def test_a_renamed_mesh_comes_before_another_of_the_same_name(tmp_path: Path) -> None:
    put(tmp_path / "femur.stl", b"another bone")
    path = put(tmp_path / "old femur.stl")
    assert find_mesh(LOST, [tmp_path]).path == path


def test_a_mesh_that_is_nowhere_is_not_found(tmp_path: Path) -> None:
    put(tmp_path / "tibia.stl", b"another bone")
    put(tmp_path / ".hidden" / "femur.stl")
    assert find_mesh(LOST, [tmp_path, tmp_path / "missing"]) is None


def test_a_session_that_knows_no_hash_finds_the_name_only(tmp_path: Path) -> None:
    put(tmp_path / "femur.stl")
    assert not find_mesh(MeshReference(LOST.path, "", 3), [tmp_path]).is_same


def test_the_search_has_an_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put(tmp_path / "1" / "2" / "3" / "4" / "5" / "femur.stl")
    assert find_mesh(LOST, [tmp_path]) is None
    path = put(tmp_path / "b" / "femur.stl")
    assert find_mesh(LOST, [tmp_path]).path == path
    monkeypatch.setattr(mesh_search, "MOST_FOLDERS", 2)
    assert find_mesh(LOST, [tmp_path]) is None


@pytest.mark.skipif(os.name != "posix", reason="links need rights on Windows")
def test_a_link_to_a_folder_above_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to(tmp_path)
    shares: list[float] = []
    assert find_mesh(LOST, [tmp_path], progress=shares.append) is None
    assert len(shares) == 1


def test_what_progress_raises_ends_the_search(tmp_path: Path) -> None:
    def stop(_share: float) -> None:
        raise InterruptedError

    with pytest.raises(InterruptedError):
        find_mesh(LOST, [tmp_path], progress=stop)


def test_a_link_that_leads_round_in_a_circle_is_passed_over(tmp_path: Path) -> None:
    (tmp_path / "a.stl").symlink_to("b.stl")
    (tmp_path / "b.stl").symlink_to("a.stl")
    (tmp_path / "itself").symlink_to("itself")
    (tmp_path / "gone.stl").symlink_to("nowhere.stl")
    (tmp_path / LOST.path.name).symlink_to(LOST.path.name)
    assert find_mesh(LOST, [tmp_path]) is None


def test_what_is_no_file_is_passed_over(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / LOST.path.name)
    (tmp_path / "zero.stl").symlink_to("/dev/zero")
    assert find_mesh(LOST, [tmp_path]) is None
