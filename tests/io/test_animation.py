"""GIF and MP4 files."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from pinwarp.core.errors import PinwarpError
from pinwarp.io.animation import durations, has_encoder, write_gif, write_mp4


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


needs_encoder = pytest.mark.skipif(not has_encoder(), reason="needs the extra 'video'")


@needs_encoder
def test_an_mp4_holds_all_frames_for_as_long_as_was_asked(tmp_path):
    import imageio_ffmpeg

    path, frames = tmp_path / "square.mp4", moving_square(12)
    write_mp4(path, [frame[:-1, :-1] for frame in frames], 3.0, remarks=["made by a test"])
    count, seconds = imageio_ffmpeg.count_frames_and_secs(path)
    assert count == 12
    assert seconds == pytest.approx(3.0, abs=0.05)
    reader = imageio_ffmpeg.read_frames(path)
    width, height = next(reader)["size"]
    high, wide = frames[0].shape[:2]
    # Odd lengths are made even.
    assert (width, height) == (wide, high)
    for frame in frames:
        found = np.frombuffer(next(reader), np.uint8).reshape(height, width, 3).astype(int)
        assert np.abs(found[:-1, :-1] - frame[:-1, :-1]).mean() < 12
    reader.close()
    assert b"made by a test" in path.read_bytes()


@needs_encoder
def test_a_cancelled_mp4_leaves_the_old_file(tmp_path):
    path = tmp_path / "old.mp4"
    path.write_bytes(b"old")

    def cancel(share, _stage):
        if share > 0.3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_mp4(path, moving_square(6), 1.0, progress=cancel)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


ENCODERS = {
    "#!/bin/sh\ncat > /dev/null\necho 'no such codec' >&2\nexit 3\n": "no such codec",
    "#!/bin/sh\nexec 0<&-\necho 'at once' >&2\nexit 1\n": "at once",
    "#!/bin/sh\ncat > /dev/null\n": "code 0",
    "": "does not start",
}


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-ins are scripts of a shell")
@pytest.mark.parametrize("script", ENCODERS)
def test_an_encoder_that_fails_is_told_and_leaves_the_old_file(tmp_path, monkeypatch, script):
    encoder = tmp_path / "ffmpeg"
    encoder.write_text(script)
    encoder.chmod(0o755 if script else 0o644)
    stand_in = SimpleNamespace(get_ffmpeg_exe=lambda: str(encoder))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", stand_in)
    folder = tmp_path / "out"
    folder.mkdir()
    path = folder / "old.mp4"
    path.write_bytes(b"old")
    with pytest.raises(PinwarpError, match=ENCODERS[script]):
        write_mp4(path, [np.zeros((600, 600, 3), np.uint8)] * 3, 1.0)
    assert path.read_bytes() == b"old"
    assert list(folder.iterdir()) == [path]


def test_without_an_encoder_it_is_said_how_to_get_one(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(PinwarpError, match=r"pip install .pinwarp\[video\]"):
        write_mp4(tmp_path / "a.mp4", moving_square(2), 1.0)
    assert list(tmp_path.iterdir()) == []
