"""A batch on a real Dask cluster of two processes, one of which is killed."""

from __future__ import annotations

import os
import signal
import tempfile
import threading
import time
from functools import partial

import pytest
from tests.session.study import make_study

from pinwarp.io.manifest import read_manifest
from pinwarp.io.summary_file import read_summary
from pinwarp.session.keeping.files import read_session
from pinwarp.session.study import batch
from pinwarp.session.study.cluster import on_cluster

distributed = pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def cluster():
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        yield cluster


def slowly(function, marks, task):
    """Do something after a while, and leave a mark that it was begun."""
    descriptor, _ = tempfile.mkstemp(dir=marks)
    os.close(descriptor)
    time.sleep(0.15)
    return function(task)


def test_the_command_runs_on_a_cluster(pinwarp_command, study, tmp_path, cluster):
    (study / "s1.csv").unlink()
    arguments = ("batch", study / "study.csv", "--session", study / "study.pinwarp.csv")
    there, here = tmp_path / "there", tmp_path / "here"
    on = ("--scheduler", cluster.scheduler_address)
    outcome = pinwarp_command(*arguments, "-o", there, *on, exit_code=1)
    assert "2 done, 0 unchanged, 1 failed of 3" in outcome.stdout
    assert "s1: study.csv, line 3: The file" in outcome.stderr
    pinwarp_command(*arguments, "-o", here, "--jobs", 1, exit_code=1)
    for name in ("s0_warped.ply", "s2_warped.ply", "s2_passengers.landmarks.csv"):
        assert (there / name).read_bytes() == (here / name).read_bytes()


def test_a_batch_on_a_cluster_can_be_stopped(cluster):
    stop = threading.Event()
    done = []
    slow = partial(on_cluster, scheduler=cluster.scheduler_address, stop=stop)
    for task, _ in slow(time.sleep, [0.1] * 100):
        done.append(task)
        stop.set()
    assert len(done) == 1


def test_a_batch_on_a_cluster_survives_the_death_of_a_worker(tmp_path, cluster):
    manifest = read_manifest(make_study(tmp_path, 24))
    source = read_session(tmp_path / "study.pinwarp.csv")
    out = tmp_path / "out"
    tasks = batch.plan(manifest, source, out)
    marks = tmp_path / "marks"
    marks.mkdir()
    with distributed.Client(cluster, set_as_default=False) as watching:
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
