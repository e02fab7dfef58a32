"""Builds the program that needs no Python, for the system that this runs on.

    python .bundle/make.py

Linux: dist/pinwarp-VERSION-linux-ARCH.tar.gz with an `install.sh` that enters the program into the
desktop's menu. macOS: dist/pinwarp-VERSION-macos-ARCH.dmg. Windows: an installer where Inno Setup
is there, else a zip. Needs what pyproject.toml calls the group `bundle`.
"""

from __future__ import annotations

import os
import platform
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
BUILD, DIST = ROOT / "build", ROOT / "dist"
FOLDER = DIST / "pinwarp"
VERSION = runpy.run_path(str(ROOT / "src" / "pinwarp" / "version.py"))["__version__"]


def main() -> None:
    """Build everything."""
    draw_icons(ROOT / "assets" / "icons" / "pinwarp.svg", BUILD / "icons")
    run(
        sys.executable,
        "-m",
        "PyInstaller",
        "--noconfirm",
        "--log-level=WARN",
        str(HERE / "pinwarp.spec"),
    )
    shutil.copy(ROOT / "LICENSE", FOLDER)
    pack = {"linux": pack_linux, "darwin": pack_macos, "win32": pack_windows}[sys.platform]
    made = pack(f"pinwarp-{VERSION}-")
    print(f"{made.relative_to(ROOT)}: {made.stat().st_size / 1e6:.0f} MB")


def draw_icons(svg: Path, folder: Path) -> None:
    """Draw the program's icon in the sizes and files that the systems ask for."""
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    from PIL import Image
    from PySide6.QtGui import QImage, QPainter
    from PySide6.QtSvg import QSvgRenderer

    folder.mkdir(parents=True, exist_ok=True)
    renderer = QSvgRenderer(str(svg))
    largest = QImage(1024, 1024, QImage.Format.Format_ARGB32)
    largest.fill(0)
    painter = QPainter(largest)
    renderer.render(painter)
    painter.end()
    largest.save(str(folder / "pinwarp.png"))
    with Image.open(folder / "pinwarp.png") as image:
        image.save(folder / "pinwarp.ico", sizes=[(n, n) for n in (16, 24, 32, 48, 64, 128, 256)])
        image.save(folder / "pinwarp.icns")


def pack_linux(name: str) -> Path:
    """Pack the folder with what enters it into the desktop's menu."""
    for file in ("pinwarp.desktop", "pinwarp-mime.xml", "install.sh"):
        shutil.copy(HERE / file, FOLDER)
    shutil.copy(ROOT / "assets" / "icons" / "pinwarp.svg", FOLDER)
    target = DIST / f"{name}linux-{platform.machine()}"
    return Path(shutil.make_archive(str(target), "gztar", DIST, FOLDER.name))


def pack_macos(name: str) -> Path:
    """Make a disk image with the program and a link to where it belongs."""
    image = DIST / f"{name}macos-{platform.machine()}.dmg"
    inside = BUILD / "image"
    shutil.rmtree(inside, ignore_errors=True)
    inside.mkdir()
    run("ditto", str(DIST / "pinwarp.app"), str(inside / "pinwarp.app"))
    (inside / "Applications").symlink_to("/Applications")
    run("hdiutil", "create", "-ov", "-volname", "pinwarp", "-srcfolder", str(inside), str(image))
    return image


def pack_windows(name: str) -> Path:
    """Make an installer, or a zip where there is nothing to make one with."""
    usual = Path(os.environ.get("PROGRAMFILES(X86)", ""), "Inno Setup 6", "ISCC.exe")
    compiler = shutil.which("iscc") or (str(usual) if usual.is_file() else None)
    target = DIST / f"{name}windows-{platform.machine().lower()}"
    if compiler is None:
        return Path(shutil.make_archive(str(target), "zip", DIST, FOLDER.name))
    run(compiler, f"/DVersion={VERSION}", f"/F{target.name}", str(HERE / "pinwarp.iss"))
    return target.with_name(target.name + ".exe")


def run(*command: str) -> None:
    """Run a program in the project's folder, and end with it where it fails."""
    subprocess.run(command, cwd=ROOT, check=True)


if __name__ == "__main__":
    main()
