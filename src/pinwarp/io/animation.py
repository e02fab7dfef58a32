"""Animations as GIF files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from pinwarp.io.atomic import atomic_path

Frame = NDArray[np.uint8]

# The palette is made from so many of the frames: colours hardly change from one to the next.
SAMPLED = 6
COLOURS = 256


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
