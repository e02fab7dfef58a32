"""The command as a user types it, in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

import pinwarp
from pinwarp.__main__ import main
from pinwarp.io.samples import sample_session

HEAVY = {"qtpy", "PySide6", "pyvista", "vtk", "vtkmodules", "matplotlib"}


def run(*arguments, display=True, **environment):
    env = {**os.environ, **environment}
    if not display:
        for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
            env.pop(name, None)
    return subprocess.run(
        [sys.executable, "-W", "error::SyntaxWarning", "-m", "pinwarp", *map(str, arguments)],
        capture_output=True,
        text=True,
        env=env,
        timeout=120,
        check=False,
    )


def test_the_version_is_told():
    assert run("--version").stdout == f"pinwarp {pinwarp.__version__}\n"


def loaded_after(*words):
    """Run a command and return the packages it has loaded, and the modules of the program."""
    code = (
        "import sys; from pinwarp.__main__ import main\n"
        f"sys.argv = ['pinwarp', *{[str(word) for word in words]!r}]\n"
        "try: main()\nexcept SystemExit as end: assert not end.code, end.code\n"
        "print(*(x for x in sys.modules if '.' not in x or x.startswith('pinwarp.')))"
    )
    told = subprocess.run(
        [sys.executable, "-c", code], check=True, timeout=60, capture_output=True, text=True
    )
    return set(told.stdout.splitlines()[-1].split())


def test_the_command_line_starts_with_what_a_command_line_needs():
    loaded = loaded_after("--version")
    assert "typer" in loaded
    assert not loaded & {*HEAVY, "numpy", "scipy", "numba", "asyncio", "rich"}


def test_help_needs_neither_qt_nor_vtk_nor_compiled_code():
    assert not loaded_after("--help") & {*HEAVY, "numba"}


def test_a_command_loads_no_other():
    loaded = loaded_after("check", "--help")
    assert "pinwarp.cli.check" in loaded
    assert not loaded & {"pinwarp.cli.batch", "pinwarp.cli.model", "pinwarp.session.study"}


def test_the_commands_need_neither_qt_nor_vtk_for_the_sample(tmp_path):
    session = sample_session()
    for words in (
        ["warp", str(session), "-o", str(tmp_path / "bone.ply")],
        ["check", str(session), "--json"],
        ["convert", str(session), str(tmp_path / "all.csv")],
    ):
        assert not loaded_after(*words) & HEAVY, words
    assert (tmp_path / "bone.ply").is_file()


def test_an_error_is_one_line_and_no_traceback(tmp_path):
    outcome = run("check", tmp_path / "gone.pinwarp.csv", display=False)
    assert outcome.returncode == 2
    assert outcome.stderr == (
        f"pinwarp: gone.pinwarp.csv: There is no such file in {tmp_path}. "
        "Was it moved or renamed?\n"
    )
    assert outcome.stdout == ""


def test_a_check_needs_no_display():
    outcome = run("check", sample_session(), "--json", display=False)
    assert outcome.returncode == 0, outcome.stderr
    assert len(json.loads(outcome.stdout)["pairs"]) == 16


@pytest.mark.parametrize("module", ["pinwarp", "pinwarp.tps3d"])
def test_importing_the_library_loads_neither_qt_nor_vtk(module):
    code = (
        f"import sys, {module}\n"
        "loaded = [m for m in sys.modules if m.startswith(('qtpy', 'PySide6', 'vtk', 'pyvista'))]\n"
        "assert not loaded, loaded"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


def test_a_file_that_is_not_there_is_named():
    outcome = run("nowhere.stl", "elsewhere.stl")
    assert outcome.returncode == 2
    assert "nowhere.stl does not exist" in outcome.stderr


def test_three_meshes_are_too_many(tmp_path):
    paths = [tmp_path / f"{i}.stl" for i in range(3)]
    for path in paths:
        path.write_text("")
    outcome = run(*paths)
    assert outcome.returncode == 2
    assert "at most two meshes" in outcome.stderr


def test_without_a_display_it_says_so():
    outcome = run("--demo", display=False)
    assert outcome.returncode == 2
    assert "there is no display" in outcome.stderr


def test_a_display_that_does_not_answer_is_no_display():
    outcome = run("--demo", DISPLAY=":7777")
    assert outcome.returncode == 2
    assert "there is no display" in outcome.stderr


def test_a_system_that_cannot_draw_is_told_what_it_lacks(monkeypatch, capsys):
    class Lacking:
        @staticmethod
        def find_spec(name, *_):
            if name == "pinwarp.gui.app":
                raise ImportError("libGL.so.1: cannot open shared object file: No such file")

    monkeypatch.setattr(sys, "meta_path", [Lacking, *sys.meta_path])
    monkeypatch.delitem(sys.modules, "pinwarp.gui.app", raising=False)
    monkeypatch.setenv("QT_QPA_PLATFORM", os.environ.get("QT_QPA_PLATFORM", "xcb"))
    monkeypatch.setattr(sys, "argv", ["pinwarp", "--demo"])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
    told = capsys.readouterr().err
    assert "the window needs libGL.so.1" in told
    assert "sudo apt install libgl1" in told


def test_a_picture_of_the_sample_is_written(tmp_path):
    path = tmp_path / "pictures" / "demo.png"
    outcome = run("--demo", "--screenshot", path, XDG_CONFIG_HOME=str(tmp_path))
    assert outcome.returncode == 0, outcome.stderr
    assert path.read_bytes().startswith(b"\x89PNG")
    assert path.stat().st_size > 50_000


def test_without_a_display_there_are_pictures_all_the_same(tmp_path):
    path = tmp_path / "demo.png"
    outcome = run("--demo", "--screenshot", path, display=False, XDG_CONFIG_HOME=str(tmp_path))
    assert (outcome.returncode, outcome.stderr) == (0, "")
    with Image.open(path) as picture:
        assert picture.size == (1280, 800)
        colours = np.asarray(picture.convert("RGB")).reshape(-1, 3)
    # The bones are in it, not only a window: bone is warm, and so is nothing else.
    assert (colours[:, 0] > colours[:, 2] + 20).mean() > 0.02


def test_a_picture_of_a_damaged_session_fails_with_its_reason(tmp_path):
    path = tmp_path / "bad.pinwarp.csv"
    path.write_text("nonsense\n")
    outcome = run(path, "--screenshot", tmp_path / "x.png", XDG_CONFIG_HOME=str(tmp_path))
    assert outcome.returncode == 1
    assert "bad.pinwarp.csv" in outcome.stderr


@pytest.mark.parametrize(
    "command", [[], ["open"], ["warp"], ["check"], ["suggest"], ["refine"], ["batch"], ["model"]]
)
def test_the_help_asks_for_no_value_of_a_flag(pinwarp_command, command):
    told = pinwarp_command(*command, "--help").stdout
    assert "--help" in told
    assert "bool" not in told
    assert "--no-" not in told


def test_whoever_has_read_enough_is_told_of_no_mistake():
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "w") as nobody:
        outcome = subprocess.run(
            [sys.executable, "-m", "pinwarp", "check", str(sample_session())],
            stdout=nobody,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
            check=False,
        )
    assert outcome.stderr == ""
    assert outcome.returncode == 1
