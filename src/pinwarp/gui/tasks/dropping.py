"""Files that are dragged in from the outside."""

from __future__ import annotations

from pathlib import Path

from qtpy.QtGui import QDropEvent


def dropped_files(event: QDropEvent) -> list[Path]:
    """Return the files that an event brings, and accept it where there are any."""
    paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
    if paths:
        event.acceptProposedAction()
    return paths
