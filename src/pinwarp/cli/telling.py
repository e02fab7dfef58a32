"""What the commands say: results on standard output, everything else beside it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import typer

from pinwarp.core.errors import PinwarpError, readable

BAD_USAGE = 2
INTERRUPTED = 130


def tell_error(words: str) -> None:
    """Say on one line what went wrong."""
    typer.echo(f"pinwarp: {readable(' '.join(words.splitlines()))}", err=True)


def tell_notes(notes: Iterable[str], about: str = "") -> None:
    """Say what the user should know beside the result, a line each."""
    for note in notes:
        typer.echo(readable(f"{about}: {note}" if about else note), err=True)


def refuse_existing(outputs: Sequence[Path], force: bool) -> None:
    """Raise where an output is there already and replacing it was not asked for.

    Raises
    ------
    PinwarpError
        With the first of them and the way out.
    """
    there = [path for path in outputs if path.exists()]
    if there and not force:
        more = f" (and {len(there) - 1} more)" if len(there) > 1 else ""
        raise PinwarpError(f"{there[0]}{more} is there already: use --force to replace it.")
