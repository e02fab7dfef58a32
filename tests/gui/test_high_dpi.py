"""Where a pixel of the mouse is more than one of the screen, or one and a half."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest


@pytest.mark.parametrize("ratio", [1.5, 2])
def test_the_mouse_meets_what_is_seen_on_screens_with_small_pixels(ratio):
    done = subprocess.run(
        [sys.executable, "-m", "tests.gui.scaled_window"],
        env={**os.environ, "QT_SCALE_FACTOR": str(ratio)},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout.splitlines()[-1])
    assert told["ratio"] == ratio
    assert max(abs(x) for row in told["outline"] for x in row) <= 2
    assert told["hovers"]
    assert told["placed"] == [0, 0]
    assert max(abs(a - b) for a, b in zip(told["dragged"], (1, 30), strict=True)) <= 1
