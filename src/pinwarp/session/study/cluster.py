"""Doing the same to many things on a Dask cluster that is there already.

A worker that dies costs nothing, a task that kills worker after worker only itself. While nobody
can work it is told what is waited for; when the scheduler is gone the work ends in a sentence.
"""

from __future__ import annotations

import asyncio
import pickle
import threading
import warnings
from collections import deque
from collections.abc import Callable, Generator, Sequence
from functools import partial
from typing import Any, TypeVar

import pinwarp
from pinwarp.core.errors import PinwarpError
from pinwarp.session.study.crew import Crew
from pinwarp.session.study.scheduler import address_of, connected
from pinwarp.session.study.workers import (
    LOOKS_UP_EVERY,
    Runner,
    WorkEnded,
    keep_to_one_core,
    on_this_machine,
)

T = TypeVar("T")
R = TypeVar("R")

# How often a task is begun again when it ends by an exception of the cluster.
RETRIES = 2
# How long a result may be on its way until others are looked at, in seconds.
FETCHED_WITHIN = 5.0
# How long nobody can work before it is told, in seconds.
PATIENCE = 3.0


def runner_of(
    jobs: int,
    scheduler: str | None,
    stop: threading.Event | None = None,
    told: Callable[[str], None] = lambda _words: None,
) -> Runner:
    """Return the runner for a cluster where one is named, else for this machine.

    Examples
    --------
    >>> list(runner_of(1, None)(len, ["ab"]))
    [('ab', 2)]
    """
    if scheduler is not None:
        return partial(on_cluster, scheduler=scheduler, stop=stop, told=told)
    return partial(on_this_machine, jobs=jobs, stop=stop)


def on_cluster(
    function: Callable[[T], R],
    tasks: Sequence[T],
    *,
    scheduler: str,
    stop: threading.Event | None = None,
    told: Callable[[str], None] = lambda _words: None,
    patience: float = PATIENCE,
) -> Generator[tuple[T, R | Exception]]:
    """Run tasks on a Dask cluster that is there already.

    What a worker was at when it died is begun again by another. A task that has killed as many
    workers as the cluster allows comes with the error.

    Parameters
    ----------
    function
        Importable by its name where the workers are.
    tasks
        What it is called with.
    scheduler
        The address, such as ``tcp://10.0.0.1:8786``.
    stop
        Once it is set nothing more is waited for, and what was not begun is not.
    told
        Called with a sentence when nobody can work, and why.
    patience
        How long nobody can work before it is told, in seconds.

    Yields
    ------
    task, result

    Raises
    ------
    PinwarpError
        When ``distributed`` is not installed, the address is none, or no scheduler answers there.
    WorkEnded
        When the scheduler is gone before all is done.
    """
    address = address_of(scheduler)
    if not tasks:
        return
    stop = stop or threading.Event()
    with connected(address) as client:
        crew = Crew(client, address, stop, told, patience)
        yield from _Work(client, crew, function, tasks).done(stop)


class _Work:
    """What is waiting, what is running, and what may be killing workers."""

    def __init__(
        self, client: Any, crew: Crew, function: Callable[[Any], Any], tasks: Sequence[Any]
    ) -> None:
        from distributed import as_completed

        self._client, self._crew = client, crew
        self._function = function
        self._waiting = deque(tasks)
        self._suspects: deque[Any] = deque()
        self._running: dict[Any, tuple[Any, frozenset[str], bool]] = {}
        self._completed = as_completed([], loop=client.loop)

    def done(self, stop: threading.Event) -> Generator[tuple[Any, Any]]:
        """Yield tasks and results as they come."""
        while (self._waiting or self._running or self._suspects) and not stop.is_set():
            if self._client.status != "running":
                raise self._lost()
            self._crew.look()
            self._take_back()
            self._submit()
            if not self._completed.has_ready():
                stop.wait(LOOKS_UP_EVERY)
                continue
            future = next(self._completed)
            if future.key in self._running:
                yield from self._finish(future)

    def _submit(self) -> None:
        """Submit all at once, so that a cluster that grows with its work grows."""
        crew = self._crew
        if not crew.unable:
            self._begin(self._waiting, len(self._waiting))
        else:
            # In portions: an able worker that comes later gets of the next.
            room = 2 * sum(crew.threads[worker] for worker in crew.able)
            self._begin(self._waiting, room - len(self._running))
        if not (self._waiting or self._running) and (crew.able or not crew.unable):
            # Alone it is clear who kills the workers, and who was only near.
            self._begin(self._suspects, 1)

    def _begin(self, queue: deque[Any], count: int) -> None:
        tasks = [queue.popleft() for _ in range(min(count, len(queue)))]
        if not tasks:
            return
        workers = self._crew.able if self._crew.unable else frozenset()
        calls = [pickle.dumps(_Call(self._function, task)) for task in tasks]
        with warnings.catch_warnings():
            # That many small tasks are large together is no surprise.
            warnings.simplefilter("ignore")
            futures = self._client.map(
                pickle.loads, calls, pure=False, retries=RETRIES, workers=sorted(workers) or None
            )
        is_alone = len(tasks) == 1 and not (self._running or self._waiting)
        for task, future in zip(tasks, futures, strict=True):
            self._running[future.key] = (task, workers, is_alone)
            self._completed.add(future)

    def _take_back(self) -> None:
        """Let those wait again who may only be done by workers that are all gone."""
        there = self._crew.threads.keys()
        for key, (task, workers, _) in list(self._running.items()):
            if workers and there and not workers & there:
                del self._running[key]
                self._waiting.append(task)

    def _finish(self, future: Any) -> Generator[tuple[Any, Any]]:
        from distributed import KilledWorker

        result = self._fetched(future)
        if future.status == "cancelled" or self._client.status != "running":
            raise self._lost()
        is_late = future.status == "finished" and isinstance(result, TimeoutError)
        if is_late or future.status not in ("finished", "error"):
            # Its worker died, or stopped, with the result: that is made again, or comes later.
            self._completed.add(future)
            return
        task, workers, is_alone = self._running.pop(future.key)
        future.release()
        if isinstance(result, KilledWorker):
            if not is_alone:
                self._suspects.append(task)
                return
            result = PinwarpError(
                f"{result.allowed_failures + 1} workers died while they were at it: perhaps for "
                f"want of memory. The last was {result.last_worker.address}; its log may say more."
            )
        elif isinstance(result, Exception) and not workers:
            self._crew.look(ask_again=True)
            if self._crew.unable:
                self._waiting.append(task)
                return
        yield task, result

    def _fetched(self, future: Any) -> Any:
        """Return the result or the error of a task."""
        try:
            return future.result(timeout=FETCHED_WITHIN)
        except (Exception, asyncio.CancelledError) as error:  # the others go on
            return error

    def _lost(self) -> WorkEnded:
        return WorkEnded(f"The scheduler at {self._crew.address} is gone, or was restarted.")


class _Call:
    """A call that happens when it is unpickled.

    What is sent may thus be read by any worker and scheduler: a worker that met names it does not
    know in a message would end, and with it whatever else it does.
    """

    def __init__(self, function: Callable[[Any], Any], task: Any) -> None:
        self._arguments = function, task, pinwarp.__version__

    def __reduce__(self) -> tuple[Any, ...]:
        return _on_one_core, self._arguments


def _on_one_core(function: Callable[[T], R], task: T, version: str) -> R:
    if version != pinwarp.__version__:
        raise PinwarpError(f"The worker has pinwarp {pinwarp.__version__}, not {version}.")
    keep_to_one_core()
    return function(task)
