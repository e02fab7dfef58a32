"""Work off the UI thread."""

from __future__ import annotations

import gc
import threading
import time

import pytest
from qtpy.QtCore import QTimer
from qtpy.QtWidgets import QStatusBar

from pinwarp.core.errors import Cancelled
from pinwarp.gui.tasks.jobs import LatestWins, SlowJob
from pinwarp.gui.tasks.progress import JobProgress


@pytest.fixture
def gate():
    event = threading.Event()
    yield event
    event.set()


def test_only_the_newest_of_many_requests_is_computed(qapp, qtbot, gate):
    started = []

    def compute(request):
        started.append(request)
        gate.wait(5)
        return request

    jobs, arrived = LatestWins(compute), []
    jobs.computed.connect(arrived.append)
    for request in range(20):
        jobs.request(request)
    qtbot.waitUntil(lambda: started == [0])
    gate.set()
    qtbot.waitUntil(lambda: jobs.is_idle)
    assert started == [0, 19]
    assert arrived == [0, 19]
    jobs.shut_down()


def test_something_that_can_wait_is_dropped_while_busy(qapp, qtbot, gate):
    jobs, arrived = LatestWins(lambda request: gate.wait(5) and request), []
    jobs.computed.connect(arrived.append)
    jobs.request("first")
    jobs.request_if_idle("later")
    gate.set()
    qtbot.waitUntil(lambda: jobs.is_idle)
    assert arrived == ["first"]
    jobs.shut_down()


def test_an_error_arrives_as_such_and_the_next_request_goes_on(qapp, qtbot):
    def compute(request):
        if request == "bad":
            raise ValueError(request)
        return request

    jobs, arrived, errors = LatestWins(compute), [], []
    jobs.computed.connect(arrived.append)
    jobs.failed.connect(errors.append)
    jobs.request("bad")
    qtbot.waitUntil(lambda: len(errors) == 1)
    jobs.request("good")
    qtbot.waitUntil(lambda: arrived == ["good"])
    jobs.shut_down()


def test_a_result_that_comes_after_closing_goes_nowhere(qapp, qtbot, gate):
    jobs, arrived = LatestWins(lambda request: gate.wait(5) and request), []
    jobs.computed.connect(arrived.append)
    jobs.request("late")
    gate.set()
    jobs.shut_down()
    qapp.processEvents()
    assert arrived == []


@pytest.mark.parametrize("kind", [LatestWins, SlowJob])
def test_a_result_that_is_on_its_way_when_the_window_closes_goes_nowhere(qapp, kind):
    arrived, computed = [], threading.Event()

    def compute(_request):
        computed.set()
        return "late"

    if kind is LatestWins:
        jobs = LatestWins(compute)
        jobs.computed.connect(arrived.append)
        jobs.request("any")
    else:
        jobs = SlowJob()
        jobs.run("any", compute, arrived.append, arrived.append)
    assert computed.wait(60)
    # Time for the worker to hand it over, but no event loop to take it.
    time.sleep(0.2)
    jobs.shut_down()
    qapp.processEvents()
    assert arrived == []


def test_slow_jobs_run_in_order_with_progress_and_can_be_cancelled(qapp, qtbot, gate):
    jobs, log = SlowJob(), []
    jobs.progressed.connect(lambda _share, stage: log.append(stage))

    def long_work(progress):
        progress(0.1, "begun")
        gate.wait(5)
        progress(0.9, "nearly done")
        return "never"

    jobs.run("Long", long_work, log.append, lambda error: log.append(type(error)))
    qtbot.waitUntil(lambda: log == ["begun"])
    jobs.cancel()
    gate.set()
    qtbot.waitUntil(lambda: jobs.is_idle)
    assert log == ["begun", Cancelled]
    jobs.run("Short", lambda _progress: "done", log.append, log.append)
    qtbot.waitUntil(lambda: log[-1] == "done")
    jobs.shut_down()


def test_a_job_that_ends_before_its_bar_is_due_shows_none(qapp, qtbot, gate):
    place, jobs = QStatusBar(), SlowJob()
    qtbot.addWidget(place)
    progress = JobProgress(place, [jobs])
    due = progress.findChild(QTimer)
    due.setInterval(60_000)
    jobs.run("Short", lambda _progress: None, lambda _done: None, lambda _error: None)
    assert due.isActive()
    qtbot.waitUntil(lambda: jobs.is_idle)
    assert not due.isActive()
    assert progress.bar.isHidden()
    due.setInterval(1)
    jobs.run("Long", lambda _progress: gate.wait(30), lambda _done: None, lambda _error: None)
    qtbot.waitUntil(lambda: not progress.bar.isHidden())
    assert not progress.cancel.isHidden()
    gate.set()
    qtbot.waitUntil(lambda: jobs.is_idle)
    assert progress.bar.isHidden()
    jobs.shut_down()


def test_nothing_is_kept_of_what_has_run(qapp, qtbot):
    """PySide keeps some of what runs in Qt's pool for ever when the machine is busy."""
    stop = threading.Event()

    def be_busy():
        while not stop.is_set():
            sum(range(1000))

    def alive():
        gc.collect()
        return sum(type(thing).__module__ == LatestWins.__module__ for thing in gc.get_objects())

    busy = [threading.Thread(target=be_busy) for _ in range(3)]
    for thread in busy:
        thread.start()
    try:
        jobs, arrived = LatestWins(lambda request: request), []
        jobs.computed.connect(arrived.append)
        before = alive()
        for request in range(100):
            jobs.request(request)
            qtbot.waitUntil(lambda request=request: arrived[-1:] == [request], timeout=30_000)
        assert alive() == before
        jobs.shut_down()
    finally:
        stop.set()
        for thread in busy:
            thread.join()


def test_what_is_no_longer_wanted_ends_at_its_next_checkpoint(qapp, qtbot):
    ended = []

    def compute(request):
        try:
            while request != "last":
                jobs.checkpoint(0.5)
                time.sleep(0.001)
        except Cancelled:
            ended.append(request)
            raise
        return request

    jobs, arrived, failed, told = LatestWins(compute), [], [], []
    jobs.computed.connect(arrived.append)
    jobs.failed.connect(failed.append)
    jobs.progressed.connect(told.append)
    jobs.request("first")
    qtbot.waitUntil(lambda: told == [0.5])
    with qtbot.waitSignal(jobs.stopped):
        jobs.stop()
    assert jobs.is_idle
    jobs.request("second")
    jobs.request("last")
    qtbot.waitUntil(lambda: jobs.is_idle)
    assert arrived == ["last"]
    jobs.request("third")
    jobs.shut_down()
    assert ended == ["first", "second", "third"]
    assert failed == []
