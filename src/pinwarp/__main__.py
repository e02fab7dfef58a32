"""The program: puts the command line and the window together."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from pinwarp.cli.app import make_app


def main() -> None:
    """Run the ``pinwarp`` command."""
    make_app(_open_window)()


def _open_window(
    *,
    session: Path | None,
    source: Path | None,
    destination: Path | None,
    source_landmarks: Path | None,
    destination_landmarks: Path | None,
    demo: bool,
    screenshot: Path | None,
) -> int:
    on_x11 = sys.platform.startswith("linux") and "QT_QPA_PLATFORM" not in os.environ
    if on_x11 and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        print(
            "pinwarp: there is no display. Run it on a desktop, or under a virtual one:\n"
            "    xvfb-run -a -s '-screen 0 1920x1080x24' pinwarp --demo --screenshot demo.png",
            file=sys.stderr,
        )
        return 2
    # Qt and VTK are loaded only once a window is wanted.
    os.environ.setdefault("QT_API", "pyside6")
    from pinwarp.gui.app import run
    from pinwarp.gui.documents import Opening

    opening = Opening(session, source, destination, source_landmarks, destination_landmarks)
    return run(opening, demo=demo, screenshot=screenshot)


if __name__ == "__main__":
    main()
