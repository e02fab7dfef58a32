"""The program is killed in the middle of work: at most two seconds of it are missing."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.gui.working_window import digest_of

from pinwarp.session.keeping.recovery import find_lost_work

# More of them by hand: PINWARP_KILLS=20 pytest -s tests/gui/test_kill.py
KILLS = int(os.environ.get("PINWARP_KILLS", "3"))
MOST_LOST = 2.0
REPOSITORY = Path(__file__).resolve().parents[2]


def work_and_kill(session: Path, state_folder: Path) -> tuple[float, list[tuple[float, str]]]:
    """Let a window work for a random while; return when it was killed, and what it had done."""
    with subprocess.Popen(
        [sys.executable, "-m", "tests.gui.working_window", str(session), str(state_folder)],
        cwd=REPOSITORY,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        lines = [process.stdout.readline(), process.stdout.readline()]
        time.sleep(random.uniform(0.0, 2.5))
        killed = time.monotonic()
        process.kill()
        lines += process.stdout.readlines()
    assert process.returncode != 0, "it was killed and did not end by itself"
    states = [line.split() for line in lines]
    return killed, [(float(moment), digest) for moment, digest in states]


@pytest.mark.parametrize("kill", range(KILLS))
def test_a_killed_window_loses_no_more_than_two_seconds(sample_copy, tmp_path, kill):
    saved = sample_copy.read_bytes()
    killed, states = work_and_kill(sample_copy, tmp_path / "state")
    lost = find_lost_work(tmp_path / "state" / "windows")
    # With nothing to restore there is the saved file, which is what was opened at first.
    found = digest_of(lost[0].work.record) if lost else states[0][1]
    # A session that undo brought back was current more than once: its last time counts.
    index = max(i for i, (_, digest) in enumerate(states) if digest == found)
    is_newest = index == len(states) - 1
    lost_seconds = 0.0 if is_newest else killed - states[index + 1][0]
    print(f"kill {kill}: {len(states)} changes, {lost_seconds:.3f} s lost")
    assert lost_seconds < MOST_LOST
    assert sample_copy.read_bytes() == saved
    assert [work.work.path for work in lost] in ([sample_copy], [])
