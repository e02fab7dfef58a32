"""A Dask scheduler and workers as processes of their own, as a cluster has them."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
STARTS_WITHIN = 120.0


class DaskProcesses:
    """Starts them on this machine, and ends them all."""

    def __init__(self, folder: Path) -> None:
        self.address = ""
        self._folder = folder
        self._started: list[subprocess.Popen[bytes]] = []

    def start_scheduler(self, *, hiding: Path | None = None) -> subprocess.Popen[bytes]:
        """Start a scheduler on a free port; where a folder hides pinwarp, it has that one."""
        told = self._folder / "scheduler.json"
        # Should the tests be killed, the scheduler ends by itself, and with it its workers.
        options = ("--port", "0", "--host", "127.0.0.1", "--idle-timeout", "600 s")
        places = ("--scheduler-file", told, "--dashboard-address", ":0")
        process = self._start("dask_scheduler", *options, *places, path=hiding)
        until = time.monotonic() + STARTS_WITHIN
        while not (told.exists() and told.read_text()):
            assert process.poll() is None
            assert time.monotonic() < until
            time.sleep(0.05)
        self.address = json.loads(told.read_text())["address"]
        return process

    def start_worker(self, *options: str, hiding: Path | None = None) -> subprocess.Popen[bytes]:
        """Start a worker of one thread; where a folder hides pinwarp, it has that one."""
        place = ("--nthreads", "1", "--no-dashboard", "--local-directory", self._folder)
        return self._start("dask_worker", self.address, *place, *options, path=hiding)

    def _start(
        self, program: str, *arguments: object, path: Path | None
    ) -> subprocess.Popen[bytes]:
        paths = [str(x) for x in (path, ROOT / "src", ROOT) if x is not None]
        environment = os.environ | {
            "PYTHONPATH": os.pathsep.join(paths),
            # Of one that kills its workers the second is the last.
            "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1",
        }
        process = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{program}", *map(str, arguments)],
            env=environment,
            cwd=self._folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self._started.append(process)
        return process

    def kill(self, process: subprocess.Popen[bytes]) -> None:
        """End a process and those that it started, without a word."""
        # Once only: the number may be another's afterwards.
        self._started.remove(process)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()

    def kill_all(self) -> None:
        """End all that were started and are not killed yet."""
        for process in list(self._started):
            self.kill(process)
