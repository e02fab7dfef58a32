"""What reading a landmark file gives, whichever program wrote it."""

from __future__ import annotations

from dataclasses import dataclass

from pinwarp.core.landmarks import Landmark


@dataclass(frozen=True)
class SkippedLine:
    """A line that could not be used.

    Parameters
    ----------
    line
        Its number, counted from 1.
    text
        What it says.
    reason
        Why it was skipped.
    """

    line: int
    text: str
    reason: str


@dataclass(frozen=True)
class LandmarkReading:
    """What was found in a landmark file.

    Parameters
    ----------
    landmarks
        In the order of the file; a file of one side fills that side only.
    is_pairs
        Whether the file holds both sides.
    skipped
        The lines that could not be used; blank lines and comments are not among them.
    """

    landmarks: tuple[Landmark, ...]
    is_pairs: bool
    skipped: tuple[SkippedLine, ...]
