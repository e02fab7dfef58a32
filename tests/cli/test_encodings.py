"""What the command says where the output, or the whole system, has few letters."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace

import pytest
from tests.session.study import make_study

from pinwarp.core.landmarks import Side
from pinwarp.io.file_names import SESSION_SUFFIX
from pinwarp.io.meshes import read_mesh
from pinwarp.session import edits
from pinwarp.session.keeping.files import read_session, write_session

NAME = "Köpfchen α 頭"
FEW_LETTERS = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


def spelt(name):
    """A name as this system has it, whose own locale may have few letters."""
    return os.fsdecode(name.encode())


def run(*arguments, **environment):
    command = [sys.executable, "-m", "pinwarp", *map(str, arguments)]
    env = {**os.environ, "COLUMNS": "100", **environment}
    return subprocess.run(command, env=env, capture_output=True, timeout=120, check=False)


@pytest.fixture
def session(tmp_path):
    """A session, a mesh and a landmark with letters of three scripts."""
    folder = tmp_path / spelt("Größe α")
    make_study(folder, 1)
    found = folder / "study.pinwarp.csv"
    opened = read_session(found)
    first, *others = opened.landmarks
    opened = replace(opened, landmarks=(replace(first, name=NAME), *others))
    mesh = read_mesh((folder / "s0.stl").rename(folder / spelt("ziel α.stl")))
    opened = edits.set_mesh(opened, Side.DESTINATION, mesh)
    path = found.rename(folder / spelt(f"Größe α{SESSION_SUFFIX}"))
    write_session(path, opened)
    return path


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_letters_that_the_output_has_not_are_spelt(session, encoding):
    # So it is with pipes and files on Windows.
    outcome = run("check", session, PYTHONIOENCODING=encoding)
    assert outcome.returncode == 0, outcome.stderr
    assert NAME.encode(encoding, "backslashreplace") in outcome.stdout


def test_signs_of_the_help_are_typed_as_one_types_them():
    outcome = run("check", "--help", PYTHONIOENCODING="ascii")
    assert outcome.returncode == 0, outcome.stderr
    assert b"r^2 log r" in outcome.stdout


def test_programs_are_told_in_letters_that_every_encoding_has(session):
    outcome = run("check", session, "--json", PYTHONIOENCODING="cp1252")
    assert outcome.stdout.isascii()
    assert json.loads(outcome.stdout)["pairs"][0]["name"] == NAME


@pytest.mark.skipif(sys.platform == "win32", reason="its file names have all letters, always")
def test_files_are_found_where_the_locale_has_no_letters_for_their_names(session):
    warped = session.with_name(spelt("ganz β.ply"))
    outcome = run("warp", session, "-o", warped, **FEW_LETTERS)
    assert outcome.returncode == 0, outcome.stderr
    assert outcome.stderr == b""
    assert warped.is_file()
    outcome = run("check", session.with_name(spelt("weg α.csv")), **FEW_LETTERS)
    assert outcome.returncode == 2
    assert b"There is no such file" in outcome.stderr
