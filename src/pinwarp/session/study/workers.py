"""Doing the same to many things, in processes of this machine.

A runner takes a function and the tasks and yields each task with its result as they come, in any
order. Function and tasks are pickled; a task whose process died comes with the error instead.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import connection, get_context, parent_process
from typing import Protocol, TypeVar

from threadpoolctl import threadpool_limits

from pinwarp.core.errors import PinwarpError

T = TypeVar("T")
R = TypeVar("R")

# How soon it is noticed that no more is wanted, in seconds.
LOOKS_UP_EVERY = 0.2


class Runner(Protocol):
    """Does something to every task, in any order."""

    def __call__(
        self, function: Callable[[T], R], tasks: Sequence[T], /
    ) -> Generator[tuple[T, R | Exception]]:
        """Yield tasks and results as they come; raise WorkEnded where no more will."""


class WorkEnded(PinwarpError):
    """The work ended before all was done, by no fault of a task; what was done stays."""


def cores() -> int:
    """Return how many processes may run at once here.

    Examples
    --------
    >>> cores() >= 1
    True
    """
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def on_this_machine(
    function: Callable[[T], R],
    tasks: Sequence[T],
    *,
    jobs: int,
    stop: threading.Event | None = None,
) -> Generator[tuple[T, R | Exception]]:
    """Run tasks in processes of their own, each on one core.

    When a process dies, only the task it was at is lost.

    Parameters
    ----------
    function
        Importable by its name.
    tasks
        What it is called with.
    jobs
        How many processes; with 1 everything happens in this one.
    stop
        Once it is set nothing more is begun; what was begun is finished and yielded.

    Yields
    ------
    task, result

    Examples
    --------
    >>> list(on_this_machine(abs, [-1, 2], jobs=1))
    [(-1, 1), (2, 2)]
    """
    stop = stop or threading.Event()
    waiting = deque(tasks)
    while waiting and not stop.is_set():
        if jobs == 1:
            task = waiting.popleft()
            yield task, function(task)
            continue
        suspects = yield from _until_one_dies(function, waiting, min(jobs, len(waiting)), stop)
        for task in suspects:
            # Alone it is clear which of them ends its process.
            if (yield from _until_one_dies(function, deque([task]), 1, stop)):
                yield (
                    task,
                    PinwarpError(
                        "Its process ended without a word: it was killed, perhaps for want of "
                        "memory. Run fewer at once."
                    ),
                )


def _until_one_dies(
    function: Callable[[T], R], waiting: deque[T], jobs: int, stop: threading.Event
) -> Generator[tuple[T, R | Exception], None, list[T]]:
    """Run what waits; where a process dies, return what was begun and not finished."""
    pool = ProcessPoolExecutor(jobs, get_context("spawn"), initializer=_be_a_worker)
    running: dict[Future[R], T] = {}
    try:
        while running or (waiting and not stop.is_set()):
            # Not all at once: only what was begun is suspected when a process dies.
            while waiting and len(running) < 2 * jobs and not stop.is_set():
                with _without_ctrl_c():
                    running[pool.submit(function, waiting[0])] = waiting[0]
                waiting.popleft()
            for future in wait(running, LOOKS_UP_EVERY, FIRST_COMPLETED).done:
                result = future.result()
                yield running.pop(future), result
    except BrokenProcessPool:
        return list(running.values())
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
    return []


@contextlib.contextmanager
def _without_ctrl_c() -> Iterator[None]:
    """Put Ctrl+C off; a process that is started meanwhile never hears of it, not even at first."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _be_a_worker() -> None:
    """Leave Ctrl+C to the first process, end when it is gone, and keep to one core."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    keep_to_one_core()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)


def keep_to_one_core() -> None:
    """Let the processes share the cores, not their threads fight for them.

    Examples
    --------
    >>> keep_to_one_core()
    """
    threadpool_limits(1)
    if "numba" not in sys.modules:
        os.environ["NUMBA_NUM_THREADS"] = "1"
