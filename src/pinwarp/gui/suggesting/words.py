"""What is said about a first guess: offered, under way, asked, shown, and why not."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np

from pinwarp.core.guessed import Reading
from pinwarp.core.words import counted, some_of

STARTING = "looking at the meshes"
CANCELLED = "Cancelled: no landmark was suggested."
MESH_CHANGED = "A mesh changed: what was suggested is of no use any more."
FAILED = "The first guess failed: Help > Copy Details says what went wrong. Nothing was changed."
LEFT = "The ghosts are gone; what was accepted stays."
ALL_TAKEN = "Every suggested landmark is placed; undo brings the last ghost back."
MIRRORED = (
    "The destination is the other side of the body: the source was mirrored. Undo takes it back."
)
WHICH = "Which of these is meant?"


def offer_in_words(count: int, key: str) -> str:
    """Say what could be done about landmarks that the destination lacks.

    Examples
    --------
    >>> offer_in_words(20, "Ctrl+G")
    'The destination has none of 20 landmarks yet: Ctrl+G suggests where they lie.'
    """
    where = "where they lie" if count > 1 else "where it lies"
    return f"The destination has none of {counted(count, 'landmark')} yet: {key} suggests {where}."


def going_in_words(name: str, radius: str, key: str) -> str:
    """Say what is asked for next, as rich text.

    Parameters
    ----------
    name
        The next landmark.
    radius
        How far off it may well be, in words.
    key
        Which key accepts it.
    """
    return (
        f"<b>{html.escape(name)}</b> ± {html.escape(radius)}: {key} accepts it, a click or a drag "
        "puts it right."
    )


def unplaced_in_words(names: Sequence[str]) -> str:
    """Say which landmarks have no ghost; empty where all have one.

    Examples
    --------
    >>> unplaced_in_words(["apex", "tip"])
    'The destination seems to end before apex, tip: no ghost is shown there.'
    """
    if not names:
        return ""
    return f"The destination seems to end before {some_of(names)}: no ghost is shown there."


def titles(readings: tuple[Reading, ...]) -> list[tuple[str, str]]:
    """Say of each reading what sets it apart from the best, and how well it fits."""
    best = readings[0]
    told = []
    for reading in readings:
        name = "The other side of the body" if reading.mirrored else "The same side of the body"
        alike = [one for one in readings if one.mirrored == reading.mirrored]
        if reading is not alike[0]:
            name += f", turned by {_angle(alike[0], reading):.0f}°"
        times = "" if reading is best else f", {reading.margin:.2f} times as far"
        told.append((name, f"{reading.fit:.1%} of its size apart{times}"))
    return told


def _angle(one: Reading, other: Reading) -> float:
    """Return by how many degrees one reading is turned against another of the same hand."""
    turn = other.pose.rotation @ one.pose.rotation.T
    return float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1.0, 1.0))))
