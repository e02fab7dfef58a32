"""What must not be written over."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from pinwarp.core.errors import PinwarpError


def refuse_to_replace(inputs: Iterable[Path], outputs: Iterable[Path]) -> None:
    """Raise when an output is one of the inputs.

    Raises
    ------
    PinwarpError
        With the file's name and the way out.

    Examples
    --------
    >>> refuse_to_replace([Path("femur.ply")], [Path("warped/femur.ply")])
    """
    real = {os.path.realpath(path) for path in inputs}
    for path in outputs:
        if os.path.realpath(path) in real:
            raise PinwarpError(
                f"{path} would be replaced, but it is read: choose another folder for the output."
            )
