"""What a session gives a first guess, and what comes back into it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.core.hooked import hooked, places, subject

from pinwarp.core.errors import PinwarpError
from pinwarp.core.findings import FindingKind
from pinwarp.core.guessed import Reading
from pinwarp.core.landmarks import Landmark, Role, Side, as_position, positions
from pinwarp.core.pose import Pose
from pinwarp.core.spline import factorise, solve
from pinwarp.core.surface import Surface
from pinwarp.io.meshes import MeshFile
from pinwarp.io.session_file import MeshReference
from pinwarp.session import edits
from pinwarp.session.judging.quality import quality_of
from pinwarp.session.session import Session
from pinwarp.session.suggesting import (
    SuggestInputs,
    ghosts_of,
    mirrored_first,
    missing_of,
    why_not,
    with_suggestions,
)
from pinwarp.session.warp.solved import solved


@pytest.fixture(scope="module")
def session():
    """A bone with ten landmarks and a passenger, and a subject's without any."""
    marks = [Landmark(f"p{k}", as_position(place)) for k, place in enumerate(places(10))]
    return Session(
        source=MeshFile(Path("source.ply"), hooked(), "sha256:one", ()),
        destination=MeshFile(Path("subject.ply"), subject(hooked()), "sha256:two", ()),
        landmarks=(*marks, Landmark("muscle", (1, 2, 3), role=Role.PASSENGER)),
    )


def read(session: Session, *, mirrored=False) -> Reading:
    """A reading of the session that is known: each place goes where it is, or to its mirror."""
    pose = Pose(1.0, np.diag([1.0, -1.0 if mirrored else 1.0, 1.0]), np.array([40.0, -70, 110]))
    corners = 50 * np.vstack([np.zeros(3), np.eye(3)])
    spline = solve(factorise(corners), pose.apply(corners))
    return Reading(pose, spline, Surface(session.mesh(Side.DESTINATION)), 60.0, 0.01, 6.0)


def without(session, **changes):
    return replace(session, **changes)


def test_why_nothing_can_be_suggested_is_said_with_the_way_out(session):
    lost = MeshReference("gone.ply", "sha256:three", 3)
    assert why_not(session) is None
    for broken, words in (
        (without(session, source=None), "no source mesh: open"),
        (without(session, destination=None), "no destination mesh: open"),
        (without(session, destination=lost), "gone.ply is not there"),
        (without(session, landmarks=session.landmarks[-1:]), "no landmark on the source: place"),
        (with_suggestions(session, read(session)), "on the destination already"),
    ):
        assert words in why_not(broken)
        with pytest.raises(PinwarpError, match=words):
            SuggestInputs.of(broken)


def test_a_guess_is_out_of_date_with_other_meshes_and_with_other_pairs(session):
    inputs = SuggestInputs.of(session)
    assert SuggestInputs.of(edits.add_passenger(session, (0, 0, 0))[0]).fingerprint == (
        inputs.fingerprint
    )
    paired = SuggestInputs.of(edits.move(session, "p3", Side.DESTINATION, (1, 2, 3)))
    assert (paired.fingerprint != inputs.fingerprint, paired.meshes) == (True, inputs.meshes)
    mirrored = SuggestInputs.of(edits.mirror_source(session, "x"))
    assert mirrored.meshes != inputs.meshes


def test_what_was_only_suggested_is_neither_known_nor_missing(session):
    (first, *rest) = session.landmarks
    suggested = without(session, landmarks=(first.suggested((1, 2, 3)), *rest))
    assert len(SuggestInputs.of(suggested).pairs[0]) == 0
    assert "p0" not in [ghost.name for ghost in ghosts_of(read(session), suggested)]


def test_every_missing_landmark_is_expected_on_the_surface_and_no_passenger(session):
    ghosts = ghosts_of(read(session), session)
    assert {ghost.name for ghost in ghosts} == {f"p{k}" for k in range(10)}
    assert {ghost.radius for ghost in ghosts} == {6.0}
    off = Surface(session.mesh(Side.DESTINATION)).index.distances([x.position for x in ghosts])
    assert off.max() < 1e-9


def test_accepting_one_moves_the_others(session):
    reading = read(session)
    before = {ghost.name: ghost.position for ghost in ghosts_of(reading, session)}
    place = np.add(before["p0"], [8.0, 0, 0])
    after = ghosts_of(reading, edits.move(session, "p0", Side.DESTINATION, as_position(place)))
    assert "p0" not in [ghost.name for ghost in after]
    moved = [np.linalg.norm(np.subtract(x.position, before[x.name])) for x in after]
    assert max(moved) > 0.5
    assert {ghost.radius for ghost in after} != {6.0}


def test_suggestions_are_marked_and_leave_what_is_there(session):
    landmarks = list(session.landmarks)
    landmarks[1] = replace(landmarks[1], note="deep")
    landmarks[2] = landmarks[2].placed(Side.DESTINATION, (50.0, -60.0, 100.0))
    landmarks[3] = replace(landmarks[3], enabled=False)
    begun = without(session, landmarks=tuple(landmarks))
    placed = with_suggestions(begun, read(session))
    assert placed.landmark("p1").note == "deep; suggested"
    assert placed.landmark("p2") == begun.landmark("p2")
    assert placed.landmark("p3") == begun.landmark("p3")
    assert placed.landmark("muscle").destination is None
    assert missing_of(placed) == ()
    assert begun.landmark("p0").destination is None


def test_the_other_side_of_the_body_is_read_with_the_source_in_a_mirror(session):
    other = replace(
        session.destination, mesh=subject(hooked(), np.diag([-1.0, -1.0, 1.0]), mirrored=True)
    )
    session = without(session, destination=other)
    reading = read(session, mirrored=True)
    turned, read_so = mirrored_first(session, reading)
    assert (turned.source.mirrored, read_so.mirrored) == ("y", False)
    np.testing.assert_allclose(
        read_so.evaluate(positions(turned.landmarks, Side.SOURCE)),
        reading.evaluate(positions(session.landmarks, Side.SOURCE)),
        atol=1e-9,
    )
    placed = with_suggestions(session, reading)
    assert not [
        x for x in quality_of(solved(placed).result).findings if x.kind is FindingKind.MIRRORED
    ]
    assert session.source.mirrored == ""
