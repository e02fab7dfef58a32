"""From every landmark format to every other and back: what both can hold is still there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.landmark_files import FORMATS, LandmarkFormat, read_landmarks, write_landmarks
from pinwarp.io.landmark_formats import bigwarp, bigwarp_json, opensim_creator
from pinwarp.io.landmark_formats.reading import ReadGroup
from pinwarp.session.importing.conversion import Meant, convert_landmarks

# Where a format says neither: 3D Slicer needs both.
MEANT = Meant("mm", "LPS")
ALONG = tuple(f"C000-{number:03d}" for number in range(3))
MARKS = (
    Landmark("nasion", (12.5, -40.2, 60.1), (1.0, 2.0, 3.0), note="worn, left", locked=True),
    Landmark("inion", (0.1, 0.2, 0.3), (4.0, 5.0, 6.0), enabled=False),
    Landmark("unset"),
    *(Landmark(name, (n / 3, 1.0, 2.0), (n + 7.0, 8.0, 9.0)) for n, name in enumerate(ALONG)),
)
CURVE = ReadGroup("C000", ALONG)
BIGWARPS: set[LandmarkFormat] = {bigwarp, bigwarp_json}


def name_of(known: LandmarkFormat) -> str:
    return known.NAME


def meant(target: LandmarkFormat) -> Meant:
    """What has to be said of a file that says it neither, and may not be said of another."""
    return Meant() if target.HOLDS.frame else MEANT


@pytest.mark.parametrize("there", FORMATS, ids=name_of)
@pytest.mark.parametrize("here", FORMATS, ids=name_of)
def test_what_two_formats_hold_survives_the_way_there_and_back(
    tmp_path: Path, here: LandmarkFormat, there: LandmarkFormat
) -> None:
    first, between, last = (
        tmp_path / f"{name}{known.SUFFIXES[0]}"
        for name, known in (("first", here), ("between", there), ("last", here))
    )
    side = None if here.HOLDS.pairs and there.HOLDS.pairs else Side.SOURCE
    write_landmarks(first, MARKS, side if here.HOLDS.pairs else Side.SOURCE, groups=[CURVE])
    # A file of pairs may hold one side of them, too.
    done = convert_landmarks(first, between, side=side, meant=meant(here))
    convert_landmarks(between, last, side=side, meant=meant(there))
    reading = read_landmarks(last, Side.SOURCE)
    assert reading.format == here.NAME

    def both(what: str) -> bool:
        return bool(getattr(here.HOLDS, what) and getattr(there.HOLDS, what))

    # A half pair is never active in BigWarp, which says nothing then.
    switches = both("switches") and (side is None or not {here, there} & BIGWARPS)
    empty = both("empty") or (side is None and {here, there} <= {opensim_creator, *BIGWARPS})
    expected = [
        replace(
            mark if side is None else mark.placed(Side.DESTINATION, None),
            note=mark.note if both("notes") else "",
            locked=mark.locked and both("locks"),
            enabled=mark.enabled or not switches,
        )
        for mark in MARKS
        if mark.source is not None or empty
    ]
    found = reading.landmarks
    if not both("names"):
        assert len(found) == len(expected)
        found = tuple(replace(x, name=y.name) for x, y in zip(found, expected, strict=True))
    assert found == tuple(expected)
    if both("curves"):
        (group,) = reading.groups
        assert [reading.names.index(x) for x in group.points] == [3, 4, 5]
    told = " ".join(done.notes)
    for words, gone in (
        ("only their order", not there.HOLDS.names),
        ("notes: those of", here.HOLDS.notes and not there.HOLDS.notes),
        ("locks: those of", here.HOLDS.locks and not there.HOLDS.locks),
        ("taken for landmarks", here.HOLDS.curves and not there.HOLDS.curves),
        ("left out", here.HOLDS.empty and not there.HOLDS.empty),
    ):
        assert not gone or words in told, words
