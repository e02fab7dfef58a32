"""Reading a text as if it were a file."""

from __future__ import annotations

import tempfile
from pathlib import Path

from pinwarp.core.landmarks import Position, Side
from pinwarp.io.landmark_files import LandmarkReading, read_landmarks


def read(content: str | bytes, suffix: str = "", side: Side = Side.SOURCE) -> LandmarkReading:
    """Read a file ``a`` with that content."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"a{suffix}")
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_landmarks(path, side)


def sources(reading: LandmarkReading) -> dict[str, Position | None]:
    """Name and source position of what was found."""
    return {landmark.name: landmark.source for landmark in reading.landmarks}


def skipped(reading: LandmarkReading) -> list[tuple[int, str]]:
    """Line and reason of what was skipped."""
    return [(line.line, line.reason) for line in reading.skipped]
