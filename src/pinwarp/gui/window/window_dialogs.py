"""All that a window may ask; handed in, so that tests can answer."""

from __future__ import annotations

from pinwarp.gui.files.file_dialogs import FileDialogs
from pinwarp.gui.importing.import_dialogs import ImportDialogs
from pinwarp.gui.model.model_dialogs import ModelDialogs


class WindowDialogs(FileDialogs, ImportDialogs, ModelDialogs):
    """The real dialogs, over one window."""
