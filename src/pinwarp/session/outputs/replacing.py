"""What must not be written over."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from pinwarp.core.errors import PinwarpError


def refuse_to_replace(inputs: Iterable[Path], outputs: Iterable[Path]) -> None:
    """Raise when an output is one of the inputs, by whichever name.

    Raises
    ------
    PinwarpError
        With the file's name and the way out.

    Examples
    --------
    >>> refuse_to_replace([Path("femur.ply")], [Path("warped/femur.ply")])
    """
    # Names alone do not tell: many systems take upper and lower case for one.
    read = {_identity(path) for path in inputs}
    for path in outputs:
        if _identity(path) in read:
            raise PinwarpError(
                f"{path} would be replaced, but it is read: choose another folder for the output."
            )


def _identity(path: Path) -> object:
    """Return what tells a file from others: its number, or its place while it is not there."""
    try:
        found = path.stat()
    except OSError:
        return os.path.realpath(path)
    return found.st_dev, found.st_ino
