"""Particles of ShapeWorks: places between blanks, told apart by their order alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pinwarp.core.landmarks import Side
from pinwarp.io.landmark_formats import blank_table
from pinwarp.io.landmark_formats.reading import LandmarkReading
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written, numbers_text, placed_only

NAME = "ShapeWorks particles"
SUFFIXES = (".particles",)
HOLDS = Holds(names=False, empty=False)


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read places between blanks, as any other such table.

    Examples
    --------
    >>> read("a.particles", "1 2 3\n", Side.SOURCE).names
    ('landmark_0',)
    """
    return replace(blank_table.read(path, text, side), format=NAME)


def matches(head: str) -> bool:
    """Whether a text can only be of particles: it never can, other tables look the same."""
    del head
    return False


def text_of(outgoing: Outgoing) -> Written:
    """Return a line for each landmark.

    Parameters
    ----------
    outgoing
        Those that have no position on the side are left out.

    Examples
    --------
    >>> from pinwarp.core.landmarks import Landmark
    >>> print(text_of(Outgoing((Landmark("nasion", (1, 2, 3)),))).text, end="")
    1.0 2.0 3.0
    """
    assert outgoing.side is not None, "pairs are refused before"
    placed, notes = placed_only(outgoing.landmarks, outgoing.side)
    return Written("".join(f"{numbers_text(at, '')}\n" for _, at in placed), notes)
