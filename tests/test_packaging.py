"""What is handed out: declared as it is used, and whole."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest

from pinwarp.version import __version__

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def names(requirements):
    """Return what requirements are called, spelt in one way."""
    return {plain(re.match(r"[\w.-]+", one)[0]) for one in requirements}


def plain(name):
    """Spell a distribution's name in one way."""
    return re.sub(r"[-_.]+", "-", name).lower()


def imported():
    """Return the top-level packages that the sources import anywhere, even late."""
    found = set()
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module.partition(".")[0])
    return found - set(sys.stdlib_module_names) - {"pinwarp"}


def test_what_is_imported_is_declared_and_what_is_declared_is_imported():
    brings = {
        package: {plain(name) for name in owners}
        for package, owners in metadata.packages_distributions().items()
    }
    optional = PROJECT["optional-dependencies"].values()
    declared = set().union(*map(names, (PROJECT["dependencies"], *optional)))
    used = set()
    for package in imported():
        # What is not installed here is called like its package.
        owners = brings.get(package, {plain(package)})
        assert owners & declared, f"{package} is imported and not declared"
        used |= owners & declared
    # qtpy imports the toolkit by the name in QT_API.
    assert declared - used == {"pyside6-essentials"}


def test_the_citation_names_this_version_and_these_authors():
    lines = (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    for line in (
        "cff-version: 1.2.0",
        "type: software",
        f"title: {PROJECT['name']}",
        f"version: {__version__}",
        f"license: {PROJECT['license']}",
    ):
        assert line in lines
    assert [line for line in lines if line.startswith("  - name: ")] == [
        f"  - name: {author['name']}" for author in PROJECT["authors"]
    ]


def test_a_wheel_and_a_bundle_have_all_that_the_program_reads():
    hatch = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]
    taken = hatch["build"]["targets"]["wheel"]["force-include"]
    spec = (ROOT / ".bundle" / "pinwarp.spec").read_text(encoding="utf-8")
    for source, target in taken.items():
        assert (ROOT / source).exists()
        assert target == f"pinwarp/{source}"
    # Beside these, the assets are scripts and pictures of the documents.
    others = {"penalty_sign.svg", "screenshot.png", "__pycache__"}
    read = {path.name for path in (ROOT / "assets").iterdir() if path.suffix != ".py"} - others
    assert {Path(one).name for one in taken} == read
    folders = [one for one in taken if (ROOT / one).is_dir()]
    assert all(f'"{Path(one).name}"' in spec for one in folders)


@pytest.mark.parametrize("suffix", [".pinwarp.csv", ".pinwarp-model.csv"])
def test_a_desktop_knows_the_files(suffix):
    kinds = (ROOT / ".bundle" / "pinwarp-mime.xml").read_text(encoding="utf-8")
    entry = (ROOT / ".bundle" / "pinwarp.desktop").read_text(encoding="utf-8")
    [kind] = [one for one in kinds.split("<mime-type") if f'"*{suffix}"' in one]
    assert re.search('type="([^"]+)"', kind)[1] + ";" in entry
    assert suffix in (ROOT / ".bundle" / "pinwarp.iss").read_text(encoding="utf-8")
