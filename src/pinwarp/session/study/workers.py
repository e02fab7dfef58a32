"""Doing the same to many things: in processes of this machine, or on a Dask cluster.

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
from functools import partial
from multiprocessing import connection, get_context, parent_process
from typing import Any, Protocol, TypeVar

from threadpoolctl import threadpool_limits

from pinwarp.core.errors import PinwarpError

T = TypeVar("T")
R = TypeVar("R")

# How often a task is begun again when it ends by an exception of the cluster.
RETRIES = 2
ANSWERS_WITHIN = "15s"
# How soon it is noticed that no more is wanted, in seconds.
LOOKS_UP_EVERY = 0.2


class Runner(Protocol):
    """Does something to every task, in any order."""

    def __call__(
        self, function: Callable[[T], R], tasks: Sequence[T], /
    ) -> Generator[tuple[T, R | Exception]]:
        """Yield tasks and results as they come."""


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
    _keep_to_one_core()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)


def _keep_to_one_core() -> None:
    """Let the processes share the cores, not their threads fight for them."""
    threadpool_limits(1)
    if "numba" not in sys.modules:
        os.environ["NUMBA_NUM_THREADS"] = "1"


def on_cluster(
    function: Callable[[T], R],
    tasks: Sequence[T],
    *,
    scheduler: str,
    stop: threading.Event | None = None,
) -> Generator[tuple[T, R | Exception]]:
    """Run tasks on a Dask cluster that is there already.

    What a worker was at when it died is begun again by another.

    Parameters
    ----------
    function
        Importable by its name where the workers are.
    tasks
        What it is called with.
    scheduler
        The address, such as ``tcp://10.0.0.1:8786``.
    stop
        Once it is set what is not done yet is cancelled.

    Yields
    ------
    task, result

    Raises
    ------
    PinwarpError
        When ``distributed`` is not installed, or no scheduler answers.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise PinwarpError(
            "Clusters need the package 'distributed': pip install 'pinwarp[cluster]'."
        ) from None
    try:
        client = Client(scheduler, timeout=ANSWERS_WITHIN, set_as_default=False)
    except (OSError, ValueError) as error:
        raise PinwarpError(f"No Dask scheduler answers at {scheduler}: {error}") from error
    stop = stop or threading.Event()
    futures: list[Any] = []
    try:
        futures = client.map(partial(_on_one_core, function), tasks, pure=False, retries=RETRIES)
        task_of = dict(zip((future.key for future in futures), tasks, strict=True))
        done = as_completed(futures, loop=client.loop)
        while done.count() and not stop.is_set():
            if not done.has_ready():
                stop.wait(LOOKS_UP_EVERY)
                continue
            future = next(done)
            yield task_of[future.key], _result(future)
            future.release()
    finally:
        client.cancel([future for future in futures if not future.done()])
        client.close()


def _on_one_core(function: Callable[[T], R], task: T) -> R:
    _keep_to_one_core()
    return function(task)


def _result(future: Any) -> Any:
    try:
        return future.result()
    except Exception as error:  # whatever ended it is this task's result; the others go on
        return error


def runner_of(jobs: int, scheduler: str | None, stop: threading.Event | None = None) -> Runner:
    """Return the runner for a cluster where one is named, else for this machine.

    Examples
    --------
    >>> list(runner_of(1, None)(len, ["ab"]))
    [('ab', 2)]
    """
    if scheduler is not None:
        return partial(on_cluster, scheduler=scheduler, stop=stop)
    return partial(on_this_machine, jobs=jobs, stop=stop)
