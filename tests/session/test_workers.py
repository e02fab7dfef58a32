"""Processes and clusters that do not lose a task, whatever dies."""

from __future__ import annotations

import os
import signal
import tempfile
import time
from functools import partial
from pathlib import Path

import pytest
from tests.session.study import make_study

from pinwarp.core.errors import PinwarpError
from pinwarp.io.manifest import read_manifest
from pinwarp.io.summary_file import read_summary
from pinwarp.session import batch
from pinwarp.session.files import read_session
from pinwarp.session.workers import on_cluster, on_this_machine


def squared_unless_deadly(task):
    """Square a number; end the process at the deadly one."""
    if task == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return task * task


def deadly_once(task):
    """Square a number; end the process the first time it is the deadly one."""
    number, mark = task
    if number == 3 and not Path(mark).exists():
        Path(mark).write_text("")
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def slowly(function, marks, task):
    """Do something after a while, and leave a mark that it was begun."""
    descriptor, _ = tempfile.mkstemp(dir=marks)
    os.close(descriptor)
    time.sleep(0.15)
    return function(task)


def slow_task_id(task):
    """Say which process it was."""
    time.sleep(0.05)
    return task, os.getpid(), os.environ.get("NUMBA_NUM_THREADS")


def test_all_processes_work_each_on_one_core():
    results = dict(on_this_machine(slow_task_id, range(12), jobs=2))
    assert sorted(results) == list(range(12))
    assert len({pid for _, pid, _ in results.values()}) == 2
    assert os.getpid() not in {pid for _, pid, _ in results.values()}
    assert {threads for _, _, threads in results.values()} == {"1"}


def test_a_task_that_ends_its_process_is_the_only_one_that_fails():
    results = dict(on_this_machine(squared_unless_deadly, range(8), jobs=2))
    error = results.pop(3)
    assert isinstance(error, PinwarpError)
    assert "killed" in str(error)
    assert results == {task: task * task for task in range(8) if task != 3}


def test_a_process_that_is_killed_by_accident_costs_nothing(tmp_path):
    tasks = [(number, str(tmp_path / "mark")) for number in range(6)]
    results = dict(on_this_machine(deadly_once, tasks, jobs=2))
    assert results == {task: task[0] ** 2 for task in tasks}


def test_a_scheduler_that_does_not_answer_is_named(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("pinwarp.session.workers.ANSWERS_WITHIN", "1s")
    with pytest.raises(PinwarpError, match=r"No Dask scheduler answers at tcp://127.0.0.1:9"):
        list(on_cluster(abs, [1], scheduler="tcp://127.0.0.1:9"))


def test_without_the_package_for_clusters_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with pytest.raises(PinwarpError, match=r"pip install 'pinwarp\[cluster\]'"):
        list(on_cluster(abs, [1], scheduler="tcp://127.0.0.1:9"))


def test_a_batch_on_a_cluster_survives_the_death_of_a_worker(tmp_path):
    distributed = pytest.importorskip("distributed")
    manifest = read_manifest(make_study(tmp_path, 24))
    source = read_session(tmp_path / "study.pinwarp.csv")
    out = tmp_path / "out"
    tasks = batch.plan(manifest, source, out)
    marks = tmp_path / "marks"
    marks.mkdir()
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as watching,
    ):
        killed = []

        def kill_one_half_way(_task, status, _words):
            told.append(status)
            if len(told) == len(tasks) // 2:
                pid = next(iter(watching.run(os.getpid).values()))
                os.kill(pid, signal.SIGKILL)
                killed.append(pid)

        told: list[str] = []
        tally = batch.run(
            tasks,
            out,
            lambda function, rows: on_cluster(
                partial(slowly, function, marks), rows, scheduler=cluster.scheduler_address
            ),
            told=kill_one_half_way,
        )
    assert killed
    assert len(list(marks.iterdir())) > len(tasks), "what the dead worker was at is begun again"
    assert (tally.done, tally.failed, tally.is_interrupted) == (24, 0, False)
    summary = read_summary(out / "summary.csv")
    assert [row["status"] for row in summary.values()] == ["done"] * 24
    assert all(path.is_file() for task in tasks for path in task.outputs)
