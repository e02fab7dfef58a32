"""How the project's own files are called."""

from __future__ import annotations

from pathlib import Path

SESSION_SUFFIX = ".pinwarp.csv"


def is_session(path: Path) -> bool:
    """Say by its name whether a file is a session.

    Examples
    --------
    >>> is_session(Path("left.pinwarp.csv")), is_session(Path("left.csv"))
    (True, False)
    """
    return path.name.lower().endswith(SESSION_SUFFIX)
