"""Nobody else can put code where compiled code is read from."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from pinwarp.core import cache_folder
from pinwarp.core.cache_folder import is_private, private_cache

pytestmark = pytest.mark.skipif(not hasattr(os, "getuid"), reason="owners have no numbers here")

NOBODY = 65534


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the user's cache folder, which is not there yet."""
    tmp_path.chmod(0o700)
    home = tmp_path / "home"
    monkeypatch.setenv("XDG_CACHE_HOME", str(home))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(cache_folder.atexit, "register", lambda *_args, **_options: None)
    return home


def is_fresh(folder: Path, home: Path) -> bool:
    assert folder.stat().st_mode & 0o777 == 0o700
    assert list(folder.iterdir()) == []
    return home not in folder.parents and folder.name.startswith("pinwarp-")


def test_the_users_cache_is_made_private_and_used_again(home):
    folder = private_cache()
    assert folder == home / "pinwarp" / "compiled"
    assert folder.stat().st_mode & 0o777 == 0o700
    (folder / "compiled").touch()
    assert private_cache() == folder


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o702, 0o755])
def test_a_folder_that_others_may_look_into_or_write_to_is_not_used(home, mode):
    private_cache().chmod(mode)
    assert is_fresh(private_cache(), home)


@pytest.mark.parametrize("mode", [0o777, 0o775])
@pytest.mark.parametrize("above", [".", "pinwarp"])
def test_a_folder_that_others_can_exchange_is_not_used(home, mode, above):
    private_cache()
    (home / above).chmod(mode)
    assert is_fresh(private_cache(), home)


def test_what_nobody_may_rename_in_is_safe_though_all_may_write(home):
    folder = private_cache()
    home.chmod(0o1777)
    assert private_cache() == folder


def test_a_link_in_its_place_is_not_followed(home, tmp_path):
    private_cache().rmdir()
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir(mode=0o700)
    (home / "pinwarp" / "compiled").symlink_to(elsewhere)
    assert is_fresh(private_cache(), home)


def test_a_link_above_it_is_followed_and_what_it_leads_to_is_looked_at(home, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir(mode=0o700)
    home.symlink_to(elsewhere)
    assert private_cache() == elsewhere / "pinwarp" / "compiled"
    elsewhere.chmod(0o777)
    assert is_fresh(private_cache(), home)


@pytest.mark.skipif(os.name == "posix" and os.getuid() != 0, reason="only root gives files away")
@pytest.mark.parametrize("above", ["compiled", ".", ".."])
def test_a_folder_of_another_user_is_not_used(home, above):
    os.chown(private_cache().parent / above, NOBODY, NOBODY)
    assert is_fresh(private_cache(), home)


def test_a_file_in_its_place_and_a_home_that_cannot_be_made_are_no_hindrance(
    home, tmp_path, monkeypatch
):
    home.touch()
    assert is_fresh(private_cache(), home)
    for place in ("/proc/1", "/proc/nowhere"):
        monkeypatch.setattr(
            cache_folder.platformdirs,
            "user_cache_path",
            lambda name, place=place: Path(place, name),
        )
        assert is_fresh(private_cache(), Path(place))


def test_what_is_missing_is_not_private(tmp_path):
    with pytest.raises(FileNotFoundError):
        is_private(tmp_path / "gone")


def test_a_fresh_folder_has_another_name_each_time_and_goes_with_the_program(home, tmp_path):
    home.touch()
    assert private_cache() != private_cache()
    code = "from pinwarp.core.cache_folder import private_cache; print(private_cache())"
    environment = dict(os.environ, XDG_CACHE_HOME="/proc/1", TMPDIR=str(tmp_path))
    told = subprocess.run(
        [sys.executable, "-c", code], check=True, env=environment, capture_output=True, text=True
    )
    folder = Path(told.stdout.strip())
    assert folder.parent == tmp_path
    assert not folder.exists()
