"""Doing the same to many subjects from the command line: progress, Ctrl+C and how it ended."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated

import typer

from pinwarp.cli.bars import progress_bar
from pinwarp.cli.telling import INTERRUPTED, tell, tell_error, tell_notes
from pinwarp.session.study import running
from pinwarp.session.study.cluster import runner_of
from pinwarp.session.study.workers import Runner, cores

FAILED = 1
CLUSTER_LOST = 3

Jobs = Annotated[
    int | None,
    typer.Option(min=1, help="Processes at once; without it one for each core."),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Do the work on the Dask cluster of this scheduler, such as "
        "tcp://10.0.0.1:8786. Its workers read and write the files themselves: all paths "
        "must lead to the same files there. Needs pinwarp\\[cluster].",
    ),
]
Again = Annotated[bool, typer.Option("--force", help="Do subjects again that have not changed.")]


def do_all(
    run: Callable[[Runner, running.Told], running.Tally],
    total: int,
    out: Path,
    jobs: int | None,
    scheduler: str | None,
) -> None:
    """Run a batch, tell how it goes and how it ended, and exit accordingly.

    Parameters
    ----------
    run
        Does it, with the runner and with what is to be called after each subject.
    total
        How many subjects there are.
    out
        Where the table of results is.
    jobs, scheduler
        Where the work is done: so many processes of this machine, or a cluster.

    Raises
    ------
    Exit
        With 1 where a subject failed, 3 where the cluster was lost, 130 after Ctrl+C.
    """
    with progress_bar() as progress, _stopped_by_signals() as stop:
        bar = progress.add_task("Warping", total=total)

        def told(task: running.Job, status: str, words: str) -> None:
            progress.advance(bar)
            if status == running.FAILED:
                tell_error(f"{task.subject.name}: {words}")

        runner = runner_of(jobs or cores(), scheduler, stop, lambda words: tell_notes([words]))
        tally = run(runner, told)
    tell(
        f"{tally.done} done, {tally.unchanged} unchanged, {tally.failed} failed "
        f"of {tally.total}: see {out / running.SUMMARY}"
    )
    if tally.is_interrupted:
        why = tally.ended or "Stopped."
        tell_error(f"{why} What was done stays: the same command goes on from there.")
        raise typer.Exit(CLUSTER_LOST if tally.ended else INTERRUPTED)
    if tally.failed:
        raise typer.Exit(FAILED)


@contextlib.contextmanager
def _stopped_by_signals() -> Iterator[threading.Event]:
    """Give an event that Ctrl+C sets, and SIGTERM, by which a cluster's queue ends a job.

    Nothing is interrupted at an unlucky moment; whoever presses Ctrl+C again means it.
    """
    stop = threading.Event()

    def handle(_number: int, _frame: object) -> None:
        if stop.is_set():
            raise KeyboardInterrupt
        stop.set()

    if threading.current_thread() is not threading.main_thread():
        yield stop
        return
    before = {number: signal.signal(number, handle) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
