"""Animations as GIF files, and as MP4 where the encoder is there."""

from __future__ import annotations

import contextlib
import importlib.util
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from pinwarp.core.errors import PinwarpError
from pinwarp.io.atomic import atomic_path

Frame = NDArray[np.uint8]

# The palette is made from so many of the frames: colours hardly change from one to the next.
SAMPLED = 6
COLOURS = 256
ENCODER_MISSING = 'MP4 needs an encoder that is not installed: pip install "pinwarp[video]"'


def _silent(_share: float, _stage: str) -> None:
    return


def write_gif(
    path: str | Path,
    frames: Sequence[Frame],
    seconds: float,
    *,
    remarks: Sequence[str] = (),
    progress: Callable[[float, str], None] = _silent,
) -> None:
    """Write frames as a GIF that repeats for ever, all of it or nothing.

    Parameters
    ----------
    path
        The file.
    frames
        At least one, all (height, width, 3) RGB and of one size.
    seconds
        How long they take together; GIF counts in hundredths.
    remarks
        A line each for people, such as what made it; it becomes the file's comment.
    progress
        Told the share that is done and what is going on; may raise to cancel.

    Raises
    ------
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile
    >>> grey = [np.full((4, 6, 3), level, np.uint8) for level in (0, 120, 240)]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_gif(Path(folder, "grey.gif"), grey, 1.0)
    ...     with Image.open(Path(folder, "grey.gif")) as found:
    ...         print(found.size, found.n_frames)
    (6, 4) 3
    """
    # One palette for all: else what stands still would flicker.
    chosen = np.linspace(0, len(frames) - 1, min(SAMPLED, len(frames))).round().astype(int)
    palette = Image.fromarray(np.vstack([frames[i] for i in chosen])).quantize(COLOURS)
    pictures = []
    for number, frame in enumerate(frames):
        progress(0.8 * number / len(frames), "choosing colours")
        picture = Image.fromarray(frame)
        pictures.append(picture.quantize(palette=palette, dither=Image.Dither.NONE))
    progress(0.8, "writing")
    with atomic_path(path) as temporary:
        pictures[0].save(
            temporary,
            format="GIF",
            save_all=True,
            append_images=pictures[1:],
            duration=durations(len(pictures), seconds),
            loop=0,
            comment="\n".join(remarks).encode(),
        )


def durations(count: int, seconds: float) -> list[int]:
    """Share a time over frames, in milliseconds that GIF can say: multiples of ten.

    Examples
    --------
    >>> durations(3, 0.1), sum(durations(60, 4.0))
    ([30, 40, 30], 4000)
    """
    ends = np.round(np.linspace(0, 100 * seconds, count + 1)).astype(int)
    return [10 * int(hundredths) for hundredths in np.diff(ends)]


def has_encoder() -> bool:
    """Return whether what writes MP4 is installed.

    Examples
    --------
    >>> isinstance(has_encoder(), bool)
    True
    """
    return importlib.util.find_spec("imageio_ffmpeg") is not None


def write_mp4(
    path: str | Path,
    frames: Sequence[Frame],
    seconds: float,
    *,
    remarks: Sequence[str] = (),
    progress: Callable[[float, str], None] = _silent,
) -> None:
    """Write frames as an MP4 (H.264), all of it or nothing.

    Parameters
    ----------
    path
        The file.
    frames
        At least one, all (height, width, 3) RGB and of one size. Its last column or row stands
        twice where a length is odd: the format knows only even ones.
    seconds
        How long they take together.
    remarks
        A line each for people, such as what made it; it becomes the file's comment.
    progress
        Told the share that is done and what is going on; may raise to cancel.

    Raises
    ------
    PinwarpError
        When the encoder is not installed, or fails; an older file is untouched.
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile
    >>> grey = [np.full((16, 16, 3), level, np.uint8) for level in (0, 120, 240)]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     found = Path(folder, "grey.mp4")
    ...     if has_encoder():
    ...         write_mp4(found, grey, 1.0)
    ...         assert found.read_bytes()[4:8] == b"ftyp"
    """
    height, width = (length + length % 2 for length in frames[0].shape[:2])
    command = [
        *(_encoder(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"),
        *("-s", f"{width}x{height}", "-r", f"{len(frames)}/{seconds}", "-i", "-"),
        # What every player knows; colours as on screens.
        *("-an", "-c:v", "libx264", "-crf", "16", "-vf", "scale=out_color_matrix=bt709"),
        *("-pix_fmt", "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709"),
        *("-color_trc", "bt709", "-movflags", "+faststart"),
        *("-metadata", "comment=" + "\n".join(remarks), "-f", "mp4"),
    ]
    with atomic_path(path) as temporary, tempfile.TemporaryFile() as said:
        encoder = _started([*command, str(temporary)], said)
        try:
            _feed(encoder, frames, (height, width), progress)
        except BaseException:
            encoder.kill()
            raise
        finally:
            encoder.wait()
        if encoder.returncode or not temporary.stat().st_size:
            said.seek(0)
            words = said.read().decode(errors="replace").strip().splitlines()
            raise PinwarpError(
                f"The encoder failed: {words[-1] if words else f'code {encoder.returncode}'}. "
                "Nothing was written: try another folder or a smaller size, or export a GIF."
            )


def _encoder() -> str:
    try:
        import imageio_ffmpeg
    except ImportError:
        raise PinwarpError(f"{ENCODER_MISSING}.") from None
    try:
        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except RuntimeError as error:
        raise _damaged(error) from error


def _started(command: Sequence[str], said: IO[bytes]) -> subprocess.Popen[bytes]:
    try:
        return subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=said,
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        )
    except OSError as error:
        raise _damaged(error) from error


def _feed(
    encoder: subprocess.Popen[bytes],
    frames: Sequence[Frame],
    size: tuple[int, int],
    progress: Callable[[float, str], None],
) -> None:
    """Give all frames to an encoder, or as many as it takes before it gives up."""
    assert encoder.stdin is not None
    try:
        for number, frame in enumerate(frames):
            progress(number / len(frames), "encoding")
            beyond = [(0, size[0] - frame.shape[0]), (0, size[1] - frame.shape[1]), (0, 0)]
            try:
                encoder.stdin.write(np.pad(frame, beyond, mode="edge").tobytes())
            except OSError:
                # It says why.
                return
    finally:
        with contextlib.suppress(OSError):
            encoder.stdin.close()


def _damaged(error: Exception) -> PinwarpError:
    return PinwarpError(
        f"The encoder does not start ({error}): install it again with "
        "pip install --force-reinstall imageio-ffmpeg, or export a GIF."
    )
