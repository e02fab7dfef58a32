"""Unsaved work on the disk: a session file with one more line, which says what it is."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.io.session_file import SessionRecord, read_session, write_session

_KEY = "unsaved_work"


@dataclass(frozen=True)
class UnsavedWork:
    """What no file of the user's holds yet.

    Parameters
    ----------
    record
        The session.
    path
        The file that it came from or was last saved to, absolute.
    sha256
        The hash of that file as it was then.
    label
        What was done last, in the words of the Edit menu.
    edited
        When, with its time zone.
    guided
        The landmark that the guide asked for; None without a guide.
    """

    record: SessionRecord
    path: Path | None
    sha256: str | None
    label: str | None
    edited: datetime
    guided: str | None = None


def write_work(path: Path, work: UnsavedWork) -> None:
    """Write unsaved work; whoever is killed meanwhile leaves the version before.

    It can be opened as a session too, should everything else fail. Meshes are named by their
    absolute paths.

    Raises
    ------
    PinwarpError, OSError
        As :func:`~pinwarp.io.session_file.write_session`.
    """
    about = {
        "path": str(work.path) if work.path is not None else None,
        "sha256": work.sha256,
        "label": work.label,
        "edited": work.edited.isoformat(),
        "guided": work.guided,
    }
    others = tuple(entry for entry in work.record.unknown if entry[0] != _KEY)
    record = replace(work.record, unknown=(*others, (_KEY, json.dumps(about))))
    write_session(path, record, relative_meshes=False)


def read_work(path: Path) -> UnsavedWork:
    """Read unsaved work.

    Raises
    ------
    FileFormatError
        When anything in it cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> edited = datetime.fromisoformat("2024-11-22T14:03:00+01:00")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "work.pinwarp.csv")
    ...     write_work(path, UnsavedWork(SessionRecord(unit="m"), None, None, "Unit m", edited))
    ...     work = read_work(path)
    >>> work.record.unit, work.label, work.edited == edited
    ('m', 'Unit m', True)
    """
    record = read_session(path)
    others = tuple(entry for entry in record.unknown if entry[0] != _KEY)
    try:
        about = json.loads(dict(record.unknown)[_KEY])
        return UnsavedWork(
            record=replace(record, unknown=others),
            path=Path(about["path"]) if about["path"] is not None else None,
            sha256=about["sha256"],
            label=about["label"],
            edited=datetime.fromisoformat(about["edited"]),
            # Versions before did not keep it.
            guided=about.get("guided"),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise FileFormatError(path, "This session says nothing of unsaved work.") from error
