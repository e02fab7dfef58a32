"""Curves and patches come in from the files of other programs, and go out and come back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.session.study import add_groups, make_study

from pinwarp.core.groups import Curve, Handle, Patch
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.landmark_files import LandmarkReading, read_landmarks
from pinwarp.io.landmark_formats.reading import ReadGroup
from pinwarp.io.semilandmark_files import semilandmark_files, write_all
from pinwarp.session import edits
from pinwarp.session.importing.asking import is_plain
from pinwarp.session.importing.fit import Fit, fitted
from pinwarp.session.importing.landmarks import (
    Arriving,
    ImportChoice,
    Pairing,
    group_words,
    imported,
)
from pinwarp.session.outputs.semilandmarks import semilandmarks_on
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
AS_NEW = ImportChoice(Pairing.AS_NEW)
BY_NAME = ImportChoice(Pairing.BY_NAME)


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """The study's session, its ring anchored at one landmark."""
    folder = tmp_path_factory.mktemp("imports") / "study"
    make_study(folder, 1)
    session = add_groups(folder)
    ring = session.group("ring")
    first = ring.handles[0]
    mark = Landmark("anchor", first.source, first.destination)
    ring = replace(ring, handles=(replace(first, landmark="anchor"), *ring.handles[1:]))
    groups = tuple(ring if x.name == "ring" else x for x in session.groups)
    return replace(session, landmarks=(*session.landmarks, mark), groups=groups, slid=None)


def line(name, *places, side=SOURCE, **more):
    """A file that holds one curve."""
    marks = tuple(Landmark(f"{name}{n}").placed(side, x) for n, x in enumerate(places))
    group = ReadGroup(name, tuple(mark.name for mark in marks), **more)
    return Arriving("a.mrk.json", LandmarkReading(marks, False, (), groups=(group,)), side)


PLACES = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0))


def written(tmp_path, session, suffix, side):
    points, _ = semilandmarks_on(session, side)
    texts, _ = semilandmark_files(tmp_path / f"{side.value}{suffix}", points)
    write_all(texts)
    return list(texts)


@pytest.mark.parametrize("suffix", [".pts", ".curves.tps", ".tps", ".mrk.json"])
def test_what_goes_out_comes_back_on_both_sides(session, tmp_path, suffix):
    bare = replace(session, landmarks=(), groups=())
    for side in (SOURCE, DESTINATION):
        for path in written(tmp_path, session, suffix, side):
            if path.suffix == ".csv" or "ball" in path.name:
                continue
            file = Arriving(path, read_landmarks(path, side), side)
            pairing = Pairing.BY_NAME
            bare = imported(bare, file, ImportChoice(pairing))
    curves = [x for x in bare.groups if isinstance(x, Curve)]
    assert len(curves) == 1
    (ring,) = curves
    points, _ = semilandmarks_on(session, SOURCE)
    own = [points.places[row][1] for row in points.curves[0].points]
    assert ring.is_closed == (suffix != ".pts")
    assert set(own) <= set(ring.places(SOURCE))
    assert ring.is_drawn
    anchored = suffix != ".pts"
    assert len(ring.anchors) == anchored
    if suffix in (".pts", ".tps"):
        (patch,) = [x for x in bare.groups if isinstance(x, Patch)]
        assert patch.count == len(points.patches[0].points)
    # Landmarks are no points of curves, nor the other way round.
    assert len(bare.pairs) == 9


def test_a_curve_comes_in_through_its_control_points_and_finds_its_landmark():
    apex = Landmark("apex", PLACES[1])
    after = imported(Session(landmarks=(apex,)), line("crest", *PLACES, are_handles=True), BY_NAME)
    (crest,) = after.groups
    assert crest.places(SOURCE) == PLACES
    assert [handle.landmark for handle in crest.handles] == ["", "apex", ""]
    assert crest.count == 20
    assert after.landmarks == (apex,)
    points = imported(Session(), line("crest", *PLACES), BY_NAME).groups[0]
    assert points.count == 3


def test_what_becomes_of_a_curve_is_said_before():
    session = Session()
    arriving = line("crest", *PLACES, is_closed=True)
    assert not is_plain(session, arriving)
    assert group_words(session, arriving, BY_NAME) == (
        "crest: a closed curve through 3 places, 3 points.",
    )
    there = line("crest", *PLACES, side=DESTINATION)
    assert "no curve of that name on the source" in group_words(session, there, BY_NAME)[0]
    assert imported(session, there, BY_NAME) == session
    short = line("crest", PLACES[0], PLACES[0])
    assert group_words(session, short, BY_NAME) == (
        "Left out: crest: a curve goes through at least 2 places.",
    )


def test_on_the_destination_the_curve_of_that_name_is_drawn():
    session = imported(Session(), line("crest", *PLACES), BY_NAME)
    there = ((5.0, 0.0, 0.0), (6.0, 0.0, 0.0), (6.0, 1.0, 0.0))
    after = imported(session, line("crest", *there, side=DESTINATION), BY_NAME)
    assert after.group("crest").is_drawn
    assert after.group("crest").places(DESTINATION) == there
    assert after.group("crest").places(SOURCE) == PLACES
    # Drawn through fewer places, the handles spread over them as on the source.
    two = line("crest", there[0], (9.0, 0.0, 0.0), side=DESTINATION)
    spread = imported(session, two, BY_NAME).group("crest")
    np.testing.assert_allclose(spread.places(DESTINATION), [(5, 0, 0), (7, 0, 0), (9, 0, 0)])
    assert "3 handles spread over 2 places" in group_words(session, two, BY_NAME)[0]
    closed = line("crest", *there, side=DESTINATION, is_closed=True)
    assert "closed on one bone and open on the other" in group_words(session, closed, BY_NAME)[0]


def test_a_landmark_of_the_curve_stays_where_it_is_or_is_placed_with_it():
    apex, tip = Landmark("apex", PLACES[0], (9.0, 9.0, 9.0)), Landmark("tip", PLACES[2])
    session = imported(Session(landmarks=(apex, tip)), line("crest", *PLACES), BY_NAME)
    there = ((5.0, 0.0, 0.0), (6.0, 0.0, 0.0), (6.0, 1.0, 0.0))
    after = imported(session, line("crest", *there, side=DESTINATION), BY_NAME)
    assert after.landmark("apex").destination == (9.0, 9.0, 9.0)
    assert after.landmark("tip").destination == there[2]
    assert after.group("crest").is_drawn


def test_curves_that_are_only_numbered_are_meant_in_order():
    session = imported(Session(), line("crest", *PLACES), BY_NAME)
    after = imported(session, line("C000", *PLACES, side=DESTINATION), BY_NAME)
    assert after.group("crest").is_drawn
    words = group_words(session, line("C000", *PLACES, side=DESTINATION), BY_NAME)
    assert words == ("crest (C000 in the file): drawn on the destination.",)


def test_a_patch_keeps_its_name_from_a_curve_and_is_left_out_on_the_destination():
    session = imported(Session(), line("cap", *PLACES), BY_NAME)
    patch = line("cap", *PLACES, is_curve=False)
    after = imported(session, patch, BY_NAME)
    assert [type(x) for x in after.groups] == [Curve, Patch]
    assert after.group("cap_2").points == PLACES
    there = line("cap", *PLACES, is_curve=False, side=DESTINATION)
    assert "by sliding" in group_words(session, there, BY_NAME)[0]
    assert imported(after, there, BY_NAME) == after


def test_curves_are_read_in_the_frame_that_was_chosen():
    choice = ImportChoice(Pairing.BY_NAME, {SOURCE: Fit(True, 10.0)})
    after = imported(Session(), line("crest", *PLACES), choice)
    assert after.group("crest").places(SOURCE)[2] == (-10.0, -10.0, 0.0)
    turned = fitted(after, SOURCE, Fit(True, 0.1))
    np.testing.assert_allclose(turned.group("crest").places(SOURCE), PLACES)


def test_what_came_in_slides(session, tmp_path):
    bare = replace(session, groups=())
    for path in written(tmp_path, session, ".mrk.json", SOURCE)[1:]:
        bare = imported(bare, Arriving(path, read_landmarks(path, SOURCE), SOURCE), AS_NEW)
    result = WarpSolver().solve_landmarks(WarpInputs.of(bare))
    assert result.not_sliding is None
    assert result.semilandmarks.count > 8


def test_a_curve_that_comes_again_takes_the_place_of_the_one_before():
    first = imported(Session(), line("crest", *PLACES), BY_NAME)
    first = edits.accept_curve(first, "crest", [(1.0, 1.0, x) for x in (0.0, 1.0, 2.0)])
    lower = tuple((x, y, -1.0) for x, y, _ in PLACES)
    again = imported(first, line("crest", *lower), BY_NAME)
    assert again.group("crest").places(SOURCE) == lower
    assert again.group("crest").is_drawn
    fewer = imported(first, line("crest", *lower[:2]), BY_NAME)
    assert not fewer.group("crest").is_drawn
    assert fewer.group("crest").handles == tuple(map(Handle, lower[:2]))
