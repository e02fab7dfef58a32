"""All that a window may ask; handed in, so that tests can answer."""

from __future__ import annotations

from pinwarp.gui.files.file_dialogs import FileDialogs
from pinwarp.gui.importing.import_dialogs import ImportDialogs


class WindowDialogs(FileDialogs, ImportDialogs):
    """The real dialogs, over one window."""
