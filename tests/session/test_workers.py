"""Processes that do not lose a task, whatever dies."""

from __future__ import annotations

import os
import signal
import threading
import time
from pathlib import Path

import pytest

from pinwarp.core.errors import PinwarpError
from pinwarp.session.study.workers import on_this_machine


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


@pytest.mark.parametrize("jobs", [1, 2])
def test_what_was_begun_is_finished_when_no_more_is_wanted(jobs):
    stop = threading.Event()
    done = []
    for task, result in on_this_machine(slow_task_id, range(50), jobs=jobs, stop=stop):
        done.append(task)
        assert result[0] == task
        stop.set()
    assert sorted(done) == list(range(len(done)))
    assert 1 <= len(done) <= 2 * jobs
