"""Destinations that were only suggested: marked, counted, confirmed, kept in files."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import pytest
from tests.core.bones import landmarks, truth

from pinwarp.core.findings import FindingKind, Severity
from pinwarp.core.landmarks import Landmark, LandmarkState, Side, as_position
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.judging.check import check
from pinwarp.session.judging.report import report_of
from pinwarp.session.judging.suggested import about_suggested
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.session import Session
from pinwarp.session.suggesting.guessing import known_pairs
from pinwarp.session.warp.solved import solved

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


@pytest.fixture
def session():
    """Ten pairs, of which the first three are only suggested; one of those has a note."""
    u = landmarks(10)
    pairs = [
        Landmark(f"p{i}", as_position(a), as_position(b))
        for i, (a, b) in enumerate(zip(u, truth(u), strict=True))
    ]
    pairs[0] = replace(pairs[0], note="worn; deep")
    for i in range(3):
        pairs[i] = pairs[i].suggested(pairs[i].destination)
    return Session(landmarks=tuple(pairs))


def suggested(session):
    return [landmark.name for landmark in session.landmarks if landmark.is_suggested]


def test_a_landmark_is_suggested_by_its_note_and_only_with_a_destination():
    apex = Landmark("apex", (0, 0, 0), (1, 0, 0))
    assert apex.state is LandmarkState.PAIRED
    for note in ("suggested", "worn; suggested", " suggested ;worn"):
        assert replace(apex, note=note).state is LandmarkState.SUGGESTED, note
    for note in ("", "not suggested", "suggested by Anna"):
        assert replace(apex, note=note).state is LandmarkState.PAIRED, note
    assert not replace(apex, note="suggested", destination=None).is_suggested
    assert replace(apex, note="suggested", enabled=False).state is LandmarkState.DISABLED
    assert apex.by_hand() is apex


def test_suggesting_twice_says_it_once_and_keeps_the_rest_of_the_note():
    apex = Landmark("apex", (0, 0, 0), note="worn; deep")
    twice = apex.suggested((1, 0, 0)).suggested((2, 0, 0))
    assert (twice.note, twice.destination) == ("worn; deep; suggested", (2, 0, 0))
    assert twice.by_hand().note == "worn; deep"
    assert twice.accepted().note == "worn; deep; accepted unmoved"


def test_confirming_moving_and_deleting_end_it_and_undo_brings_it_back(session):
    editor = Editor(session)
    place = (1.0, 2.0, 3.0)
    for edit, left in (
        (lambda s: edits.confirm(s, "p1"), ["p0", "p2"]),
        (lambda s: edits.move(s, "p1", DESTINATION, place), ["p0", "p2"]),
        (lambda s: edits.remove_side(s, "p1", DESTINATION), ["p0", "p2"]),
        # The doubt is about the destination.
        (lambda s: edits.move(s, "p1", SOURCE, place), ["p0", "p1", "p2"]),
    ):
        editor.commit(edit(editor.session), "Edit")
        assert suggested(editor.session) == left
        editor.undo()
        assert editor.session == session
    assert edits.confirm(session, "p0").landmark("p0").note == "worn; deep; accepted unmoved"
    bare = edits.remove_side(edits.remove_side(session, "p1", DESTINATION), "p1", SOURCE)
    assert bare.landmark("p1").note == ""


def test_what_is_swapped_stays_suggested_for_the_other(session):
    swapped = edits.swap_destinations(session, "p0", "p5")
    assert suggested(swapped) == ["p1", "p2", "p5"]
    assert swapped.landmark("p0").note == "worn; deep"
    assert swapped.landmark("p5").destination == session.landmark("p0").destination
    assert suggested(edits.swap_destinations(session, "p0", "p1")) == ["p0", "p1", "p2"]


def test_check_and_report_count_them_and_say_what_to_do(session):
    words = "3 of 10 destination landmarks are only suggested: look at each."
    checked = check(session)
    found = next(x for x in checked.findings if x.finding.kind is FindingKind.SUGGESTED)
    assert (found.sentence, found.names) == (words, ("p0", "p1", "p2"))
    assert found.severity is Severity.WARNING
    assert not checked.is_flagged
    assert checked.as_json()["suggested"] == 3
    report = report_of("bones", solved(session), datetime(2026, 11, 22))
    assert dict(report.facts)["Pairs"] == "10 of 10 landmarks, 3 of them only suggested"
    assert words in report.findings
    for name in suggested(session):
        session = edits.confirm(session, name)
    checked = check(session)
    assert checked.suggested == 0
    assert not any(x.finding.kind is FindingKind.SUGGESTED for x in checked.findings)
    # Somebody has looked, but what was left where it was proves nothing.
    words = "3 of 10 pairs are as proposed, accepted unmoved. They prove nothing: "
    found = next(x for x in checked.findings if x.finding.kind is FindingKind.ACCEPTED)
    assert found.sentence.startswith(words)
    # Of the others alone is what it would be without them.
    rest = replace(session, landmarks=session.landmarks[3:])
    alone = check(rest).rms_leave_one_out
    assert found.finding.others == (10, pytest.approx(alone))
    assert found.sentence.endswith(f"error of the others alone is {alone:.3g} mm.")
    assert (found.names, found.severity) == (("p0", "p1", "p2"), Severity.REMARK)
    report = report_of("bones", solved(session), datetime(2026, 11, 22))
    told = dict(report.facts)["Pairs"]
    assert told == "10 of 10 landmarks, 3 as proposed (accepted unmoved)"
    assert found.sentence in report.findings


def test_with_too_few_others_no_error_of_theirs_is_told(session):
    for pair in session.landmarks[:6]:
        session = edits.confirm(session, pair.name)
    (found,) = about_suggested(session)
    assert found.finding.others == (10,)
    assert found.sentence.endswith("count them as if they did.")


def test_what_was_accepted_unmoved_is_known_until_it_is_moved(session, tmp_path):
    place = (1.0, 2.0, 3.0)
    bare = edits.remove_side(session, "p5", DESTINATION)
    taken = edits.accept(bare, "p5", DESTINATION, place)
    assert taken.landmark("p5").is_accepted
    assert taken.landmark("p5").state is LandmarkState.PAIRED
    write_session(tmp_path / "bones.pinwarp.csv", taken)
    assert read_session(tmp_path / "bones.pinwarp.csv").landmarks == taken.landmarks
    for edit in (
        lambda s: edits.move(s, "p5", DESTINATION, (1.0, 2.0, 3.5)),
        lambda s: edits.move(s, "p5", SOURCE, place),
        lambda s: edits.remove_side(s, "p5", DESTINATION),
        lambda s: edits.swap_destinations(s, "p5", "p6"),
    ):
        assert not edit(taken).landmark("p5").is_accepted
        assert edit(taken).landmark("p5").note == ""


def test_a_first_guess_learns_nothing_from_what_was_accepted_unmoved(session):
    known = [pair.name for pair in known_pairs(edits.confirm(session, "p1"))]
    assert known == [f"p{i}" for i in range(3, 10)]
    moved = edits.move(session, "p1", DESTINATION, (1.0, 2.0, 3.0))
    assert "p1" in [pair.name for pair in known_pairs(moved)]


def test_a_session_file_keeps_it(session, tmp_path):
    write_session(tmp_path / "bones.pinwarp.csv", session)
    kept = read_session(tmp_path / "bones.pinwarp.csv")
    assert kept.landmarks == session.landmarks
    assert suggested(kept) == ["p0", "p1", "p2"]
