"""Bars that show how far a command is."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn


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


@contextlib.contextmanager
def stage_bar() -> Iterator[Callable[[float, str], None]]:
    """Show one piece of work by its share and stage, and give what is called with them."""
    with progress_bar() as progress:
        bar = progress.add_task("", total=1.0)

        def told(share: float, words: str) -> None:
            progress.update(bar, completed=share, description=words.capitalize())

        yield told
