"""GIF files."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from pinwarp.io.animation import durations, write_gif


def moving_square(frames: int, size: int = 40) -> list[np.ndarray]:
    pictures = []
    for i in range(frames):
        picture = np.full((size, size + 10, 3), 230, np.uint8)
        picture[10:20, i : i + 10] = (63, 143, 210)
        pictures.append(picture)
    return pictures


def test_frames_come_back_in_order_and_repeat_for_ever(tmp_path):
    frames = moving_square(12)
    path = tmp_path / "square.gif"
    write_gif(path, frames, 3.0)
    with Image.open(path) as found:
        assert (found.n_frames, found.size, found.info["loop"]) == (12, (50, 40), 0)
        total = 0
        for number, frame in enumerate(frames):
            found.seek(number)
            shown = np.asarray(found.convert("RGB")).astype(int)
            assert np.abs(shown - frame).max() <= 8
            total += found.info["duration"]
    assert total == 3000


@given(count=st.integers(1, 600), seconds=st.floats(0.2, 60))
def test_the_frames_together_take_the_time_that_was_asked_for(count, seconds):
    shares = durations(count, seconds)
    assert abs(sum(shares) - 1000 * seconds) <= 5 + 1e-6
    assert max(shares) - min(shares) <= 10


def test_a_cancelled_animation_leaves_the_old_file(tmp_path):
    path = tmp_path / "square.gif"
    path.write_bytes(b"older")

    def cancel(_share: float, stage: str) -> None:
        if stage == "writing":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_gif(path, moving_square(3), 1.0, progress=cancel)
    assert path.read_bytes() == b"older"
    assert [x.name for x in tmp_path.iterdir()] == ["square.gif"]
