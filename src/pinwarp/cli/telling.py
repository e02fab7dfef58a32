"""What the commands say: results on standard output, everything else beside it."""

from __future__ import annotations

from collections.abc import Iterable

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from pinwarp.core.errors import readable

BAD_USAGE = 2
INTERRUPTED = 130


def tell_error(words: str) -> None:
    """Say on one line what went wrong."""
    typer.echo(f"pinwarp: {readable(' '.join(words.splitlines()))}", err=True)


def tell_notes(notes: Iterable[str], about: str = "") -> None:
    """Say what the user should know beside the result, a line each."""
    for note in notes:
        typer.echo(readable(f"{about}: {note}" if about else note), err=True)


def progress_bar() -> Progress:
    """Return a bar for many files; it shows itself only on a terminal."""
    console = Console(stderr=True)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=console,
        transient=True,
        disable=not console.is_terminal,
    )


def counted(count: int, thing: str) -> str:
    """Return a number with its noun.

    Examples
    --------
    >>> counted(1, "pair"), counted(1200, "pair")
    ('1 pair', '1,200 pairs')
    """
    return f"{count:,} {thing}{'' if count == 1 else 's'}"
