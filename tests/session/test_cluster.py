"""A real Dask scheduler and real workers: who is missing is told, who dies costs little."""

from __future__ import annotations

import os
import signal
import socket
import threading

import pytest
from tests.session.dask_processes import DaskProcesses

from pinwarp.core.errors import PinwarpError
from pinwarp.session.study.cluster import on_cluster
from pinwarp.session.study.scheduler import address_of
from pinwarp.session.study.workers import WorkEnded

pytestmark = pytest.mark.skipif(os.name != "posix", reason="groups of processes are POSIX")
pytest.importorskip("distributed")

SOON = 0.5


@pytest.fixture
def dask(tmp_path):
    processes = DaskProcesses(tmp_path)
    yield processes
    processes.kill_all()


@pytest.fixture
def hiding(tmp_path):
    """A folder in which something else is called pinwarp."""

    def make(content):
        package = tmp_path / "hiding" / "pinwarp"
        package.mkdir(parents=True)
        (package / "__init__.py").write_text(content)
        return package.parent

    return make


MISSING = "raise ModuleNotFoundError(\"No module named 'pinwarp'\", name='pinwarp')"


def squared_unless_deadly(task):
    """Square a number; end the process at the deadly one."""
    if task == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return task * task


def slow_square(task):
    """Square a number after a while."""
    threading.Event().wait(0.1)
    return task * task


def test_who_is_waited_for_is_told_and_the_work_begins_when_a_worker_comes(dask, hiding):
    # The scheduler itself need know nothing of what is done.
    dask.start_scheduler(hiding=hiding(MISSING))
    told = []

    def start_a_worker(words):
        if not told:
            dask.start_worker("--no-nanny")
        told.append(words)

    on = {"scheduler": dask.address, "told": start_a_worker, "patience": SOON}
    assert sorted(on_cluster(slow_square, [1, 2], **on)) == [(1, 1), (2, 4)]
    assert told == [
        f"No worker is connected to {dask.address}. Waiting for one: start it with "
        f"'dask worker {dask.address}'; Ctrl+C ends it, and what was done stays."
    ]


def test_a_dead_worker_is_missed_and_replaced_in_the_middle_of_the_work(dask):
    dask.start_scheduler()
    first = dask.start_worker("--no-nanny")
    told = []

    def start_another(words):
        told.append(words)
        if results:
            dask.start_worker("--no-nanny")

    results = {}
    tasks = range(40)
    on = {"scheduler": dask.address, "told": start_another, "patience": SOON}
    for task, result in on_cluster(slow_square, tasks, **on):
        if not results:
            dask.kill(first)
        results[task] = result
    assert results == {task: task * task for task in tasks}
    assert "No worker is connected" in told[-1]


def test_nobody_who_was_near_fails_with_the_task_that_kills_the_workers(dask):
    dask.start_scheduler()
    # A nanny starts a new worker for each that dies.
    dask.start_worker("--nworkers", "1", "--nthreads", "2")
    results = dict(on_cluster(squared_unless_deadly, range(6), scheduler=dask.address))
    error = results.pop(1)
    assert isinstance(error, PinwarpError)
    assert str(error).startswith(
        "2 workers died while they were at it: perhaps for want of memory."
    )
    assert results == {task: task * task for task in (0, 2, 3, 4, 5)}


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (MISSING, "cannot import pinwarp: No module named 'pinwarp'"),
        ("__version__ = '0.0.1'", "have pinwarp 0.0.1, not "),
    ],
)
def test_workers_that_cannot_be_used_are_told_and_others_do_all_the_work(
    dask, hiding, content, why
):
    dask.start_scheduler()
    dask.start_worker("--no-nanny", hiding=hiding(content))
    told = []

    def start_a_better_one(words):
        told.append(words)
        if f"The workers of {dask.address} {why}" in words:
            dask.start_worker("--no-nanny")

    on = {"scheduler": dask.address, "told": start_a_better_one, "patience": SOON}
    results = dict(on_cluster(slow_square, range(8), **on))
    assert results == {task: task * task for task in range(8)}
    assert any("Waiting for one that can be used: install pinwarp" in words for words in told)


def test_a_scheduler_that_dies_ends_the_work_in_one_sentence(dask, capfd):
    scheduler = dask.start_scheduler()
    dask.start_worker("--no-nanny")
    results = on_cluster(slow_square, range(200), scheduler=dask.address)
    task, result = next(results)
    assert result == task * task
    dask.kill(scheduler)
    with pytest.raises(WorkEnded, match=f"at {dask.address} is gone, or was restarted.$"):
        list(results)
    assert capfd.readouterr().err == ""


def test_waiting_for_a_worker_can_be_stopped(dask):
    dask.start_scheduler()
    stop = threading.Event()
    on = {"scheduler": dask.address, "stop": stop, "patience": SOON}
    assert list(on_cluster(abs, [1], told=lambda _words: stop.set(), **on)) == []


def test_a_scheduler_that_stops_answering_is_told_and_need_not_be_waited_for(dask, monkeypatch):
    monkeypatch.setattr("pinwarp.session.study.crew.ANSWERS_WITHIN", SOON)
    scheduler = dask.start_scheduler()
    dask.start_worker("--no-nanny")
    stop = threading.Event()
    told = []

    def stop_then(words):
        if results:
            told.append(words)
            stop.set()

    results = []
    on = {"scheduler": dask.address, "stop": stop, "told": stop_then, "patience": SOON}
    for result in on_cluster(slow_square, range(200), **on):
        if not results:
            os.killpg(scheduler.pid, signal.SIGSTOP)
        results.append(result)
    assert told[0].startswith(f"The scheduler at {dask.address} does not answer.")
    assert len(results) < 200


def test_an_address_that_nobody_listens_at_is_named():
    with socket.create_server(("127.0.0.1", 0)) as free:
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    with pytest.raises(PinwarpError, match=f"No Dask scheduler answers at {address}: .*refused"):
        list(on_cluster(abs, [1], scheduler=address))


def test_a_program_that_is_no_scheduler_is_not_waited_for(monkeypatch):
    monkeypatch.setattr("pinwarp.session.study.scheduler.ANSWERS_WITHIN", SOON)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(PinwarpError, match=f"answers at {address} is no Dask scheduler"):
            list(on_cluster(abs, [1], scheduler=address))


def test_without_the_package_for_clusters_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with pytest.raises(PinwarpError, match=r"pip install 'pinwarp\[cluster\]'"):
        list(on_cluster(abs, [1], scheduler="tcp://127.0.0.1:9"))


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "the host is missing"),
        ("tcp://", "the host is missing"),
        ("tcp://:8786", "the host is missing"),
        ("node7", "the port is missing or no number"),
        ("tcp://node7:", "the port is missing or no number"),
        ("tcp://node7:0", "the port is missing or no number"),
        ("tcp://node7:99999", "the port is missing or no number"),
        ("tcp://node7:dask", "more or less in it than host and port"),
        ("tcp://node7:8786/status", "more or less in it than host and port"),
        ("tcp://me@node7:8786", "more or less in it than host and port"),
        ("tcp://[::1:8786", "more or less in it than host and port"),
        ("::1:8786", "more or less in it than host and port"),
        ("http://node7:8787", "it begins with 'http'"),
        ("tcp://node 7:8786", "no host can be called so"),
        ("tcp://a..b:8786", "no host can be called so"),
    ],
)
def test_an_address_that_is_none_is_refused_before_anybody_is_asked(text, why):
    with pytest.raises(PinwarpError, match=f"is no address of a scheduler: .*{why}"):
        address_of(text)


@pytest.mark.parametrize("text", ["tcp://10.0.0.1:8786", "tls://node-7.lab:8786", "ws://[::1]:80"])
def test_an_address_stays_as_it_is(text):
    assert address_of(text) == text
