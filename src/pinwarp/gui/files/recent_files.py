"""The sessions opened last, remembered in the user's settings."""

from __future__ import annotations

import os
from pathlib import Path

from qtpy.QtCore import QSettings

_KEY = "recent_sessions"
_MOST = 8


class RecentFiles:
    """A short list of paths, newest first.

    Parameters
    ----------
    settings
        Where it is kept.
    """

    def __init__(self, settings: QSettings) -> None:
        self._settings = settings

    @property
    def paths(self) -> list[Path]:
        """The files that still exist, newest first."""
        stored = self._settings.value(_KEY, [])
        names = stored if isinstance(stored, list) else [stored]
        # Unlike Path.is_file, this never fails where a folder may not be looked into.
        return [Path(name) for name in names if isinstance(name, str) and os.path.isfile(name)]

    def add(self, path: Path) -> None:
        """Put a file first."""
        path = path.absolute()
        kept = [path, *(other for other in self.paths if other != path)][:_MOST]
        self._settings.setValue(_KEY, [str(p) for p in kept])

    def clear(self) -> None:
        """Forget all of them."""
        self._settings.remove(_KEY)
