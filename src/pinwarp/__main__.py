"""The program: puts the command line and the window together."""

from __future__ import annotations

import contextlib
import os
import re
import socket
import sys
from pathlib import Path

from pinwarp.cli.app import make_app
from pinwarp.cli.telling import spell_what_is_not_in_the_encoding

# Qt draws into memory, and VTK by no window system; neither is to complain of what is missing.
_WITHOUT_DISPLAY = {
    "QT_QPA_PLATFORM": "offscreen",
    "QT_LOGGING_RULES": "default.warning=false",
    "VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow",
}


def main() -> None:
    """Run the ``pinwarp`` command."""
    spell_what_is_not_in_the_encoding()
    make_app(_open_window)()


def _open_window(
    *,
    session: Path | None,
    model: Path | None,
    source: Path | None,
    destination: Path | None,
    source_landmarks: Path | None,
    destination_landmarks: Path | None,
    passengers: Path | None,
    demo: bool,
    screenshot: Path | None,
) -> int:
    if not _has_display():
        if screenshot is None:
            print(
                "pinwarp: there is no display. Without one it only draws pictures:\n"
                "    pinwarp --demo --screenshot demo.png",
                file=sys.stderr,
            )
            return 2
        os.environ.update(_WITHOUT_DISPLAY)
    # Qt and VTK are loaded only once a window is wanted.
    os.environ.setdefault("QT_API", "pyside6")
    try:
        from pinwarp.gui.app import run
        from pinwarp.gui.files.documents import Opening
    except ImportError as error:
        library = re.match(r"(lib\S+\.so\S*): cannot open", str(error))
        if library is None:
            raise
        print(
            f"pinwarp: the window needs {library[1]}, which comes with the system and is missing "
            "here. On Debian and Ubuntu:\n"
            "    sudo apt install libgl1 libegl1 libfontconfig1 fonts-dejavu-core",
            file=sys.stderr,
        )
        return 2

    landmarks = (source_landmarks, destination_landmarks)
    opening = Opening(session, source, destination, *landmarks, model, passengers)
    return run(opening, demo=demo, screenshot=screenshot)


def _has_display() -> bool:
    """Say whether a window can open; Qt would abort with a misleading message."""
    if not sys.platform.startswith("linux") or "QT_QPA_PLATFORM" in os.environ:
        return True
    if os.environ.get("WAYLAND_DISPLAY"):
        return True
    display = os.environ.get("DISPLAY", "")
    local = re.fullmatch(r"(?:unix)?:(\d+)(?:\.\d+)?", display)
    if local is None:
        return bool(display)
    # A display of this machine listens at a socket by its number, in the file system or without.
    place = f"/tmp/.X11-unix/X{local[1]}"
    for address in (place, "\0" + place):
        with socket.socket(socket.AF_UNIX) as probe, contextlib.suppress(OSError):
            probe.connect(address)
            return True
    return False


if __name__ == "__main__":
    main()
